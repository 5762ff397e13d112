#include "sweep/fit/optimum.h"

#include <algorithm>
#include <cmath>

#include "core/geometry/random.h"
#include "sweep/refine/bounded_minimum.h"

namespace drumsweep {
namespace {

/// Evenly spread points of [low, high]; a margin beyond is folded onto the faces.
std::vector<Point> candidates_in(const Point& low, const Point& high, int count, std::int64_t seed) {
  constexpr double margin = 0.06;
  std::vector<Point> out;
  for (int i = 0; i < count; ++i) {
    Point p = low_discrepancy(low.size(), seed, static_cast<std::uint64_t>(i));
    for (std::size_t k = 0; k < p.size(); ++k)
      p[k] = low[k] + (high[k] - low[k]) * std::clamp((1 + 2 * margin) * p[k] - margin, 0.0, 1.0);
    out.push_back(std::move(p));
  }
  return out;
}

/// Independent standard normals (rows x columns); Box and Muller.
Eigen::MatrixXd normals(Eigen::Index rows, Eigen::Index columns, std::int64_t seed, std::uint32_t round) {
  Eigen::MatrixXd out(rows, columns);
  for (Eigen::Index j = 0; j < columns; ++j)
    for (Eigen::Index i = 0; i < rows; i += 2) {
      const auto index = static_cast<std::uint64_t>(j) << 32 | static_cast<std::uint64_t>(i);
      const auto u = uniform4(seed, Purpose::posterior_draw, index, round);
      const double radius = std::sqrt(-2 * std::log(1 - u[0])), angle = 2 * M_PI * u[1];
      out(i, j) = radius * std::cos(angle);
      if (i + 1 < rows) out(i + 1, j) = radius * std::sin(angle);
    }
  return out;
}

/// Square root of a covariance that rounding may have made slightly indefinite.
Eigen::MatrixXd square_root(const Eigen::MatrixXd& covariance) {
  const double scale = covariance.diagonal().maxCoeff();
  for (double jitter = 1e-9; jitter < 1; jitter *= 10) {
    Eigen::MatrixXd k = covariance;
    k.diagonal().array() += jitter * scale;
    const Eigen::LLT<Eigen::MatrixXd> llt(k);
    if (llt.info() == Eigen::Success) return llt.matrixL();
  }
  return Eigen::MatrixXd::Zero(covariance.rows(), covariance.cols());
}

std::vector<Point> drawn_argmins(const std::vector<FittedSurface>& surfaces, const std::vector<Point>& candidates,
                                 int num_draws, std::int64_t seed, std::uint32_t round) {
  const int each = (num_draws + static_cast<int>(surfaces.size()) - 1) / static_cast<int>(surfaces.size());
  std::vector<Point> out;
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    const Posterior p = surfaces[s].posterior(candidates);
    const Eigen::MatrixXd root = square_root(p.covariance);
    const auto stream = round + 2 * static_cast<std::uint32_t>(s);
    const Eigen::MatrixXd draws = root * normals(root.rows(), each, seed, stream);
    for (Eigen::Index j = 0; j < draws.cols(); ++j) {
      Eigen::Index lowest = 0;
      (p.mean + draws.col(j)).minCoeff(&lowest);
      out.push_back(candidates[static_cast<std::size_t>(lowest)]);
    }
  }
  return out;
}

/// The box around points, wider by a tenth of the whole at each side, inside the whole.
std::pair<Point, Point> around(const Box& box, const std::vector<Point>& points) {
  Point low = points.front(), high = points.front();
  for (const Point& p : points)
    for (std::size_t k = 0; k < p.size(); ++k) {
      low[k] = std::min(low[k], p[k]);
      high[k] = std::max(high[k], p[k]);
    }
  for (std::size_t k = 0; k < box.size(); ++k) {
    const double more = 0.05 * (box[k].high - box[k].low);
    low[k] = std::max(low[k] - more, box[k].low);
    high[k] = std::min(high[k] + more, box[k].high);
  }
  return {low, high};
}

/// Minimum of the mean near `start`, in unit coordinates so that steps mean the same in every variable.
Point polished(const FittedSurface& surface, const Point& start) {
  const Box& box = surface.box();
  const std::size_t d = box.size();
  // A second, idle variable where there is one only: BOBYQA needs two.
  const std::size_t n = std::max<std::size_t>(d, 2);
  Point unit = to_unit(box, start);
  unit.resize(n, 0.5);
  const auto objective = [&](const std::vector<double>& u) {
    return surface.mean_m(from_unit(box, Point(u.begin(), u.begin() + static_cast<std::ptrdiff_t>(d))));
  };
  const BoundedMinimum found = bounded_minimum(objective, unit, Point(n, 0), Point(n, 1), Point(n, 0.05), 1e-3, 200);
  return from_unit(box, Point(found.at.begin(), found.at.begin() + static_cast<std::ptrdiff_t>(d)));
}

/// The best lattice point within one step: rounding alone may go up the wall of a valley.
Point best_lattice_point(const FittedSurface& surface, const Point& at) {
  const Box& box = surface.box();
  std::vector<Point> tries(1);
  for (std::size_t k = 0; k < box.size(); ++k) {
    std::vector<Point> longer;
    for (const Point& p : tries)
      for (const double step : {0.0, -1.0, 1.0}) {
        longer.push_back(p);
        longer.back().push_back(std::clamp(at[k] + step * box[k].resolution, box[k].low, box[k].high));
      }
    tries = std::move(longer);
    if (tries.size() > 1000) break;
  }
  Point best = quantised(box, at);
  double best_f = surface.mean_m(best);
  for (Point& p : tries) {
    p.insert(p.end(), at.begin() + static_cast<std::ptrdiff_t>(p.size()), at.end());
    p = quantised(box, p);
    if (const double f = surface.mean_m(p); f < best_f) {
      best = p;
      best_f = f;
    }
  }
  return best;
}

double quantile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  const double at = share * static_cast<double>(values.size() - 1);
  const auto i = static_cast<std::size_t>(at);
  return i + 1 < values.size() ? values[i] + (at - std::floor(at)) * (values[i + 1] - values[i]) : values.back();
}

}  // namespace

Optimum optimum(const FittedSurface& surface, std::int64_t seed, const OptimumOptions& options) {
  const Box& box = surface.box();
  Point low, high;
  for (const DesignAxis& axis : box) {
    low.push_back(axis.low);
    high.push_back(axis.high);
  }

  const std::vector<FittedSurface> surfaces =
      options.num_surfaces > 1 ? surface.drawn(options.num_surfaces, seed) : std::vector<FittedSurface>{surface};

  // Surfaces over the box, then over the part where their minima lie.
  std::vector<Point> candidates = candidates_in(low, high, options.num_candidates, seed);
  const std::vector<Point> coarse = drawn_argmins(surfaces, candidates, options.num_draws, seed, 0);
  const auto [inner_low, inner_high] = around(box, coarse);
  const std::vector<Point> inner = candidates_in(inner_low, inner_high, options.num_candidates, seed + 1);
  Optimum out;
  out.argmins = drawn_argmins(surfaces, inner, options.num_draws, seed, 1);

  // The mean's own minimum.
  candidates.insert(candidates.end(), inner.begin(), inner.end());
  std::vector<Site> sites;
  for (const Point& p : candidates) sites.push_back({p, std::nullopt});
  Eigen::Index lowest = 0;
  surface.mean(sites).minCoeff(&lowest);
  out.at = best_lattice_point(surface, polished(surface, candidates[static_cast<std::size_t>(lowest)]));
  out.f_m = surface.mean_m(out.at);
  out.sigma_m = surface.sd_m(out.at);

  for (std::size_t k = 0; k < box.size(); ++k) {
    std::vector<double> values;
    for (const Point& p : out.argmins) values.push_back(p[k]);
    out.low.push_back(quantile(values, 0.025));
    out.high.push_back(quantile(values, 0.975));
  }
  return out;
}

}  // namespace drumsweep

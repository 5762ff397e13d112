#include "sweep/fit/acquisition.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>
#include <utility>

#include "sweep/fit/optimum.h"

namespace drumsweep {
namespace {

using Run = std::pair<Point, double>;  // point and replicate

double normal_density(double z) { return std::exp(-0.5 * z * z) / std::sqrt(2 * M_PI); }
double normal_below(double z) { return 0.5 * std::erfc(-z / std::sqrt(2.0)); }

/// Lattice points over the box, where the minimum may be, and those known.
std::vector<Point> candidate_points(const FittedSurface& surface, int count, std::int64_t seed,
                                    const std::function<bool(const Point&)>& allowed) {
  const Box& box = surface.box();
  std::vector<Point> out;
  std::set<Point> seen;
  const auto add = [&](const Point& point) {
    const Point at = quantised(box, point);
    if (seen.insert(at).second && (!allowed || allowed(at))) out.push_back(at);
  };
  const Optimum best = optimum(surface, seed, {200, 2 * count, 4});
  add(best.at);
  for (const Measurement& row : surface.rows()) add(row.at);
  for (const Point& point : space_filling(box, static_cast<std::size_t>(count / 3), seed)) add(point);
  const std::size_t most = out.size() + static_cast<std::size_t>(2 * count / 3);
  for (const Point& point : best.argmins)
    if (out.size() < most) add(point);
  return out;
}

/// Replicate numbers to choose from: the latest known, ascending, and a new one.
std::vector<double> replicate_choices(const std::vector<Measurement>& rows, int most) {
  std::set<double> known;
  for (const Measurement& row : rows) known.insert(row.replicate);
  std::vector<double> out(known.begin(), known.end());
  const double next = out.empty() ? 0 : out.back() + 1;
  if (out.size() > static_cast<std::size_t>(most)) out.erase(out.begin(), out.end() - most);
  out.push_back(next);
  return out;
}

struct Choice {
  Run run;
  double gain = -1;
};

/// The run with the largest gain among those not taken.
Choice best_run(const FittedSurface& surface, const std::vector<Point>& points, const std::vector<double>& replicates,
                const std::set<Run>& taken) {
  std::vector<Site> targets, runs;
  for (const Point& point : points) targets.push_back({point, std::nullopt});
  for (const double replicate : replicates)
    for (const Point& point : points)
      if (!taken.contains({point, replicate})) runs.push_back({point, replicate});
  const Eigen::VectorXd mean = surface.mean(targets);
  const Eigen::MatrixXd cross = surface.covariance(targets, runs);
  const Eigen::VectorXd variance = surface.variance(runs);
  Choice best;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    const double own = surface.run_sd_m(runs[i].at);
    const double of_row = std::max(variance[column], 0.0) + own * own;
    if (!(of_row > 0)) continue;
    const double gain = -expected_drop(mean, cross.col(column) / std::sqrt(of_row));
    if (gain > best.gain) best = {{runs[i].at, *runs[i].replicate}, gain};
  }
  return best;
}

}  // namespace

double expected_drop(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  // Lines by falling slope: from the left (Z = -inf) the line with the largest slope is lowest.
  std::vector<Eigen::Index> order(static_cast<std::size_t>(a.size()));
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::sort(order.begin(), order.end(), [&](Eigen::Index i, Eigen::Index j) {
    return b[i] != b[j] ? b[i] > b[j] : a[i] != a[j] ? a[i] < a[j] : i < j;
  });
  // Lower envelope: line hull[k] is lowest from Z = from[k] on.
  std::vector<Eigen::Index> hull;
  std::vector<double> from;
  for (const Eigen::Index line : order) {
    if (!hull.empty() && b[hull.back()] == b[line]) continue;  // parallel and not lower
    double crossing = -std::numeric_limits<double>::infinity();
    while (!hull.empty()) {
      crossing = (a[line] - a[hull.back()]) / (b[hull.back()] - b[line]);
      if (crossing > from.back()) break;
      hull.pop_back();
      from.pop_back();
      crossing = -std::numeric_limits<double>::infinity();
    }
    hull.push_back(line);
    from.push_back(crossing);
  }
  // E[min] - min a = sum over the kinks of (b_k+1 - b_k) E[(Z - c)^+] when c > 0, and mirrored when c < 0: the line that
  // is lowest at Z = 0 is the reference, so nothing large is subtracted.
  double drop = 0;
  for (std::size_t k = 1; k < hull.size(); ++k) {
    const double c = std::abs(from[k]);
    drop += (b[hull[k]] - b[hull[k - 1]]) * (normal_density(c) - c * normal_below(-c));
  }
  return drop;
}

Batch next_batch(const FittedSurface& surface, int count, std::int64_t seed, const AcquisitionOptions& options,
                 const std::function<bool(const Point&)>& allowed) {
  const std::vector<Point> points = candidate_points(surface, options.num_candidates, seed, allowed);
  std::set<Point> known;
  std::set<Run> taken;
  for (const Measurement& row : surface.rows()) {
    known.insert(row.at);
    taken.insert({row.at, row.replicate});
  }
  Batch out;
  FittedSurface fit = surface;
  int num_known = 0;
  std::set<double> replicates;
  for (int i = 0; i < count; ++i) {
    const Choice choice = best_run(fit, points, replicate_choices(fit.rows(), options.most_replicates), taken);
    if (choice.gain < 0) break;  // nothing left to choose
    const auto& [at, replicate] = choice.run;
    out.runs.push_back({at, replicate, known.contains(at), choice.gain});
    out.batch_gain_m += choice.gain;
    num_known += known.contains(at);
    replicates.insert(replicate);
    taken.insert(choice.run);
    const double expected = fit.mean({{at, replicate}})[0];
    fit = fit.with_row({at, replicate, expected, 0});
  }
  if (out.runs.empty()) {
    out.reason = "no point left to measure";
    return out;
  }
  out.gain_m = out.runs.front().gain_m;
  out.reason = fmt::format(
      "{} runs, {} of them at known points, in {} replicates: expected to lower f at the optimum by {:.2g} m "
      "(the first by {:.2g} m)",
      out.runs.size(), num_known, replicates.size(), out.batch_gain_m, out.gain_m);
  return out;
}

}  // namespace drumsweep

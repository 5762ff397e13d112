#include "sweep/fit/surface.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "core/geometry/random.h"
#include "sweep/refine/bounded_minimum.h"

namespace drumsweep {
namespace {

double square(double x) { return x * x; }
std::size_t size(Eigen::Index i) { return static_cast<std::size_t>(i); }
Eigen::Index index(std::size_t i) { return static_cast<Eigen::Index>(i); }

/// Matern 5/2 of a squared distance.
double matern(double r2) {
  const double s = std::sqrt(5 * r2);
  return (1 + s + s * s / 3) * std::exp(-s);
}

/// Constant; with order 1 the variables, with order 2 also their squares and products. About the centre of the box.
Eigen::RowVectorXd polynomial(const Point& unit, int order) {
  std::vector<double> terms = {1};
  if (order >= 1)
    for (const double u : unit) terms.push_back(u - 0.5);
  if (order >= 2)
    for (std::size_t i = 0; i < unit.size(); ++i)
      for (std::size_t j = 0; j <= i; ++j) terms.push_back((unit[i] - 0.5) * (unit[j] - 0.5));
  return Eigen::Map<const Eigen::RowVectorXd>(terms.data(), index(terms.size()));
}

std::size_t num_terms(std::size_t num_axes, int order) {
  return order == 0 ? 1 : order == 1 ? num_axes + 1 : (num_axes + 1) * (num_axes + 2) / 2;
}

/// Log-normal priors of the parameters: mean and sd of the logarithm (of the odds for the share).
struct Prior {
  double mean, sd;
};
constexpr Prior prior_length{0, 1};           // a length of the box's own size
constexpr Prior prior_amplitude{0.3, 1};      // like the scatter of the rows
constexpr Prior prior_rho{0.3, 0.4};          // quick drum: 1.0 to 1.9
constexpr Prior prior_shared_odds{1.5, 1.5};  // quick drum: 0.8 to 0.97
constexpr Prior prior_shared_length{-0.3, 0.7};

std::vector<Prior> priors_of(std::size_t num_axes) {
  std::vector<Prior> out(num_axes, prior_length);
  out.insert(out.end(), {prior_amplitude, prior_rho, prior_shared_odds, prior_shared_length});
  return out;
}

/// Rows from which the parameters are chosen; the fit itself takes all.
constexpr std::size_t most_rows_for_parameters = 240;

/// The trend h(x) of F: a plane. On the quick drum a constant and a quadratic changed the log score of left-out rows by
/// less than 0.03 a row.
constexpr int trend_order = 1;

}  // namespace

/// Sites as the kernel wants them.
struct FittedSurface::Places {
  std::vector<Point> unit;
  std::vector<double> replicate;  ///< NaN: F, equal to nothing
  Eigen::VectorXd sigma;          ///< s(x) [m]
};

FittedSurface::Places FittedSurface::places_of(const Box& box, const NoiseTrend& trend,
                                               const std::vector<Site>& sites) {
  Places out;
  out.sigma.resize(index(sites.size()));
  for (const Site& site : sites) {
    out.sigma[index(out.unit.size())] = trend.sigma(box, site.at);
    out.unit.push_back(to_unit(box, site.at));
    out.replicate.push_back(site.replicate.value_or(std::numeric_limits<double>::quiet_NaN()));
  }
  return out;
}

FittedSurface::Places FittedSurface::row_places(const std::vector<std::size_t>& subset) const {
  std::vector<Site> sites;
  for (const std::size_t i : subset) sites.push_back({rows_[i].at, rows_[i].replicate});
  return places_of(box_, trend_, sites);
}

std::vector<std::size_t> FittedSurface::all_rows() const {
  std::vector<std::size_t> all(rows_.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  return all;
}

FittedSurface::FittedSurface(const Box& box, std::vector<Measurement> rows) : box_(box), rows_(std::move(rows)) {
  // Eigen cuts products into blocks that fit the machine's caches, and sums would follow them: the same blocks everywhere.
  Eigen::setCpuCacheSizes(32 << 10, 512 << 10, 8 << 20);
  Pooled pooled = pool(box, rows_);
  own_sigma_ = std::move(pooled.own_sigma_m);
  trend_ = std::move(pooled.trend);
  const auto n = static_cast<double>(rows_.size());
  for (const Measurement& row : rows_) center_ += row.f_m / n;
  double variance = 0;
  for (const Measurement& row : rows_) variance += square(row.f_m - center_) / n;
  spread_ = variance > 0 ? std::sqrt(variance) : std::max(own_sigma_.front(), 1e-12);

  choose_parameters(rows_for_parameters());
  factorise(all_rows());
}

std::vector<std::size_t> FittedSurface::rows_for_parameters() const {
  std::vector<std::size_t> subset = all_rows();
  if (subset.size() <= most_rows_for_parameters) return subset;
  // Evenly by a golden step, so that no line of a grid is left out as a whole.
  std::stable_sort(subset.begin(), subset.end(), [](std::size_t a, std::size_t b) {
    const auto key = [](std::size_t i) { return std::fmod(0.6180339887498949 * static_cast<double>(i), 1.0); };
    return key(a) < key(b);
  });
  subset.resize(most_rows_for_parameters);
  return subset;
}

/// Covariance of F + C on z.
Eigen::MatrixXd FittedSurface::kernel(const Places& a, const Places& b) const {
  const double f2 = square(parameters_.amplitude_m / spread_);
  const double c2 = square(parameters_.rho / spread_) * parameters_.shared;
  Eigen::MatrixXd k(index(a.unit.size()), index(b.unit.size()));
  for (std::size_t j = 0; j < b.unit.size(); ++j)
    for (std::size_t i = 0; i < a.unit.size(); ++i) {
      double of_f = 0, of_c = 0;
      for (std::size_t c = 0; c < box_.size(); ++c) {
        const double difference = a.unit[i][c] - b.unit[j][c];
        of_f += square(difference / parameters_.length[c]);
        of_c += square(difference / parameters_.shared_length);
      }
      double value = f2 * matern(of_f);
      if (a.replicate[i] == b.replicate[j]) value += c2 * a.sigma[index(i)] * b.sigma[index(j)] * matern(of_c);
      k(index(i), index(j)) = value;
    }
  return k;
}

/// Everything that follows from the parameters. @return false when K is not positive definite.
bool FittedSurface::factorise(const std::vector<std::size_t>& subset) {
  const Places places = row_places(subset);
  const Eigen::Index n = index(subset.size());
  Eigen::MatrixXd k = kernel(places, places);
  Eigen::VectorXd z(n);
  basis_.resize(n, index(num_terms(box_.size(), trend_order)));
  const double of_run = square(parameters_.rho / spread_) * (1 - parameters_.shared);
  for (Eigen::Index i = 0; i < n; ++i) {
    const std::size_t row = subset[size(i)];
    z[i] = (rows_[row].f_m - center_) / spread_;
    basis_.row(i) = polynomial(places.unit[size(i)], trend_order);
    // The last term is rounding's: it keeps K positive definite when the noise is nothing.
    k(i, i) += of_run * square(own_sigma_[row]) + 1e-9 * square(parameters_.amplitude_m / spread_);
  }
  factor_.compute(k);
  if (factor_.info() != Eigen::Success) return false;
  solved_basis_ = factor_.solve(basis_);
  // Points on one line leave the plane undetermined across it; a slope of 1e4 spreads is as good as free.
  trend_factor_.compute(basis_.transpose() * solved_basis_ +
                        1e-8 * Eigen::MatrixXd::Identity(basis_.cols(), basis_.cols()));
  if (trend_factor_.info() != Eigen::Success) return false;
  beta_ = trend_factor_.solve(solved_basis_.transpose() * z);
  const Eigen::VectorXd rest = z - basis_ * beta_;
  weights_ = factor_.solve(rest);

  const auto half_log_det = [](const Eigen::LLT<Eigen::MatrixXd>& llt) {
    return llt.matrixLLT().diagonal().array().log().sum();
  };
  log_likelihood_ = -0.5 * rest.dot(weights_) - half_log_det(factor_) - half_log_det(trend_factor_);
  return true;
}

/// theta: log lengths of F, log amplitude, log rho, log odds of the share, log length of C.
void FittedSurface::set_parameters(const std::vector<double>& theta) {
  const std::size_t d = box_.size();
  theta_ = theta;
  parameters_.length.resize(d);
  for (std::size_t i = 0; i < d; ++i) parameters_.length[i] = std::exp(theta[i]);
  parameters_.amplitude_m = spread_ * std::exp(theta[d]);
  parameters_.rho = std::exp(theta[d + 1]);
  parameters_.shared = 1 / (1 + std::exp(-theta[d + 2]));
  parameters_.shared_length = std::exp(theta[d + 3]);
}

/// - log of likelihood times priors, but for a constant.
double FittedSurface::cost(const std::vector<double>& theta, const std::vector<std::size_t>& subset) {
  set_parameters(theta);
  if (!factorise(subset)) return std::numeric_limits<double>::infinity();
  const std::vector<Prior> priors = priors_of(box_.size());
  double prior = 0;
  for (std::size_t i = 0; i < theta.size(); ++i) prior += square((theta[i] - priors[i].mean) / priors[i].sd);
  return 0.5 * prior - log_likelihood_;
}

void FittedSurface::choose_parameters(const std::vector<std::size_t>& subset) {
  const std::size_t d = box_.size();
  std::vector<double> low, high;
  for (const Prior& prior : priors_of(d)) {
    low.push_back(prior.mean - 4 * prior.sd);
    high.push_back(prior.mean + 4 * prior.sd);
  }

  // The likelihood has one hill where all is noise and one where all is surface; the two best of a coarse grid of both
  // kinds are climbed.
  std::vector<std::pair<double, std::vector<double>>> starts;
  for (const double length : {0.2, 0.6, 1.8})
    for (const double odds : {-1.5, 1.5, 3.0}) {
      std::vector<double> theta(d, std::log(length));
      theta.insert(theta.end(), {prior_amplitude.mean, prior_rho.mean, odds, prior_shared_length.mean});
      starts.emplace_back(cost(theta, subset), theta);
    }
  std::stable_sort(starts.begin(), starts.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  const auto objective = [&](const std::vector<double>& theta) { return cost(theta, subset); };
  BoundedMinimum best;
  for (std::size_t i = 0; i < 2; ++i) {
    const BoundedMinimum found = bounded_minimum(objective, starts[i].second, low, high,
                                                 std::vector<double>(d + 4, 0.5), 0.02, 40 * static_cast<int>(d + 2));
    if (best.at.empty() || found.value < best.value) best = found;
  }
  set_parameters(best.at);
}

std::vector<FittedSurface> FittedSurface::drawn(int count, std::int64_t seed) const {
  constexpr int steps_a_surface = 20;
  const std::vector<std::size_t> subset = rows_for_parameters();
  FittedSurface walker = *this;
  std::vector<double> at = theta_;
  double here = walker.cost(at, subset);

  // Steps as wide as the hill: by its curvature along each parameter, at most the prior's.
  const std::vector<Prior> priors = priors_of(box_.size());
  std::vector<double> width;
  for (std::size_t k = 0; k < at.size(); ++k) {
    constexpr double h = 0.2;
    std::vector<double> up = at, down = at;
    up[k] += h;
    down[k] -= h;
    const double curvature = (walker.cost(up, subset) - 2 * here + walker.cost(down, subset)) / (h * h);
    const double own = curvature > 0 && std::isfinite(curvature) ? 1 / std::sqrt(curvature) : priors[k].sd;
    width.push_back(2.4 / std::sqrt(static_cast<double>(at.size())) * std::min(own, priors[k].sd));
  }

  std::vector<FittedSurface> out;
  for (int step = 0; step < count * steps_a_surface; ++step) {
    const auto draw = [&](std::size_t k) {
      return uniform4(seed, Purpose::fit_parameters, static_cast<std::uint64_t>(step), static_cast<std::uint32_t>(k));
    };
    std::vector<double> next = at;
    for (std::size_t k = 0; k < at.size(); ++k) {
      const auto u = draw(k);
      next[k] += width[k] * std::sqrt(-2 * std::log(1 - u[0])) * std::cos(2 * M_PI * u[1]);
    }
    const double there = walker.cost(next, subset);
    if (std::log(1 - draw(at.size())[0]) < here - there) {
      at = std::move(next);
      here = there;
    }
    if ((step + 1) % steps_a_surface != 0) continue;
    out.push_back(*this);
    out.back().set_parameters(at);
    if (!out.back().factorise(all_rows())) out.back() = *this;
  }
  return out;
}

FittedSurface FittedSurface::with_row(const Measurement& row) const {
  FittedSurface out = *this;
  out.rows_.push_back(row);
  out.own_sigma_.push_back(trend_.sigma(box_, row.at));
  out.factorise(out.all_rows());
  return out;
}

Eigen::VectorXd FittedSurface::mean(const std::vector<Site>& sites) const {
  const Places places = places_of(box_, trend_, sites);
  Eigen::VectorXd z = kernel(row_places(all_rows()), places).transpose() * weights_;
  for (std::size_t i = 0; i < sites.size(); ++i) z[index(i)] += polynomial(places.unit[i], trend_order).dot(beta_);
  return center_ + spread_ * z.array();
}

/// What the rows say about sites: L^-1 K* and its like of the trend.
struct FittedSurface::Given {
  Places places;
  Eigen::MatrixXd of_rows, of_trend;
};

FittedSurface::Given FittedSurface::given(const std::vector<Site>& sites) const {
  Given out{places_of(box_, trend_, sites), {}, {}};
  const Eigen::MatrixXd cross = kernel(row_places(all_rows()), out.places);
  Eigen::MatrixXd h(basis_.cols(), index(sites.size()));
  for (std::size_t i = 0; i < sites.size(); ++i) h.col(index(i)) = polynomial(out.places.unit[i], trend_order);
  out.of_rows = factor_.matrixL().solve(cross);
  out.of_trend = trend_factor_.matrixL().solve(h - solved_basis_.transpose() * cross);
  return out;
}

Eigen::MatrixXd FittedSurface::covariance(const std::vector<Site>& a, const std::vector<Site>& b) const {
  // K_ab - K_a' K^-1 K_b + R_a' (H' K^-1 H)^-1 R_b,  R = H*' - H' K^-1 K*.
  const Given of_a = given(a), of_b = given(b);
  return square(spread_) * (kernel(of_a.places, of_b.places) - of_a.of_rows.transpose() * of_b.of_rows +
                            of_a.of_trend.transpose() * of_b.of_trend);
}

Eigen::VectorXd FittedSurface::variance(const std::vector<Site>& sites) const {
  const Given of = given(sites);
  Eigen::VectorXd out(index(sites.size()));
  for (Eigen::Index i = 0; i < out.size(); ++i) {
    double prior = square(parameters_.amplitude_m);
    if (sites[size(i)].replicate) prior += square(parameters_.rho * of.places.sigma[i]) * parameters_.shared;
    out[i] = prior + square(spread_) * (of.of_trend.col(i).squaredNorm() - of.of_rows.col(i).squaredNorm());
  }
  return out;
}

Posterior FittedSurface::posterior(const std::vector<Site>& sites) const {
  return {mean(sites), covariance(sites, sites)};
}

Posterior FittedSurface::posterior(const std::vector<Point>& points) const {
  std::vector<Site> sites;
  for (const Point& point : points) sites.push_back({point, std::nullopt});
  return posterior(sites);
}

double FittedSurface::mean_m(const Point& at) const { return mean({{at, std::nullopt}})[0]; }

double FittedSurface::sd_m(const Point& at) const {
  const std::vector<Site> site = {{at, std::nullopt}};
  return std::sqrt(std::max(0.0, covariance(site, site)(0, 0)));
}

double FittedSurface::run_sd_m(const Point& at) const {
  return parameters_.rho * std::sqrt(1 - parameters_.shared) * trend_.sigma(box_, at);
}

double FittedSurface::shared_sd_m(const Point& at) const {
  return parameters_.rho * std::sqrt(parameters_.shared) * trend_.sigma(box_, at);
}

std::vector<LeftOut> FittedSurface::leave_one_out() const {
  // P = K^-1 - K^-1 H (H' K^-1 H)^-1 H' K^-1; error_i = (P z)_i / P_ii, variance_i = 1 / P_ii.
  const Eigen::Index n = index(rows_.size());
  Eigen::MatrixXd p = factor_.solve(Eigen::MatrixXd::Identity(n, n));
  p -= solved_basis_ * trend_factor_.solve(solved_basis_.transpose());
  std::vector<LeftOut> out;
  for (Eigen::Index i = 0; i < n; ++i) out.push_back({spread_ * weights_[i] / p(i, i), spread_ / std::sqrt(p(i, i))});
  return out;
}

std::optional<QuadraticFit> quadratic_fit(const Box& box, const std::vector<Sample>& samples) {
  const std::size_t d = box.size(), terms = num_terms(d, 2);
  if (samples.size() < terms) return std::nullopt;
  Eigen::MatrixXd basis(index(samples.size()), index(terms));
  Eigen::VectorXd f(index(samples.size()));
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double weight = 1 / samples[i].sigma_m;
    basis.row(index(i)) = weight * polynomial(to_unit(box, samples[i].at), 2);
    f[index(i)] = weight * samples[i].f_m;
  }
  const Eigen::VectorXd c = basis.colPivHouseholderQr().solve(f);
  QuadraticFit out;
  out.num_coefficients = static_cast<int>(terms);
  out.dof = static_cast<int>(samples.size() - terms);
  if (out.dof > 0) {
    const double dof = out.dof;
    out.chi2_per_dof = (f - basis * c).squaredNorm() / dof;
    const double normal = (std::cbrt(out.chi2_per_dof) - (1 - 2 / (9 * dof))) / std::sqrt(2 / (9 * dof));
    out.p_value = 0.5 * std::erfc(normal / std::sqrt(2.0));
  }
  // f = c0 + g'u + u'A u/2 about the centre.
  Eigen::MatrixXd hessian(index(d), index(d));
  std::size_t term = d + 1;
  for (std::size_t i = 0; i < d; ++i)
    for (std::size_t j = 0; j <= i; ++j, ++term)
      hessian(index(i), index(j)) = hessian(index(j), index(i)) = (i == j ? 2 : 1) * c[index(term)];
  const Eigen::LLT<Eigen::MatrixXd> llt(hessian);
  out.convex = llt.info() == Eigen::Success;
  if (!out.convex) return out;
  const Eigen::VectorXd u = -llt.solve(c.segment(1, index(d))).array() + 0.5;
  if (u.minCoeff() >= 0 && u.maxCoeff() <= 1) out.minimum = from_unit(box, Point(u.data(), u.data() + u.size()));
  return out;
}

}  // namespace drumsweep

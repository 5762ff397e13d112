#include "sweep/fit/samples.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace drumsweep {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

double square(double x) { return x * x; }

/// Variance of log chi^2_k / k is trigamma(k/2); asymptotic series, good to 1e-4 above 2.
double log_chi2_variance(double dof) {
  double x = dof / 2, sum = 0;
  for (; x < 5; ++x) sum += 1 / (x * x);
  return sum + 1 / x + 1 / (2 * x * x) + 1 / (6 * x * x * x) - 1 / (30 * std::pow(x, 5));
}

/// The rows of one point, by index.
using Groups = std::map<Point, std::vector<std::size_t>>;

double mean_of(const std::vector<std::size_t>& group, const std::vector<double>& f) {
  double sum = 0;
  for (const std::size_t i : group) sum += f[i];
  return sum / static_cast<double>(group.size());
}

/// var(f_i - f_j) between over within replicates, for the pairs that `partners` gives a design.
template <typename Partners>
double gain_of_pairs(const std::vector<const std::vector<std::size_t>*>& groups, const std::vector<Measurement>& rows,
                     const std::vector<double>& residual, Partners partners) {
  double same = 0, other = 0, num_same = 0, num_other = 0;
  for (std::size_t a = 0; a < groups.size(); ++a)
    for (const std::size_t b : partners(a))
      for (const std::size_t i : *groups[a])
        for (const std::size_t j : *groups[b]) {
          const bool shared = rows[i].replicate == rows[j].replicate;
          (shared ? same : other) += square(residual[i] - residual[j]);
          ++(shared ? num_same : num_other);
        }
  return num_same > 0 && num_other > 0 && same > 0 ? (other / num_other) / (same / num_same) : nan;
}

void compare_differences(const Box& box, const Groups& all, const std::vector<Measurement>& rows, SharedNoise& noise) {
  // About the mean of each point; points with a single replicate say nothing.
  std::vector<const std::vector<std::size_t>*> groups;
  std::vector<Point> unit;
  std::vector<double> residual(rows.size(), 0);
  for (const auto& [at, group] : all) {
    if (group.size() < 2) continue;
    double mean = 0;
    for (const std::size_t i : group) mean += rows[i].f_m / static_cast<double>(group.size());
    for (const std::size_t i : group)
      residual[i] = (rows[i].f_m - mean) / std::sqrt(1 - 1 / static_cast<double>(group.size()));
    groups.push_back(&group);
    unit.push_back(to_unit(box, at));
  }
  noise.gain = gain_of_pairs(groups, rows, residual, [&](std::size_t a) {
    std::vector<std::size_t> later;
    for (std::size_t b = a + 1; b < groups.size(); ++b) later.push_back(b);
    return later;
  });
  noise.gain_neighbours = gain_of_pairs(groups, rows, residual, [&](std::size_t a) {
    std::vector<std::size_t> nearest;
    double best = std::numeric_limits<double>::infinity();
    for (std::size_t b = 0; b < groups.size(); ++b) {
      double distance = 0;
      for (std::size_t k = 0; k < box.size(); ++k) distance += square(unit[a][k] - unit[b][k]);
      if (b == a || distance >= best) continue;
      best = distance;
      nearest = {b};
    }
    return nearest;
  });
}

}  // namespace

NoiseTrend::NoiseTrend(const Box& box, const std::vector<Point>& points, const std::vector<double>& sigma,
                       double fallback) {
  std::vector<std::size_t> known;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (std::isfinite(sigma[i]) && sigma[i] > 0) known.push_back(i);
  coefficients_.assign(box.size() + 1, 0);
  coefficients_[0] = std::log(fallback);
  if (known.empty()) return;
  const bool linear = known.size() >= 3 * (box.size() + 1);
  const auto num_rows = static_cast<Eigen::Index>(known.size());
  const Eigen::Index num_columns = linear ? static_cast<Eigen::Index>(box.size()) + 1 : 1;
  Eigen::MatrixXd basis = Eigen::MatrixXd::Ones(num_rows, num_columns);
  Eigen::VectorXd logs(num_rows);
  for (Eigen::Index r = 0; r < num_rows; ++r) {
    const std::size_t i = known[static_cast<std::size_t>(r)];
    logs[r] = std::log(sigma[i]);
    const Point unit = to_unit(box, points[i]);
    for (Eigen::Index c = 1; c < num_columns; ++c) basis(r, c) = unit[static_cast<std::size_t>(c) - 1];
  }
  const Eigen::VectorXd solution = basis.colPivHouseholderQr().solve(logs);
  for (Eigen::Index c = 0; c < num_columns; ++c) coefficients_[static_cast<std::size_t>(c)] = solution[c];
  // The mean of log chi^2_k / k is below 0 by 1/k + 1/(3k^2).
  coefficients_[0] += 0.5 * (1 / own_dof + 1 / (3 * own_dof * own_dof));
  if (num_rows > num_columns)
    scatter_ = 4 * (logs - basis * solution).squaredNorm() / static_cast<double>(num_rows - num_columns);
}

double NoiseTrend::sigma(const Box& box, const Point& at) const {
  const Point unit = to_unit(box, at);
  double log_sigma = coefficients_[0];
  for (std::size_t i = 0; i < unit.size(); ++i) log_sigma += coefficients_[i + 1] * unit[i];
  return std::exp(log_sigma);
}

Pooled pool(const Box& box, const std::vector<Measurement>& rows) {
  Pooled out;
  if (rows.empty()) return out;
  Groups groups;
  std::vector<Point> points;
  std::vector<double> own;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    groups[rows[i].at].push_back(i);
    points.push_back(rows[i].at);
    own.push_back(rows[i].sigma_m);
  }

  std::vector<double> f;
  for (const Measurement& row : rows) f.push_back(row.f_m);

  // Own variances shrunk to their trend. Nothing known of the noise: a tenth of the scatter of f.
  double mean_f = 0, scatter_f = 0;
  for (const double value : f) mean_f += value / static_cast<double>(f.size());
  for (const double value : f) scatter_f += square(value - mean_f) / static_cast<double>(f.size());
  out.trend = NoiseTrend(box, points, own, std::max(0.1 * std::sqrt(scatter_f), 1e-6 * std::abs(mean_f) + 1e-300));
  const double expected = log_chi2_variance(own_dof);
  const double keep = std::max(0.0, out.trend.scatter() - expected) / std::max(out.trend.scatter(), expected);
  std::vector<double> variance;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double smooth = std::log(out.trend.sigma(box, rows[i].at));
    const bool known = std::isfinite(own[i]) && own[i] > 0;
    variance.push_back(std::exp(2 * (smooth + (known ? keep * (std::log(own[i]) - smooth) : 0))));
    out.own_sigma_m.push_back(std::sqrt(variance.back()));
  }

  // How much larger the scatter between replicates is.
  double ratio_sum = 0;
  for (const auto& [at, group] : groups) {
    const double mean = mean_of(group, f);
    for (const std::size_t i : group) ratio_sum += square(f[i] - mean) / variance[i];
    out.noise.scatter_dof += static_cast<int>(group.size()) - 1;
  }
  const double ratio = (ratio_prior_dof + ratio_sum) / (ratio_prior_dof + out.noise.scatter_dof);
  out.noise.scatter_over_own = out.noise.scatter_dof > 0 ? std::sqrt(ratio_sum / out.noise.scatter_dof) : nan;

  for (const auto& [at, group] : groups) {
    const auto n = static_cast<double>(group.size());
    const double mean = mean_of(group, f);
    double own_sum = 0, scatter = 0;
    for (const std::size_t i : group) {
      own_sum += variance[i];
      scatter += square(f[i] - mean);
    }
    const double of_one = (own_dof * ratio * own_sum + scatter) / (own_dof * n + n - 1);
    out.samples.push_back({at, mean, std::sqrt(of_one / n), static_cast<int>(group.size())});
  }
  compare_differences(box, groups, rows, out.noise);
  return out;
}

}  // namespace drumsweep

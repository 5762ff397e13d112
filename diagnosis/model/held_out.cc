#include "diagnosis/model/held_out.h"

#include <map>
#include <numbers>
#include <numeric>

#include "diagnosis/model/laws.h"
#include "diagnosis/model/linear_algebra.h"

namespace drumsweep {
namespace {

using Index = Eigen::Index;

struct Prediction {
  Eigen::VectorXd mean;
  Eigen::MatrixXd covariance;
};
Prediction prediction(const Inquiry& in, const ModelFit& fit, const std::vector<Index>& outputs) {
  const ModelEmulator emulator = in.emulator_of(fit.effects);
  const Eigen::MatrixXd c = emulator.coefficients(Eigen::all, outputs);
  const Eigen::MatrixXd slope = transposed_product(c, feature_slopes(fit.x));
  return {transposed_times(c, features_of(fit.x)),
          in.predictive_covariance(emulator, fit.v, outputs) + congruence(slope, fit.spread)};
}

/// Of the measured values; and their chi^2.
std::pair<double, double> log_density(const Inquiry& in, const Prediction& p, const std::vector<Index>& outputs) {
  const Eigen::VectorXd off = in.measured(outputs) - p.mean;
  const double chi2 = off.dot(solve_symmetric(p.covariance, off));
  const auto n = static_cast<double>(outputs.size());
  return {-0.5 * (chi2 + log_determinant_symmetric(p.covariance) + n * std::log(2 * std::numbers::pi)), chi2};
}

std::map<std::string, std::vector<Index>> held_out_conditions(const Problem& problem) {
  std::map<std::string, std::vector<Index>> out;
  for (const Index i : problem.with_use(Use::holdout))
    out[problem.data[static_cast<std::size_t>(i)].condition].push_back(i);
  return out;
}

/// Few conditions, some of which see the effect and some not: a skewed sample, for which Student's interval covers too seldom.
/// Hall's transformation (J. R. Stat. Soc. B 54, 221, 1992) takes the skewness out.
void set_interval(HeldOutGain& gain) {
  const auto n = static_cast<double>(gain.nats.size());
  gain.mean = std::accumulate(gain.nats.begin(), gain.nats.end(), 0.0) / n;
  if (gain.nats.size() < 2) return;
  double squares = 0, cubes = 0;
  for (const double g : gain.nats) {
    const double off = g - gain.mean;
    squares += off * off;
    cubes += off * (off * off);
  }
  // With Fisher's k-statistics: the plain third moment of eight numbers is a third too small.
  const double s = std::sqrt(squares / (n - 1)),
               skewness = s > 0 && n > 2 ? n / ((n - 1) * (n - 2)) * cubes / (s * s * s) : 0;
  const auto bound = [&](double t) {
    const double x = t / std::sqrt(n);
    if (std::abs(skewness) < 1e-6) return gain.mean - s * x;
    return gain.mean - s * 3 / skewness * (std::cbrt(1 + skewness * (x - skewness / (6 * n))) - 1);
  };
  gain.low = bound(student_95(n - 1));
  gain.high = bound(-student_95(n - 1));
  gain.adopted = gain.low > 0;
}

/// The same in errors and in units.
void set_units(HeldOutGain& gain, const Inquiry& in, const Prediction& before, const Prediction& after,
               const std::vector<Index>& all) {
  struct Sum {
    double n = 0, before = 0, after = 0;
    std::string unit;
  };
  std::map<std::string, Sum> by_quantity;
  double z2_before = 0, z2_after = 0, in_before = 0, in_after = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const auto r = static_cast<Index>(i);
    const Datum& datum = in.problem.data[static_cast<std::size_t>(all[i])];
    const double unit = in.emulator.scale()[all[i]], off0 = in.measured[all[i]] - before.mean[r],
                 off1 = in.measured[all[i]] - after.mean[r];
    const double z0 = off0 / std::sqrt(before.covariance(r, r)), z1 = off1 / std::sqrt(after.covariance(r, r));
    z2_before += z0 * z0;
    z2_after += z1 * z1;
    in_before += std::abs(z0) < 1.645 ? 1 : 0;
    in_after += std::abs(z1) < 1.645 ? 1 : 0;
    Sum& sum = by_quantity[datum.quantity];
    sum.n += 1;
    sum.before += off0 * unit * (off0 * unit);
    sum.after += off1 * unit * (off1 * unit);
    sum.unit = datum.unit;
  }
  const auto num = static_cast<double>(all.size());
  gain.rms_z_before = std::sqrt(z2_before / num);
  gain.rms_z_after = std::sqrt(z2_after / num);
  gain.coverage_before = in_before / num;
  gain.coverage_after = in_after / num;
  for (const auto& [quantity, sum] : by_quantity)
    gain.quantities.push_back({quantity, sum.unit, std::sqrt(sum.before / sum.n), std::sqrt(sum.after / sum.n)});
}

}  // namespace

HeldOutJudgement judge_held_out(const Inquiry& in, const ModelFit& plain, const ModelFit& fit) {
  const std::vector<Index> outputs = in.problem.with_use(Use::holdout);
  if (outputs.empty()) return {};
  const auto [log_after, chi2] = log_density(in, prediction(in, fit, outputs), outputs);
  const double log_before = log_density(in, prediction(in, plain, outputs), outputs).first;
  return {chi2_tail(chi2, static_cast<double>(outputs.size())), log_after - log_before};
}

HeldOutGain held_out_gain(const Inquiry& in, const ModelFit& plain, const ModelFit& best) {
  HeldOutGain gain;
  const std::vector<Index> all = in.problem.with_use(Use::holdout);
  if (all.empty()) return gain;
  for (const auto& [condition, outputs] : held_out_conditions(in.problem)) {
    gain.conditions.push_back(condition);
    gain.nats.push_back(log_density(in, prediction(in, best, outputs), outputs).first -
                        log_density(in, prediction(in, plain, outputs), outputs).first);
  }
  set_interval(gain);
  set_units(gain, in, prediction(in, plain, all), prediction(in, best, all), all);
  return gain;
}

}  // namespace drumsweep

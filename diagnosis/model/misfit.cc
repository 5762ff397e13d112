#include "diagnosis/model/misfit.h"

#include <map>

#include "diagnosis/model/linear_algebra.h"

namespace drumsweep {
namespace {

using Index = Eigen::Index;

/// Sums of squares of each group, of the residuals in the plain units.
std::map<std::string, double> group_sums(const Inquiry& in, const Eigen::VectorXd& z, const ModelFit& plain) {
  const Eigen::VectorXd residual = times(in.plain_model.space->to_plain, z - predict(in.plain_model, plain.x));
  std::map<std::string, double> sums;
  for (std::size_t i = 0; i < in.fitted.size(); ++i) {
    const Index k = in.fitted[i];
    const double variance = in.covariance(k, k) + plain.v * (*in.plain_emulator.noise)(k, k),
                 off = residual[static_cast<Index>(i)];
    sums[in.problem.data[static_cast<std::size_t>(k)].group] += off * off / variance;
  }
  return sums;
}

/// max_k (Q_0 - Q_k) of data that were drawn, each single fitted from where the plain model is.
double directed_statistic(const Inquiry& in, const Inquiry::Drawn& drawn, const ModelFit& plain) {
  double best = 0;
  for (int k = 0; k < in.num_effects; ++k) {
    if (!in.listed(k)) continue;
    const SubModel& single = in.single_models[static_cast<std::size_t>(k)];
    Eigen::VectorXd start = Eigen::VectorXd::Zero(single.dimensions());
    start.head(plain.x.size()) = plain.x;
    best = std::max(best, plain.q - fit_from(single, drawn.z, drawn.centre, start).q);
  }
  return best;
}

}  // namespace

Misfit test_misfit(const Inquiry& in) {
  Misfit out;
  out.num_fitted_data = static_cast<Index>(in.fitted.size());
  const Eigen::VectorXd z = in.seen_by(in.plain_model);
  out.plain = in.fit_plain(z, in.centre);
  out.q0 = out.plain.q;
  double directed = 0;
  for (int k = 0; k < in.num_effects; ++k) {
    out.singles.push_back(fit_model(in.single_models[static_cast<std::size_t>(k)], z, in.centre, true));
    if (in.listed(k)) directed = std::max(directed, out.q0 - out.singles.back().q);
  }
  std::map<std::string, std::vector<double>> group_draws;
  std::vector<double> omnibus_draws;
  for (int b = 0; b < in.options.num_bootstraps; ++b) {
    const Inquiry::Drawn drawn = in.draw(in.plain_model, out.plain, static_cast<std::uint64_t>(b));
    const ModelFit plain = in.fit_plain(drawn.z, drawn.centre);
    omnibus_draws.push_back(plain.q);
    out.directed_draws.push_back(directed_statistic(in, drawn, plain));
    for (const auto& [group, sum] : group_sums(in, drawn.z, plain)) group_draws[group].push_back(sum);
  }
  out.p_omnibus = upper_tail(omnibus_draws, out.q0);
  out.p_directed = in.num_effects > 0 ? upper_tail(out.directed_draws, directed) : 1;
  out.p_value = std::min(1.0, (in.num_effects > 0 ? 2 : 1) * std::min(out.p_omnibus, out.p_directed));
  out.birge = std::sqrt(out.plain.chi2 / static_cast<double>(in.fitted.size()));
  for (const auto& [group, sum] : group_sums(in, z, out.plain)) {
    std::size_t num = 0;
    for (const Index k : in.fitted) num += in.problem.data[static_cast<std::size_t>(k)].group == group ? 1 : 0;
    out.groups.push_back({group, num, sum, upper_tail(group_draws[group], sum)});
  }
  return out;
}

Whereabouts look_where(const Inquiry& in, const ModelFit& plain) {
  Whereabouts out;
  const ModelEmulator& emulator = in.plain_emulator;
  const Index num_parameters = emulator.num_parameters;
  const Eigen::VectorXd bench = Eigen::VectorXd::Zero(num_parameters);
  const Eigen::VectorXd before = emulator.predict(bench), after = emulator.predict(plain.x);
  const double v0 = emulator.variance_factor(bench), v1 = emulator.variance_factor(plain.x);
  const auto slopes = [&](const Eigen::VectorXd& x) {
    return transposed_product(emulator.coefficients, feature_slopes(x));
  };
  const Eigen::MatrixXd j0 = slopes(bench), j1 = slopes(plain.x), posteriors = congruence(j1, plain.spread);
  for (Index i = 0; i < in.problem.num_data(); ++i) {
    const double unit = in.emulator.scale()[i], noise = (*emulator.noise)(i, i), error = in.covariance(i, i);
    const double prior = j0.row(i).squaredNorm(), posterior = posteriors(i, i);
    // Fitted data have pulled the fit towards them: the residual is smaller by its leverage.
    const bool is_fitted = in.problem.data[static_cast<std::size_t>(i)].use == Use::fit;
    const double var0 = error + v0 * noise + prior,
                 var1 = std::max(0.02 * error, error + v1 * noise + (is_fitted ? -posterior : posterior));
    DatumMisfit m{};
    m.simulated_before = before[i] * unit;
    m.simulated_after = after[i] * unit;
    m.sigma_before = unit * std::sqrt(v0 * noise + prior);
    m.sigma_after = unit * std::sqrt(v1 * noise + posterior);
    m.z_before = (in.measured[i] - before[i]) / std::sqrt(var0);
    m.z_after = (in.measured[i] - after[i]) / std::sqrt(var1);
    m.off_before = (in.measured[i] - before[i]) / std::sqrt(error + v0 * noise);
    out.misfits.push_back(m);
  }
  for (Index j = 0; j < num_parameters; ++j) {
    // Prior and data disagree by (shift) / sqrt(prior variance - posterior variance).
    const double freed = std::max(1e-6, 1 - plain.spread(j, j));
    out.theta_z.push_back(plain.x[j] / std::sqrt(freed));
    out.at_edge = out.at_edge || std::abs(plain.x[j]) > fit_reach - 1e-6;
  }
  return out;
}

}  // namespace drumsweep

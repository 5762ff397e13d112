#include "diagnosis/model/inquiry.h"

#include <fmt/format.h>

#include "core/config/schema.h"
#include "diagnosis/model/draws.h"
#include "diagnosis/model/linear_algebra.h"

namespace drumsweep {
namespace {

using Index = Eigen::Index;

constexpr double reach_of_tangent = 2;  // half widths of a box

Eigen::MatrixXd scaled_covariance(const Problem& problem, const Emulator& emulator, const Mutation& mutation) {
  Eigen::MatrixXd covariance = problem.measurement_covariance();
  for (Index i = 0; i < covariance.rows(); ++i)
    for (Index j = 0; j < covariance.cols(); ++j)
      covariance(i, j) *= 1 / emulator.scale()[i] * (1 / emulator.scale()[j]);
  if (mutation.halve_covariance) covariance *= 0.5;
  return covariance;
}

}  // namespace

Inquiry::Inquiry(const Problem& the_problem, const Emulator& the_emulator, const DiagnosisOptions& the_options,
                 const std::vector<LocalRuns>& second_wave)
    : problem(the_problem), emulator(the_emulator), options(the_options) {
  num_effects = static_cast<int>(problem.effects.size());
  covariance = scaled_covariance(problem, emulator, options.mutation);
  fitted = problem.with_use(Use::fit);
  if (static_cast<Index>(fitted.size()) <= emulator.num_parameters())
    throw InputError(
        fmt::format("{} data with use = fit for {} free parameters: accepted is more data than free parameters",
                    fitted.size(), emulator.num_parameters()));
  measured = Eigen::VectorXd::Zero(problem.num_data());
  for (Index i = 0; i < problem.num_data(); ++i)
    measured[i] = problem.data[static_cast<std::size_t>(i)].value / emulator.scale()[i];
  centre = Eigen::VectorXd::Zero(emulator.num_parameters());
  for (const LocalRuns& runs : second_wave)
    if (runs.x.rows() >= fewest_local_runs(runs.centre)) corrections_.push_back(local_correction(emulator, runs));
  pool_noise(corrections_);
  if (!corrections_.empty())
    lack_of_fit = (emulator.noise().diagonal() - corrections_.front().noise->diagonal()).cwiseMax(0);
  const FitOptions fit_options{.with_simulation_noise = !options.mutation.drop_simulation_noise};
  const Eigen::MatrixXd errors = covariance(fitted, fitted);
  plain_emulator = emulator.of_model({});
  const auto& campaign_noise = plain_emulator.noise;
  spaces_.emplace_back(campaign_noise, make_fit_space(*campaign_noise, fitted, errors, fit_options, lack_of_fit));
  if (!corrections_.empty()) {
    const auto& noise = corrections_.front().noise;
    spaces_.emplace_back(noise, make_fit_space(*noise, fitted, errors, fit_options));
  }
  plain_model = viewed(plain_emulator);
  for (int k = 0; k < num_effects; ++k) single_models.push_back(campaign_model({k}));
}

const LocalCorrection* Inquiry::correction_of(const std::vector<int>& effects) const {
  for (const LocalCorrection& correction : corrections_)
    if (correction.centre.effects == effects) return &correction;
  return nullptr;
}

ModelEmulator Inquiry::emulator_of(const std::vector<int>& effects) const {
  const LocalCorrection* correction = correction_of(effects);
  const ModelEmulator plain = emulator.of_model(effects);
  return correction != nullptr ? corrected(plain, *correction) : plain;
}

SubModel Inquiry::model(const std::vector<int>& effects) const {
  SubModel out = viewed(emulator_of(effects));
  if (const LocalCorrection* correction = correction_of(effects)) {
    // Where a tangent is not followed any more, large errors would make anything fit.
    const LocalCentre& box = correction->centre;
    out.low = out.low.cwiseMax(box.x - reach_of_tangent * box.half_width);
    out.high = out.high.cwiseMin(box.x + reach_of_tangent * box.half_width);
  }
  return out;
}

SubModel Inquiry::viewed(const ModelEmulator& of) const {
  for (const auto& [noise, space] : spaces_)
    if (noise == of.noise) return make_sub_model(of, space, problem);
  throw std::logic_error("a model with a noise that no part of the campaign has");
}

Eigen::MatrixXd Inquiry::predictive_covariance(const ModelEmulator& of, double v,
                                               const std::vector<Index>& outputs) const {
  Eigen::MatrixXd out = covariance(outputs, outputs) + v * (*of.noise)(outputs, outputs);
  if (lack_of_fit.size() > 0 && of.noise == spaces_.front().first) out.diagonal() += lack_of_fit(outputs);
  return out;
}

std::shared_ptr<const FitSpace> Inquiry::space_of(const std::vector<Index>& outputs,
                                                  const Eigen::MatrixXd& covariance_of_all) const {
  return make_fit_space(emulator.noise(), outputs, covariance_of_all(outputs, outputs),
                        {.with_simulation_noise = !options.mutation.drop_simulation_noise});
}

Eigen::VectorXd Inquiry::seen_by(const SubModel& m) const { return times(m.space->to_rotated, measured(fitted)); }

ModelFit Inquiry::fit_plain(const Eigen::VectorXd& data, const Eigen::VectorXd& prior_centre) const {
  if (!options.mutation.skip_refit) return fit_model(plain_model, data, prior_centre);
  SubModel fixed = plain_model;
  fixed.low.setConstant(-1e-9);
  fixed.high.setConstant(1e-9);
  return fit_model(fixed, data, Eigen::VectorXd::Zero(prior_centre.size()));
}

Inquiry::Drawn Inquiry::draw(const SubModel& m, const ModelFit& fit, std::uint64_t index) const {
  const Eigen::VectorXd& lambda = m.space->lambda;
  const Index num = lambda.size();
  const Eigen::VectorXd normal = normal_draws(options.seed, Purpose::bootstrap, index, num + m.num_parameters);
  Drawn out;
  out.z = predict(m, fit.x);
  for (Index i = 0; i < num; ++i) out.z[i] += std::sqrt(1 + fit.v * lambda[i]) * normal[i];
  out.centre = fit.x.head(m.num_parameters) + normal.tail(m.num_parameters);
  return out;
}

double distance_to(const SubModel& rival, const Eigen::VectorXd& truth, const Eigen::VectorXd& centre) {
  // Two fits with the logarithms left out: their sum at the minimum is not part of a distance.
  const ModelFit fit = fit_model(rival, truth, centre, true);
  return std::sqrt(std::max(0.0, fit.chi2));
}

double upper_tail(const std::vector<double>& draws, double x) {
  const auto above = std::count_if(draws.begin(), draws.end(), [x](double d) { return d >= x; });
  return (1.0 + static_cast<double>(above)) / (1.0 + static_cast<double>(draws.size()));
}

}  // namespace drumsweep

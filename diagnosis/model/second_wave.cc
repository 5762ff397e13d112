#include "diagnosis/model/second_wave.h"

#include "diagnosis/model/linear_algebra.h"

namespace drumsweep {
namespace {

using Index = Eigen::Index;

/// Where the dimensions of the correction are among those of the model.
std::vector<Index> places(const ModelEmulator& model, const LocalCentre& centre) {
  std::vector<Index> out;
  for (Index j = 0; j < model.num_parameters; ++j) out.push_back(j);
  for (const int effect : centre.effects)
    out.push_back(model.num_parameters +
                  (std::find(model.effects.begin(), model.effects.end(), effect) - model.effects.begin()));
  return out;
}

/// H: features in, what is left of them when their tangent at the centre is taken away. Only features of the correction's own
/// dimensions have a tangent here; the others pass.
Eigen::MatrixXd without_tangent(const ModelEmulator& model, const LocalCentre& centre, const std::vector<Index>& at) {
  const Index n = model.dimensions();
  Eigen::VectorXd x = Eigen::VectorXd::Zero(n);
  std::vector<bool> own(static_cast<std::size_t>(n), false);
  for (std::size_t i = 0; i < at.size(); ++i) {
    x[at[i]] = centre.x[static_cast<Index>(i)];
    own[static_cast<std::size_t>(at[i])] = true;
  }
  const Eigen::VectorXd f = features_of(x);
  const Eigen::MatrixXd slope = feature_slopes(x);
  Eigen::MatrixXd h = Eigen::MatrixXd::Identity(f.size(), f.size());
  const auto take_away = [&](Index feature) {
    h(feature, 0) -= f[feature];
    for (const Index i : at) {
      h(feature, 0) += slope(feature, i) * x[i];
      h(feature, 1 + i) -= slope(feature, i);
    }
  };
  take_away(0);
  for (const Index i : at) take_away(1 + i);
  Index feature = 1 + n;
  for (Index i = 0; i < n; ++i)
    for (Index j = i; j < n; ++j, ++feature)
      if (own[static_cast<std::size_t>(i)] && own[static_cast<std::size_t>(j)]) take_away(feature);
  return h;
}

}  // namespace

Index fewest_local_runs(const LocalCentre& centre) { return 3 * (1 + centre.x.size()); }

LocalCorrection local_correction(const Emulator& emulator, const LocalRuns& runs) {
  const Index num = runs.x.rows(), n = runs.centre.x.size();
  const ModelEmulator model = emulator.of_model(runs.centre.effects);
  Eigen::MatrixXd g = Eigen::MatrixXd::Ones(num, 1 + n), off(num, runs.outputs.cols());
  for (Index i = 0; i < num; ++i) {
    const Eigen::VectorXd x = runs.x.row(i), predicted = model.predict(x);
    for (Index j = 0; j < n; ++j) g(i, 1 + j) = (x[j] - runs.centre.x[j]) / runs.centre.half_width[j];
    for (Index k = 0; k < off.cols(); ++k) off(i, k) = runs.outputs(i, k) / emulator.scale()[k] - predicted[k];
  }
  const LeastSquares fit = least_squares(g, off);
  // g = T (1, x)
  Eigen::MatrixXd t = Eigen::MatrixXd::Identity(1 + n, 1 + n);
  for (Index j = 0; j < n; ++j) {
    t(1 + j, 1 + j) = 1 / runs.centre.half_width[j];
    t(1 + j, 0) = -runs.centre.x[j] / runs.centre.half_width[j];
  }
  LocalCorrection out;
  out.centre = runs.centre;
  out.coefficients = transposed_product(t, fit.coefficients);
  out.a = transposed_product(t, product(fit.inverse_information, t));
  out.noise =
      std::make_shared<const Eigen::MatrixXd>(shrunk_covariance(off - product(g, fit.coefficients), num - 1 - n));
  return out;
}

double largest_shift(const LocalCorrection& correction) {
  Eigen::VectorXd at(1 + correction.centre.x.size());
  at[0] = 1;
  at.tail(correction.centre.x.size()) = correction.centre.x;
  return transposed_times(correction.coefficients, at).cwiseAbs().maxCoeff();
}

ModelEmulator corrected(ModelEmulator model, const LocalCorrection& correction) {
  const std::vector<Index> at = places(model, correction.centre);
  const Eigen::MatrixXd h = without_tangent(model, correction.centre, at);
  model.a = congruence(h.transpose(), model.a);
  std::vector<Index> features = {0};
  for (const Index i : at) features.push_back(1 + i);
  for (std::size_t i = 0; i < features.size(); ++i) {
    model.coefficients.row(features[i]) += correction.coefficients.row(static_cast<Index>(i));
    for (std::size_t j = 0; j < features.size(); ++j)
      model.a(features[i], features[j]) += correction.a(static_cast<Index>(i), static_cast<Index>(j));
  }
  model.noise = correction.noise;
  return model;
}

}  // namespace drumsweep

#include "diagnosis/model/second_wave.h"

#include "diagnosis/model/linear_algebra.h"

namespace drumsweep {
namespace {

using Index = Eigen::Index;

/// H: features in, what is left of them when their tangent at x is taken away.
Eigen::MatrixXd without_tangent(const Eigen::VectorXd& x) {
  const Eigen::VectorXd f = features_of(x);
  const Eigen::MatrixXd slope = feature_slopes(x);
  const Eigen::VectorXd level = f - times(slope, x);
  Eigen::MatrixXd h = Eigen::MatrixXd::Identity(f.size(), f.size());
  h.col(0) -= level;
  h.block(0, 1, f.size(), x.size()) -= slope;
  return h;
}

}  // namespace

Index fewest_local_runs(const LocalCentre& centre) { return 5 * (1 + centre.x.size()); }

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
  out.degrees_of_freedom = num - 1 - n;
  out.coefficients = transposed_product(t, fit.coefficients);
  out.a = transposed_product(t, product(fit.inverse_information, t));
  out.noise = std::make_shared<const Eigen::MatrixXd>(
      shrunk_covariance(off - product(g, fit.coefficients), out.degrees_of_freedom));
  return out;
}

void pool_noise(std::vector<LocalCorrection>& corrections) {
  if (corrections.empty()) return;
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(corrections.front().noise->rows(), corrections.front().noise->cols());
  double num = 0;
  for (const LocalCorrection& c : corrections) {
    sum += static_cast<double>(c.degrees_of_freedom) * *c.noise;
    num += static_cast<double>(c.degrees_of_freedom);
  }
  const auto pooled = std::make_shared<const Eigen::MatrixXd>(sum / num);
  for (LocalCorrection& c : corrections) c.noise = pooled;
}

double largest_shift(const LocalCorrection& correction) {
  Eigen::VectorXd at(1 + correction.centre.x.size());
  at[0] = 1;
  at.tail(correction.centre.x.size()) = correction.centre.x;
  return transposed_times(correction.coefficients, at).cwiseAbs().maxCoeff();
}

ModelEmulator corrected(ModelEmulator model, const LocalCorrection& correction) {
  const Index n = correction.coefficients.rows();  // the features 1 and x come first
  model.a = congruence(without_tangent(correction.centre.x).transpose(), model.a);
  model.a.topLeftCorner(n, n) += correction.a;
  model.coefficients.topRows(n) += correction.coefficients;
  model.noise = correction.noise;
  return model;
}

}  // namespace drumsweep

#include "diagnosis/model/emulator.h"

#include <fmt/format.h>

#include "core/config/schema.h"
#include "diagnosis/model/linear_algebra.h"

namespace drumsweep {
namespace {

constexpr double shrinkage = 0.2;

/// Place of x_i x_j, i <= j, among the features of n dimensions.
Eigen::Index product_index(Eigen::Index n, Eigen::Index i, Eigen::Index j) {
  return 1 + n + i * n - i * (i - 1) / 2 + (j - i);
}

}  // namespace

Eigen::Index num_features(Eigen::Index n) { return 1 + n + n * (n + 1) / 2; }

Eigen::VectorXd features_of(const Eigen::VectorXd& x) {
  const Eigen::Index n = x.size();
  Eigen::VectorXd f(num_features(n));
  f[0] = 1;
  f.segment(1, n) = x;
  Eigen::Index k = 1 + n;
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = i; j < n; ++j) f[k++] = x[i] * x[j];
  return f;
}

Eigen::MatrixXd feature_slopes(const Eigen::VectorXd& x) {
  const Eigen::Index n = x.size();
  Eigen::MatrixXd slope = Eigen::MatrixXd::Zero(num_features(n), n);
  Eigen::Index k = 1 + n;
  for (Eigen::Index i = 0; i < n; ++i) {
    slope(1 + i, i) = 1;
    for (Eigen::Index j = i; j < n; ++j, ++k) {
      slope(k, i) += x[j];
      slope(k, j) += x[i];
    }
  }
  return slope;
}

Emulator::Emulator(const CampaignRuns& runs, const Eigen::VectorXd& scale)
    : num_parameters_(runs.parameters.cols()),
      num_effects_(runs.strengths.cols()),
      num_runs_(runs.outputs.rows()),
      scale_(scale) {
  const Eigen::Index dimensions = num_parameters_ + num_effects_, n = num_features(dimensions);
  if (num_runs_ < n + 2)
    throw InputError(fmt::format(
        "{} campaign runs for {} coefficients ({} free parameters and {} candidates): accepted is {} runs and more",
        num_runs_, n, num_parameters_, num_effects_, n + 2));
  Eigen::MatrixXd f(num_runs_, n);
  for (Eigen::Index i = 0; i < num_runs_; ++i) {
    Eigen::VectorXd x(dimensions);
    x.head(num_parameters_) = runs.parameters.row(i);
    x.tail(num_effects_) = runs.strengths.row(i);
    f.row(i) = features_of(x).transpose();
  }
  Eigen::MatrixXd y = runs.outputs;
  for (Eigen::Index i = 0; i < y.cols(); ++i) y.col(i) *= 1 / scale[i];
  LeastSquares fit = least_squares(f, y);
  if (!fit.regular)
    throw InputError(
        "the campaign's runs do not tell all parameters and candidates apart: more runs, or fewer candidates");
  a_ = std::move(fit.inverse_information);
  coefficients_ = std::move(fit.coefficients);
  residuals_ = y - product(f, coefficients_);
  noise_ = std::make_shared<const Eigen::MatrixXd>(shrunk_covariance(residuals_, num_runs_ - n));
}

Eigen::MatrixXd shrunk_covariance(const Eigen::MatrixXd& residuals, Eigen::Index degrees_of_freedom) {
  Eigen::MatrixXd out = transposed_product(residuals, residuals) / static_cast<double>(degrees_of_freedom);
  const Eigen::VectorXd diagonal = out.diagonal();
  out *= 1 - shrinkage;
  // An output that no random number moves (one ball on an incline) still needs a noise to be divided by.
  out.diagonal() = diagonal.cwiseMax(1e-12);
  return out;
}

std::vector<Eigen::Index> Emulator::features_of_model(const std::vector<int>& effects) const {
  const Eigen::Index n = num_parameters_ + num_effects_;
  std::vector<Eigen::Index> dimension, list = {0};
  for (Eigen::Index i = 0; i < num_parameters_; ++i) dimension.push_back(i);
  for (const int e : effects) dimension.push_back(num_parameters_ + e);
  for (const Eigen::Index d : dimension) list.push_back(1 + d);
  for (std::size_t i = 0; i < dimension.size(); ++i)
    for (std::size_t j = i; j < dimension.size(); ++j)
      list.push_back(product_index(n, std::min(dimension[i], dimension[j]), std::max(dimension[i], dimension[j])));
  return list;
}

ModelEmulator Emulator::of_model(const std::vector<int>& effects) const {
  const std::vector<Eigen::Index> features = features_of_model(effects);
  return {effects, num_parameters_, coefficients_(features, Eigen::all), a_(features, features), noise_};
}

Eigen::VectorXd ModelEmulator::predict(const Eigen::VectorXd& x) const {
  return transposed_times(coefficients, features_of(x));
}

double ModelEmulator::variance_factor(const Eigen::VectorXd& x) const {
  const Eigen::VectorXd f = features_of(x);
  return f.dot(times(a, f));
}

Eigen::VectorXd Emulator::predict(const Eigen::VectorXd& x) const {
  return transposed_times(coefficients_, features_of(x));
}

Eigen::Index runs_by_budget_law(const Emulator& emulator) {
  Eigen::VectorXd ratio = emulator.noise().diagonal();
  std::sort(ratio.begin(), ratio.end());
  const double typical = ratio[static_cast<Eigen::Index>(0.9 * static_cast<double>(ratio.size() - 1))];
  return static_cast<Eigen::Index>(std::ceil(9 * static_cast<double>(emulator.coefficients().rows()) * typical));
}

}  // namespace drumsweep

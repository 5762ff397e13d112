/// The campaign's runs as one shared quadratic regression: y(u, p) = m(u, p) + e, with the features
/// {1, x_i, x_i x_j (i <= j)} of x = (u, p), the same for all outputs, so that
///   predictive covariance = v Sigma_s,  v = f^T A f,  A = (F^T F)^-1,
/// where Sigma_s is the covariance of the residuals (simulation noise and lack of fit), shrunk by 20 % to its diagonal.
#pragma once

#include <memory>

#include "diagnosis/model/problem.h"

namespace drumsweep {

/// Features of a point: 1, x_i, then x_i x_j with i <= j in rows.
Eigen::Index num_features(Eigen::Index dimensions);
Eigen::VectorXd features_of(const Eigen::VectorXd& x);
/// Their derivatives (features x dimensions).
Eigen::MatrixXd feature_slopes(const Eigen::VectorXd& x);

/// What an emulator says of one model (the parameters and some effects; all others are off): y = C^T f(x), covariance v Sigma_s.
struct ModelEmulator {
  std::vector<int> effects;  ///< ascending
  Eigen::Index num_parameters = 0;
  Eigen::MatrixXd coefficients;                  ///< C (features of the model x outputs), in units of the scale
  Eigen::MatrixXd a;                             ///< v = f^T A f (features x features)
  std::shared_ptr<const Eigen::MatrixXd> noise;  ///< Sigma_s (outputs x outputs)

  Eigen::Index dimensions() const { return num_parameters + static_cast<Eigen::Index>(effects.size()); }
  Eigen::VectorXd predict(const Eigen::VectorXd& x) const;
  double variance_factor(const Eigen::VectorXd& x) const;
};

class Emulator {
 public:
  /// @param scale  of each output; all that follows is in these units (those of the data's sigma)
  /// @throws InputError when there are fewer runs than features + 2, or when the runs do not tell the features apart
  Emulator(const CampaignRuns& runs, const Eigen::VectorXd& scale);

  Eigen::Index num_parameters() const { return num_parameters_; }
  Eigen::Index num_effects() const { return num_effects_; }
  Eigen::Index num_outputs() const { return coefficients_.cols(); }
  Eigen::Index num_runs() const { return num_runs_; }
  /// (features x outputs), in units of `scale`
  const Eigen::MatrixXd& coefficients() const { return coefficients_; }
  const Eigen::MatrixXd& inverse_information() const { return a_; }  ///< A (features x features)
  const Eigen::MatrixXd& noise() const { return *noise_; }           ///< Sigma_s (outputs x outputs), units of `scale`
  const Eigen::MatrixXd& residuals() const { return residuals_; }    ///< (runs x outputs)
  const Eigen::VectorXd& scale() const { return scale_; }

  /// Indices of the features that use only the parameters and these effects, in the order of features_of() for that subset.
  std::vector<Eigen::Index> features_of_model(const std::vector<int>& effects) const;
  ModelEmulator of_model(const std::vector<int>& effects) const;
  /// At a full point x = (u, p), in units of `scale`.
  Eigen::VectorXd predict(const Eigen::VectorXd& x) const;

 private:
  Eigen::Index num_parameters_, num_effects_, num_runs_;
  Eigen::VectorXd scale_;
  Eigen::MatrixXd coefficients_, a_, residuals_;
  std::shared_ptr<const Eigen::MatrixXd> noise_;
};

/// Covariance of residuals with so many degrees of freedom, shrunk by 20 % to its diagonal.
Eigen::MatrixXd shrunk_covariance(const Eigen::MatrixXd& residuals, Eigen::Index degrees_of_freedom);

/// Runs that the budget law asks for: 9 n_coef (sigma_s / sigma_m)^2, with the largest ratio but one in ten of the outputs.
/// Fewer, and intervals undercover and true pairs are refused; false alarms stay right.
Eigen::Index runs_by_budget_law(const Emulator& emulator);

}  // namespace drumsweep

/// Fits of the emulator to measurements: which parameters and strengths bring it nearest, and how near.
///
/// Minimised over x = (u, p) in a box:
///   S(x) = sum_i [ (z_i - m_i(x))^2 / s_i + ln s_i ] + |u - c|^2,   s_i = 1 + v(x) lambda_i,
/// in coordinates z in which the measurement covariance is 1 and that of the simulation noise is diagonal (generalised
/// eigenvectors of Sigma_s against Sigma_m), so that Sigma_m + v Sigma_s is diagonal for every v. c is the centre of the bench
/// prior, 0 but in a bootstrap, where the bench measurements are drawn anew as well.
#pragma once

#include "diagnosis/model/emulator.h"

namespace drumsweep {

/// Largest |u| that the runs cover, and a fit may use: the design reaches 2.2 bench errors.
inline constexpr double design_reach = 2.2, fit_reach = 2.6;

/// Some outputs in rotated coordinates, in which the noise of a model's emulator is diagonal.
struct FitSpace {
  std::vector<Eigen::Index> outputs;
  Eigen::MatrixXd to_rotated;  ///< z = to_rotated y (outputs x outputs), y in units of the scale
  Eigen::MatrixXd to_plain;    ///< its inverse
  Eigen::VectorXd lambda;      ///< variance of the simulation noise in each coordinate
  double log_scale = 0;        ///< ln det of covariance and lack of fit over that of the covariance; part of S
};

struct FitOptions {
  bool with_simulation_noise = true;  ///< false only in tests that must fail
};

/// @param noise  of the simulation (all outputs)  @param covariance  of the measurements of `outputs`
/// @param lack_of_fit  variance by which the emulator is off however many runs it has (all outputs), or empty; all in units of the scale
std::shared_ptr<const FitSpace> make_fit_space(const Eigen::MatrixXd& noise, const std::vector<Eigen::Index>& outputs,
                                               const Eigen::MatrixXd& covariance, const FitOptions& options = {},
                                               const Eigen::VectorXd& lack_of_fit = {});

/// One model: the parameters and some effects; all others are off.
struct SubModel {
  std::vector<int> effects;  ///< ascending
  Eigen::Index num_parameters = 0;
  std::shared_ptr<const FitSpace> space;
  Eigen::MatrixXd coefficients;  ///< (features of the model x outputs of the space), rotated
  Eigen::MatrixXd a;             ///< A of these features
  Eigen::VectorXd low, high;     ///< box of x

  Eigen::Index dimensions() const { return num_parameters + static_cast<Eigen::Index>(effects.size()); }
};
SubModel make_sub_model(const ModelEmulator& emulator, const std::shared_ptr<const FitSpace>& space,
                        const Problem& problem);

struct ModelFit {
  std::vector<int> effects;
  Eigen::VectorXd x;  ///< (parameters and effects of the model)
  double q = 0;       ///< S at the minimum
  double chi2 = 0;    ///< its first part and the prior's
  double v = 0;
  Eigen::MatrixXd spread;  ///< posterior covariance of x, from the Gauss-Newton Hessian
};

/// @param z  the measurements in rotated coordinates  @param centre  c, (parameters)
/// @param start  first guess of x
ModelFit fit_from(const SubModel& model, const Eigen::VectorXd& z, const Eigen::VectorXd& centre,
                  const Eigen::VectorXd& start);
/// From effects that are off and, if `thorough`, also from half strength either way; the best of them.
ModelFit fit_model(const SubModel& model, const Eigen::VectorXd& z, const Eigen::VectorXd& centre,
                   bool thorough = false);

/// Prediction of the model in rotated coordinates.
Eigen::VectorXd predict(const SubModel& model, const Eigen::VectorXd& x);
/// The full point (all parameters, all effects) of a model's x.
Eigen::VectorXd full_point(const Emulator& emulator, const SubModel& model, const Eigen::VectorXd& x);

/// log of the evidence (Laplace): -q/2 + log prior of the strengths + log volume of the posterior.
double log_evidence(const ModelFit& fit, const SubModel& model, const Problem& problem);

/// 95 % interval of strength number `k` of the model: where S has risen by 3.84 after all else was refitted; in units of p.
struct Interval {
  double low, high;
};
Interval profile_interval(const SubModel& model, const Eigen::VectorXd& z, const Eigen::VectorXd& centre,
                          const ModelFit& fit, std::size_t k);

}  // namespace drumsweep

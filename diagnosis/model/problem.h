/// Measured data, what may be adjusted, and what may be missing from the model: the input of a diagnosis, as plain data.
///
/// Two kinds of unknowns. Free parameters theta have bench priors N(mean, sigma^2); inside, u = (theta - mean) / sigma. Candidate
/// effects have a strength phi that is 0 in the plain model; inside, p = (phi / largest |phi| of the range)^curve, in [0, 1] where the
/// effect has a sign and in [-1, 1] where not. A curve below 1 straightens an effect that saturates.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace drumsweep {

enum class Use {
  fit,        ///< for finding what is wrong
  holdout,    ///< never looked at before a cause has been chosen
  available,  ///< not measured yet, but could be, with this sigma
  ignored,
};

struct Datum {
  std::string condition;
  std::string quantity;
  double position = std::nan("");  ///< NaN for a quantity without one
  std::string position_unit = "m";
  double value = std::nan("");  ///< measured; NaN where only available
  double sigma = 1;             ///< standard error of the measurement, finite recording included; > 0
  std::string unit = "1";
  std::string group = "bench";  ///< bench | drum | outlet | belt | mass
  Use use = Use::fit;
};

/// "drum60 charge_angle", "outlet bed_height at 0.2 m"
std::string name_of(const Datum& datum);

struct FreeParameter {
  std::string id, unit;
  double mean = 0, sigma = 1;  ///< bench prior
};

struct CandidateEffect {
  std::string id, unit;
  double low = 0, high = 1;  ///< of the strength; low = 0 where only one sign is possible
  double prior_scale = 0.5;  ///< of a (half-)normal prior of the strength
  std::string about{};
  bool listed = true;  ///< false: in the campaign's runs, but not among the causes that may be named

  double curve = 1;

  double scale() const { return std::max(std::abs(low), std::abs(high)); }
  double strength(double p) const { return std::copysign(scale() * std::pow(std::abs(p), 1 / curve), p); }
  double inner(double phi) const { return std::copysign(std::pow(std::abs(phi) / scale(), curve), phi); }
};

struct Problem {
  std::vector<Datum> data;
  /// Of the measurements (data x data), with sigma^2 on the diagonal; empty: independent.
  Eigen::MatrixXd covariance{};
  std::vector<FreeParameter> parameters;
  std::vector<CandidateEffect> effects;

  Eigen::Index num_data() const { return static_cast<Eigen::Index>(data.size()); }
  Eigen::MatrixXd measurement_covariance() const;
  std::vector<Eigen::Index> with_use(Use use) const;
};

/// What the campaign has simulated: one row a run, each with its own random numbers.
struct CampaignRuns {
  Eigen::MatrixXd parameters;  ///< u (runs x parameters)
  Eigen::MatrixXd strengths;   ///< p (runs x effects)
  Eigen::MatrixXd outputs;     ///< (runs x data), in the data's units
};

}  // namespace drumsweep

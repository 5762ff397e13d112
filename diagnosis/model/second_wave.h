/// The second wave: runs close round a model that may explain the data, and what they correct in the campaign's emulator.
///
/// A quadratic over the whole range is off by more than its noise where an effect is strong. Runs round the point that was found
/// say by how much. With D = y - m(x) of the runs and g = (1, (x - c) / w) with centre c and half widths w,
///   D = g^T B + e,   m'(x) = m(x) + g^T B,
/// so that level and slopes at c are those of the second wave, and only the curvature is still the campaign's:
///   v'(x) = g^T (G^T G)^-1 g + h^T A h,   h = f(x) - [f(c) + f'(c) (x - c)],
/// with the covariance of e as noise: simulation noise alone, as lack of fit within so small a box is small.
#pragma once

#include "diagnosis/model/emulator.h"

namespace drumsweep {

/// A box round a fitted model, in inner units; rounded, so that it is the same on every machine.
struct LocalCentre {
  std::vector<int> effects;    ///< of the model, ascending
  Eigen::VectorXd x;           ///< middle (parameters and effects of the model)
  Eigen::VectorXd half_width;  ///< > 0
};

struct LocalRuns {
  LocalCentre centre;
  Eigen::MatrixXd x;        ///< (runs x dimensions of the model)
  Eigen::MatrixXd outputs;  ///< (runs x data), in the data's units
};

/// What one box's runs correct.
struct LocalCorrection {
  LocalCentre centre;
  Eigen::MatrixXd coefficients;  ///< of (1, x) (1 + dimensions x outputs), in units of the scale
  Eigen::MatrixXd a;             ///< of (1, x)
  std::shared_ptr<const Eigen::MatrixXd> noise;
  Eigen::Index degrees_of_freedom = 0;  ///< of the noise
};
/// The noise of all boxes together, which each then has: that of one box alone is too uncertain to divide by.
void pool_noise(std::vector<LocalCorrection>& corrections);
/// Fewest runs in a box that a correction is made of.
Eigen::Index fewest_local_runs(const LocalCentre& centre);
LocalCorrection local_correction(const Emulator& emulator, const LocalRuns& runs);
/// How far off the emulator was at the centre: largest over the outputs, in units of their scale.
double largest_shift(const LocalCorrection& correction);

/// The emulated model of the centre's effects with the correction put in.
ModelEmulator corrected(ModelEmulator model, const LocalCorrection& correction);

}  // namespace drumsweep

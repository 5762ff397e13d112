/// Where the next simulations teach most about the optimum: the knowledge gradient (Frazier, Powell and Dayanik,
/// INFORMS J. Comput. 21, 599, 2009) on the fit,
///   gain(x, r) = min_j m_j - E[ min_j m'_j ],   m, m': mean of F at candidate points before and after a run at (x, r).
/// It is exact for a Gaussian fit over the candidates and, unlike expected improvement, knows that runs are noisy: a
/// point measured before may be worth another replicate. Replicates are part of the choice: a run of a known replicate
/// number shares its error with its neighbours (differences along the valley become sharp), one of a new number
/// averages that error out. A batch is filled one run at a time, each run's result taken to be its prediction.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "sweep/fit/surface.h"

namespace drumsweep {

struct Proposal {
  Point at;                  ///< lattice point
  double replicate = 0;      ///< one with rows already, or the next free number
  bool known_point = false;  ///< has rows already: one more replicate of it
  double gain_m = 0;         ///< expected lowering of F at the point then thought best
};

struct Batch {
  std::vector<Proposal> runs;  ///< in order of choice; no (point, replicate) twice, none that has a row
  double gain_m = 0;           ///< of the first run
  double batch_gain_m = 0;     ///< sum over the runs: what the batch is expected to lower F by, about
  std::string reason;          ///< for people
};

struct AcquisitionOptions {
  int num_candidates = 150;  ///< a third over the box, the rest where the minimum may be
  int most_replicates = 8;   ///< numbers considered beside a new one: the latest
};

/// @param allowed false for points without a drum (holes); they are neither proposed nor thought best
Batch next_batch(const FittedSurface& surface, int count, std::int64_t seed, const AcquisitionOptions& options = {},
                 const std::function<bool(const Point&)>& allowed = {});

/// E[min_j (a_j + b_j Z)] - min_j a_j for standard normal Z; <= 0. Exact by the lower envelope of the lines.
double expected_drop(const Eigen::VectorXd& a, const Eigen::VectorXd& b);

}  // namespace drumsweep

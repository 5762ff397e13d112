/// One outer step of a scene: contact search, then sub-steps of contact and motion.
#pragma once

#include <array>
#include <functional>

#include "core/solver/residual.h"
#include "core/step/assemble.h"
#include "core/step/smooth_step.h"

namespace drumsweep {

/// Parts of a step that are timed apart.
enum class Phase { feed, search, assemble, solve, move, report, count };
inline constexpr std::array<const char*, 6> phase_names = {"feed", "search", "assemble", "solve", "move", "report"};

/// Solver quality in the last sub-step of an outer step.
struct StepReport {
  std::size_t num_contacts = 0;  ///< rows with an impulse
  std::size_t num_rows = 0;      ///< rows, speculative ones included
  Residual residual;             ///< natural map [m/s]; 0 with the smooth step, which solves nothing
  double iterations = 0;         ///< of the solver in that sub-step
  double max_overlap = 0;        ///< over the diameter
  double overlap_95 = 0;         ///< 95 % of the pressed contacts overlap less, over the diameter
  double mean_overlap = 0;       ///< over the diameter
  double force_balance = 0;      ///< largest |m dv - sum of impulses| / m of a ball [m/s]
};

/// Scratch memory, kept from step to step.
struct Workspace {
  PairSearchScratch pair_search;
  WallCandidates candidates;
  Assembly assembly;
  SmoothScratch smooth;
  std::vector<Pose> poses;           ///< (walls)
  std::vector<double> inverse_mass;  ///< (balls) 0: never moves [1/kg]
  std::vector<float> pressed;
  std::vector<Eigen::Vector3f> impulse_sum;
  std::array<double, static_cast<std::size_t>(Phase::count)> phase_s{};  ///< seconds spent, summed over steps
};

/// Called when the balls have moved by one sub-step that ends at `time`. It must not add or remove balls.
using AfterMove = std::function<void(double time)>;

/// Advances the state by one outer step. @param after_move  may be empty
StepReport advance(const World& world, BallState& state, Workspace& work, const AfterMove& after_move = {});

/// Seconds since the last call, for the phases.
class PhaseClock {
 public:
  explicit PhaseClock(Workspace& work);
  void done(Phase phase);

 private:
  Workspace& work_;
  double last_;
};

}  // namespace drumsweep

/// One outer step of a scene: contact search, then sub-steps of contact and motion.
#pragma once

#include <array>
#include <functional>

#include "core/solver/residual.h"
#include "core/step/impacts.h"
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

/// Distribution of the overlaps of contacts that press, over the mean diameter.
struct Overlaps {
  static constexpr float bins_per_diameter = 2000;
  static constexpr std::size_t num_bins = 1000;  ///< the last holds all beyond
  float per_diameter = 0, max = 0;
  double sum = 0, num = 0;
  std::size_t num_pressed = 0;  ///< contacts with an impulse
  std::array<std::uint32_t, num_bins> counts{};

  void clear(double diameter) { *this = {static_cast<float>(1 / diameter), 0, 0, 0, 0, {}}; }
  void add(float overlap) {
    const float part = overlap * per_diameter;
    sum += static_cast<double>(part);
    max = part > max ? part : max;
    num += 1;
    const float bin = part * bins_per_diameter;
    ++counts[bin < static_cast<float>(num_bins - 1) ? static_cast<std::size_t>(bin) : num_bins - 1];
  }
};

/// Scratch memory, kept from step to step.
struct Workspace {
  int threads = 1;  ///< results do not depend on it
  Assembly assembly;
  ImpactScratch impacts;
  SmoothScratch smooth;
  std::vector<Pose> poses;                                               ///< (walls)
  std::vector<double> inverse_mass;                                      ///< (balls) 0: never moves [1/kg]
  std::vector<Overlaps> overlaps;                                        ///< (blocks)
  std::vector<BodyVelocity> check;                                       ///< (bodies)
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

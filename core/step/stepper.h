/// One outer step of the drum: feed, contact search, sub-steps, belt.
#pragma once

#include <array>

#include "core/solver/residual.h"
#include "core/step/assemble.h"
#include "core/step/feed.h"

namespace drumsweep {

/// Parts of a step that are timed apart.
enum class Phase { feed, search, assemble, solve, move, report, count };
inline constexpr std::array<const char*, 6> phase_names = {"feed", "search", "assemble", "solve", "move", "report"};

/// Solver quality in the last sub-step of an outer step.
struct StepReport {
  std::size_t num_contacts = 0;  ///< rows with an impulse
  std::size_t num_rows = 0;      ///< rows, speculative ones included
  Residual residual;             ///< natural map [m/s]
  double max_overlap = 0;        ///< over the diameter
  double overlap_95 = 0;         ///< 95 % of the pressed contacts overlap less, over the diameter
  double mean_overlap = 0;       ///< over the diameter
  double force_balance = 0;      ///< largest |m dv - sum of impulses| / m of a ball [m/s]
};

/// Scratch memory, kept from step to step.
struct Workspace {
  PairSearchScratch pair_search;
  FeedScratch feed;
  WallCandidates candidates;
  Assembly assembly;
  std::vector<char> gone;
  std::vector<float> pressed;
  std::vector<Eigen::Vector3f> impulse_sum;
  std::array<double, static_cast<std::size_t>(Phase::count)> phase_s{};  ///< seconds spent, summed over steps
};

/// Advances the state by one outer step.
/// @param landings  appended to; null when nobody listens
StepReport advance(const DrumModel& model, DrumState& state, Workspace& work, std::vector<Landing>* landings = nullptr);

}  // namespace drumsweep

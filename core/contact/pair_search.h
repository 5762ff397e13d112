/// Candidate pairs of balls from a cell grid, in a canonical order.
#pragma once

#include <cstdint>
#include <vector>

#include "core/state/drum_state.h"

namespace drumsweep {

struct PairSearch {
  double cell_size = 0;    ///< larger than a ball with its margin; a matter of speed alone [m]
  double margin = 0;       ///< pairs are listed up to this gap ... [m]
  double horizon = 0;      ///< ... plus what their relative velocity closes in this time [s]
  double extra_speed = 0;  ///< ... and this speed more, for what collisions change [m/s]
  bool rebounds = false;   ///< velocities may turn within that time: any direction of the relative velocity counts
  double period = 0;       ///< along y; 0: not periodic [m]
  bool turns = false;      ///< keep the turns of the pairs too
};

/// Scratch that keeps its memory from search to search.
struct PairSearchScratch {
  std::vector<std::uint32_t> cell_of, cell_begin, order, place_of, old_begin;
  std::vector<PairImpulse> old;
  std::vector<Turn> old_turns;
  std::vector<std::uint8_t> num_near;  ///< (balls) pairs of each in the near search, at most 255
};

/// Sorts the balls by cell (along the axis first, so that neighbours in space are neighbours in memory), lists the
/// pairs and carries their impulses over; periodic positions are put back into [0, period). Deterministic: a function of the state alone.
void sort_and_find_pairs(const PairSearch& search, BallState& state, PairSearchScratch& scratch);

}  // namespace drumsweep

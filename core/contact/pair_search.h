/// Sorting of the balls by cells and candidate pairs, in a canonical order.
///
/// Cells of the grid are sorted along the axis first, so that neighbours in space are neighbours in memory, and cut across the axis into
/// slabs of some hundred balls: a pair has both balls in one slab or in two neighbours, so every other slab can be worked on at the same
/// time. Where that is not so (balls that fly far, ends of a periodic scene) pairs are listed apart.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/state/drum_state.h"

namespace drumsweep {

struct PairSearch {
  double cell_size = 0;    ///< larger than a ball with its margin; a matter of speed alone [m]
  double margin = 0;       ///< pairs are listed that come nearer than this gap ... [m]
  double horizon = 0;      ///< ... within this time as they fly ... [s]
  double extra_speed = 0;  ///< ... or when they approach by this speed more, for what collisions change [m/s]
  bool rebounds = false;   ///< velocities may turn within that time: any direction of the relative velocity counts
  double slope = 0;        ///< dz/dy of the axis along which the balls lie: the grid follows it, so that it stays small
  double period = 0;       ///< along y; 0: not periodic [m]
  bool turns = false;      ///< keep the turns of the pairs too
};

/// Places of two balls, the lower first.
using BallPair = std::array<std::uint32_t, 2>;

/// Balls as they fly within the horizon, one array each [m]; readable up to sixteen past the last.
struct Flights {
  const float *x = nullptr, *y = nullptr, *z = nullptr, *way_x = nullptr, *way_y = nullptr, *way_z = nullptr,
              *radius = nullptr,
              *turn = nullptr;      ///< turn: how far it may go another way
  float near_gap = 0, far_gap = 0;  ///< pairs are listed when they come nearer than this
  bool rebounds = false;            ///< ... or may by their turns
};

/// A run of balls between two planes across the axis, and the pairs whose lower ball is in it.
struct Slab {
  std::uint32_t begin = 0, end = 0;  ///< places of its balls
  std::vector<BallPair> near;        ///< pairs that meet within the margin as they fly
  std::vector<BallPair> far;         ///< pairs that may meet if collisions bring them together
  std::vector<BallPair> apart;       ///< scratch
};

/// What the search of one outer step found, and scratch that keeps its memory from search to search.
struct PairList {
  std::vector<Slab> slabs;  ///< in use: the first num_slabs
  std::size_t num_slabs = 0;
  std::vector<BallPair> apart;           ///< pairs of slabs that are no neighbours
  std::vector<PairImpulse> old;          ///< impulses before, by their lower ball
  std::vector<Turn> old_turns;           ///< likewise, or empty
  std::vector<std::uint32_t> old_begin;  ///< (balls + 1) range of each ball in `old`

  static constexpr std::uint32_t none = 0xFFFFFFFFu;
  /// Where in `old` this pair is, or none.
  std::uint32_t old_place(const BallPair& pair) const {
    for (std::uint32_t o = old_begin[pair[0]]; o < old_begin[pair[0] + 1]; ++o)
      if (old[o].b == pair[1]) return o;
    return none;
  }
  /// Slab that holds a ball.
  std::size_t slab_of(std::uint32_t ball) const;
  /// Past the last ball that a pair of this slab may name.
  std::uint32_t reach_end(std::size_t slab) const { return slabs[slab + 1 < num_slabs ? slab + 1 : slab].end; }

  Flights flights;                                ///< of the balls, by their new places
  Eigen::Vector3d low = Eigen::Vector3d::Zero();  ///< where the flights count from, in the room [m]

  std::vector<std::uint32_t> cell_of, cell_begin, order, place_of;
  std::vector<std::uint8_t> num_near;            ///< (balls) pairs of each in the near search, at most 255
  std::array<std::vector<float>, 8> flight;      ///< (balls) place, way within the horizon, radius, turn [m]
  std::vector<std::vector<std::uint32_t>> hits;  ///< (threads)
  BallScratch spare;
};

/// Sorts the balls by cell, lists the pairs and keeps their impulses; periodic positions are put back into [0, period).
/// state.pairs, its turns and the balls of state.walls are renamed. Deterministic: a function of the state alone.
void sort_and_find_pairs(const PairSearch& search, int threads, BallState& state, PairList& list);

}  // namespace drumsweep

/// Everything that evolves. A run is a function of (model, state): what is written to a snapshot is exactly this.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "core/state/landing.h"

namespace drumsweep {

/// Memory for sorting.
struct BallScratch {
  std::vector<Eigen::Vector3d> vectors;
  std::vector<double> numbers;
  std::vector<std::uint32_t> ids;
  std::vector<std::uint8_t> bytes;
};

/// Balls, one entry each in all arrays; the order is that of the cells of the last contact search.
struct Balls {
  std::vector<Eigen::Vector3d> position;  ///< in the room: x along the belt, y across it, z up [m]
  std::vector<Eigen::Vector3d> velocity;  ///< [m/s]
  std::vector<Eigen::Vector3d> spin;      ///< angular velocity [rad/s]
  std::vector<double> radius;             ///< [m]
  std::vector<std::uint32_t> id;          ///< stable, in the order of feeding
  std::vector<std::uint8_t> exit;         ///< see Exit

  std::size_t size() const { return position.size(); }
  void add(const Eigen::Vector3d& at, double ball_radius, std::uint32_t ball_id);
  /// Puts old entry order[i] at place i in all arrays.
  void reorder(const std::vector<std::uint32_t>& order, int threads, BallScratch& scratch);
  /// Keeps the entries named, in ascending order.
  void keep(const std::vector<std::uint32_t>& ascending);
};

/// A listed pair of balls and the impulse of the last time step on a (and minus that on b), the next warm start.
struct PairImpulse {
  std::uint32_t a, b;  ///< places in Balls
  float tangent[3];    ///< [N s]
  float normal;        ///< >= 0 [N s]
};

/// Impulse of the last time step between a ball and a wall, in the frame of the wall.
struct WallImpulse {
  std::uint32_t ball;
  std::uint32_t wall;  ///< index in World::walls
  float direction[3];  ///< unit normal, from the wall to the ball
  float tangent[3];    ///< [N s]
  float normal;        ///< >= 0 [N s]
};

/// Mass balance in balls: fed = landed + spilled + removed + those inside (in drum, outlet or the air above the belt).
struct Counts {
  std::int64_t fed = 0;
  std::int64_t landed = 0;   ///< on the belt
  std::int64_t spilled = 0;  ///< past its edges
  std::int64_t removed = 0;  ///< lost: found where no ball can be
};

/// Torque impulse of the last time step on the first of a pair, or on a ball at the wall, over the contact's arm [N s].
using Turn = std::array<float, 3>;

/// Balls and what their contacts remember. With the smooth step the impulses are forces [N] and the turns torques over the arm [N].
struct BallState {
  std::int64_t num_steps = 0;  ///< outer steps since the beginning; time and place of the walls follow from it
  Balls balls;
  std::vector<PairImpulse> pairs;
  std::vector<WallImpulse> walls;
  std::vector<Turn> pair_turns;  ///< (pairs), or empty: no rolling or twisting resistance
  std::vector<Turn> wall_turns;  ///< (walls), or empty
};

struct DrumState : BallState {
  double feed_debt_kg = 0;  ///< fed by the clock but not yet placed
  Counts counts;
};

/// Removes the balls marked in `gone` (balls) with their impulses; the order of the others stays.
void drop_gone(BallState& state, const std::vector<char>& gone);

/// 64-bit hash of all balls (ids, positions, velocities, spins, exits), step and counts; independent of the order of the
/// arrays.
std::uint64_t state_hash(const DrumState& state);
std::uint64_t state_hash(const BallState& state);

}  // namespace drumsweep

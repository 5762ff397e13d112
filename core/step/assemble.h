/// From balls and walls to the contact problem of one time step and back: the only file that knows both contacts and
/// solver.
#pragma once

#include <array>
#include <span>

#include "core/contact/wall_contact.h"
#include "core/solver/contact_problem.h"
#include "core/state/drum_state.h"
#include "core/step/world.h"

namespace drumsweep {

/// Triangles that one ball may touch before the next contact search.
struct NearWall {
  std::uint32_t ball, wall;
  std::uint32_t begin, end;  ///< range in WallCandidates::triangles
};
struct WallCandidates {
  std::vector<NearWall> balls;  ///< by wall, then by ball
  std::vector<std::int32_t> triangles;
};

/// Lists, for every ball near a wall, the triangles within its reach: contact distance, margin, and what it can
/// travel relative to the wall in one outer step.
/// @param inverse_mass  (balls) 0 for balls that never move
void find_wall_candidates(const World& world, const Balls& balls, std::span<const double> inverse_mass,
                          std::span<const Pose> poses, WallCandidates& candidates);

/// Contact rows of one time step. Rows of pairs come first, in the order of the pair list, then those of the walls.
struct Assembly {
  ContactProblem problem;
  std::vector<float> overlap;                      ///< (rows) > 0 pressed, < 0 open [m]
  std::vector<Impulse> impulse;                    ///< (rows)
  std::vector<TurnImpulse> turn;                   ///< (rows), or empty: no rolling or twisting resistance
  std::vector<BodyVelocity> velocity;              ///< (balls, then one piece of wall per wall row)
  std::vector<std::uint32_t> pair_of;              ///< (pair rows) index in state.pairs
  std::vector<WallImpulse> walls;                  ///< (wall rows) direction in the frame of the wall
  std::vector<Eigen::Vector3f> attracted;          ///< (balls) impulse of cohesion [N s]; empty without cohesion
  bool impacts = false;                            ///< some row is an impact with restitution
  std::vector<WallContact> contacts;               ///< scratch
  ContactProblem impact_problem;                   ///< scratch
  std::vector<Impulse> impact_impulse;             ///< scratch
  std::vector<TurnImpulse> impact_turn;            ///< scratch
  std::vector<std::uint32_t> impact_group;         ///< scratch
  std::vector<std::array<double, 3>> impact_gain;  ///< scratch
};

/// Builds rows from positions and velocities at the beginning of the step (gaps, normals, impact or not, warm start).
void assemble_rows(const World& world, const BallState& state, std::span<const double> inverse_mass,
                   const WallCandidates& candidates, std::span<const Pose> poses, Assembly& out);

/// Impact stage for restitution: velocities at which all rows that collide obey Newton's law u+ = -e u- and no other row approaches;
/// friction and resistance to rolling act under the impulses of the impact as under any other, and no energy is gained. The rows are
/// then to be assembled anew. @param iterations  of Gauss-Seidel
void resolve_impacts(const World& world, int iterations, std::span<const double> inverse_mass, Assembly& assembly,
                     BallState& state);

/// Fills the ball part of `velocity` from the state's (already free-falling) velocities.
void load_velocities(const Balls& balls, std::span<const double> inverse_mass, Assembly& assembly);

/// Adds what the solver changed to the state's velocities.
void store_velocities(const Assembly& assembly, Balls& balls);

/// Keeps the impulses for the next warm start.
void store_impulses(std::span<const Pose> poses, const Assembly& assembly, BallState& state);

}  // namespace drumsweep

/// From balls and walls to the contact problem of one time step and back: the only files that know both contacts and
/// solver are this one and its siblings contact_rows and impacts.
#pragma once

#include <span>

#include "core/contact/pair_search.h"
#include "core/solver/contact_problem.h"
#include "core/solver/packer.h"
#include "core/step/wall_search.h"

namespace drumsweep {

/// What one slab's balls have to do with walls.
struct SlabWalls {
  WallCandidates candidates;
  std::vector<WallImpulse>
      impulse;             ///< of the last time step, by wall and ball; directions and tangents in the wall's frame
  std::vector<Turn> turn;  ///< likewise, or empty
  std::vector<WallImpulse> old_impulse;
  std::vector<Turn> old_turn;
  std::vector<std::uint32_t> place;  ///< (contacts of this step) pack_width * pack + lane
  std::vector<WallContact> contacts;
  std::vector<Eigen::Vector3d> normal, velocity;  ///< (contacts) in the room
  std::vector<float> overlap;                     ///< (contacts) [m]
};

/// Contacts of an outer step, and the contact problem of each of its sub-steps. One block of the problem a slab, and one more for pairs
/// of slabs that are no neighbours.
struct Assembly {
  PairList pairs;
  std::vector<SlabWalls> walls;  ///< (slabs)
  ContactProblem problem;
  std::vector<BodyVelocity> velocity;  ///< (balls, then one for the idle lanes of each block)
  std::vector<char> impacts;           ///< (blocks) whether some row is an impact with restitution
  std::vector<Packer> packers;         ///< (threads)

  std::size_t num_blocks() const { return pairs.num_slabs + 1; }
  bool any_impact() const;
};

/// Contact search, once for all sub-steps: sorts the balls, lists what may touch before the next one, packs it, and takes the impulses
/// out of the state.
/// @param inverse_mass  out: (balls) 0 for balls that never move [1/kg]
void find_contacts(const World& world, std::span<const Pose> poses, int threads, BallState& state,
                   std::vector<double>& inverse_mass, Assembly& assembly);

/// Velocities of the balls as the solver knows them.
void load_velocities(const Balls& balls, std::span<const double> inverse_mass, int threads, Assembly& assembly);

/// Rows of one time step from positions and loaded velocities at its beginning (gaps, normals, impact or not, warm start).
void make_rows(const World& world, const Balls& balls, std::span<const Pose> poses, int threads, Assembly& assembly);

/// Adds what the solver changed to the velocities that were loaded, and moves the balls.
void store_velocities(const Assembly& assembly, double time_step, int threads, Balls& balls);

/// Keeps the walls' impulses for the next time step.
void keep_wall_impulses(const World& world, std::span<const Pose> poses, int threads, Assembly& assembly);

/// Puts the impulses back into the state, for the next outer step.
void store_impulses(const Assembly& assembly, BallState& state);

}  // namespace drumsweep

/// From balls and wall to the contact problem of one time step and back: the only file that knows both contacts and
/// solver.
#pragma once

#include "core/contact/wall_contact.h"
#include "core/solver/contact_problem.h"
#include "core/state/drum_state.h"
#include "core/step/drum_model.h"

namespace drumsweep {

/// Triangles that one ball may touch before the next contact search.
struct NearWall {
  std::uint32_t ball;
  std::uint32_t begin, end;  ///< range in WallCandidates::triangles
};
struct WallCandidates {
  std::vector<NearWall> balls;
  std::vector<std::int32_t> triangles;
};

/// Lists, for every ball near the wall, the triangles within its reach: contact distance, margin, and what it can
/// travel relative to the wall in one outer step.
void find_wall_candidates(const DrumModel& model, const Balls& balls, const Pose& pose, WallCandidates& candidates);

/// Contact rows of one time step. Rows of pairs come first, in the order of the pair list, then those of the wall.
struct Assembly {
  ContactProblem problem;
  std::vector<Impulse> impulse;        ///< (rows)
  std::vector<BodyVelocity> velocity;  ///< (balls, then one piece of wall per wall row)
  std::vector<std::uint32_t> pair_of;  ///< (pair rows) index in state.pairs
  std::vector<WallImpulse> walls;      ///< (wall rows) direction in the frame of the drum
  std::vector<WallContact> contacts;   ///< scratch
};

/// Builds rows from positions and velocities at the beginning of the step (gaps, normals, impact or not, warm start).
void assemble_rows(const DrumModel& model, const DrumState& state, const WallCandidates& candidates, const Pose& pose,
                   Assembly& out);

/// Fills the ball part of `velocity` from the state's (already free-falling) velocities.
void load_velocities(const DrumModel& model, const Balls& balls, Assembly& assembly);

/// Adds what the solver changed to the state's velocities and keeps the impulses for the next warm start.
void store_result(const Pose& pose, const Assembly& assembly, DrumState& state);

}  // namespace drumsweep

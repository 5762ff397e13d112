/// What stays fixed during a run: study, world with the wall of one outlet design, belt. Built once, read by every step.
#pragma once

#include "core/geometry/drum_mesh.h"
#include "core/step/world.h"

namespace drumsweep {

/// Room: x along the belt, y across it from its edge (the drum's axis projected runs along y), z up. The axis passes
/// through (0, belt.outlet_begin, 0) where the outlet begins and falls with the inclination.
struct DrumModel {
  Study study;
  World world;             ///< its only wall is the drum with the outlet
  DrumSurface wall;        ///< what that wall was made from
  Eigen::Matrix3d tilt;    ///< body axes in the room at time 0
  double belt_height = 0;  ///< z of the belt plane [m]

  DrumModel(const Study& study, const OutletConfig& outlet);
  Pose pose(double time) const { return world.walls.front().motion.pose(time); }
  const TriangleMesh& mesh() const { return world.walls.front().mesh; }
  double seconds_per_turn() const;
};

/// Simulation time of a state.
inline double time_of(const DrumModel& model, std::int64_t num_steps) { return time_of(model.world, num_steps); }

/// Outer steps that make `turns`, rounded to the nearest.
std::int64_t steps_for_turns(const DrumModel& model, double turns);

}  // namespace drumsweep

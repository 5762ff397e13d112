/// What stays fixed during a run: study, wall of one outlet design, contact law, belt. Built once, read by every step.
#pragma once

#include <Eigen/Geometry>

#include "core/config/study.h"
#include "core/contact/contact_law.h"
#include "core/contact/pair_search.h"
#include "core/geometry/drum_mesh.h"
#include "core/geometry/wall_grid.h"

namespace drumsweep {

inline constexpr double gravity = 9.81;  ///< [m/s^2]

/// Drum frame at one instant: room = origin + rotation * body.
struct Pose {
  Eigen::Matrix3d rotation;
  Eigen::Vector3d origin;            ///< [m]
  Eigen::Vector3d angular_velocity;  ///< [rad/s]

  Eigen::Vector3d to_body(const Eigen::Vector3d& room) const { return rotation.transpose() * (room - origin); }
  Eigen::Vector3d wall_velocity(const Eigen::Vector3d& room) const { return angular_velocity.cross(room - origin); }
};

/// Room: x along the belt, y across it from its edge (the drum's axis projected runs along y), z up. The axis passes
/// through (0, belt.outlet_begin, 0) where the outlet begins and falls with the inclination.
struct DrumModel {
  Study study;
  DrumWall wall;
  WallGrid grid;
  std::vector<Eigen::Vector4f> bounds;  ///< sphere around each triangle: centre and radius, body frame [m]
  Eigen::Matrix3d tilt;                 ///< body axes in the room at time 0
  ContactLaw law;
  PairSearch search;
  double time_step = 0;       ///< of a sub-step [s]
  double largest_radius = 0;  ///< of any ball [m]
  double ball_mass = 0;       ///< [kg]
  double belt_height = 0;     ///< z of the belt plane [m]

  DrumModel(const Study& study, const OutletConfig& outlet);
  Pose pose(double time) const;
  double margin() const;  ///< speculative, [m]
  double seconds_per_turn() const;
  double inverse_mass(double radius) const;
};

/// Simulation time of a state: a product, not a sum, so it does not drift and needs no storage.
double time_of(const DrumModel& model, std::int64_t num_steps);

/// Outer steps that make `turns`, rounded to the nearest.
std::int64_t steps_for_turns(const DrumModel& model, double turns);

}  // namespace drumsweep

/// What stays fixed during a run of any scene: physics, walls and how they move, contact search. Built once, read by every step.
///
/// Room frame: z up where gravity is not tilted. A scene may be periodic along y; its walls then reach beyond both ends.
#pragma once

#include <Eigen/Geometry>
#include <limits>
#include <vector>

#include "core/config/study.h"
#include "core/contact/pair_search.h"
#include "core/contact/surface.h"
#include "core/geometry/triangle_mesh.h"
#include "core/geometry/wall_grid.h"

namespace drumsweep {

inline constexpr double gravity = 9.81;  ///< [m/s^2]

/// A wall's frame at one instant: room = origin + rotation * body.
struct Pose {
  Eigen::Matrix3d rotation;
  Eigen::Vector3d origin;            ///< [m]
  Eigen::Vector3d angular_velocity;  ///< [rad/s]
  Eigen::Vector3d velocity;          ///< of the origin; of a belt, of its surface [m/s]

  Eigen::Vector3d to_body(const Eigen::Vector3d& room) const { return rotation.transpose() * (room - origin); }
  Eigen::Vector3d wall_velocity(const Eigen::Vector3d& room) const {
    return angular_velocity.cross(room - origin) + velocity;
  }
};

/// How a wall moves: it turns about its own z axis, and travels between two instants.
struct Motion {
  Eigen::Matrix3d tilt = Eigen::Matrix3d::Identity();  ///< body axes in the room at time 0
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();    ///< [m]
  double angular_velocity = 0;                         ///< [rad/s]
  Eigen::Vector3d travel = Eigen::Vector3d::Zero();    ///< velocity between travel_from and travel_to [m/s]
  double travel_from = 0, travel_to = std::numeric_limits<double>::infinity();  ///< [s]
  Eigen::Vector3d belt = Eigen::Vector3d::Zero();  ///< velocity of a surface that slides in itself [m/s]

  Pose pose(double time) const;
};

/// A rigid wall.
struct Wall {
  TriangleMesh mesh;
  WallGrid grid;
  Motion motion;
  Surface surface;
  bool one_sided = true;  ///< balls whose exit is Exit::inside are kept in front of it
  double removed_at = std::numeric_limits<double>::infinity();  ///< from then on it is not there [s]
};

struct World {
  Physics physics;
  Eigen::Vector3d gravity_vector{0, 0, -gravity};  ///< [m/s^2]
  double period = 0;                               ///< along y, y in [0, period); 0: not periodic [m]
  Surface balls;                                   ///< between balls
  std::vector<Wall> walls;
  PairSearch search;
  double time_step = 0;            ///< of a sub-step [s]
  std::int64_t sub_steps = 1;      ///< per outer step
  double largest_radius = 0;       ///< of any ball [m]
  double mean_mass = 0;            ///< of a ball [kg]
  bool rotation_resisted = false;  ///< rolling or twisting resistance somewhere
  bool cohesive = false;

  /// @param typical_speed  of balls relative to each other and to walls, for the reach of the contact search: a matter of
  ///   speed alone as long as it is about right [m/s]
  World(const Physics& physics, double typical_speed);

  /// @param resolution  size of the mesh's triangles, for the search [m]
  Wall& add_wall(TriangleMesh mesh, double resolution, const Motion& motion, const Surface& surface);
  Wall& add_wall(TriangleMesh mesh, double resolution, const Motion& motion = {});

  /// Makes y periodic. @pre called before the first step
  void set_period(double length) { search.period = period = length; }

  /// Surface number of a contact row: 0 between balls, 1 + index of the wall.
  const Surface& surface(std::uint32_t number) const { return number == 0 ? balls : walls[number - 1].surface; }

  double margin() const;  ///< speculative, [m]
  double inverse_mass(double radius) const;
  double radius_of(std::uint32_t id) const;

  /// a - b by the shortest way.
  Eigen::Vector3d apart(const Eigen::Vector3d& a, const Eigen::Vector3d& b) const {
    Eigen::Vector3d d = a - b;
    if (period > 0) d[1] -= period * std::round(d[1] / period);
    return d;
  }

 private:
  void update_search();
  double typical_speed_;
};

/// The mesh in the room, without its borders.
TriangleMesh placed(const TriangleMesh& mesh, const Pose& pose);

/// Simulation time of a state: a product, not a sum, so it does not drift and needs no storage.
double time_of(const World& world, std::int64_t num_steps);

}  // namespace drumsweep

#include "core/step/world.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/effects/size_distribution.h"

namespace drumsweep {
namespace {

// Collisions change velocities within an outer step; in a flow rarely by more than this part of its typical speed.
constexpr double collision_change = 0.2;

/// Time for which two balls of effective mass m* touch when they meet at speed v without damping: 2.943 times the greatest
/// overlap (5 m* v^2 / (4 k))^(2/5) over v (Landau and Lifshitz, Theory of Elasticity, section 9).
double contact_time(double effective_mass, double stiffness, double speed) {
  return 2.943 * std::pow(1.25 * effective_mass * speed * speed / stiffness, 0.4) / speed;
}

}  // namespace

Pose Motion::pose(double time) const {
  const double angle = std::fmod(angular_velocity * time, 2 * std::numbers::pi);
  const double c = std::cos(angle), s = std::sin(angle);
  Eigen::Matrix3d turn;
  turn << c, -s, 0, s, c, 0, 0, 0, 1;
  const bool travelling = time >= travel_from && time < travel_to;
  const double travelled = std::max(0.0, std::min(time, travel_to) - travel_from);
  Eigen::Vector3d velocity = belt;
  if (travelling) velocity += travel;
  return {tilt * turn, origin + travelled * travel, tilt.col(2) * angular_velocity, velocity};
}

World::World(const Physics& p, double typical_speed) : physics(p), typical_speed_(typical_speed) {
  balls = ball_surface(p);
  largest_radius = drumsweep::largest_radius(p);
  mean_mass = mean_ball_mass(p);
  update_search();
}

Wall& World::add_wall(TriangleMesh mesh, double resolution, const Motion& motion) {
  return add_wall(std::move(mesh), resolution, motion, wall_surface(physics));
}

Wall& World::add_wall(TriangleMesh mesh, double resolution, const Motion& motion, const Surface& surface) {
  WallGrid grid(mesh, std::max(4 * resolution, physics.material.diameter_m),
                largest_radius + margin() + collision_change * typical_speed_ * physics.solver.outer_step_s);
  Wall& wall = walls.emplace_back(Wall{std::move(mesh), std::move(grid), motion, surface});
  update_search();
  return wall;
}

void World::update_search() {
  const auto any = [&](auto&& has) {
    return has(balls) || std::any_of(walls.begin(), walls.end(), [&](const Wall& w) { return has(w.surface); });
  };
  rotation_resisted = any([](const Surface& s) { return s.rolling > 0 || s.twisting > 0; });
  cohesive = any([](const Surface& s) { return s.cohesion.force > 0; });

  sub_steps = physics.solver.sub_steps;
  if (physics.step.method == "smooth") {
    // The shortest contact: of the smallest balls at the given speed.
    const double r = smallest_radius(physics), mass = 1 / inverse_mass(r), v = physics.step.contact_speed_m_s;
    double shortest = contact_time(0.5 * mass, balls.stiffness(0.5 * r), v);
    for (const Wall& w : walls) shortest = std::min(shortest, contact_time(mass, w.surface.stiffness(r), v));
    sub_steps =
        static_cast<std::int64_t>(std::ceil(physics.solver.outer_step_s / shortest * physics.step.steps_per_contact));
  }
  time_step = physics.solver.outer_step_s / static_cast<double>(sub_steps);

  // Within one time step nothing collides that does not as it flies.
  search.extra_speed = sub_steps > 1 ? collision_change * typical_speed_ : 0;
  search.horizon = physics.solver.outer_step_s;
  search.margin = margin();
  if (cohesive) search.margin = std::max(search.margin, physics.effects.cohesion_range_m);
  search.cell_size = 2 * largest_radius + search.margin + 0.8 * typical_speed_ * search.horizon;
  search.turns = rotation_resisted;
  // The smooth step lets every contact spring back within the outer step.
  search.rebounds = physics.step.method == "smooth" || any([](const Surface& s) { return s.restitution > 0; });
}

double World::margin() const {
  return physics.solver.speculative_margin * physics.material.diameter_m *
         (physics.effects.size_spread > 0 ? 2 * largest_radius / physics.material.diameter_m : 1);
}

double World::inverse_mass(double radius) const {
  return 1 / (physics.material.density_kg_m3 * 4 * std::numbers::pi / 3 * radius * radius * radius);
}

double World::radius_of(std::uint32_t id) const { return radius_of_ball(physics, id); }

TriangleMesh placed(const TriangleMesh& mesh, const Pose& pose) {
  TriangleMesh out{{}, mesh.triangles, {}};
  out.vertices.reserve(mesh.vertices.size());
  for (const Eigen::Vector3d& v : mesh.vertices) out.vertices.push_back(pose.origin + pose.rotation * v);
  return out;
}

double time_of(const World& world, std::int64_t num_steps) {
  return static_cast<double>(num_steps) * world.physics.solver.outer_step_s;
}

}  // namespace drumsweep

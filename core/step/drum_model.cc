#include "core/step/drum_model.h"

#include <cmath>
#include <numbers>

namespace drumsweep {
namespace {

// Collisions change velocities within an outer step; in a flow at drum speed rarely by more than this part of the
// wall's.
constexpr double collision_change = 0.2;

// Of the overlap of a ball at rest: a contact that carries 3 % of a ball's weight is still Hertz'.
constexpr double first_overlap_part = 0.1;

double wall_speed(const DrumConfig& drum) { return 0.5 * drum.diameter_m * drum.angular_velocity_rad_s; }

}  // namespace

DrumModel::DrumModel(const Study& s, const OutletConfig& outlet)
    : study(s),
      wall(build_drum_wall(s, outlet)),
      grid(wall.mesh, std::max(2 * s.drum.mesh_resolution_m, s.material.diameter_m),
           (0.5 + s.solver.speculative_margin) * s.material.diameter_m +
               collision_change * wall_speed(s.drum) * s.solver.outer_step_s) {
  study.outlet = outlet;
  const double incline = s.drum.inclination_deg * std::numbers::pi / 180, c = std::cos(incline), i = std::sin(incline);
  tilt.col(0) = Eigen::Vector3d(1, 0, 0);
  tilt.col(1) = Eigen::Vector3d(0, -i, -c);
  tilt.col(2) = Eigen::Vector3d(0, c, -i);
  law = {s.material.stiffness_N_m15, s.material.damping_s, s.solver.impact_speed_m_s, s.solver.stabilization_steps, 0};
  time_step = s.solver.outer_step_s / static_cast<double>(s.solver.sub_steps);
  largest_radius = 0.5 * s.material.diameter_m;
  ball_mass = s.material.density_kg_m3 * std::numbers::pi / 6 * std::pow(s.material.diameter_m, 3);
  law.first_overlap = first_overlap_part * std::pow(ball_mass * gravity / law.stiffness, 2.0 / 3);
  belt_height = -(outlet.length_m * i + 0.5 * s.drum.diameter_m * c) - s.belt.drop_height_m;

  search.extra_speed = collision_change * wall_speed(s.drum);
  search.horizon = s.solver.outer_step_s;
  search.margin = margin();
  search.cell_size = 2 * largest_radius + search.margin + 0.8 * wall_speed(s.drum) * search.horizon;

  bounds.reserve(wall.mesh.triangles.size());
  for (const auto& t : wall.mesh.triangles) {
    const Eigen::Vector3d &a = wall.mesh.vertices[static_cast<std::size_t>(t[0])],
                          &b = wall.mesh.vertices[static_cast<std::size_t>(t[1])],
                          &e = wall.mesh.vertices[static_cast<std::size_t>(t[2])];
    const Eigen::Vector3d centre = (a.cwiseMin(b).cwiseMin(e) + a.cwiseMax(b).cwiseMax(e)) / 2;
    const double radius =
        std::sqrt(std::max({(a - centre).squaredNorm(), (b - centre).squaredNorm(), (e - centre).squaredNorm()}));
    bounds.emplace_back(static_cast<float>(centre[0]), static_cast<float>(centre[1]), static_cast<float>(centre[2]),
                        static_cast<float>(radius * 1.001 + 1e-6));
  }
}

Pose DrumModel::pose(double time) const {
  const double angle = std::fmod(study.drum.angular_velocity_rad_s * time, 2 * std::numbers::pi);
  const double c = std::cos(angle), s = std::sin(angle);
  Eigen::Matrix3d turn;
  turn << c, -s, 0, s, c, 0, 0, 0, 1;
  return {tilt * turn, Eigen::Vector3d(0, study.belt.outlet_begin_m, 0),
          tilt.col(2) * study.drum.angular_velocity_rad_s};
}

double DrumModel::margin() const { return study.solver.speculative_margin * study.material.diameter_m; }

double DrumModel::seconds_per_turn() const { return 2 * std::numbers::pi / study.drum.angular_velocity_rad_s; }

double DrumModel::inverse_mass(double radius) const {
  return 1 / (study.material.density_kg_m3 * 4 * std::numbers::pi / 3 * radius * radius * radius);
}

double time_of(const DrumModel& model, std::int64_t num_steps) {
  return static_cast<double>(num_steps) * model.study.solver.outer_step_s;
}

std::int64_t steps_for_turns(const DrumModel& model, double turns) {
  return std::llround(turns * model.seconds_per_turn() / model.study.solver.outer_step_s);
}

}  // namespace drumsweep

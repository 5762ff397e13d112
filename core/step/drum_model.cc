#include "core/step/drum_model.h"

#include <cmath>
#include <numbers>

namespace drumsweep {

DrumModel::DrumModel(const Study& s, const OutletConfig& outlet)
    : study(s), world(s, 0.5 * s.drum.diameter_m * s.drum.angular_velocity_rad_s) {
  study.outlet = outlet;
  const double incline = s.drum.inclination_deg * std::numbers::pi / 180, c = std::cos(incline), i = std::sin(incline);
  tilt.col(0) = Eigen::Vector3d(1, 0, 0);
  tilt.col(1) = Eigen::Vector3d(0, -i, -c);
  tilt.col(2) = Eigen::Vector3d(0, c, -i);
  belt_height = -(outlet.length_m * i + 0.5 * s.drum.diameter_m * c) - s.belt.drop_height_m;

  world.search.slope = tilt(2, 2) / tilt(1, 2);

  DrumWall built = build_drum_wall(s, outlet);
  wall = built;
  Motion turning;
  turning.tilt = tilt;
  turning.origin = Eigen::Vector3d(0, s.belt.outlet_begin_m, 0);
  turning.angular_velocity = s.drum.angular_velocity_rad_s;
  world.add_wall(std::move(built.mesh), s.drum.mesh_resolution_m, turning);
}

double DrumModel::seconds_per_turn() const { return 2 * std::numbers::pi / study.drum.angular_velocity_rad_s; }

std::int64_t steps_for_turns(const DrumModel& model, double turns) {
  return std::llround(turns * model.seconds_per_turn() / model.study.solver.outer_step_s);
}

}  // namespace drumsweep

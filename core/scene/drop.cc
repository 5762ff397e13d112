#include "core/scene/drop.h"

#include <cmath>
#include <numbers>

#include "core/geometry/primitives.h"
#include "core/scene/scene_run.h"

namespace drumsweep {

void DropScene::add_fields(FieldTable& table) {
  table.number("speed_m_s", speed_m_s, 1e-3, 100, "of the ball at impact");
  table.number("angle_deg", angle_deg, 0, 89, "of its path, from the plate's normal");
  table.number("height_m", height_m, 0, 100, "of its lower side over the plate at the beginning");
  table.number("spin_rad_s", spin_rad_s, -1e5, 1e5, "before the impact; positive is backspin");
}

void DropScene::validate(const Physics& physics, const Where& where) const {
  refuse_effects(
      physics, where,
      {"effects.size_spread", "effects.outlet_coating_m", "effects.drum_coating_m", "effects.texture_height_scale"},
      "drop");
}

SceneResult DropScene::run(const Physics& physics, const SceneObserver& observer) const {
  World world(physics, speed_m_s);
  world.gravity_vector.setZero();
  const double angle = angle_deg * std::numbers::pi / 180, radius = 0.5 * physics.material.diameter_m;
  const double v_n = speed_m_s * std::cos(angle), v_t = speed_m_s * std::sin(angle);
  // Long enough for the approach and for leaving by as much, at the slowest rebound that counts.
  const double approach = height_m / v_n, end = 3 * approach + 200 * physics.solver.outer_step_s;
  const double reach = 2 * (speed_m_s * end + height_m + 10 * radius);
  TriangleMesh plate;
  add_plate(plate, {-reach, -reach, 0}, {2 * reach, 0, 0}, {0, 2 * reach, 0});
  world.add_wall(std::move(plate), 0.1 * reach);

  SceneRun run(std::move(world), observer, Eigen::Vector3d::Constant(-reach), Eigen::Vector3d::Constant(reach));
  run.threads = threads;
  run.add({-v_t * approach, 0, radius + height_m}, {v_t, 0, -v_n});
  run.state.balls.spin.back() = Eigen::Vector3d(0, -spin_rad_s, 0);
  run.run_until("falling", end);

  const Eigen::Vector3d v = run.state.balls.velocity.front(), w = run.state.balls.spin.front();
  SceneResult out = run.finish();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  out.observables = {observable("normal_restitution", v[2] / v_n, nan, "1"),
                     observable("tangential_restitution", v_t > 0 ? v[0] / v_t : nan, nan, "1"),
                     observable("spin", w[1], nan, "rad/s"),
                     observable("rebound_angle", std::atan2(v[0], v[2]) * 180 / std::numbers::pi, nan, "deg"),
                     observable("speed", v.norm(), nan, "m/s")};
  return out;
}

}  // namespace drumsweep

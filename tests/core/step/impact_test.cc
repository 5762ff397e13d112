#include <gtest/gtest.h>

#include "core/geometry/primitives.h"
#include "core/geometry/random.h"
#include "core/scene/drop.h"
#include "core/scene/scene_run.h"

namespace drumsweep {
namespace {

// A loose heap of springy balls falls into a narrow box: hundreds of collisions at once, with rebounds of a third of a diameter per
// step.
TEST(Impacts, of_a_falling_heap_never_raise_its_energy_nor_press_balls_into_each_other) {
  Physics p;
  p.material.diameter_m = 0.003;
  p.material.friction = 0.3;
  p.material.restitution = 0.97;
  p.material.wall_restitution = 0.85;
  p.material.youngs_modulus_Pa = 1e7;
  p.solver.outer_step_s = 0.002;
  p.solver.sub_steps = 1;
  p.solver.iterations = 40;
  World world(p, 0.4);
  world.add_wall(box_mesh({0, 0, 0}, {0.014, 0.014, 0.3}), 0.014);
  SceneRun run(std::move(world), {}, Eigen::Vector3d::Constant(-0.1), Eigen::Vector3d::Constant(1));
  const auto places = lattice({0, 0, 0.001}, {0.014, 0.014, 0.12}, 0.0015, 1);
  for (std::size_t i = 0; i < places.size(); ++i)
    if (uniform4(1, Purpose::fill, i, 3)[0] < 0.8) run.add(places[i]);
  const double mass = 1 / run.world.inverse_mass(0.0015);
  const auto energy = [&] {
    double sum = run.kinetic_energy();
    for (const Eigen::Vector3d& at : run.state.balls.position) sum += mass * gravity * at[2];
    return sum;
  };
  const double first = energy();
  double last = first, pressed = 0;
  const auto num = run.state.balls.size();
  while (run.time() < 0.2) {
    run.step("falling", 0.2);
    const double now = energy();
    EXPECT_LT(now, last + 0.003 * first) << run.time();
    last = now;
    pressed = std::max(pressed, run.last_report().max_overlap);
  }
  EXPECT_EQ(run.state.balls.size(), num);
  EXPECT_LT(last, 0.9 * first);
  EXPECT_LT(pressed, 0.2);
}

TEST(Impacts, rolling_resistance_brakes_spin_under_the_impulse_of_a_rebound) {
  // No friction, so only the torque impulse mu_r R m (1 + e) v_n changes the spin: by 5/2 mu_r (1 + e) v_n / R.
  Physics physics;
  physics.material.diameter_m = 0.01;
  physics.material.friction = 0;
  physics.effects.rolling_friction = 0.2;
  physics.solver.outer_step_s = 1e-3;
  physics.solver.sub_steps = 1;
  DropScene scene;
  scene.speed_m_s = 1;
  scene.height_m = 0.005;
  scene.spin_rad_s = -1000;
  for (const double e : {0.0, 0.5, 1.0}) {
    physics.material.restitution = e;
    const SceneResult r = scene.run(physics, {});
    EXPECT_NEAR(r.state.balls.spin.front()[1], 1000 - 2.5 * 0.2 * (1 + e) * 1 / 0.005, e == 0 ? 10 : 0.1) << e;
  }
}

}  // namespace
}  // namespace drumsweep

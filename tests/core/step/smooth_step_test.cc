#include "core/step/smooth_step.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/geometry/primitives.h"
#include "core/scene/scene_run.h"

namespace drumsweep {
namespace {

Physics smooth() {
  Physics p;
  p.step.method = "smooth";
  p.material.youngs_modulus_Pa = 1e6;
  p.material.friction = 0.5;
  p.material.restitution = 0.6;
  p.solver.outer_step_s = 0.002;
  p.step.steps_per_contact = 50;
  return p;
}

/// A ball on or above a plate at z = 0.
SceneRun on_plate(const Physics& physics, const Eigen::Vector3d& gravity_vector, double z, const Eigen::Vector3d& v) {
  World world(physics, 1);
  world.gravity_vector = gravity_vector;
  TriangleMesh plate;
  add_plate(plate, {-2, -2, 0}, {4, 0, 0}, {0, 4, 0});
  world.add_wall(std::move(plate), 0.5);
  SceneRun run(std::move(world), {}, Eigen::Vector3d::Constant(-3), Eigen::Vector3d::Constant(3));
  run.add({0, 0, z}, v);
  return run;
}

constexpr double ball_radius = 0.005;

TEST(SmoothStep, rebounds_with_the_restitution_that_was_asked_for_at_any_speed) {
  for (const double e : {0.2, 0.6, 0.95})
    for (const double speed : {0.1, 1.0}) {
      Physics p = smooth();
      p.step.steps_per_contact = 100;
      p.material.restitution = e;
      SceneRun run = on_plate(p, Eigen::Vector3d::Zero(), ball_radius + 1e-5, {0, 0, -speed});
      run.run_until("falling", 0.1);
      EXPECT_NEAR(run.state.balls.velocity[0][2] / speed, e, 0.01) << speed;
    }
}

TEST(SmoothStep, contact_lasts_as_long_as_hertz_says) {
  Physics p = smooth();
  p.material.restitution = 1;
  p.solver.outer_step_s = 1e-5;
  SceneRun run = on_plate(p, Eigen::Vector3d::Zero(), ball_radius, {0, 0, -1});
  int touching = 0;
  for (int i = 0; i < 2000; ++i) {
    run.step("falling", 1);
    touching += run.state.walls.empty() ? 0 : 1;
  }
  const double m = 1 / run.world.inverse_mass(ball_radius), k = run.world.walls[0].surface.stiffness(ball_radius);
  const double expected = 2.943 * std::pow(1.25 * m / k, 0.4);
  EXPECT_NEAR(touching * 1e-5, expected, 0.01 * expected);
  EXPECT_NEAR(run.state.balls.velocity[0][2], 1, 1e-3);
}

TEST(SmoothStep, resting_ball_sinks_by_the_hertz_overlap) {
  SceneRun run = on_plate(smooth(), {0, 0, -9.81}, ball_radius, Eigen::Vector3d::Zero());
  run.run_until("resting", 2);
  const double m = 1 / run.world.inverse_mass(ball_radius), k = run.world.walls[0].surface.stiffness(ball_radius);
  const double expected = std::pow(m * 9.81 / k, 2.0 / 3);
  EXPECT_NEAR(ball_radius - run.state.balls.position[0][2], expected, 1e-3 * expected);
}

TEST(SmoothStep, sliding_ball_ends_rolling_at_five_sevenths_and_rolling_friction_stops_it_at_its_rate) {
  Physics p = smooth();
  p.material.friction = 0.3;
  for (const double rolling : {0.0, 0.02}) {
    p.effects.rolling_friction = rolling;
    SceneRun run = on_plate(p, {0, 0, -9.81}, ball_radius, Eigen::Vector3d::Zero());
    run.run_until("resting", 1);
    run.state.balls.velocity[0] = {1, 0, 0};
    run.run_until("sliding", 1.3);
    const double v = run.state.balls.velocity[0][0];
    if (rolling == 0) {
      EXPECT_NEAR(v, 5.0 / 7, 2e-3);
    } else {
      run.run_until("rolling", 1.4);
      EXPECT_NEAR((v - run.state.balls.velocity[0][0]) / 0.1, 5.0 / 7 * rolling * 9.81,
                  0.02 * 5.0 / 7 * rolling * 9.81);
    }
  }
}

TEST(SmoothStep, holds_a_ball_on_an_incline_by_the_tangential_spring_and_rolling_resistance) {
  Physics p = smooth();
  p.effects.rolling_friction = 0.3;
  const double tan = 0.25, g = 9.81;
  SceneRun run = on_plate(p, Eigen::Vector3d(tan, 0, -1).normalized() * g, ball_radius, Eigen::Vector3d::Zero());
  run.run_until("settling", 1);
  const double x = run.state.balls.position[0][0];
  run.run_until("resting", 3);
  EXPECT_NEAR(run.state.balls.position[0][0], x, 1e-7);
  p.effects.rolling_friction = 0.2;
  SceneRun rolls = on_plate(p, Eigen::Vector3d(tan, 0, -1).normalized() * g, ball_radius, Eigen::Vector3d::Zero());
  rolls.run_until("rolling", 1);
  EXPECT_GT(rolls.state.balls.position[0][0], 0.05);
}

TEST(SmoothStep, isolated_collision_conserves_momentum_and_angular_momentum) {
  Physics p = smooth();
  p.effects.rolling_friction = 0.1;
  p.effects.twisting_friction = 0.1;
  World world(p, 1);
  world.gravity_vector.setZero();
  SceneRun run(std::move(world), {}, Eigen::Vector3d::Constant(-3), Eigen::Vector3d::Constant(3));
  run.add({0, 0, 0}, {0.5, 0.1, 0});
  run.add({0.011, 0.004, 0.001}, {-0.7, 0, 0.05});
  run.state.balls.spin[0] = {10, 50, -70};
  const auto momenta = [&] {
    Eigen::Matrix<double, 6, 1> sum = Eigen::Matrix<double, 6, 1>::Zero();
    const Balls& b = run.state.balls;
    for (std::size_t i = 0; i < b.size(); ++i) {
      const double m = 1 / run.world.inverse_mass(b.radius[i]);
      sum.head<3>() += m * b.velocity[i];
      sum.tail<3>() += m * b.position[i].cross(b.velocity[i]) + 0.4 * m * b.radius[i] * b.radius[i] * b.spin[i];
    }
    return sum;
  };
  const auto before = momenta();
  run.run_until("colliding", 0.1);
  EXPECT_GT(run.state.balls.velocity[0].norm(), 0);
  EXPECT_NEAR((momenta() - before).head<3>().norm(), 0, 1e-12);
  EXPECT_NEAR((momenta() - before).tail<3>().norm(), 0, 1e-9 * before.tail<3>().norm());
}

TEST(SmoothStep, agrees_with_the_nonsmooth_step_on_a_heap_at_rest) {
  // Weight of a small heap in a box on its floor.
  for (const char* method : {"smooth", "nonsmooth"}) {
    Physics p = smooth();
    p.step.method = method;
    p.step.steps_per_contact = 25;
    p.material.restitution = 0.2;
    p.solver.iterations = 30;
    World world(p, 0.5);
    world.add_wall(box_mesh({0, 0, 0}, {0.05, 0.05, 0.2}), 0.05);
    SceneRun run(std::move(world), {}, {-0.01, -0.01, -0.01}, {0.06, 0.06, 0.3});
    for (const Eigen::Vector3d& at : lattice({0, 0, 0}, {0.05, 0.05, 0.06}, ball_radius, 1)) run.add(at);
    run.run_until("settling", 0.8);
    double weight = 0;
    for (const double r : run.state.balls.radius) weight += 9.81 / run.world.inverse_mass(r);
    EXPECT_EQ(run.state.balls.size(), 80u) << method;
    EXPECT_NEAR(run.wall_force(0)[2] / weight, 1, 0.01) << method;
    EXPECT_LT(run.fastest(), 0.02) << method;
  }
}

}  // namespace
}  // namespace drumsweep

#include "core/step/stepper.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/effects/size_distribution.h"
#include "core/geometry/primitives.h"
#include "core/geometry/random.h"
#include "core/scene/scene_run.h"

namespace drumsweep {
namespace {

constexpr double radius = 0.005;

SceneRun empty_space(const Physics& physics, double period = 0) {
  World world(physics, 1);
  world.gravity_vector.setZero();
  if (period > 0) world.set_period(period);
  return {std::move(world), {}, Eigen::Vector3d::Constant(-5), Eigen::Vector3d::Constant(5)};
}

TEST(ImpactStage, a_ball_that_hits_two_touching_ones_obeys_newtons_law_for_all_contacts_at_once) {
  // u12+ = -e u12-, u23+ = 0: impulses 2/3 (1 + e) and 1/3 (1 + e) of m v.
  for (const double e : {0.2, 0.5, 1.0}) {
    Physics p;
    p.material.restitution = e;
    p.material.friction = 0;
    p.solver.outer_step_s = 1e-3;
    p.solver.sub_steps = 1;
    p.solver.iterations = 500;
    SceneRun run = empty_space(p);
    run.add({-0.012, 0, 0}, {1, 0, 0});
    run.add({0, 0, 0});
    run.add({2 * radius, 0, 0});
    run.run_until("flying", 0.02);
    std::vector<double> v(3);
    for (std::size_t i = 0; i < 3; ++i) v[run.state.balls.id[i]] = run.state.balls.velocity[i][0];
    EXPECT_NEAR(v[0], 1 - 2.0 / 3 * (1 + e), 1e-5);
    EXPECT_NEAR(v[1], 1.0 / 3 * (1 + e), 1e-5);
    EXPECT_NEAR(v[2], 1.0 / 3 * (1 + e), 1e-5);
  }
}

TEST(ImpactStage, restitution_does_not_depend_on_the_time_step) {
  for (const double h : {1e-4, 1e-3, 1e-2}) {
    Physics p;
    p.material.restitution = 0.7;
    p.solver.outer_step_s = h;
    p.solver.sub_steps = 1;
    SceneRun run = empty_space(p);
    run.add({-0.05, 0, 0}, {1.3, 0, 0});
    run.add({0.05, 0, 0}, {-0.7, 0, 0});
    run.run_until("flying", 0.2);
    const double apart = std::abs(run.state.balls.velocity[1][0] - run.state.balls.velocity[0][0]);
    EXPECT_NEAR(apart, 0.7 * 2, 1e-5) << h;
  }
}

TEST(Collision, conserves_momentum_and_angular_momentum_however_deep_or_early_the_contact) {
  // A coarse step: rows act across gaps of half a diameter.
  for (const double e : {0.0, 0.5}) {
    Physics p;
    p.material.restitution = e;
    p.effects.rolling_friction = 0.2;
    p.effects.twisting_friction = 0.1;
    p.solver.outer_step_s = 0.005;
    p.solver.sub_steps = 1;
    SceneRun run = empty_space(p);
    for (std::uint32_t i = 0; i < 30; ++i) {
      const auto r = uniform4(7, Purpose::fill, i);
      const Eigen::Vector3d at = 0.06 * Eigen::Vector3d(r[0], r[1], r[2]);
      bool free = true;
      for (const Eigen::Vector3d& q : run.state.balls.position) free = free && (q - at).norm() > 2 * radius;
      if (!free) continue;
      run.add(at, 10 * (Eigen::Vector3d::Constant(0.03) - at));
      run.state.balls.spin.back() = 50 * Eigen::Vector3d(r[3] - 0.5, r[0] - 0.5, r[1] - 0.5);
    }
    const auto momenta = [&](bool magnitude) {
      Eigen::Matrix<double, 6, 1> sum = Eigen::Matrix<double, 6, 1>::Zero();
      const Balls& b = run.state.balls;
      for (std::size_t i = 0; i < b.size(); ++i) {
        const double m = 1 / run.world.inverse_mass(radius);
        Eigen::Matrix<double, 6, 1> one;
        one << m * b.velocity[i], m * b.position[i].cross(b.velocity[i]) + 0.4 * m * radius * radius * b.spin[i];
        sum += magnitude ? one.cwiseAbs().eval() : one;
      }
      return sum;
    };
    const auto before = momenta(false), scale = momenta(true);
    std::size_t contacts = 0;
    for (int i = 0; i < 40; ++i) {
      run.step("colliding", 1);
      contacts += run.last_report().num_contacts;
    }
    if (e == 0) {
      EXPECT_GT(contacts, 10u);  // with restitution the impact stage does it all
    }
    // The solver works in single precision.
    for (int k = 0; k < 6; ++k) EXPECT_NEAR(momenta(false)[k], before[k], 2e-6 * scale[k]) << k;
  }
}

TEST(AutoIterations, go_on_until_the_residual_is_at_its_target) {
  Physics p;
  p.solver.iterations = 0;
  double last = 0;
  for (const double target : {1e-2, 1e-3, 1e-4}) {
    p.solver.residual_target_m_s = target;
    World world(p, 0.5);
    world.add_wall(box_mesh({0, 0, 0}, {0.06, 0.06, 0.2}), 0.06);
    SceneRun run(std::move(world), {}, Eigen::Vector3d::Constant(-0.1), Eigen::Vector3d::Constant(0.3));
    for (const Eigen::Vector3d& at : lattice({0, 0, 0}, {0.06, 0.06, 0.15}, radius, 1)) run.add(at);
    double iterations = 0;
    for (int i = 0; i < 60; ++i) {
      run.step("falling", 1);
      EXPECT_TRUE(run.last_report().residual.mean <= target || run.last_report().iterations >= 2000);
      iterations += run.last_report().iterations;
    }
    EXPECT_GT(iterations, last) << target;
    last = iterations;
  }
}

TEST(PeriodicWorld, is_the_same_wherever_its_boundary_lies) {
  // A cloud falls together in a cell; shifted by part of the period it must do the same.
  constexpr double period = 0.08;
  const auto run_shifted = [&](double shift) {
    Physics p;
    p.solver.iterations = 200;
    SceneRun run = empty_space(p, period);
    for (const Eigen::Vector3d& at : lattice({-0.03, 0, -0.03}, {0.03, period, 0.03}, radius, 5)) {
      const Eigen::Vector3d v(-5 * at[0], 0.3 * std::sin(2 * M_PI * at[1] / period), -5 * at[2]);
      run.add(at + Eigen::Vector3d(0, shift, 0), v);
    }
    std::size_t contacts = 0;
    run.run_until("falling together", 0.08, [&] {
      contacts += run.last_report().num_contacts;
      return false;
    });
    EXPECT_GT(contacts, 200u);
    std::vector<Eigen::Vector3d> by_id(run.state.balls.size());
    for (std::size_t i = 0; i < by_id.size(); ++i) {
      by_id[run.state.balls.id[i]] = run.state.balls.velocity[i];
      EXPECT_GE(run.state.balls.position[i][1], -0.01);
      EXPECT_LE(run.state.balls.position[i][1], period + 0.01);
    }
    return by_id;
  };
  const auto one = run_shifted(0), two = run_shifted(0.37 * period);
  double squares = 0, difference = 0;
  for (std::size_t i = 0; i < one.size(); ++i) {
    squares += one[i].squaredNorm();
    difference += (one[i] - two[i]).squaredNorm();
  }
  // Another order of visits, so equal as far as the solver has converged.
  EXPECT_LT(std::sqrt(difference / squares), 0.02);
}

TEST(FixedBalls, never_move_and_carry_what_lies_on_them) {
  Physics p;
  p.solver.iterations = 50;
  World world(p, 0.5);
  SceneRun run(std::move(world), {}, Eigen::Vector3d::Constant(-1), Eigen::Vector3d::Constant(1));
  for (int i = 0; i < 3; ++i)
    run.add_fixed(1.1 * radius * Eigen::Vector3d(std::cos(2.1 * i), std::sin(2.1 * i), 0), radius);
  run.add({0, 0, 3 * radius});
  run.run_until("resting", 1);
  ASSERT_EQ(run.state.balls.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) {
    if (run.state.balls.exit[i] == static_cast<std::uint8_t>(Exit::fixed))
      EXPECT_EQ(run.state.balls.position[i][2], 0);
    else
      EXPECT_NEAR(run.state.balls.position[i][2], radius * std::sqrt(4 - 1.21), 0.02 * radius);
  }
  EXPECT_LT(run.fastest(), 1e-3);
}

TEST(RemovedWall, lets_go_at_its_time) {
  Physics p;
  p.solver.outer_step_s = 0.004;
  World world(p, 0.5);
  TriangleMesh plate;
  add_plate(plate, {-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
  world.add_wall(std::move(plate), 0.5).removed_at = 0.5;
  SceneRun run(std::move(world), {}, Eigen::Vector3d::Constant(-5), Eigen::Vector3d::Constant(5));
  run.add({0, 0, radius});
  run.run_until("resting", 0.5);
  EXPECT_NEAR(run.state.balls.position[0][2], radius, 1e-4);
  run.run_until("falling", 0.7);
  EXPECT_NEAR(run.state.balls.position[0][2], radius - 0.5 * 9.81 * 0.04, 0.005);
}

TEST(Cohesion, holds_a_hanging_ball_below_its_pull_off_force_and_lets_it_fall_above) {
  for (const char* method : {"nonsmooth", "smooth"})
    for (const double part : {0.9, 1.1}) {
      Physics p;
      p.step.method = method;
      const double weight = mean_ball_mass(p) * gravity;
      p.effects.cohesion_force_N = weight / part;
      World world(p, 0.5);
      TriangleMesh ceiling;
      add_plate(ceiling, {-1, -1, 0}, {0, 2, 0}, {2, 0, 0});
      world.add_wall(std::move(ceiling), 0.5);
      SceneRun run(std::move(world), {}, Eigen::Vector3d::Constant(-5), Eigen::Vector3d::Constant(5));
      run.add({0, 0, -radius});
      run.run_until("hanging", 0.6);
      const double z = run.state.balls.position[0][2];
      if (part > 1) {
        EXPECT_LT(z, -0.1) << method;
      } else {
        // The overlap carries what the pull has beyond the weight.
        const double overlap = std::pow((p.effects.cohesion_force_N - weight) / 25000, 2.0 / 3);
        EXPECT_NEAR(z + radius, overlap, 2e-3 * overlap) << method;
      }
    }
}

TEST(AirDrag, gives_the_terminal_speed) {
  Physics p;
  p.effects.air_density_kg_m3 = 1.2;
  World world(p, 0.5);
  SceneRun run(std::move(world), {}, Eigen::Vector3d::Constant(-5e3), Eigen::Vector3d::Constant(5e3));
  run.add({0, 0, 0});
  run.run_until("falling", 40);
  const double expected = std::sqrt(8 * radius * 2500 * 9.81 / (3 * 1.2 * 0.44));
  EXPECT_NEAR(-run.state.balls.velocity[0][2], expected, 1e-3 * expected);
}

TEST(FrictionSpeed, slows_a_sliding_ball_by_the_friction_of_its_speed) {
  Physics p;
  p.material.friction = 0.5;
  p.effects.dynamic_friction = 0.1;
  p.effects.friction_speed_m_s = 0.05;
  p.solver.outer_step_s = 1e-3;
  p.solver.sub_steps = 1;
  World world(p, 0.5);
  TriangleMesh plate;
  add_plate(plate, {-5, -5, 0}, {10, 0, 0}, {0, 10, 0});
  world.add_wall(std::move(plate), 1);
  SceneRun run(std::move(world), {}, Eigen::Vector3d::Constant(-6), Eigen::Vector3d::Constant(6));
  run.add({0, 0, radius});
  run.run_until("resting", 0.5);
  run.state.balls.velocity[0] = {3, 0, 0};
  run.run_until("sliding", 0.7);
  // Far above v_c only mu_d acts.
  EXPECT_NEAR(run.state.balls.velocity[0][0], 3 - 0.1 * 9.81 * 0.2, 2e-3);
}

}  // namespace
}  // namespace drumsweep

#include "core/solver/projected_gauss_seidel.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/effects/rotation_resistance.h"
#include "core/geometry/random.h"
#include "core/solver/residual.h"
#include "oracle/dense_contact_solver.h"

namespace drumsweep {
namespace {

struct Case {
  std::vector<oracle::Sphere> spheres;
  std::vector<oracle::Contact> contacts;
  ContactProblem problem;
  std::vector<BodyVelocity> velocity;
};

/// A chain of spheres of different size on a moving floor, with regularized, rigid and speculative rows.
Case heap(std::uint64_t seed, double rolling = 0, double twisting = 0) {
  Case c;
  const auto draw = [&](std::uint32_t i, std::uint32_t k) {
    return uniform4(static_cast<std::int64_t>(seed), Purpose::fill, i, k);
  };
  const auto f = [](double x) { return static_cast<float>(x); };
  constexpr int num = 8;
  for (int i = 0; i < num; ++i) {
    const auto r = draw(static_cast<std::uint32_t>(i), 0), s = draw(static_cast<std::uint32_t>(i), 1);
    c.spheres.push_back({0.001 * (1 + r[0]), 0.004 + 0.002 * r[1], Eigen::Vector3d(r[2] - 0.5, r[3] - 0.5, -s[0]),
                         Eigen::Vector3d(s[1] - 0.5, s[2] - 0.5, s[3] - 0.5) * 100});
  }
  const auto add = [&](int a, int b, Eigen::Vector3d n, double bias, double sigma) {
    n.normalize();
    const double arm = 1 + 0.05 * bias / 0.02;  // pressed and open ones
    const Eigen::Vector3d wall_spin(0.5, 2, -1);
    c.contacts.push_back(
        {a, b, n, Eigen::Vector3d(0.3, -0.2, 0.05), bias, sigma, 0.5, rolling, twisting, wall_spin, arm});
    const auto& A = c.spheres[static_cast<std::size_t>(a)];
    const double w = 1 / A.mass + (b >= 0 ? 1 / c.spheres[static_cast<std::size_t>(b)].mass : 0.0);
    const auto body_b = b >= 0 ? static_cast<std::size_t>(b) : static_cast<std::size_t>(num) + c.contacts.size() - 1;
    c.problem.rows.push_back({Float4{f(n[0]), f(n[1]), f(n[2]), f(bias)}, f(sigma), f(1 / (w + sigma)),
                              f(1 / ((1 + 2.5 * arm * arm) * w)), 0.5f, static_cast<std::uint32_t>(a),
                              static_cast<std::uint32_t>(body_b), f(arm), 0});
    if (rolling == 0 && twisting == 0) return;
    const Eigen::Vector3d turn = b >= 0 ? Eigen::Vector3d(0, 0, 0) : Eigen::Vector3d(A.radius * wall_spin);
    c.problem.rotation.push_back(rotation_row(A.radius, b >= 0 ? c.spheres[static_cast<std::size_t>(b)].radius : 0,
                                              1 / A.mass, b >= 0 ? 1 / c.spheres[static_cast<std::size_t>(b)].mass : 0,
                                              rolling, twisting, Float4{f(turn[0]), f(turn[1]), f(turn[2]), 0}));
  };
  for (int i = 0; i < num; ++i) {
    const auto r = draw(static_cast<std::uint32_t>(i), 2);
    if (i + 1 < num)
      add(i + 1, i, Eigen::Vector3d(r[0] - 0.5, r[1] - 0.5, 0.7), i % 3 == 0 ? -0.02 : 0.01, i % 2 ? 50.0 : 0.0);
    if (i % 2 == 0) add(i, -1, Eigen::Vector3d(0.2 * r[2], 0.1, 1), 0.0, i % 4 ? 20.0 : 0.0);
  }
  for (const auto& s : c.spheres)
    c.velocity.push_back({Float4{f(s.velocity[0]), f(s.velocity[1]), f(s.velocity[2]), f(1 / s.mass)},
                          Float4{f(s.spin[0] * s.radius), f(s.spin[1] * s.radius), f(s.spin[2] * s.radius), 0}});
  // One piece of wall per contact, used by the wall contacts among them.
  for (std::size_t i = 0; i < c.contacts.size(); ++i) c.velocity.push_back({Float4{0.3f, -0.2f, 0.05f, 0}, Float4{}});
  return c;
}

TEST(ProjectedGaussSeidel, agrees_with_the_dense_oracle_when_both_have_converged) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Case c = heap(seed);
    const auto expected = oracle::solve(c.spheres, c.contacts, 20000);
    std::vector<Impulse> impulse(c.problem.rows.size(), Impulse{});
    solve(c.problem, 5000, impulse, {}, c.velocity);
    for (std::size_t i = 0; i < c.spheres.size(); ++i)
      for (int k = 0; k < 3; ++k) {
        EXPECT_NEAR(c.velocity[i].linear[k], c.spheres[i].velocity[k], 2e-5) << "seed " << seed;
        EXPECT_NEAR(c.velocity[i].surface[k], c.spheres[i].spin[k] * c.spheres[i].radius, 2e-5) << "seed " << seed;
      }
    EXPECT_LT(natural_map_residual(c.problem, impulse, {}, c.velocity).max, 1e-5);
  }
}

TEST(ProjectedGaussSeidel, one_iteration_equals_one_of_the_oracle) {
  // Same order of visits, so equality holds before convergence too; a missing factor 7/2 would show here.
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Case c = heap(seed);
    oracle::solve(c.spheres, c.contacts, 1);
    std::vector<Impulse> impulse(c.problem.rows.size(), Impulse{});
    solve(c.problem, 1, impulse, {}, c.velocity);
    for (std::size_t i = 0; i < c.spheres.size(); ++i)
      for (int k = 0; k < 3; ++k)
        EXPECT_NEAR(c.velocity[i].linear[k], c.spheres[i].velocity[k], 5e-6) << "seed " << seed;
  }
}

TEST(ProjectedGaussSeidel, rolling_and_twisting_resistance_agree_with_the_dense_oracle) {
  // Weak and strong resistance: some contacts roll, others are held.
  for (const double rolling : {0.02, 0.5})
    for (const double twisting : {0.0, 0.1})
      for (std::uint64_t seed = 1; seed <= 4; ++seed) {
        for (const int iterations : {1, 5000}) {
          Case c = heap(seed, rolling, twisting);
          oracle::solve(c.spheres, c.contacts, iterations == 1 ? 1 : 20000);
          std::vector<Impulse> impulse(c.problem.rows.size(), Impulse{});
          std::vector<TurnImpulse> turn(c.problem.rows.size(), TurnImpulse{});
          solve(c.problem, iterations, impulse, turn, c.velocity);
          for (std::size_t i = 0; i < c.spheres.size(); ++i)
            for (int k = 0; k < 3; ++k) {
              EXPECT_NEAR(c.velocity[i].linear[k], c.spheres[i].velocity[k], 3e-5) << seed << " " << iterations;
              EXPECT_NEAR(c.velocity[i].surface[k], c.spheres[i].spin[k] * c.spheres[i].radius, 3e-5)
                  << seed << " " << iterations;
            }
          if (iterations > 1) {
            EXPECT_LT(natural_map_residual(c.problem, impulse, turn, c.velocity).max, 2e-5);
            // A warm start from the solution stays there.
            Case again = heap(seed, rolling, twisting);
            apply_impulses(again.problem, impulse, turn, again.velocity);
            for (std::size_t i = 0; i < c.spheres.size(); ++i)
              for (int k = 0; k < 3; ++k)
                EXPECT_NEAR(again.velocity[i].surface[k], c.velocity[i].surface[k], 2e-4);  // rounding of 5000 sums
          }
        }
      }
}

TEST(ProjectedGaussSeidel, impulses_stay_in_the_friction_cone_and_momentum_is_conserved) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Case c = heap(seed);
    // Without the wall: an isolated cluster.
    std::erase_if(c.problem.rows, [&](const ContactRow& r) { return r.b >= c.spheres.size(); });
    Eigen::Vector3d before = Eigen::Vector3d::Zero(), after = before;
    const auto momentum = [&](Eigen::Vector3d& sum) {
      for (std::size_t i = 0; i < c.spheres.size(); ++i)
        for (int k = 0; k < 3; ++k) sum[k] += c.spheres[i].mass * static_cast<double>(c.velocity[i].linear[k]);
    };
    momentum(before);
    std::vector<Impulse> impulse(c.problem.rows.size(), Impulse{});
    solve(c.problem, 7, impulse, {}, c.velocity);
    momentum(after);
    EXPECT_LT((after - before).norm(), 1e-8);
    for (std::size_t i = 0; i < impulse.size(); ++i) {
      EXPECT_GE(impulse[i][3], 0);
      EXPECT_LE(std::hypot(impulse[i][0], impulse[i][1], impulse[i][2]), 0.5f * impulse[i][3] * 1.00001f);
    }
  }
}

TEST(ProjectedGaussSeidel, starting_from_the_solution_changes_nothing) {
  Case c = heap(5);
  std::vector<Impulse> impulse(c.problem.rows.size(), Impulse{});
  auto cold = c.velocity;
  solve(c.problem, 5000, impulse, {}, cold);
  auto warm = c.velocity;
  auto start = impulse;
  apply_impulses(c.problem, start, {}, warm);
  solve(c.problem, 1, start, {}, warm);
  for (std::size_t i = 0; i < c.spheres.size(); ++i)
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(warm[i].linear[k], cold[i].linear[k], 1e-5);
}

TEST(Residual, sees_a_velocity_that_no_longer_fits) {
  Case c = heap(2);
  std::vector<Impulse> impulse(c.problem.rows.size(), Impulse{});
  solve(c.problem, 5000, impulse, {}, c.velocity);
  const double good = natural_map_residual(c.problem, impulse, {}, c.velocity).max;
  c.velocity[0].linear[2] += 0.01f;
  EXPECT_GT(natural_map_residual(c.problem, impulse, {}, c.velocity).max, good + 1e-3);
}

}  // namespace
}  // namespace drumsweep

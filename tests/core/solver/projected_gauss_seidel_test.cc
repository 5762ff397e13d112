#include "core/solver/projected_gauss_seidel.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/geometry/random.h"
#include "core/solver/residual.h"
#include "oracle/dense_contact_solver.h"
#include "support/packed_problem.h"

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
  std::vector<PlainContact> plain;
  const auto add = [&](int a, int b, Eigen::Vector3d n, double bias, double sigma) {
    n.normalize();
    const double arm = 1 + 0.05 * bias / 0.02;  // pressed and open ones
    const Eigen::Vector3d wall_spin(0.5, 2, -1);
    c.contacts.push_back(
        {a, b, n, Eigen::Vector3d(0.3, -0.2, 0.05), bias, sigma, 0.5, rolling, twisting, wall_spin, arm});
    const double radius = c.spheres[static_cast<std::size_t>(a)].radius;
    plain.push_back({static_cast<std::uint32_t>(a), b, n, Eigen::Vector3d(0.3, -0.2, 0.05), bias, sigma, 0.5, arm,
                     rolling, twisting, radius * wall_spin});
  };
  for (int i = 0; i < num; ++i) {
    const auto r = draw(static_cast<std::uint32_t>(i), 2);
    if (i + 1 < num)
      add(i + 1, i, Eigen::Vector3d(r[0] - 0.5, r[1] - 0.5, 0.7), i % 3 == 0 ? -0.02 : 0.01, i % 2 ? 50.0 : 0.0);
    if (i % 2 == 0) add(i, -1, Eigen::Vector3d(0.2 * r[2], 0.1, 1), 0.0, i % 4 ? 20.0 : 0.0);
  }
  for (const auto& s : c.spheres)
    c.velocity.push_back({{f(s.velocity[0]), f(s.velocity[1]), f(s.velocity[2])},
                          f(1 / s.mass),
                          {f(s.spin[0] * s.radius), f(s.spin[1] * s.radius), f(s.spin[2] * s.radius)},
                          f(s.radius)});
  c.velocity.push_back({{0, 0, 0}, 0, {0, 0, 0}, 1});  // of idle lanes
  c.problem = one_by_one(plain, num, rolling > 0 || twisting > 0);
  return c;
}

TEST(ProjectedGaussSeidel, agrees_with_the_dense_oracle_when_both_have_converged) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Case c = heap(seed);
    const auto expected = oracle::solve(c.spheres, c.contacts, 20000);
    solve(c.problem, 5000, 1, c.velocity);
    for (std::size_t i = 0; i < c.spheres.size(); ++i)
      for (int k = 0; k < 3; ++k) {
        EXPECT_NEAR(c.velocity[i].linear[k], c.spheres[i].velocity[k], 2e-5) << "seed " << seed;
        EXPECT_NEAR(c.velocity[i].surface[k], c.spheres[i].spin[k] * c.spheres[i].radius, 2e-5) << "seed " << seed;
      }
    EXPECT_LT(natural_map_residual(c.problem, 1, c.velocity).max, 1e-5);
  }
}

TEST(ProjectedGaussSeidel, one_iteration_equals_one_of_the_oracle) {
  // Same order of visits, so equality holds before convergence too; a missing factor 7/2 would show here.
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Case c = heap(seed);
    oracle::solve(c.spheres, c.contacts, 1);
    solve(c.problem, 1, 1, c.velocity);
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
          solve(c.problem, iterations, 1, c.velocity);
          for (std::size_t i = 0; i < c.spheres.size(); ++i)
            for (int k = 0; k < 3; ++k) {
              EXPECT_NEAR(c.velocity[i].linear[k], c.spheres[i].velocity[k], 3e-5) << seed << " " << iterations;
              EXPECT_NEAR(c.velocity[i].surface[k], c.spheres[i].spin[k] * c.spheres[i].radius, 3e-5)
                  << seed << " " << iterations;
            }
          if (iterations > 1) {
            EXPECT_LT(natural_map_residual(c.problem, 1, c.velocity).max, 2e-5);
            // A warm start from the solution stays there.
            Case again = heap(seed, rolling, twisting);
            apply_impulses(c.problem, 1, again.velocity);
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
    for (ContactBlock& block : c.problem.blocks) block.walls.active.clear();
    Eigen::Vector3d before = Eigen::Vector3d::Zero(), after = before;
    const auto momentum = [&](Eigen::Vector3d& sum) {
      for (std::size_t i = 0; i < c.spheres.size(); ++i)
        for (int k = 0; k < 3; ++k) sum[k] += c.spheres[i].mass * static_cast<double>(c.velocity[i].linear[k]);
    };
    momentum(before);
    solve(c.problem, 7, 1, c.velocity);
    momentum(after);
    EXPECT_LT((after - before).norm(), 1e-8);
    for (std::size_t i = 0; i < c.problem.blocks.size(); ++i) {
      const ImpulsePack& p = impulse_of(c.problem, i);
      EXPECT_GE(p.normal[0], 0);
      EXPECT_LE(std::hypot(p.tangent[0][0], p.tangent[1][0], p.tangent[2][0]), 0.5f * p.normal[0] * 1.00001f);
    }
  }
}

TEST(ProjectedGaussSeidel, starting_from_the_solution_changes_nothing) {
  Case c = heap(5);
  auto cold = c.velocity;
  solve(c.problem, 5000, 1, cold);
  auto warm = c.velocity;
  apply_impulses(c.problem, 1, warm);
  solve(c.problem, 1, 1, warm);
  for (std::size_t i = 0; i < c.spheres.size(); ++i)
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(warm[i].linear[k], cold[i].linear[k], 1e-5);
}

TEST(ProjectedGaussSeidel, visits_slabs_in_a_wave_with_the_bits_of_the_phases) {
  // A row of balls pressed together, three to a slab, in more slabs than are kept in the cache.
  constexpr std::uint32_t slabs = 130, num = 3 * slabs;
  const auto problem = [&](bool as_slabs) {
    std::vector<PlainContact> contacts;
    for (std::uint32_t i = 0; i + 1 < num; ++i)
      contacts.push_back({i + 1, static_cast<int>(i), {0.1, 1, 0}, {0, 0, 0}, i % 5 == 0 ? 0.02 : 0.0, 10, 0.5});
    const ContactProblem single = one_by_one(contacts, num, false);
    ContactProblem out;
    out.blocks.resize(slabs + 1);
    out.phases.resize(3);
    for (std::uint32_t i = 0; i + 1 < num; ++i) {
      ContactPacks& packs = out.blocks[i / 3].pairs;
      packs.active.push_back(static_cast<std::uint32_t>(packs.rows.size()));
      packs.rows.push_back(single.blocks[i].pairs.rows[0]);
      packs.impulse.emplace_back();
    }
    for (std::uint32_t s = 0; s < slabs; ++s) out.phases[s % 2].push_back(s);
    out.phases[2].push_back(slabs);
    out.num_slabs = as_slabs ? slabs : 0;
    return out;
  };
  const auto solved = [&](bool as_slabs, int threads) {
    std::vector<BodyVelocity> v(num + 1, {{0, 0, 0}, 760, {0, 0, 0}, 0.005f});
    for (std::uint32_t i = 0; i < num; ++i) v[i].linear[1] = i % 2 == 0 ? 0.3f : -0.4f;
    v[num].inverse_mass = 0;
    ContactProblem p = problem(as_slabs);
    solve(p, 7, threads, v);
    return v;
  };
  const std::vector<BodyVelocity> phases = solved(false, 1);
  for (const int threads : {1, 3}) {
    const std::vector<BodyVelocity> wave = solved(true, threads);
    for (std::uint32_t i = 0; i < num; ++i)
      for (int k = 0; k < 3; ++k) {
        EXPECT_EQ(wave[i].linear[k], phases[i].linear[k]) << i;
        EXPECT_EQ(wave[i].surface[k], phases[i].surface[k]) << i;
      }
  }
}

TEST(Residual, sees_a_velocity_that_no_longer_fits) {
  Case c = heap(2);
  solve(c.problem, 5000, 1, c.velocity);
  const double good = natural_map_residual(c.problem, 1, c.velocity).max;
  c.velocity[0].linear[2] += 0.01f;
  EXPECT_GT(natural_map_residual(c.problem, 1, c.velocity).max, good + 1e-3);
}

}  // namespace
}  // namespace drumsweep

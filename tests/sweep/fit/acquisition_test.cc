#include "sweep/fit/acquisition.h"

#include <gtest/gtest.h>

#include <set>

#include "sweep/fit/optimum.h"
#include "tests/sweep/fit/synthetic.h"

namespace drumsweep {
namespace {

TEST(ExpectedDrop, equals_the_mean_over_many_draws_and_two_lines_have_a_closed_form) {
  // E[min(0, a + bZ)] = a Phi(-a/b) - b phi(a/b).
  EXPECT_NEAR(expected_drop(Eigen::Vector2d(0, 1), Eigen::Vector2d(0, 1)), -0.0833154705876864, 1e-12);
  EXPECT_EQ(expected_drop(Eigen::Vector2d(0, 1), Eigen::Vector2d(2, 2)), 0);
  for (std::int64_t seed = 1; seed <= 5; ++seed) {
    Eigen::VectorXd a(20), b(20);
    for (Eigen::Index i = 0; i < 20; ++i) {
      a[i] = std::abs(normal(seed, static_cast<std::uint64_t>(i)));
      b[i] = normal(seed, static_cast<std::uint64_t>(i), 1);
    }
    double mean = 0;
    constexpr int num = 4000;  // strata of equal probability by bisection of the normal integral
    for (int k = 0; k < num; ++k) {
      double low = -9, high = 9;
      for (int step = 0; step < 50; ++step) {
        const double z = 0.5 * (low + high);
        (0.5 * std::erfc(-z / std::sqrt(2.0)) < (k + 0.5) / num ? low : high) = z;
      }
      mean += (a + low * b).minCoeff() / num;
    }
    EXPECT_NEAR(expected_drop(a, b), mean - a.minCoeff(), 2e-3);
  }
}

TEST(NextBatch, runs_are_lattice_points_inside_none_known_none_twice_and_repeatable) {
  Laboratory lab;
  lab.truth = Valley(2);
  const std::vector<Measurement> rows = lab.measure(space_filling(lab.box, 12, 2));
  const FittedSurface fit(lab.box, rows);
  const auto allowed = [](const Point& at) { return at[0] > 1; };
  const Batch batch = next_batch(fit, 8, 3, {}, allowed), again = next_batch(fit, 8, 3, {}, allowed);
  ASSERT_EQ(batch.runs.size(), 8u);
  std::set<std::pair<Point, double>> seen;
  for (const Measurement& row : rows) seen.insert({row.at, row.replicate});
  for (std::size_t i = 0; i < batch.runs.size(); ++i) {
    const Proposal& run = batch.runs[i];
    EXPECT_EQ(run.at, quantised(lab.box, run.at));
    EXPECT_TRUE(allowed(run.at));
    EXPECT_TRUE(seen.insert({run.at, run.replicate}).second);
    EXPECT_GE(run.gain_m, 0);
    EXPECT_EQ(run.at, again.runs[i].at);
    EXPECT_EQ(run.replicate, again.runs[i].replicate);
  }
  EXPECT_FALSE(batch.reason.empty());
}

TEST(NextBatch, a_surface_known_from_one_replicate_is_measured_in_others_too) {
  int others = 0;
  for (std::int64_t seed = 1; seed <= 5; ++seed) {
    Laboratory lab;
    lab.truth = Valley(seed);
    const Batch batch = next_batch(FittedSurface(lab.box, lab.measure(space_filling(lab.box, 30, seed))), 6, 1);
    for (const Proposal& run : batch.runs) others += run.replicate > 0;
  }
  EXPECT_GE(others, 15) << "of 30";
}

TEST(NextBatch, the_gain_falls_as_runs_are_added_and_the_optimum_is_approached) {
  double first = 0, last = 0, regret_before = 0, regret_after = 0;
  constexpr int num_seeds = 6;
  for (std::int64_t seed = 1; seed <= num_seeds; ++seed) {
    Laboratory lab;
    const Valley valley(seed);
    lab.truth = valley;
    lab.seed = seed;
    const double lowest = valley({valley.at[0], valley.at[1]});
    std::vector<Measurement> rows = lab.measure(space_filling(lab.box, 10, seed));
    regret_before += valley(to_unit(lab.box, optimum(FittedSurface(lab.box, rows), seed).at)) - lowest;
    for (int round = 0; round < 5; ++round) {
      const Batch batch = next_batch(FittedSurface(lab.box, rows), 6, seed, {90, 6});
      (round == 0 ? first : last) = batch.batch_gain_m;
      for (const Proposal& run : batch.runs) rows.push_back(lab.measure(run.at, run.replicate));
    }
    EXPECT_LT(last, 0.6 * first) << seed;
    regret_after += valley(to_unit(lab.box, optimum(FittedSurface(lab.box, rows), seed).at)) - lowest;
  }
  EXPECT_LT(regret_after, 0.4 * regret_before);
  EXPECT_LT(regret_after / num_seeds, 0.0002);  // a third of the sigma of one run
}

}  // namespace
}  // namespace drumsweep

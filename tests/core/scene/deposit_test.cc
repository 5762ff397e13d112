#include "core/scene/deposit.h"

#include <gtest/gtest.h>

#include <numbers>

namespace drumsweep {
namespace {

Balls some(const std::vector<Eigen::Vector3d>& at, double radius) {
  Balls out;
  for (std::size_t i = 0; i < at.size(); ++i) out.add(at[i], radius, static_cast<std::uint32_t>(i));
  return out;
}

TEST(Deposit, packing_of_a_cubic_lattice_is_pi_sixths) {
  std::vector<Eigen::Vector3d> at;
  for (int i = -1; i < 6; ++i)
    for (int j = 0; j < 5; ++j)
      for (int k = -1; k < 6; ++k) at.emplace_back(i + 0.5, j + 0.5, k + 0.5);
  // Periodic along y; parts are halves of x.
  const Estimate got = packing_fraction(
      some(at, 0.5), {0, 0, 0}, {5, 5, 5}, 5, [](const Eigen::Vector3d&) { return true; },
      [](const Eigen::Vector3d& p) { return p[0] < 2.5 ? std::size_t{0} : std::size_t{1}; }, 2);
  EXPECT_NEAR(got.mean, std::numbers::pi / 6, 0.01);
  EXPECT_LT(got.sigma, 0.01);
}

TEST(Deposit, surface_shows_the_highest_point_of_any_ball_and_the_floor) {
  const Balls balls = some({{0, 0.1, 1}, {0, 0.1, 3}}, 0.5);
  const HeightMap map = surface_from_above(balls, -1, 1, 0, 2, 0.1, -7, 2, [](std::size_t) { return true; });
  ASSERT_EQ(map.nx, 20);
  ASSERT_EQ(map.ny, 20);
  EXPECT_NEAR(map.at(10, 1), 3.5, 0.02);
  EXPECT_NEAR(map.at(10, 18), 3 + std::sqrt(0.25 - 0.05 * 0.05 - 0.25 * 0.25), 1e-9) << "through the period";
  EXPECT_EQ(map.at(0, 10), -7);
}

TEST(Deposit, chain_of_small_gaps_joins_and_a_larger_gap_cuts) {
  const Balls balls = some({{0, 0, 0}, {1.1, 0, 0}, {2.2, 0, 0}, {3.5, 0, 0}, {0, 9.0, 0}}, 0.5);
  const std::vector<char> joined =
      connected(balls, 10, 0.2, [&](std::size_t i) { return balls.position[i].norm() < 0.1; });
  EXPECT_EQ(joined, (std::vector<char>{1, 1, 1, 0, 1})) << "the last across the period";
}

TEST(Deposit, line_goes_through_points_of_a_line) {
  const Line line = fit_line({1, 2, 4}, {5, 3, -1});
  EXPECT_NEAR(line.slope, -2, 1e-12);
  EXPECT_NEAR(line.offset, 7, 1e-12);
}

TEST(Deposit, loose_lattice_of_the_computed_height_holds_the_balls_and_none_overlap) {
  const Eigen::Vector3d low(0, 0, 0), high(0.1, 0.07, 0);
  const double height = loose_height(500, low, high, 0.005);
  const std::vector<Eigen::Vector3d> at = loose_lattice(low, {0.1, 0.07, height}, 0.005, 3);
  EXPECT_GE(at.size(), 500u);
  double nearest = 1;
  for (std::size_t i = 0; i < at.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) nearest = std::min(nearest, (at[i] - at[j]).norm());
  EXPECT_GE(nearest, 0.01);
}

}  // namespace
}  // namespace drumsweep

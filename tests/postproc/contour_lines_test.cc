#include "postproc/contour_lines.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace drumsweep {
namespace {

GridSurface sampled(double x0, double x1, int nx, double y0, double y1, int ny, double (*f)(double, double)) {
  std::vector<PlaneSample> samples;
  for (int j = 0; j < ny; ++j) {
    for (int i = 0; i < nx; ++i) {
      const double x = x0 + (x1 - x0) * i / (nx - 1), y = y0 + (y1 - y0) * j / (ny - 1);
      samples.push_back({{x, y}, f(x, y)});
    }
  }
  return grid_surface(samples);
}

double bilinear(double x, double y) { return 1.0 + 2.0 * x - y + 3.0 * x * y; }
double cone(double x, double y) { return std::hypot(x, y); }

TEST(GridSurface, reproduces_a_bilinear_function_exactly_and_ends_at_the_samples) {
  const GridSurface surface = sampled(0, 1, 3, -1, 1, 4, bilinear);
  for (double x : {0.0, 0.3, 0.5, 1.0})
    for (double y : {-1.0, 0.123, 1.0}) EXPECT_NEAR(surface.at(x, y), bilinear(x, y), 1e-13);
  EXPECT_TRUE(std::isnan(surface.at(1.01, 0.0)));
  EXPECT_TRUE(std::isnan(surface.at(0.5, -1.01)));
}

TEST(GridSurface, missing_corner_leaves_the_triangle_of_the_other_three) {
  for (int missing = 0; missing < 4; ++missing) {
    std::vector<PlaneSample> samples;
    for (int k = 0; k < 4; ++k) {
      const double x = k % 2, y = k / 2;
      samples.push_back({{x, y}, k == missing ? std::nan("") : 5.0 + 2.0 * x - 3.0 * y});
    }
    const GridSurface surface = grid_surface(samples);
    EXPECT_TRUE(surface.has_area());
    // A point beside the missing corner and its mirror image.
    const double x = missing % 2 == 0 ? 0.2 : 0.8, y = missing / 2 == 0 ? 0.3 : 0.7;
    EXPECT_TRUE(std::isnan(surface.at(x, y))) << missing;
    EXPECT_NEAR(surface.at(1 - x, 1 - y), 5.0 + 2.0 * (1 - x) - 3.0 * (1 - y), 1e-13) << missing;
  }
}

TEST(GridSurface, line_of_samples_has_no_area) {
  EXPECT_FALSE(grid_surface(std::vector<PlaneSample>{{{0, 0}, 1}, {{1, 0}, 1}, {{2, 0}, 1}}).has_area());
  EXPECT_FALSE(grid_surface(std::vector<PlaneSample>{{{0, 0}, 1}, {{1, 1}, 1}, {{2, 2}, 1}}).has_area());
}

TEST(GridSurface, values_that_differ_by_rounding_are_one_line_of_the_grid) {
  EXPECT_EQ(distinct_values({0.3, 0.1 + 0.2, 0.0, 1.0}).size(), 3U);
}

TEST(LevelLines, circle_of_a_cone_is_one_closed_line_at_the_right_radius) {
  const std::vector<GridSurface> surfaces = {sampled(-1, 1, 41, -1, 1, 41, cone)};
  const auto lines = level_lines(rasterize(surfaces, 201), 0.5);
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_EQ(lines[0].front().x, lines[0].back().x);
  double length = 0.0;
  for (std::size_t k = 0; k < lines[0].size(); ++k) {
    EXPECT_NEAR(cone(lines[0][k].x, lines[0][k].y), 0.5, 0.002);
    if (k > 0) length += std::hypot(lines[0][k].x - lines[0][k - 1].x, lines[0][k].y - lines[0][k - 1].y);
  }
  EXPECT_NEAR(length, std::numbers::pi, 0.01);
}

TEST(LevelLines, saddle_gives_two_lines_that_do_not_touch) {
  const std::vector<GridSurface> surfaces = {sampled(-1, 1, 2, -1, 1, 2, [](double x, double y) { return x * y; })};
  EXPECT_EQ(level_lines(rasterize(surfaces, 52), 0.1).size(), 2U);
  EXPECT_EQ(level_lines(rasterize(surfaces, 52), -0.1).size(), 2U);
}

TEST(LevelLines, finer_surface_covers_the_coarser_one) {
  const std::vector<GridSurface> surfaces = {sampled(0, 1, 2, 0, 1, 2, [](double x, double) { return x; }),
                                             sampled(0.25, 0.75, 3, 0.25, 0.75, 3, [](double, double) { return 9.0; })};
  const Raster raster = rasterize(surfaces, 101);
  EXPECT_EQ(raster.value[50 * 101 + 50], 9.0);
  EXPECT_NEAR(raster.value[10 * 101 + 50], 0.5, 1e-12);
  // The line x = 0.5 is cut in two by the plateau, and no line follows the jump around it.
  const auto lines = level_lines(raster, 0.5);
  ASSERT_EQ(lines.size(), 2U);
  for (const auto& line : lines)
    for (const PlanePoint& point : line) EXPECT_NEAR(point.x, 0.5, 1e-9);
}

}  // namespace
}  // namespace drumsweep

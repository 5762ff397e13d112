#include "postproc/plane_geometry.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace drumsweep {
namespace {

const Polygon unit_square = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};

std::vector<PlanePoint> random_points(std::size_t count, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> place(0.0, 1.0);
  std::vector<PlanePoint> points;
  for (std::size_t i = 0; i < count; ++i) points.push_back({place(random), place(random)});
  return points;
}

double length(const Segment& s) { return std::hypot(s.second.x - s.first.x, s.second.y - s.first.y); }

TEST(ConvexHull, of_a_grid_has_its_corners_only) {
  std::vector<PlanePoint> points;
  for (const double x : {0.0, 0.5, 1.0})
    for (const double y : {0.0, 0.5, 1.0}) points.push_back({x, y});
  const Polygon hull = convex_hull(points);
  EXPECT_EQ(hull.size(), 4u);
  EXPECT_DOUBLE_EQ(area(hull), 1.0);
}

TEST(ConvexHull, holds_all_points_and_its_corners_are_points) {
  const std::vector<PlanePoint> points = random_points(200, 1);
  const Polygon hull = convex_hull(points);
  for (const PlanePoint& p : points) EXPECT_TRUE(inside(hull, p));
  for (const PlanePoint& corner : hull)
    EXPECT_TRUE(
        std::any_of(points.begin(), points.end(), [&](PlanePoint p) { return p.x == corner.x && p.y == corner.y; }));
  EXPECT_FALSE(inside(hull, {1.5, 0.5}));
}

TEST(ConvexHull, of_points_on_a_line_is_the_line) {
  const Polygon line = convex_hull({{0, 0}, {1, 2}, {0.5, 1}, {0, 0}});
  ASSERT_EQ(line.size(), 2u);
  EXPECT_TRUE(inside(line, {0.25, 0.5}));
  EXPECT_FALSE(inside(line, {0.25, 0.6}));
  EXPECT_FALSE(inside(line, {2, 4}));
  EXPECT_TRUE(convex_hull({}).empty());
}

TEST(Clipped, keeps_the_side_that_is_asked_for) {
  EXPECT_DOUBLE_EQ(area(clipped(unit_square, 1, 0, 0.25)), 0.25);
  EXPECT_DOUBLE_EQ(area(clipped(unit_square, 1, 1, 1)), 0.5);
  EXPECT_DOUBLE_EQ(area(clipped(unit_square, 1, 0, 2)), 1.0);
  EXPECT_TRUE(clipped(unit_square, 1, 0, -1).empty());
}

TEST(NearestRegion, cells_of_all_sites_tile_the_square_and_each_point_lies_in_that_of_its_nearest_site) {
  std::vector<PlaneSite> sites;
  for (const PlanePoint& p : random_points(30, 2)) sites.push_back({p, 0.0});
  // Some lie off the plane; one so far that it has no part in it.
  sites[3].off_plane_squared = 0.01;
  sites[4].off_plane_squared = 9.0;
  std::vector<Polygon> cells;
  double sum = 0;
  for (std::size_t i = 0; i < sites.size(); ++i) {
    cells.push_back(nearest_region(sites, i, unit_square));
    sum += area(cells.back());
  }
  EXPECT_NEAR(sum, 1.0, 1e-12);
  EXPECT_LT(area(cells[4]), 1e-12);
  for (const PlanePoint& p : random_points(300, 3)) EXPECT_TRUE(inside(cells[nearest_site(sites, p)], p));
}

TEST(NearestRegion, of_a_node_of_a_grid_is_half_way_to_its_neighbours_whatever_the_rounding) {
  // Coordinates whose squares round.
  std::vector<PlaneSite> sites;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) sites.push_back({{i * 0.2, j * 0.2}, 0.0});
  for (std::size_t i = 0; i < sites.size(); ++i) {
    const PlanePoint at = sites[i].at;
    const double wide = at.x > 0.1 && at.x < 0.9 ? 0.2 : 0.1, tall = at.y > 0.1 && at.y < 0.9 ? 0.2 : 0.1;
    EXPECT_NEAR(area(nearest_region(sites, i, unit_square)), wide * tall, 1e-12) << i;
  }
}

TEST(Hatching, length_of_the_lines_is_area_over_spacing) {
  double sum = 0;
  for (const Segment& line : hatching(std::vector<Polygon>{unit_square}, 0.001)) sum += length(line);
  EXPECT_NEAR(sum * 0.001, 1.0, 1e-3);
}

TEST(Hatching, neighbours_share_lines_and_an_overlap_is_hatched_once) {
  const Polygon left = {{0, 0}, {0.5, 0}, {0.5, 1}, {0, 1}}, right = {{0.5, 0}, {1, 0}, {1, 1}, {0.5, 1}};
  const std::vector<Segment> whole = hatching(std::vector<Polygon>{unit_square}, 0.03);
  for (const auto& parts : {std::vector<Polygon>{left, right}, {left, right, unit_square}}) {
    const std::vector<Segment> lines = hatching(parts, 0.03);
    ASSERT_EQ(lines.size(), whole.size());
    for (std::size_t k = 0; k < lines.size(); ++k) EXPECT_NEAR(length(lines[k]), length(whole[k]), 1e-9);
  }
  for (const Segment& line : whole) {
    EXPECT_TRUE(inside(unit_square, line.first));
    EXPECT_NEAR(line.second.y - line.first.y, line.second.x - line.first.x, 1e-12) << "45 degrees";
  }
}

TEST(HullOfMost, leaves_the_outliers_out_and_holds_the_share) {
  std::vector<PlanePoint> points;
  for (int i = 0; i < 95; ++i) points.push_back({0.5 + 0.1 * std::cos(i), 0.5 + 0.02 * std::sin(i)});
  for (int i = 0; i < 5; ++i) points.push_back({0.5, 0.9 + 0.01 * i});
  const Polygon hull = hull_of_most(points, 0.95);
  const auto held = std::count_if(points.begin(), points.end(), [&](PlanePoint p) { return inside(hull, p); });
  EXPECT_EQ(held, 95);
  for (const PlanePoint& corner : hull) EXPECT_LT(corner.y, 0.6);
}

TEST(HullOfMost, of_draws_on_an_edge_of_the_box_is_a_line) {
  std::vector<PlanePoint> points;
  for (int i = 0; i <= 100; ++i) points.push_back({0.0, 0.01 * i});
  const Polygon hull = hull_of_most(points, 0.95);
  ASSERT_EQ(hull.size(), 2u);
  EXPECT_NEAR(hull[1].y - hull[0].y, 0.95, 0.011);
}

TEST(CutOfHull, of_a_cube_and_of_a_pyramid) {
  std::vector<std::vector<double>> cube;
  for (const double x : {0.0, 1.0})
    for (const double y : {0.0, 1.0})
      for (const double z : {0.0, 1.0}) cube.push_back({x, y, z});
  const double free = std::nan("");
  const auto area_at = [&](std::vector<std::vector<double>> points, double z) {
    std::vector<PlanePoint> plane;
    for (const auto& p : cut_of_hull(std::move(points), {free, free, z})) plane.push_back({p[0], p[1]});
    return area(convex_hull(std::move(plane)));
  };
  EXPECT_NEAR(area_at(cube, 0.3), 1.0, 1e-12);
  EXPECT_NEAR(area_at(cube, 1.0), 1.0, 1e-12);
  EXPECT_EQ(area_at(cube, 1.1), 0.0);
  const std::vector<std::vector<double>> pyramid = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0.5, 1}};
  EXPECT_NEAR(area_at(pyramid, 0.5), 0.25, 1e-12);
}

TEST(CutOfHull, of_many_points_stays_inside) {
  std::mt19937_64 random(4);
  std::normal_distribution<double> normal;
  std::vector<std::vector<double>> ball;
  for (int i = 0; i < 2000; ++i) {
    const double x = normal(random), y = normal(random), z = normal(random), r = std::sqrt(x * x + y * y + z * z);
    ball.push_back({x / r, y / r, z / r});
  }
  std::vector<PlanePoint> plane;
  for (const auto& p : cut_of_hull(ball, {std::nan(""), std::nan(""), 0.6})) plane.push_back({p[0], p[1]});
  for (const PlanePoint& p : plane) EXPECT_LE(std::hypot(p.x, p.y), 0.8 + 1e-9);
  EXPECT_GT(area(convex_hull(plane)), 0.9 * M_PI * 0.64);
}

}  // namespace
}  // namespace drumsweep

#include "sweep/fit/box.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "core/config/schema.h"
#include "sweep/plan/designs.h"

namespace drumsweep {
namespace {

const Box lattice_box = {{"a_deg", 0, 0.65, 0.1}, {"b_m", 0.02, 0.065, 0.0005}};

RC_GTEST_PROP(Box, quantised_points_are_lattice_points_inside_and_stay_where_they_are, (double u, double v)) {
  const Point at = quantised(lattice_box, {std::fmod(u, 2.0), std::fmod(v, 0.2)});
  for (std::size_t i = 0; i < 2; ++i) {
    const std::vector<double> values = lattice_values(lattice_box[i]);
    RC_ASSERT(std::find(values.begin(), values.end(), at[i]) != values.end());
    RC_ASSERT(at[i] >= lattice_box[i].low && at[i] <= lattice_box[i].high && at[i] == rounded(at[i]));
  }
  RC_ASSERT(quantised(lattice_box, at) == at);
}

TEST(Box, the_upper_end_is_allowed_although_no_step_leads_there) {
  EXPECT_EQ(quantised(lattice_box, {0.64, 0.04})[0], 0.65);
  EXPECT_EQ(quantised(lattice_box, {0.62, 0.04})[0], 0.6);
  EXPECT_EQ(quantised(lattice_box, {7, 9}), (Point{0.65, 0.065}));
  EXPECT_EQ(quantised(lattice_box, {0.31, 0.04026}), (Point{0.3, 0.0405}));  // the decimal numbers themselves
  EXPECT_EQ(lattice_values(lattice_box[0]), (std::vector<double>{0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.65}));
  EXPECT_EQ(lattice_size(lattice_box, 100000), whole_lattice(lattice_box).size());
  EXPECT_EQ(whole_lattice(lattice_box).size(), 8u * 91u);
}

TEST(Box, a_box_without_room_is_refused_by_name) {
  for (const DesignAxis& wrong : {DesignAxis{"x", 1, 1, 0.1}, DesignAxis{"x", 0, 1, 0}, DesignAxis{"x", 0, NAN, 1}})
    EXPECT_THROW(check_box({wrong}), InputError);
  EXPECT_THROW(check_box({}), InputError);
}

TEST(SpaceFilling, points_are_distinct_even_and_a_longer_set_begins_with_the_shorter) {
  for (std::int64_t seed = 0; seed < 20; ++seed) {
    const std::vector<Point> points = space_filling(lattice_box, 64, seed);
    EXPECT_EQ(std::set<Point>(points.begin(), points.end()).size(), 64u);
    const std::vector<Point> fewer = space_filling(lattice_box, 20, seed);
    EXPECT_TRUE(std::equal(fewer.begin(), fewer.end(), points.begin()));
    // Each sixteenth of the box has its 4 points, give or take 3 (independent points: 0 to 10).
    std::array<int, 16> count{};
    for (const Point& p : points) {
      const Point u = to_unit(lattice_box, p);
      ++count[static_cast<std::size_t>(std::min(3.0, 4 * u[0]) * 1) * 4 +
              static_cast<std::size_t>(std::min(3.0, 4 * u[1]))];
    }
    const auto [few, many] = std::minmax_element(count.begin(), count.end());
    EXPECT_GE(*few, 1);
    EXPECT_LE(*many, 8);
  }
}

TEST(SpaceFilling, a_small_lattice_is_taken_whole) {
  const Box small = {{"a", 0, 1, 0.5}, {"b", 0, 1, 0.5}, {"c", 0, 1, 1}};
  EXPECT_EQ(space_filling(small, 18, 1).size(), 18u);
  EXPECT_EQ(space_filling(small, 500, 1).size(), 18u);
  const std::vector<Point> most = space_filling(small, 17, 1);
  EXPECT_EQ(std::set<Point>(most.begin(), most.end()).size(), 17u);
}

}  // namespace
}  // namespace drumsweep

#include "postproc/bed.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "core/config/schema.h"
#include "support/complaint.h"
#include "tests/postproc/synthetic.h"

namespace drumsweep {
namespace {

const double two_turns_s = turns_to_seconds(2.0);
constexpr double lab_angle_deg = 35.0;

Bed empty_bed(int num_along, int num_across, double cell_along_m = 0.025, double cell_across_m = 0.025) {
  Bed bed;
  bed.grid = {num_along, num_across, cell_along_m, cell_across_m};
  bed.height_m.assign(static_cast<std::size_t>(num_along * num_across), 0.0);
  return bed;
}

double sum_of_heights(const Bed& bed) { return std::accumulate(bed.height_m.begin(), bed.height_m.end(), 0.0); }

/// Largest difference between neighbours over what the angle allows.
double worst_slope(const Bed& bed, double angle_deg) {
  const double slope = std::tan(angle_deg * std::numbers::pi / 180.0);
  double worst = 0.0;
  for (int i = 0; i < bed.grid.num_along; ++i) {
    for (int j = 0; j < bed.grid.num_across; ++j) {
      const double here = bed.height_m[bed.index(i, j)];
      const double next = bed.height_m[bed.index((i + 1) % bed.grid.num_along, j)];
      worst = std::max(worst, std::abs(here - next) / (slope * bed.grid.cell_along_m));
      if (j + 1 < bed.grid.num_across)
        worst = std::max(worst, std::abs(here - bed.height_m[bed.index(i, j + 1)]) / (slope * bed.grid.cell_across_m));
    }
  }
  return worst;
}

TEST(Bed, lab_grid_has_40_cells_of_25_mm_across_and_whole_blocks_along) {
  const BedGrid grid = bed_grid(BeltConfig{}, ObjectiveConfig{}, 0.01, two_turns_s, 6);
  EXPECT_EQ(grid.num_across, 40);
  EXPECT_DOUBLE_EQ(grid.cell_across_m, 0.025);
  EXPECT_EQ(grid.num_along, 48);
  EXPECT_DOUBLE_EQ(grid.cell_along_m * grid.num_along, 0.25 * two_turns_s);
}

RC_GTEST_PROP(Bed, grid_fills_the_strip_and_divides_into_blocks, ()) {
  BeltConfig belt;
  belt.width_m = *rc::gen::inRange(1, 4000) * 1e-3;
  belt.speed_m_s = *rc::gen::inRange(1, 2000) * 1e-3;
  const double duration = *rc::gen::inRange(1, 100) * 0.1;
  const int num_blocks = *rc::gen::inRange(1, 40);
  const BedGrid grid = bed_grid(belt, ObjectiveConfig{}, 0.01, duration, num_blocks);
  RC_ASSERT(grid.num_across >= 2 && grid.num_across % 2 == 0);
  RC_ASSERT(grid.num_along >= num_blocks && grid.num_along % num_blocks == 0);
  RC_ASSERT(std::abs(grid.num_across * grid.cell_across_m - belt.width_m) < 1e-12 * belt.width_m);
  RC_ASSERT(std::abs(grid.num_along * grid.cell_along_m - belt.speed_m_s * duration) < 1e-12 * duration);
}

TEST(Bed, standing_belt_is_refused_by_name) {
  BeltConfig belt;
  belt.speed_m_s = 0.0;
  const std::string text = complaint([&] { bed_grid(belt, ObjectiveConfig{}, 0.01, two_turns_s, 6); });
  EXPECT_NE(text.find("belt.speed_m_s"), std::string::npos) << text;
}

TEST(Bed, volume_landed_equals_height_times_area_times_packing) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> across(0.0, 1.0);
  const std::vector<Landing> landings = poisson_landings(random, [&](auto& r) { return across(r); });
  const BeltConfig belt;
  const ObjectiveConfig objective;
  const BedGrid grid = bed_grid(belt, objective, 0.01, two_turns_s, 6);
  Bed bed = build_bed(landings, 0.0, two_turns_s, belt, objective, grid);
  topple(bed, lab_angle_deg);
  EXPECT_EQ(bed.landed, static_cast<std::int64_t>(landings.size()));
  const double radius = 0.005F;
  const double landed = static_cast<double>(landings.size()) * 4.0 / 3.0 * std::numbers::pi * radius * radius * radius;
  const double stored = sum_of_heights(bed) * grid.cell_along_m * grid.cell_across_m * objective.packing;
  EXPECT_NEAR(stored / landed, 1.0, 1e-12);
}

TEST(Bed, ball_lies_where_the_belt_was_when_it_landed) {
  const BeltConfig belt;
  const ObjectiveConfig objective;
  const BedGrid grid = bed_grid(belt, objective, 0.01, two_turns_s, 6);
  // Thrown 30 mm with the belt one second into the window: X = 0.03 - 0.25 m, wrapped.
  const std::vector<Landing> landings = {landing_at(11.0, 0.03, 0.26)};
  const Bed bed = build_bed(landings, 10.0, two_turns_s, belt, objective, grid);
  const double place = 0.03 - 0.25 + 0.25 * two_turns_s;
  EXPECT_GT(bed.height_m[bed.index(static_cast<int>(place / grid.cell_along_m), 10)], 0.0);
}

TEST(Bed, window_of_time_is_half_open) {
  const BeltConfig belt;
  const ObjectiveConfig objective;
  const BedGrid grid = bed_grid(belt, objective, 0.01, 4.0, 6);
  const std::vector<Landing> landings = {landing_at(std::nextafter(10.0, 0.0), 0, 0.5), landing_at(10.0, 0, 0.5),
                                         landing_at(std::nextafter(14.0, 0.0), 0, 0.5), landing_at(14.0, 0, 0.5)};
  EXPECT_EQ(build_bed(landings, 10.0, 4.0, belt, objective, grid).landed, 2);
}

TEST(Bed, skirt_keeps_in_the_edge_cell_what_an_open_edge_spills) {
  BeltConfig belt;
  const ObjectiveConfig objective;
  const BedGrid grid = bed_grid(belt, objective, 0.01, two_turns_s, 6);
  const std::vector<Landing> landings = {landing_at(0, 0, -0.1), landing_at(0, 0, 1e30), landing_at(0, 0, 0.0),
                                         landing_at(0, 0, 1.0)};
  const Bed skirt = build_bed(landings, 0.0, two_turns_s, belt, objective, grid);
  EXPECT_EQ(skirt.landed, 4);
  EXPECT_EQ(skirt.spilled, 0);
  EXPECT_GT(skirt.height_m[skirt.index(0, 0)], 0.0);
  EXPECT_DOUBLE_EQ(skirt.height_m[skirt.index(0, 0)], skirt.height_m[skirt.index(0, 39)]);

  belt.edge = "open";
  const Bed open = build_bed(landings, 0.0, two_turns_s, belt, objective, grid);
  EXPECT_EQ(open.landed, 2);
  EXPECT_EQ(open.spilled, 2);
  EXPECT_DOUBLE_EQ(2.0 * open.height_m[open.index(0, 0)], skirt.height_m[skirt.index(0, 0)]);
}

TEST(Bed, landing_that_is_not_finite_is_named) {
  const BeltConfig belt;
  const ObjectiveConfig objective;
  const BedGrid grid = bed_grid(belt, objective, 0.01, two_turns_s, 6);
  const std::vector<Landing> landings = {landing_at(0, 0, std::nan(""), 4711)};
  try {
    build_bed(landings, 0.0, two_turns_s, belt, objective, grid);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("4711"), std::string::npos) << error.what();
  }
}

RC_GTEST_PROP(Topple, conserves_volume_and_leaves_no_slope_above_the_angle, ()) {
  Bed bed = empty_bed(*rc::gen::inRange(1, 20), *rc::gen::inRange(2, 20), 0.02, 0.03);
  for (double& height : bed.height_m) height = *rc::gen::inRange(0, 300) * 1e-3;
  const double angle = *rc::gen::inRange(1, 60);
  const double before = sum_of_heights(bed);
  const auto [low, high] = std::minmax_element(bed.height_m.begin(), bed.height_m.end());
  const double lowest = *low, highest = *high;
  topple(bed, angle);
  RC_ASSERT(std::abs(sum_of_heights(bed) - before) <= 1e-12 * before);
  RC_ASSERT(worst_slope(bed, angle) <= 1.0 + 1e-6 + 1e-5);  // 1 nm against the least limit, 0.35 mm
  for (double height : bed.height_m) RC_ASSERT(height >= lowest - 1e-12 && height <= highest + 1e-12);
}

TEST(Topple, gentle_bed_is_left_bit_for_bit) {
  Bed bed = empty_bed(48, 40);
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> height(0.0, 0.0175);  // tan 35 deg * 25 mm = 17.505 mm
  for (double& h : bed.height_m) h = height(random);
  const std::vector<double> before = bed.height_m;
  topple(bed, lab_angle_deg);
  EXPECT_EQ(bed.height_m, before);
}

TEST(Topple, symmetric_heap_stays_symmetric_exactly) {
  // A peak between two columns and one on a column, on an odd number of rows: no order of visits may lean it.
  Bed between = empty_bed(21, 40);
  between.height_m[between.index(10, 19)] = between.height_m[between.index(10, 20)] = 0.7;
  Bed on = empty_bed(21, 41);
  on.height_m[on.index(10, 20)] = 0.7;
  for (Bed* bed : {&between, &on}) {
    topple(*bed, lab_angle_deg);
    for (int i = 0; i < bed->grid.num_along; ++i) {
      for (int j = 0; j < bed->grid.num_across; ++j) {
        const double here = bed->height_m[bed->index(i, j)];
        EXPECT_EQ(here, bed->height_m[bed->index(20 - i, j)]);
        EXPECT_EQ(here, bed->height_m[bed->index(i, bed->grid.num_across - 1 - j)]);
      }
    }
  }
}

TEST(Topple, ridge_spreads_to_the_heap_of_the_friction_angle) {
  // All of the lab's flow on one line: 0.4 m on one cell. Slope s and volume V give a triangle of height sqrt(V s).
  Bed bed = empty_bed(48, 40);
  for (int i = 0; i < 48; ++i) bed.height_m[bed.index(i, 20)] = 0.4024;
  const auto begin = std::chrono::steady_clock::now();
  topple(bed, lab_angle_deg);
  const double ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
  RecordProperty("milliseconds", std::to_string(ms));
  std::printf("topple of a 0.4 m ridge, 48 x 40 cells: %.2f ms\n", ms);
  const double slope = std::tan(lab_angle_deg * std::numbers::pi / 180.0);
  EXPECT_NEAR(bed.height_m[bed.index(0, 20)], std::sqrt(0.4024 * 0.025 * slope), 0.003);
  EXPECT_LE(worst_slope(bed, lab_angle_deg), 1.0 + 2e-6);
  EXPECT_LT(ms, 1000.0);  // a hundred times what it takes here
}

TEST(Topple, heap_at_the_skirt_leans_on_it) {
  Bed bed = empty_bed(12, 40);
  for (int i = 0; i < 12; ++i) bed.height_m[bed.index(i, 39)] = 0.4024;
  topple(bed, lab_angle_deg);
  const double slope = std::tan(lab_angle_deg * std::numbers::pi / 180.0);
  EXPECT_NEAR(bed.height_m[bed.index(0, 39)], std::sqrt(2.0 * 0.4024 * 0.025 * slope), 0.012);
  EXPECT_LE(worst_slope(bed, lab_angle_deg), 1.0 + 2e-6);
}

TEST(Topple, ends_at_friction_angle_zero_with_a_level_bed) {
  Bed bed = empty_bed(6, 8);
  bed.height_m[5] = 1.0;
  topple(bed, 0.0);
  for (double height : bed.height_m) EXPECT_NEAR(height, 1.0 / 48.0, 1e-7);
}

}  // namespace
}  // namespace drumsweep

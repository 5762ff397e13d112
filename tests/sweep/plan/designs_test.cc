#include "sweep/plan/designs.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <set>

#include "core/config/schema.h"

namespace drumsweep {
namespace {

StageConfig grid(const std::string& name, std::vector<StageVariable> variables) {
  return {name, "grid", std::move(variables)};
}

Study small_study() {
  Study study;
  study.outlet.opening_angle_deg = 1.0;
  study.stages = {
      grid("coarse", {{"outlet.opening_angle_deg", 0, 0.6, 4, {}}, {"outlet.base_width_m", 0.04, 0.06, 3, {}}})};
  return study;
}

TEST(Designs, a_grid_has_all_combinations_with_the_first_variable_slowest) {
  const Plan plan = plan_designs(small_study());
  ASSERT_EQ(plan.designs.size(), 12u);
  EXPECT_EQ(plan.columns, (std::vector<std::string>{"opening_angle_deg", "base_width_m"}));
  // Exactly the decimal numbers, not sums of steps: 0.2 and not 0.19999999999999998.
  EXPECT_EQ(plan.designs[0].row, (std::vector<double>{0.0, 0.04}));
  EXPECT_EQ(plan.designs[2].row, (std::vector<double>{0.0, 0.06}));
  EXPECT_EQ(plan.designs[4].row, (std::vector<double>{0.2, 0.05}));
  EXPECT_EQ(plan.designs[11].row, (std::vector<double>{0.6, 0.06}));
}

TEST(Designs, overlapping_stages_share_designs_and_ids_do_not_depend_on_the_other_stages) {
  Study study = small_study();
  const Plan before = plan_designs(study);
  study.stages.insert(study.stages.begin(), {"points",
                                             "points",
                                             {{"outlet.base_width_m", not_given, not_given, 1, {0.05, 0.077}},
                                              {"outlet.opening_angle_deg", not_given, not_given, 1, {0.4, 0.1}}}});
  const Plan after = plan_designs(study);
  EXPECT_EQ(after.designs.size(), 13u);
  EXPECT_EQ(after.stages[0].nodes, 2u);
  EXPECT_EQ(after.stages[1].shared, 1u);
  std::set<std::string> ids;
  for (const PlannedDesign& d : after.designs) ids.insert(d.id);
  EXPECT_EQ(ids.size(), 13u);
  for (const PlannedDesign& d : before.designs) EXPECT_EQ(ids.count(d.id), 1u);
  // The shared one belongs to the stage that comes first.
  for (const PlannedDesign& d : after.designs) {
    if (d.values == Design{{"outlet.base_width_m", 0.05}, {"outlet.opening_angle_deg", 0.4}}) {
      EXPECT_EQ(d.stage, "points");
    }
  }
}

TEST(Designs, an_impossible_geometry_is_a_hole_and_no_error) {
  Study study = small_study();
  study.stages = {grid("wide", {{"outlet.base_width_m", 0.05, 2.0, 2, {}}})};
  const Plan plan = plan_designs(study);
  ASSERT_EQ(plan.designs.size(), 2u);
  EXPECT_TRUE(plan.designs[0].impossible.empty());
  EXPECT_NE(plan.designs[1].impossible.find("overlap"), std::string::npos);
  EXPECT_EQ(plan.stages[0].impossible, 1u);
}

TEST(Designs, columns_that_a_stage_does_not_set_hold_the_studys_own_value) {
  Study study = small_study();
  study.stages.push_back(grid("belt", {{"belt.drop_height_m", 0.05, 0.1, 2, {}}}));
  const Plan plan = plan_designs(study);
  EXPECT_EQ(plan.columns.back(), "drop_height_m");
  EXPECT_EQ(plan.designs.back().row, (std::vector<double>{1.0, 0.048, 0.1}));
  EXPECT_EQ(plan.designs.back().values.size(), 1u);
}

TEST(Designs, an_angle_in_the_other_unit_is_an_empty_cell) {
  Study study = small_study();
  study.stages.push_back(grid("radians", {{"outlet.opening_angle_rad", 0.01, 0.02, 2, {}}}));
  const Plan plan = plan_designs(study);
  EXPECT_TRUE(std::isnan(plan.designs.back().row[0]));
  EXPECT_EQ(plan.designs.back().row[2], 0.02);
  EXPECT_TRUE(std::isnan(plan.designs.front().row[2]));
}

TEST(Designs, the_id_is_a_fixed_function_of_the_content) {
  // Written down once: a change would orphan every stored recording.
  EXPECT_EQ(design_id({{"outlet.base_width_m", 0.02}, {"outlet.opening_angle_deg", 1}}), "c46c1d7f2e");
  EXPECT_EQ(design_id({{"outlet.opening_angle_deg", 1}, {"outlet.base_width_m", 0.02}}), "c46c1d7f2e");
}

RC_GTEST_PROP(Designs, rounding_keeps_decimals_forgets_rounding_errors_and_is_idempotent, ()) {
  const auto nano = *rc::gen::inRange<std::int64_t>(-5'000'000'000, 5'000'000'000);
  const double value = std::stod(std::to_string(nano) + "e-9");
  RC_ASSERT(rounded(value) == value);
  RC_ASSERT(rounded(std::nextafter(value, 10.0)) == value);
  RC_ASSERT(rounded(value + 0.4e-9) == rounded(rounded(value + 0.4e-9)));
  RC_ASSERT(!std::signbit(rounded(-1e-12)));
}

RC_GTEST_PROP(Designs, a_finer_grid_contains_the_coarse_one, ()) {
  const auto count = *rc::gen::inRange<std::int64_t>(2, 30);
  const auto refine = *rc::gen::inRange<std::int64_t>(2, 6);
  const double from = static_cast<double>(*rc::gen::inRange(0, 50)) / 1000,
               to = from + static_cast<double>(*rc::gen::inRange(1, 100)) / 1000;
  Study study = small_study();
  study.stages = {grid("coarse", {{"outlet.base_width_m", 0.01 + from, 0.01 + to, count, {}}}),
                  grid("fine", {{"outlet.base_width_m", 0.01 + from, 0.01 + to, (count - 1) * refine + 1, {}}})};
  const Plan plan = plan_designs(study);
  RC_ASSERT(plan.stages[1].shared == static_cast<std::size_t>(count));
}

TEST(Designs, an_impossible_design_leaves_no_trace_in_the_next) {
  Study study = small_study();
  study.stages = {{"list",
                   "points",
                   {{"outlet.opening_angle_rad", {}, {}, 1, {0.01, 0.02, 0.01}},
                    {"outlet.base_width_m", {}, {}, 1, {0.04, 0.9, 0.05}}}}};
  study.stages.push_back(grid("deg", {{"outlet.opening_angle_deg", 1, 2, 2, {}}}));
  const Plan plan = plan_designs(study);
  ASSERT_EQ(plan.designs.size(), 5u);
  EXPECT_TRUE(plan.designs[0].impossible.empty());
  EXPECT_FALSE(plan.designs[1].impossible.empty());
  EXPECT_TRUE(plan.designs[2].impossible.empty());
  // Columns: angle in rad, width, angle in deg; the other unit of a given angle is absent.
  EXPECT_TRUE(std::isnan(plan.designs[0].row[2]));
  EXPECT_TRUE(std::isnan(plan.designs[3].row[0]));
  EXPECT_EQ(plan.designs[3].row[1], study.outlet.base_width_m);
}

TEST(Designs, ten_thousand_points_are_planned_at_once) {
  Study study = small_study();
  StageVariable width{"outlet.base_width_m", {}, {}, 1, {}};
  for (int i = 0; i < 10000; ++i) width.values.push_back(0.04 + 1e-6 * i);
  study.stages = {{"list", "points", {width}}};
  validate(study);
  EXPECT_EQ(plan_designs(study).designs.size(), 10000u);  // was quadratic: minutes
}

}  // namespace
}  // namespace drumsweep

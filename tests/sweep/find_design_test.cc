#include "sweep/find_design.h"

#include <gtest/gtest.h>

#include <functional>

#include "core/config/schema.h"
#include "support/complaint.h"
#include "tests/support/stored_designs.h"

namespace drumsweep {
namespace {

TEST(FindDesign, by_values_or_by_the_beginning_of_its_id) {
  const Study study = grid_study(3, 3);
  const Plan plan = plan_designs(study);
  const PlannedDesign& design = design_with_values(plan, study, {0.35, 0.05});
  EXPECT_EQ(design.row, (std::vector<double>{0.35, 0.05}));
  EXPECT_EQ(design_with_id(plan, design.id.substr(0, 6)).id, design.id);
  EXPECT_NE(complaint([&] { design_with_id(plan, ""); }).find("9 ids"), std::string::npos);
  EXPECT_NE(complaint([&] { design_with_values(plan, study, {0.35}); }).find("opening_angle_deg, base_width_m"),
            std::string::npos);
}

TEST(FindDesign, the_nearest_are_named_in_order_and_not_taken) {
  const Study study = grid_study(3, 3);
  const Plan plan = plan_designs(study);
  const std::string text = complaint([&] { design_with_values(plan, study, {0.36, 0.041}); });
  const std::size_t first = text.find("opening_angle_deg = 0.35, base_width_m = 0.04\n");
  const std::size_t second = text.find("opening_angle_deg = 0.35, base_width_m = 0.05");
  EXPECT_NE(first, std::string::npos) << text;
  EXPECT_NE(second, std::string::npos) << text;
  EXPECT_LT(first, second);
}

TEST(FindDesign, of_replicates_it_is_the_studys_own_or_the_one_asked_for) {
  Study study = grid_study(2, 2);
  StageConfig again{"again",
                    "points",
                    {{"outlet.opening_angle_deg", not_given, not_given, 1, {0.1, 0.1, 0.3}},
                     {"outlet.base_width_m", not_given, not_given, 1, {0.04, 0.04, 0.05}},
                     {"record.replicate", not_given, not_given, 1, {1, 2, 3}}}};
  study.stages.push_back(again);
  const Plan plan = plan_designs(study);
  EXPECT_EQ(design_with_values(plan, study, {0.1, 0.04}).row[2], 0.0);
  EXPECT_EQ(design_with_values(plan, study, {0.1, 0.04}, 2).row[2], 2.0);
  EXPECT_EQ(design_with_values(plan, study, {0.1, 0.04, 1}).row[2], 1.0);
  EXPECT_EQ(design_with_values(plan, study, {0.3, 0.05}).row[2], 3.0) << "the only run that there is";
  EXPECT_NE(complaint([&] {
              design_with_values(plan, study, {0.1, 0.04}, 7);
            }).find("--replicate 7"),
            std::string::npos);
}

}  // namespace
}  // namespace drumsweep

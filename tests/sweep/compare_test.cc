#include "sweep/compare.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/config/schema.h"
#include "core/io/durable_file.h"
#include "postproc/child_process.h"
#include "support/stored_designs.h"
#include "sweep/plan/designs.h"

namespace drumsweep {
namespace {

/// Two studies that differ in name and one key; the second has one design of two, and another variable.
class Compare : public testing::Test {
 protected:
  Compare() {
    for (Study& study : studies_) study.stages.front().variables.pop_back();
    studies_[1].name = "another name";
    studies_[1].solver.iterations = 77;
    studies_[1].stages.front().variables.front() = {"record.replicate", 0, 1, 2, {}};
    for (std::size_t i = 0; i < 2; ++i) {
      const Store store(folders_[i], studies_[i]);
      write_durably(store.paths().warm_state(), pack_warm_state(studies_[i], made_up_warm_drum()));
      const Plan plan = plan_designs(studies_[i]);
      for (std::size_t k = 0; k < plan.designs.size() - i; ++k)
        write_recording(store.paths(), studies_[i], plan.designs[k],
                        made_up_recording(studies_[i], static_cast<std::uint32_t>(40 * k), 900));
    }
  }

  Study studies_[2] = {grid_study(2, 2), grid_study(2, 2)};
  ScratchFolder scratch_;
  std::vector<std::string> folders_ = {(scratch_.path / "a").string(), (scratch_.path / "b").string()};
};

TEST_F(Compare, shows_the_keys_that_differ_and_the_designs_of_all_folders) {
  const Comparison all = compare(folders_);
  EXPECT_EQ(all.keys, std::vector<std::string>{"solver.iterations"});
  EXPECT_EQ(all.variable_names, (std::vector<std::string>{"opening_angle_deg", "replicate"}));
  EXPECT_EQ(all.folders[0].values, std::vector<std::string>{"10"});
  EXPECT_EQ(all.folders[1].values, std::vector<std::string>{"77"});
  ASSERT_EQ(all.folders[0].designs.size(), 2u);
  ASSERT_EQ(all.folders[1].designs.size(), 1u);
  for (std::size_t i = 0; i < 2; ++i)
    for (const ComparedDesign& d : all.folders[i].designs) {
      ASSERT_EQ(d.variables.size(), 2u);
      EXPECT_EQ(d.variables[1 - i], i == 0 ? 0 : 1) << "the study's own";
      EXPECT_NEAR(d.over_end, 0.25, 0.01);
      EXPECT_GT(d.row.f_m, 0);
    }
  EXPECT_EQ(all.folders[0].warm_balls, 0);
  ASSERT_EQ(all.warnings.size(), 1u);
  EXPECT_NE(all.warnings[0].find("1 of 2 designs are not there"), std::string::npos) << all.warnings[0];
}

TEST_F(Compare, a_failed_design_has_its_reason_and_a_damaged_drum_is_said) {
  const Plan plan = plan_designs(studies_[1]);
  write_failure({folders_[1]}, plan.designs[1], "by hand");
  write_durably(OutputPaths{folders_[0]}.warm_state(), "garbage");
  const Comparison all = compare(folders_);
  ASSERT_EQ(all.folders[1].designs.size(), 2u);
  EXPECT_EQ(all.folders[1].designs[1].row.state, "failed");
  EXPECT_EQ(all.folders[1].designs[1].row.reason, "by hand");
  ASSERT_EQ(all.warnings.size(), 1u);
  EXPECT_NE(all.warnings[0].find("warm_state.h5"), std::string::npos) << all.warnings[0];
  EXPECT_EQ(all.folders[0].designs.size(), 2u);
}

TEST_F(Compare, another_outlet_of_the_warm_up_is_a_difference) {
  Study other = studies_[0];
  other.outlet.base_width_m *= 1.01;
  const std::string folder = (scratch_.path / "c").string();
  const Store store(folder, other);
  EXPECT_EQ(compare({folders_[0], folder}).keys, std::vector<std::string>{"outlet.base_width_m"});
}

TEST_F(Compare, table_has_as_many_cells_in_every_line) {
  std::filesystem::remove_all(folders_[0] + "/designs");
  const std::string csv = to_csv(compare(folders_));
  std::vector<std::ptrdiff_t> commas;
  for (std::size_t begin = 0; begin < csv.size();) {
    const std::size_t end = csv.find('\n', begin);
    commas.push_back(std::count(csv.begin() + static_cast<std::ptrdiff_t>(begin),
                                csv.begin() + static_cast<std::ptrdiff_t>(end), ','));
    begin = end + 1;
  }
  ASSERT_EQ(commas.size(), 3u) << csv;  // head, one design, the folder without any
  EXPECT_EQ(commas[1], commas[0]) << csv;
  EXPECT_EQ(commas[2], commas[0]) << csv;
}

TEST_F(Compare, a_folder_that_is_not_a_sweeps_is_named) {
  EXPECT_THROW(compare({folders_[0], (scratch_.path / "none").string()}), InputError);
}

}  // namespace
}  // namespace drumsweep

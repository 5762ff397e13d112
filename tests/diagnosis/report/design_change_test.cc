#include "diagnosis/report/design_change.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "core/config/schema.h"
#include "postproc/child_process.h"
#include "postproc/result_table.h"

namespace drumsweep {
namespace {

/// A sweep whose f is a valley about `best`.
void write_sweep(const std::string& folder, double best, const std::string& name = "base_width_m") {
  std::filesystem::create_directories(folder);
  ResultTable table{{name}, {}};
  for (int i = 0; i <= 12; ++i) {
    ResultRow row;
    row.design_id = fmt::format("{:08x}", i);
    row.stage = "grid";
    row.state = "done";
    row.variables = {0.03 + 0.0025 * i};
    row.f_m = 0.01 + 20 * std::pow(row.variables[0] - best, 2) + 1e-4 * std::sin(37.0 * i);
    row.sigma_f_m = 1e-4;
    table.rows.push_back(row);
  }
  std::ofstream(folder + "/results.csv") << to_csv(table);
}

}  // namespace

TEST(DesignChange, optimum_and_regret_are_those_of_two_valleys) {
  const ScratchFolder scratch;
  const std::string& folder = scratch.path;
  write_sweep(folder + "/before", 0.040);
  write_sweep(folder + "/after", 0.050);
  const DesignChange change = change_of_design(folder + "/before", {folder + "/after"}, 1);
  EXPECT_NEAR(change.before.at[0], 0.040, 0.001);
  ASSERT_EQ(change.members.size(), 1u);
  EXPECT_NEAR(change.members[0].after.at[0], 0.050, 0.001);
  EXPECT_NEAR(change.members[0].of_old.f_m, 20 * 1e-4, 3e-4);
  EXPECT_GT(change.members[0].spread, 3);
  write_sweep(folder + "/other", 0.050, "opening_angle_deg");
  EXPECT_THROW(change_of_design(folder + "/before", {folder + "/other"}, 1), InputError);
}

TEST(DesignChange, members_of_a_set_agree_where_one_design_is_best_for_all) {
  const ScratchFolder scratch;
  const std::string& folder = scratch.path;
  write_sweep(folder + "/before", 0.040);
  write_sweep(folder + "/a", 0.0500);
  write_sweep(folder + "/b", 0.0505);
  write_sweep(folder + "/c", 0.0350);
  const DesignChange same = change_of_design(folder + "/before", {folder + "/a", folder + "/b"}, 1);
  EXPECT_TRUE(same.agree());
  EXPECT_LT(same.apart, 2);
  const DesignChange other = change_of_design(folder + "/before", {folder + "/a", folder + "/b", folder + "/c"}, 1);
  EXPECT_FALSE(other.agree());
  EXPECT_GT(other.apart, 3);
  // Its own optimum costs nothing; that of a where c is the truth, 20 (0.015)^2.
  EXPECT_EQ(other.regret[0][0].f_m, 0);
  EXPECT_NEAR(other.regret[0][2].f_m, 20 * 0.015 * 0.015, 6e-4);
}

}  // namespace drumsweep

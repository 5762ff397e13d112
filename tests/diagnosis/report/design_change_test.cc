#include "diagnosis/report/design_change.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <stdlib.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "core/config/schema.h"
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
  std::string pattern = (std::filesystem::temp_directory_path() / "drumsweep-change-XXXXXX").string();
  const std::string folder = ::mkdtemp(pattern.data());
  write_sweep(folder + "/before", 0.040);
  write_sweep(folder + "/after", 0.050);
  const DesignChange change = change_of_design(folder + "/before", folder + "/after", 1);
  EXPECT_NEAR(change.before.at[0], 0.040, 0.001);
  EXPECT_NEAR(change.after.at[0], 0.050, 0.001);
  EXPECT_NEAR(change.regret_m, 20 * 1e-4, 3e-4);
  EXPECT_GT(change.spread, 3);
  write_sweep(folder + "/other", 0.050, "opening_angle_deg");
  EXPECT_THROW(change_of_design(folder + "/before", folder + "/other", 1), InputError);
  std::filesystem::remove_all(folder);
}

}  // namespace drumsweep

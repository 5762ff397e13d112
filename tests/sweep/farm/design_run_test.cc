#include "sweep/farm/design_run.h"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>

#include "core/config/toml_reader.h"
#include "core/io/durable_file.h"

namespace drumsweep {
namespace {

struct DesignRunTest : testing::Test {
  std::string folder;
  OutputPaths paths;
  Study study;
  Plan plan;
  void SetUp() override {
    std::string pattern = (std::filesystem::temp_directory_path() / "drumsweep-run-XXXXXX").string();
    folder = paths.folder = ::mkdtemp(pattern.data());
    make_folder(paths.designs());
    // A small drum without feed: nothing to compute. The second design is impossible.
    study = parse_study(R"(
drum = { diameter_m = 0.2, length_m = 0.2, mesh_resolution_m = 0.02, texture.density_1_m2 = 0 }
outlet = { length_m = 0.1, opening_angle_deg = 1, base_width_m = 0.03 }
feed = { rate_kg_s = 0, zone_begin_m = 0, zone_length_m = 0.1, zone_width_m = 0.1 }
record = { adapt_turns = 0, turns = 1 }
[[stage]]
name = "s"
variables = [ { key = "outlet.base_width_m", from = 0.03, to = 1, count = 2 } ]
)",
                        "test");
    plan = plan_designs(study);
  }
  void TearDown() override { std::filesystem::remove_all(folder); }
};

TEST_F(DesignRunTest, done_means_that_the_recording_is_there) {
  const DesignOutcome outcome = simulate_and_store(paths, study, DrumState{}, plan.designs[0], 0, "here", {});
  EXPECT_EQ(outcome.kind, DesignOutcome::Kind::done);
  EXPECT_TRUE(read_design(paths, study, plan.designs[0]).recording.has_value());
}

TEST_F(DesignRunTest, an_exception_of_the_engine_is_the_designs_failure_and_stays) {
  const DesignOutcome outcome = simulate_and_store(paths, study, DrumState{}, plan.designs[1], 1, "here", {});
  EXPECT_EQ(outcome.kind, DesignOutcome::Kind::failed);
  EXPECT_NE(outcome.reason.find("overlap"), std::string::npos);
  EXPECT_NE(read_design(paths, study, plan.designs[1]).failure.value().find("overlap"), std::string::npos);
}

TEST_F(DesignRunTest, a_stopped_design_leaves_nothing) {
  const DesignOutcome outcome =
      simulate_and_store(paths, study, DrumState{}, plan.designs[0], 0, "here", [](const Progress&) { return false; });
  EXPECT_EQ(outcome.kind, DesignOutcome::Kind::stopped);
  EXPECT_TRUE(std::filesystem::is_empty(paths.designs()));
}

TEST_F(DesignRunTest, a_result_that_cannot_be_written_is_the_machines_fault_not_the_designs) {
  paths.folder += "/nowhere";
  EXPECT_THROW(simulate_and_store(paths, study, DrumState{}, plan.designs[0], 0, "here", {}), WriteError);
  EXPECT_THROW(simulate_and_store(paths, study, DrumState{}, plan.designs[1], 1, "here", {}), WriteError);
}

TEST_F(DesignRunTest, outcomes_travel_as_text) {
  const DesignOutcome sent{812, DesignOutcome::Kind::failed, 1.25, 0.1, "node-7", "slots overlap,\nand more"};
  const DesignOutcome got = unpack_outcome(pack_outcome(sent));
  EXPECT_EQ(got.index, sent.index);
  EXPECT_EQ(got.kind, sent.kind);
  EXPECT_EQ(got.wall_s, sent.wall_s);
  EXPECT_EQ(got.cpu_s, sent.cpu_s);
  EXPECT_EQ(got.host, sent.host);
  EXPECT_EQ(got.reason, sent.reason);
  EXPECT_THROW(unpack_outcome("what?"), std::runtime_error);
}

}  // namespace
}  // namespace drumsweep

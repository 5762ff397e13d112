#include "sweep/farm/design_run.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "core/config/toml_reader.h"
#include "core/io/durable_file.h"
#include "postproc/child_process.h"
#include "sweep/stop.h"

namespace drumsweep {
namespace {

struct DesignRunTest : testing::Test {
  const ScratchFolder scratch;
  const std::string folder = scratch.path;
  OutputPaths paths;
  Study study;
  Plan plan;
  void SetUp() override {
    paths.folder = folder;
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

TEST_F(DesignRunTest, a_stopped_design_leaves_a_checkpoint_and_goes_on_inside_it_to_the_same_bytes) {
  const DesignOutcome outcome =
      simulate_and_store(paths, study, DrumState{}, plan.designs[0], 0, "here", [](const Progress&) { return false; });
  EXPECT_EQ(outcome.kind, DesignOutcome::Kind::stopped);
  EXPECT_FALSE(has_loose_recording(paths, plan.designs[0].id));
  EXPECT_TRUE(std::filesystem::exists(paths.checkpoint(plan.designs[0].id)));

  const DesignOutcome second = simulate_and_store(paths, study, DrumState{}, plan.designs[0], 0, "here", {});
  EXPECT_EQ(second.kind, DesignOutcome::Kind::done);
  EXPECT_NE(second.note.find("at outer step 1"), std::string::npos) << second.note;
  EXPECT_FALSE(std::filesystem::exists(paths.checkpoint(plan.designs[0].id)));
  const std::string resumed = read_whole_file(paths.recording(plan.designs[0].id));
  std::filesystem::remove(paths.recording(plan.designs[0].id));
  simulate_and_store(paths, study, DrumState{}, plan.designs[0], 0, "here", {});
  EXPECT_EQ(resumed, read_whole_file(paths.recording(plan.designs[0].id)));
}

TEST_F(DesignRunTest, a_checkpoint_that_is_damaged_or_of_another_design_or_study_is_ignored_and_said) {
  const std::string path = paths.checkpoint(plan.designs[0].id);
  const auto stop = [](const Progress&) { return false; };
  simulate_and_store(paths, study, DrumState{}, plan.designs[0], 0, "here", stop);
  const std::string good = read_whole_file(path);
  Study other = study;
  other.drum.angular_velocity_rad_s *= 1.01;
  std::string flipped = good;
  flipped[flipped.size() / 2] = static_cast<char>(flipped[flipped.size() / 2] ^ 1);
  for (const std::string& bad : {flipped, good.substr(0, good.size() - 1), std::string(),
                                 pack_progress(other, plan.designs[0].id, plan.designs[0].values, {}, 1),
                                 pack_progress(study, "0123456789", plan.designs[1].values, {}, 1)}) {
    write_durably(path, bad);
    const DesignOutcome outcome = simulate_and_store(paths, study, DrumState{}, plan.designs[0], 0, "here", {});
    EXPECT_EQ(outcome.kind, DesignOutcome::Kind::done);
    EXPECT_NE(outcome.note.find("begun anew"), std::string::npos) << outcome.note;
    EXPECT_FALSE(std::filesystem::exists(path));
  }
}

TEST_F(DesignRunTest, checkpoints_come_at_turns_and_when_asked_for) {
  const std::string path = paths.checkpoint(plan.designs[0].id);
  study.record.turns = 3;
  int num_seen = 0, steps = 0;
  std::filesystem::file_time_type time{};
  const auto watch = [&](const Progress&) {
    std::error_code error;
    if (const auto now = std::filesystem::last_write_time(path, error); !error && now != time) {
      time = now;
      ++num_seen;
    }
    return ++steps > 0;
  };
  simulate_and_store(paths, study, DrumState{}, plan.designs[0], 0, "here", watch, {1, 1, 0});
  EXPECT_EQ(num_seen, 2) << "at the ends of turns, apart from the last";

  num_seen = steps = 0;
  const auto ask = [&](const Progress& at) {
    if (steps == 100) request_checkpoint();
    return watch(at);
  };
  simulate_and_store(paths, study, DrumState{}, plan.designs[0], 0, "here", ask, {1, 1, 1e6});
  EXPECT_EQ(num_seen, 1);
}

TEST_F(DesignRunTest, a_result_that_cannot_be_written_is_the_machines_fault_not_the_designs) {
  paths.folder += "/nowhere";
  EXPECT_THROW(simulate_and_store(paths, study, DrumState{}, plan.designs[0], 0, "here", {}), WriteError);
  EXPECT_THROW(simulate_and_store(paths, study, DrumState{}, plan.designs[1], 1, "here", {}), WriteError);
}

TEST_F(DesignRunTest, outcomes_travel_as_text) {
  const DesignOutcome sent{812,      DesignOutcome::Kind::failed, 1.25,     0.1,
                           "node-7", "slots overlap,\nand more",  "went on"};
  const DesignOutcome got = unpack_outcome(pack_outcome(sent));
  EXPECT_EQ(got.index, sent.index);
  EXPECT_EQ(got.kind, sent.kind);
  EXPECT_EQ(got.wall_s, sent.wall_s);
  EXPECT_EQ(got.cpu_s, sent.cpu_s);
  EXPECT_EQ(got.host, sent.host);
  EXPECT_EQ(got.reason, sent.reason);
  EXPECT_EQ(got.note, sent.note);
  EXPECT_THROW(unpack_outcome("what?"), std::runtime_error);
}

}  // namespace
}  // namespace drumsweep

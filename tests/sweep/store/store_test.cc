#include "sweep/store/store.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "core/config/schema.h"
#include "core/io/durable_file.h"
#include "postproc/child_process.h"

namespace drumsweep {
namespace {

namespace fs = std::filesystem;

struct StoreTest : testing::Test {
  const ScratchFolder scratch;
  const std::string folder = scratch.path / "out";
  Study study;
  void SetUp() override {
    study.outlet.opening_angle_deg = 1;
    study.stages = {{"s", "grid", {{"outlet.base_width_m", 0.04, 0.05, 2, {}}}}};
  }

  void put(const std::string& name, const std::string& text) {
    std::ofstream(folder + "/" + name, std::ios::binary) << text;
  }
  PlannedDesign design(std::size_t i) const { return plan_designs(study).designs.at(i); }
  static Recording some_recording() {
    Recording r;
    r.landings.push_back({1.5, 0.1, 0.2, 0.f, 0.f, -1.f, 0.005f, 7, 2});
    r.begin_s = 1;
    r.turns = 2;
    r.hash = 0x0123456789abcdefull;
    return r;
  }
  void expect_refused(const Study& other, const std::string& words) {
    try {
      const Store store(folder, other);
      FAIL() << "was accepted";
    } catch (const MismatchError& error) {
      EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
    }
  }
};

TEST_F(StoreTest, a_recording_comes_back_and_an_absent_one_is_absent) {
  const Store store(folder, study);
  write_recording(store.paths(), study, design(0), some_recording());
  const StoredDesign stored = read_design(store.paths(), study, design(0));
  ASSERT_TRUE(stored.recording.has_value());
  EXPECT_EQ(stored.recording->landings.at(0).ball_id, 7u);
  EXPECT_EQ(stored.recording->hash, 0x0123456789abcdefull);
  const StoredDesign absent = read_design(store.paths(), study, design(1));
  EXPECT_FALSE(absent.recording.has_value());
  EXPECT_FALSE(absent.failure.has_value());
}

TEST_F(StoreTest, a_failure_comes_back_in_one_line_and_a_recording_overrides_it) {
  const Store store(folder, study);
  write_failure(store.paths(), design(0), "two\nlines");
  EXPECT_EQ(read_design(store.paths(), study, design(0)).failure, "two lines");
  write_recording(store.paths(), study, design(0), some_recording());
  EXPECT_FALSE(read_design(store.paths(), study, design(0)).failure.has_value());
}

TEST_F(StoreTest, every_truncation_and_flipped_byte_is_damage_and_another_designs_file_is_foreign) {
  const Store store(folder, study);
  write_recording(store.paths(), study, design(0), some_recording());
  const std::string path = store.paths().recording(design(0).id), whole = read_whole_file(path);
  for (std::size_t i = 0; i < whole.size(); i += 211) {
    write_durably(path, whole.substr(0, i));
    EXPECT_THROW(read_design(store.paths(), study, design(0)), StoreError) << "cut at " << i;
    if (i > 80 && i < 512) continue;  // padding after the header line: no content
    std::string flipped = whole;
    flipped[i] = static_cast<char>(flipped[i] ^ 4);
    write_durably(path, flipped);
    EXPECT_THROW(read_design(store.paths(), study, design(0)), StoreError) << "flipped at " << i;
  }
  write_durably(store.paths().recording(design(1).id), whole);
  EXPECT_THROW(read_design(store.paths(), study, design(1)), MismatchError);
}

TEST_F(StoreTest, leftovers_of_a_kill_are_removed_and_said) {
  { const Store store(folder, study); }
  put("results.csv.123.tmp", "half a ta");
  put("designs/0123456789.h5.9.tmp", "half");
  const Store store(folder, study);
  EXPECT_EQ(store.notes().size(), 2u);
  EXPECT_FALSE(fs::exists(folder + "/results.csv.123.tmp"));
  EXPECT_FALSE(fs::exists(folder + "/designs/0123456789.h5.9.tmp"));
}

TEST_F(StoreTest, a_folder_where_a_run_was_killed_before_it_had_begun_is_still_empty) {
  fs::create_directories(folder);
  put("lock", "pid 1 on nowhere");
  put("study.toml.77.tmp", "# drums");
  EXPECT_NO_THROW(const Store store(folder, study));
}

TEST_F(StoreTest, other_physics_is_refused_with_both_values_and_the_frozen_study_stays) {
  { const Store store(folder, study); }
  const std::string before = read_whole_file(folder + "/study.toml");
  Study other = study;
  other.material.friction = 0.5;
  other.record.turns = 5;
  expect_refused(other, "material.friction: stored 0.7, now 0.5");
  expect_refused(other, "record.turns: stored 2.0, now 5.0");
  EXPECT_EQ(read_whole_file(folder + "/study.toml"), before);
}

TEST_F(StoreTest, evaluation_keys_and_stages_are_taken_over) {
  { const Store store(folder, study); }
  study.objective.weights = "uniform";
  study.name = "renamed";
  study.stages.clear();
  const Store store(folder, study);
  EXPECT_EQ(store.notes().size(), 3u);
  const Study frozen = read_frozen_study(folder);
  EXPECT_EQ(frozen.objective.weights, "uniform");
  EXPECT_EQ(frozen.name, "renamed");
  EXPECT_TRUE(frozen.stages.empty());
}

TEST_F(StoreTest, the_folder_can_be_opened_once_at_a_time) {
  const Store store(folder, study);
  EXPECT_THROW(Store(folder, study), LockHeldError);
}

TEST_F(StoreTest, something_elses_folder_is_refused_before_a_byte_changes) {
  fs::create_directories(folder);
  put("notes.txt", "mine");
  expect_refused(study, "nothing was changed");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder), fs::directory_iterator()), 1);
  EXPECT_THROW(read_frozen_study(folder), InputError);
}

TEST_F(StoreTest, set_aside_keeps_the_bytes) {
  const Store store(folder, study);
  put("designs/x.h5", "damaged bytes");
  set_aside(folder + "/designs/x.h5", "why");
  EXPECT_FALSE(fs::exists(folder + "/designs/x.h5"));
  EXPECT_EQ(read_whole_file(folder + "/designs/x.h5.damaged"), "damaged bytes");
}

}  // namespace
}  // namespace drumsweep

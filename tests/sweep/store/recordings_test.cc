#include "sweep/store/recordings.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "core/io/durable_file.h"
#include "postproc/child_process.h"
#include "support/stored_designs.h"

namespace drumsweep {
namespace {

namespace fs = std::filesystem;

/// Twelve finished designs.
struct RecordingsTest : testing::Test {
  const ScratchFolder scratch;
  const std::string folder = scratch.path;
  Study study = grid_study(3, 4);
  Plan plan = plan_designs(study);
  OutputPaths paths;
  PackingRules small{4, 4, 64u << 20u, 10};
  void SetUp() override {
    paths.folder = folder;
    make_folder(paths.designs());
    for (std::uint32_t i = 0; i < plan.designs.size(); ++i)
      write_recording(paths, study, plan.designs[i], made_up_recording(study, i, 50));
  }

  /// Every design reads as it was written, through an index as the next process makes it.
  void expect_all() {
    RecordingIndex index(paths);
    for (std::uint32_t i = 0; i < plan.designs.size(); ++i) {
      ASSERT_TRUE(index.has_recording(plan.designs[i].id)) << i;
      index.verify(plan.designs[i].id);
      const Recording r = index.read(study, plan.designs[i]).recording.value();
      EXPECT_EQ(r.hash, i);
      EXPECT_EQ(r.landings.size(), 50u);
    }
  }
  std::vector<std::string> some_ids() const {
    std::vector<std::string> ids;
    for (std::size_t i = 0; i < 5; ++i) ids.push_back(plan.designs[i].id);
    return ids;
  }
  std::size_t num_files() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(paths.designs()), {}));
  }
};

TEST_F(RecordingsTest, packing_leaves_few_files_and_all_recordings) {
  RecordingIndex index(paths);
  EXPECT_TRUE(index.pack().empty());  // twelve are not many
  const Checksum before = index.verify(plan.designs[0].id);
  EXPECT_EQ(index.pack(small), std::vector<std::string>{"8 recordings packed into 2 files"});
  EXPECT_EQ(num_files(), 6u);
  EXPECT_EQ(index.num_loose(), 4u);
  expect_all();
  for (const PlannedDesign& design : plan.designs) EXPECT_TRUE(fs::exists(index.file_of(design.id)));
  RecordingIndex again(paths);
  EXPECT_EQ(again.verify(plan.designs[0].id), before);  // the same bytes as far as anybody can tell
}

TEST_F(RecordingsTest, a_size_limit_makes_smaller_packs) {
  RecordingIndex index(paths);
  small.bytes_per_pack = 1;
  EXPECT_EQ(index.pack(small).back(), "8 recordings packed into 8 files");
  expect_all();
  small.most_loose = 0;
  small.most_packs = 1;
  index.pack(small);
  EXPECT_EQ(index.num_loose(), 3u);
}

TEST_F(RecordingsTest, a_crash_after_any_step_of_packing_loses_nothing_and_the_next_packing_tidies_up) {
  const std::vector<std::string> ids = some_ids();
  for (int steps = 0; steps <= 4; ++steps) {
    TearDown();
    SetUp();
    {
      RecordingIndex index(paths);
      // A crash while the pack is written leaves a temporary file, which the next run removes.
      if (steps == 0) write_durably(paths.designs() + "/pack_0001.h5.77.tmp", "half a pack");
      std::string pack;
      if (steps >= 1) pack = index.write_pack(ids);
      if (steps >= 2) {
        EXPECT_TRUE(index.holds(pack, ids));
      }
      // A crash while they are removed leaves some of them.
      if (steps >= 3) index.remove_loose(steps == 3 ? std::vector<std::string>{ids[0], ids[1]} : ids);
    }
    expect_all();
    RecordingIndex next(paths);
    next.pack(small);
    EXPECT_LE(next.num_loose(), small.most_loose);
    expect_all();
  }
}

TEST_F(RecordingsTest, a_pack_that_reads_otherwise_than_written_does_not_replace_the_loose_ones) {
  RecordingIndex index(paths);
  const std::vector<std::string> ids = some_ids();
  const std::string pack = index.write_pack(ids);
  std::string bytes = read_whole_file(pack);
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
  write_durably(pack, bytes);
  EXPECT_FALSE(index.holds(pack, ids));
}

TEST_F(RecordingsTest, a_damaged_pack_is_taken_apart_and_only_what_is_damaged_is_lost) {
  {
    RecordingIndex index(paths);
    index.pack({0, 12, 64u << 20u, 10});
    EXPECT_EQ(index.num_loose(), 0u);
  }
  const std::string pack = paths.designs() + "/pack_0001.h5", whole = read_whole_file(pack);
  std::size_t worst = 0;
  for (std::size_t at = 4096; at < whole.size(); at += whole.size() / 15) {
    for (const auto& entry : fs::directory_iterator(paths.designs())) fs::remove(entry.path());
    std::string flipped = whole;
    flipped[at] = static_cast<char>(flipped[at] ^ 16);
    write_durably(pack, flipped);
    RecordingIndex index(paths);
    std::size_t lost = 0;
    for (std::uint32_t i = 0; i < plan.designs.size(); ++i) {
      const std::string& id = plan.designs[i].id;
      for (int look = 0; look < 2 && index.has_recording(id); ++look) {
        try {
          index.verify(id);
          EXPECT_EQ(index.read(study, plan.designs[i]).recording.value().hash, i);
          break;
        } catch (const StoreError& error) {
          EXPECT_NE(index.set_aside(id, error.what()).find("set aside"), std::string::npos);
        }
      }
      lost += index.has_recording(id) ? 0 : 1;
    }
    EXPECT_TRUE(fs::exists(pack + ".damaged")) << at;
    EXPECT_FALSE(fs::exists(pack)) << at;
    worst = std::max(worst, lost);
    EXPECT_LE(lost, 1u) << at;
  }
  EXPECT_EQ(worst, 1u);
}

TEST_F(RecordingsTest, a_damaged_index_is_survived_by_what_is_behind_it) {
  RecordingIndex(paths).pack({0, 12, 64u << 20u, 10});
  const std::string pack = paths.designs() + "/pack_0001.h5";
  std::string bytes = read_whole_file(pack);
  bytes[200] = static_cast<char>(bytes[200] ^ 1);
  write_durably(pack, bytes);
  RecordingIndex index(paths);
  try {
    index.verify(plan.designs[3].id);
    FAIL();
  } catch (const StoreError& error) {
    index.set_aside(plan.designs[3].id, error.what());
  }
  EXPECT_EQ(index.num_loose(), 12u);
  expect_all();
}

TEST_F(RecordingsTest, a_damaged_loose_one_is_not_packed) {
  const std::string path = paths.recording(plan.designs[2].id);
  std::string bytes = read_whole_file(path);
  bytes[bytes.size() - 3] ^= 1;
  write_durably(path, bytes);
  RecordingIndex index(paths);
  const auto said = index.pack({0, 12, 64u << 20u, 10});
  EXPECT_EQ(said.size(), 2u);
  EXPECT_FALSE(index.has_recording(plan.designs[2].id));
  EXPECT_TRUE(fs::exists(path + ".damaged"));
  EXPECT_TRUE(index.has_recording(plan.designs[3].id));
}

TEST_F(RecordingsTest, a_reader_finds_what_another_process_has_packed_meanwhile) {
  RecordingIndex reader(paths);
  RecordingIndex(paths).pack({0, 12, 64u << 20u, 10});
  EXPECT_EQ(reader.read(study, plan.designs[4]).recording.value().hash, 4u);
}

}  // namespace
}  // namespace drumsweep

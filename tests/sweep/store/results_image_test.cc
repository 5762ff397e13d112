#include "sweep/store/results_image.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "core/io/durable_file.h"
#include "postproc/child_process.h"
#include "support/stored_designs.h"
#include "sweep/store/results.h"

namespace drumsweep {
namespace {

namespace fs = std::filesystem;

struct ResultsImageTest : testing::Test {
  const ScratchFolder scratch;
  const std::string folder = scratch.path;
  Study study = grid_study(3, 2);
  Plan plan = plan_designs(study);
  OutputPaths paths;
  void SetUp() override {
    paths.folder = folder;
    make_folder(paths.designs());
    for (std::uint32_t i = 0; i < plan.designs.size(); ++i)
      write_recording(paths, study, plan.designs[i], made_up_recording(study, i, 500));
  }

  /// The table as a run makes it, and results.h5 with it.
  ResultTable write_image(RecordingIndex& index, bool steady = true) const {
    ResultTable table{plan.columns, {}};
    for (const PlannedDesign& design : plan.designs)
      table.rows.push_back(stored_row(index, {}, study, design, steady).value());
    const std::vector<ProvenanceLine> lines = {{"started", plan.designs[1].id, 1, 0, "", 0, 0, "", ""},
                                               {"stopped", plan.designs[1].id, 1, 0, "node1", 2, 1, "", ""},
                                               {"started", plan.designs[1].id, 2, 0, "", 0, 0, "", ""},
                                               {"done", plan.designs[1].id, 2, 3, "node2", 4, 3, "", ""}};
    write_durably(paths.results_image(), pack_results(study, table, steady, index, lines));
    return table;
  }
};

TEST_F(ResultsImageTest, holds_the_table_bit_for_bit_in_the_columns_of_the_csv) {
  RecordingIndex index(paths);
  ResultTable table = write_image(index);
  table.rows[4] = failed_row(plan.designs[4], "an \"odd\", reason");
  const std::string bytes = pack_results(study, table, true, index, {});
  EXPECT_EQ(to_csv(unpack_results(bytes, "it")), to_csv(table));
  EXPECT_TRUE(bytes == pack_results(study, table, true, index, {}));
}

TEST_F(ResultsImageTest, has_hosts_attempts_and_times) {
  RecordingIndex index(paths);
  write_image(index);
  const Hdf5Reader file(read_whole_file(paths.results_image()), "results", 1, "results.h5");
  EXPECT_EQ(file.texts("provenance/host").at(1), "node2");
  EXPECT_EQ(file.int64s("provenance/attempts").at(1), 2);
  EXPECT_EQ(file.doubles("provenance/wall_s").at(1), 6);
  EXPECT_EQ(file.int64s("provenance/attempts").at(0), 0);
  EXPECT_NE(file.texts("study").at(0).find("[[stage]]"), std::string::npos);
  EXPECT_EQ(file.integer("seed"), study.seed);
}

TEST_F(ResultsImageTest, standard_tools_show_columns_with_units) {
  if (std::system("h5dump --version >/dev/null 2>&1") != 0) GTEST_SKIP() << "h5dump (hdf5-tools) is not installed";
  RecordingIndex index(paths);
  write_image(index);
  const auto shows = [&](const std::string& options, const std::string& text) {
    return std::system(("h5dump " + options + " " + paths.results_image() + " | grep -q '" + text + "'").c_str()) == 0;
  };
  EXPECT_TRUE(shows("-d /results/state", "\"done\", \"done\""));
  EXPECT_TRUE(shows("-a /results/f_m/unit", "(0): \"m\""));
  EXPECT_TRUE(shows("-a /results/columns", "\"design_id\", \"stage\", \"state\""));
}

TEST_F(ResultsImageTest, rows_are_known_again_only_where_recording_and_settings_are_the_same) {
  RecordingIndex index(paths);
  const ResultTable table = write_image(index);
  const std::string path = paths.results_image();
  const PlannedDesign& design = plan.designs[2];
  const Checksum checksum = index.verify(design.id);
  const KnownRows known(path, study, true);
  EXPECT_EQ(known.size(), 6u);
  EXPECT_EQ(known.find(design, checksum).value().f_m, table.rows[2].f_m);
  EXPECT_FALSE(known.find(design, {checksum.crc + 1, checksum.bytes}).has_value());
  EXPECT_FALSE(known.find(plan.designs[1], checksum).has_value());

  Study other = study;
  other.name = "renamed";
  EXPECT_EQ(KnownRows(path, other, true).size(), 6u);
  other.objective.weights = "uniform";
  EXPECT_EQ(KnownRows(path, other, true).size(), 0u);
  EXPECT_EQ(KnownRows(path, study, false).size(), 0u);
  EXPECT_EQ(KnownRows(path + ".gone", study, true).size(), 0u);

  std::string bytes = read_whole_file(path);
  bytes[bytes.size() / 2] ^= 1;
  write_durably(path, bytes);
  EXPECT_EQ(KnownRows(path, study, true).size(), 0u);
}

TEST_F(ResultsImageTest, rows_that_are_not_what_the_recordings_give_are_not_believed) {
  RecordingIndex index(paths);
  ResultTable table = write_image(index);
  KnownRows known(paths.results_image(), study, true);
  known.confirm(index, study, plan, true);
  EXPECT_EQ(known.size(), 6u);

  for (ResultRow& row : table.rows) row.f_m *= 1.0000001;
  write_durably(paths.results_image(), pack_results(study, table, true, index, {}));
  KnownRows wrong(paths.results_image(), study, true);
  EXPECT_EQ(wrong.size(), 6u);
  wrong.confirm(index, study, plan, true);
  EXPECT_EQ(wrong.size(), 0u);
}

TEST_F(ResultsImageTest, a_damaged_recording_is_found_although_its_row_is_known) {
  RecordingIndex index(paths);
  write_image(index);
  const KnownRows known(paths.results_image(), study, true);
  const std::string path = paths.recording(plan.designs[3].id);
  std::string bytes = read_whole_file(path);
  bytes[bytes.size() - 9] ^= 1;
  write_durably(path, bytes);
  RecordingIndex next(paths);
  EXPECT_THROW(stored_row(next, known, study, plan.designs[3], true), StoreError);
  EXPECT_EQ(stored_row(next, known, study, plan.designs[2], true).value().state, "done");
}

}  // namespace
}  // namespace drumsweep

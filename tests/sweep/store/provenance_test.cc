#include "sweep/store/provenance.h"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>
#include <fstream>

#include "core/io/durable_file.h"

namespace drumsweep {
namespace {

struct ProvenanceTest : testing::Test {
  std::string folder, path;
  void SetUp() override {
    std::string pattern = (std::filesystem::temp_directory_path() / "drumsweep-provenance-XXXXXX").string();
    folder = ::mkdtemp(pattern.data());
    path = folder + "/provenance.csv";
  }
  void TearDown() override { std::filesystem::remove_all(folder); }
};

TEST_F(ProvenanceTest, lines_come_back_and_attempts_are_counted_over_runs) {
  {
    Provenance first(path);
    first.add({"started", "aaaaaaaaaa", 1, 3, "node1", 0, 0, "", ""});
    first.add({"stopped", "aaaaaaaaaa", 1, 3, "node1", 2.5, 2.25, "", ""});
  }
  Provenance second(path);
  second.add({"started", "aaaaaaaaaa", second.attempts("aaaaaaaaaa") + 1, 0, "", 0, 0, "", ""});
  const auto lines = read_provenance(path);
  ASSERT_EQ(lines.size(), 3u);
  EXPECT_EQ(lines[1].event, "stopped");
  EXPECT_EQ(lines[1].rank, 3);
  EXPECT_EQ(lines[1].host, "node1");
  EXPECT_EQ(lines[1].cpu_s, 2.25);
  EXPECT_EQ(lines[2].attempt, 2);
  EXPECT_EQ(second.attempts("aaaaaaaaaa"), 2);
  EXPECT_EQ(second.attempts("bbbbbbbbbb"), 0);
}

TEST_F(ProvenanceTest, a_torn_last_line_is_ignored_wherever_it_is_torn_and_does_not_spoil_the_next) {
  { Provenance(path).add({"started", "aaaaaaaaaa", 1, 0, "n", 0, 0, "", ""}); }
  const std::string header_and_line = read_whole_file(path);
  const std::size_t begin = header_and_line.find('\n') + 1;
  for (std::size_t cut = begin + 1; cut < header_and_line.size(); ++cut) {
    write_durably(path, header_and_line.substr(0, cut));
    Provenance again(path);
    again.add({"started", "bbbbbbbbbb", 1, 0, "n", 0, 0, "", ""});
    const auto lines = read_provenance(path);
    ASSERT_FALSE(lines.empty());
    EXPECT_EQ(lines.back().design_id, "bbbbbbbbbb") << "cut at " << cut;
  }
}

TEST_F(ProvenanceTest, a_folder_that_is_not_there_is_a_write_error_with_the_path) {
  try {
    Provenance(folder + "/nowhere/provenance.csv");
    FAIL();
  } catch (const WriteError& error) {
    EXPECT_NE(std::string(error.what()).find("nowhere/provenance.csv"), std::string::npos);
  }
}

}  // namespace
}  // namespace drumsweep

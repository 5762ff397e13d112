#include "sweep/store/provenance.h"

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>

#include "core/io/durable_file.h"
#include "postproc/child_process.h"

namespace drumsweep {
namespace {

struct ProvenanceTest : testing::Test {
  const ScratchFolder scratch;
  const std::string folder = scratch.path, path = folder + "/provenance.csv";
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

TEST_F(ProvenanceTest, a_history_tells_open_crashed_and_lost_attempts_and_retry_forgets_them) {
  Provenance ledger(path);
  const auto add = [&](const char* event, const char* id, int attempt) {
    ledger.add({event, id, attempt, 0, "n", 0, 0, "", ""});
  };
  add("started", "aaaaaaaaaa", 1);
  add("started", "bbbbbbbbbb", 1);
  EXPECT_EQ(ledger.open_designs(), (std::vector<std::string>{"aaaaaaaaaa", "bbbbbbbbbb"}));
  add("crashed", "aaaaaaaaaa", 1);
  add("lost", "bbbbbbbbbb", 1);
  add("started", "bbbbbbbbbb", 2);
  add("aborted", "bbbbbbbbbb", 2);
  add("started", "bbbbbbbbbb", 3);
  add("lost", "bbbbbbbbbb", 3);
  const Provenance again(path);
  EXPECT_TRUE(again.open_designs().empty());
  EXPECT_EQ(again.history("aaaaaaaaaa").crashes, 1);
  EXPECT_EQ(again.history("bbbbbbbbbb").lost, (std::vector<int>{1, 3}));
  EXPECT_EQ(again.history("bbbbbbbbbb").attempts, 3);
  add("retry", "aaaaaaaaaa", 1);
  add("stopped", "bbbbbbbbbb", 4);
  EXPECT_EQ(ledger.history("aaaaaaaaaa").crashes, 0);
  EXPECT_TRUE(ledger.history("bbbbbbbbbb").lost.empty());
}

TEST_F(ProvenanceTest, a_hundred_thousand_lines_are_answered_from_an_index) {
  {
    std::ofstream stream(path);
    stream << "time_utc,event,design_id,attempt,rank,host,wall_s,cpu_s,program_version,ranks\n";
    for (int i = 0; i < 100000; ++i) stream << "t,started," << 1000000000 + i << ",1,0,n,0,0,v,0\n";
  }
  const Provenance ledger(path);
  // A search through the lines for each would take minutes.
  int sum = 0;
  for (int i = 0; i < 100000; ++i) sum += ledger.attempts(std::to_string(1000000000 + i));
  EXPECT_EQ(sum, 100000);
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

/// drumsweep doctor, alone and with ranks, and drumsweep slurm as far as it needs no Slurm.
#include <gtest/gtest.h>

#include "cli/mini_json.h"
#include "cli/program.h"

namespace drumsweep {
namespace {

/// Levels of the findings on a subject.
std::vector<std::string> levels(const Json& report, const std::string& subject) {
  std::vector<std::string> found;
  for (const Json& f : report["findings"].list)
    if (f["subject"].text == subject) found.push_back(f["level"].text);
  return found;
}

using Levels = std::vector<std::string>;

TEST(Doctor, ranks_see_each_other_the_folder_and_its_lock) {
  const TestFolder folder;
  Program program(folder, under_mpirun(3, {"doctor", "--json", "-o", "not/there/yet"}));
  ASSERT_EQ(program.wait(), 0) << program.out() << program.err();
  const Json report = JsonReader::parse(program.out());
  EXPECT_EQ(report["usable"].number, 1);
  EXPECT_EQ(report["ranks"].number, 3);
  EXPECT_GT(report["durable_write_ms"].number, 0);
  EXPECT_GT(report["round_trip_us"].number, 0);
  for (const char* subject : {"ranks", "writing", "locking", "shared folder"})
    EXPECT_EQ(levels(report, subject), Levels{"ok"}) << subject << "\n" << program.out();
  EXPECT_FALSE(std::filesystem::exists(folder / "not")) << "nothing stays behind";
  EXPECT_EQ(count_files(folder.path, ".lock") + count_files(folder.path, ".probe"), 0u);
}

TEST(Doctor, copies_that_do_not_know_each_other_are_a_problem_and_only_the_first_speaks) {
  const TestFolder folder;
  for (const char* rank : {"0", "1"}) {
    Program program(folder, {"env", std::string("PMI_RANK=") + rank, "PMI_SIZE=2", DRUMSWEEP_BINARY, "doctor"});
    EXPECT_EQ(program.wait(), 2);
    EXPECT_EQ(program.out().find("do not see each other") != std::string::npos, std::string(rank) == "0");
    EXPECT_EQ(program.out().empty(), std::string(rank) == "1");
  }
}

TEST(Doctor, a_folder_that_cannot_be_written_to_is_a_problem) {
  const TestFolder folder;
  const Finished result = drumsweep(folder, {"doctor", "--json", "-o", "/proc/out"});
  EXPECT_EQ(result.code, 2);
  EXPECT_EQ(levels(JsonReader::parse(result.out), "writing"), Levels{"problem"});
}

TEST(Slurm_script, wrong_input_is_refused_and_idle_ranks_are_said) {
  const TestFolder folder;
  write_text(folder / "study.toml", tiny_study(2, 2));
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases = {
      {{"slurm", "nowhere.toml", "-N", "1", "-t", "10"}, "nowhere.toml"},
      {{"slurm", "study.toml", "-N", "0", "-t", "10"}, "--nodes"},
      {{"slurm", "study.toml", "-N", "1", "-t", "soon"}, "soon"},
      {{"slurm", "study.toml", "-N", "1", "-t", "1"}, "--signal-before"},
      {{"slurm", "study.toml", "-N", "1", "-t", "10", "-p", "a b"}, "--partition"},
      {{"slurm", "study.toml", "-N", "1", "-t", "10", "-o", "no/such"}, "does not exist"},
  };
  for (const auto& [words, must_name] : cases) {
    const Finished result = drumsweep(folder, words);
    EXPECT_EQ(result.code, 2);
    EXPECT_EQ(result.out, "");
    EXPECT_NE(result.err.find(must_name), std::string::npos) << result.err;
  }
  const Finished many = drumsweep(
      folder, {"slurm", "study.toml", "-N", "3", "-t", "10", "--tasks-per-node", "2", "--module", "openmpi/4"});
  EXPECT_EQ(many.code, 0);
  EXPECT_NE(many.err.find("6 ranks for 4 designs"), std::string::npos) << many.err;
  EXPECT_NE(many.out.find("\nmodule load openmpi/4\n"), std::string::npos) << many.out;
}

}  // namespace
}  // namespace drumsweep

/// Keys set on the command line, folders compared by them, and the reproduction that is made of both.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <sstream>

#include "cli/program.h"

namespace drumsweep {
namespace {

TEST(Sweep, keys_set_on_the_command_line_are_part_of_the_study_and_folders_are_compared_by_them) {
  const TestFolder folder;
  write_text(folder / "study.toml", tiny_study());
  const std::vector<std::string> changed = {"run", "study.toml", "--set", "solver.iterations=11", "-o", "eleven"};
  ASSERT_EQ(drumsweep(folder, {"run", "study.toml", "-o", "ten"}).code, 0);
  ASSERT_EQ(drumsweep(folder, changed).code, 0);
  EXPECT_NE(file_text(folder / "ten/results.csv"), file_text(folder / "eleven/results.csv"));
  EXPECT_EQ(drumsweep(folder, changed).code, 0);
  const Finished refused = drumsweep(folder, {"run", "study.toml", "-o", "eleven"});
  EXPECT_EQ(refused.code, 5);
  EXPECT_NE(refused.err.find("solver.iterations"), std::string::npos) << refused.err;

  const Finished both = drumsweep(folder, {"compare", "ten", "eleven", "-o", "both.csv"});
  ASSERT_EQ(both.code, 0) << both.err;
  const std::string csv = file_text(folder / "both.csv");
  EXPECT_EQ(csv.rfind("folder,solver.iterations,", 0), 0u) << csv;
  EXPECT_NE(csv.find("\neleven,11,"), std::string::npos) << csv;
  EXPECT_NE(both.out.find("eleven          11"), std::string::npos) << both.out;
  EXPECT_EQ(drumsweep(folder, {"compare", "ten", "none"}).code, 2);
  const std::string frozen = file_text(folder / "ten/study.toml");
  EXPECT_EQ(drumsweep(folder, {"compare", "ten", "-o", "ten/study.toml"}).code, 2);
  EXPECT_EQ(file_text(folder / "ten/study.toml"), frozen);
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  EXPECT_EQ(drumsweep(folder, {"compare", "ten", "-o", "pipe"}).code, 2);
}

TEST(Papers, every_run_of_the_reproduction_is_a_valid_study_with_these_keys) {
  const TestFolder folder;
  const std::string schedules = DRUMSWEEP_SOURCE_DIR "/schedules";
  for (const char* part : {"samples", "line", "holdup", "convergence", "adaptive", "pellets"}) {
    Program list(folder, {"bash", schedules + "/reproduce.sh", part, "--list"});
    ASSERT_EQ(list.wait(), 0) << list.err();
    std::istringstream lines(list.out());
    int num_lines = 0;
    for (std::string line; std::getline(lines, line); ++num_lines) {
      std::istringstream words(line);
      std::string name, study;
      words >> name >> study;
      std::vector<std::string> check = {"check", schedules + "/" + study};
      for (std::string key; words >> key;) check.insert(check.end(), {"--set", key});
      const Finished checked = drumsweep(folder, check);
      EXPECT_EQ(checked.code, 0) << line << ": " << checked.err;
    }
    EXPECT_GE(num_lines, 1) << part;
  }
}

}  // namespace
}  // namespace drumsweep

#include "sweep/job_script.h"

#include <gtest/gtest.h>

#include "core/config/schema.h"

namespace drumsweep {
namespace {

JobOptions some_job() {
  JobOptions options;
  options.program = "/opt/drumsweep";
  options.study_path = "/home/me/study.toml";
  options.output = "/scratch/out";
  options.title = "mine";
  options.time = "1:00:00";
  return options;
}

bool has_line(const std::string& script, const std::string& line) {
  return script.find("\n" + line + "\n") != std::string::npos;
}

TEST(Slurm_time, is_read_as_slurm_does) {
  const std::vector<std::pair<std::string, std::int64_t>> cases = {
      {"90", 5400},     {"0:30", 30},      {"1:30", 90},         {"24:00:00", 86400},
      {"2-12", 216000}, {"1-0:10", 87000}, {"1-00:00:01", 86401}};
  for (const auto& [text, seconds] : cases) EXPECT_EQ(slurm_time_s(text), seconds) << text;
  for (const char* text : {"", "0", "-5", "1h", "1:2:3:4", "1-", "1 2", "400-0", "99999999999999999999", "UNLIMITED"})
    EXPECT_THROW(slurm_time_s(text), InputError) << text;
}

TEST(Job_script, every_place_is_filled_and_options_appear) {
  JobOptions options = some_job();
  options.tasks_per_node = 64;
  options.partition = "long";
  const std::string script = job_script(options);
  for (const char* line :
       {"#SBATCH --nodes=1", "#SBATCH --ntasks-per-node=64", "#SBATCH --time=1:00:00", "#SBATCH --partition=long",
        "#SBATCH --signal=B:USR2@120", "#SBATCH --requeue", "#SBATCH --open-mode=append",
        "#SBATCH --output=\"/scratch/out.log\"", "max_requeues=10", "ranks_per_node=64"})
    EXPECT_TRUE(has_line(script, line)) << line;
  // What is left of @ stands for an array or the seconds.
  EXPECT_EQ(script.find("@title@"), std::string::npos);
  EXPECT_EQ(script.find('@', script.find("USR2@120") + 5), script.find("[@]") + 1);
  EXPECT_EQ(script.rfind("#!/bin/bash\n", 0), 0u);
}

TEST(Job_script, without_a_number_of_tasks_it_takes_whole_nodes) {
  const std::string script = job_script(some_job());
  EXPECT_TRUE(has_line(script, "#SBATCH --exclusive"));
  EXPECT_TRUE(has_line(script, "ranks_per_node=$SLURM_CPUS_ON_NODE"));
}

TEST(Job_script, names_and_paths_cannot_become_commands) {
  JobOptions options = some_job();
  options.title = "a\nrm -rf $HOME\n#SBATCH --nodes=99 @out@";
  options.study_path = "/home/it's $(me)/@title@.toml";
  options.output = "/scratch/100%";
  const std::string script = job_script(options);
  EXPECT_EQ(script.find("\nrm"), std::string::npos);
  EXPECT_EQ(script.find("\n#SBATCH --nodes=99"), std::string::npos);
  EXPECT_TRUE(has_line(script, "#SBATCH --job-name=a_rm_-rf__HOME__SBATCH_--nodes_99__out_")) << script;
  EXPECT_TRUE(has_line(script, "study='/home/it'\\''s $(me)/@title@.toml'")) << script;
  EXPECT_TRUE(has_line(script, "#SBATCH --output=\"/scratch/100%%.log\"")) << script;

  options.study_path = "/home/a\nb.toml";
  EXPECT_THROW(job_script(options), InputError);
  options = some_job();
  options.account = "a;b";
  EXPECT_THROW(job_script(options), InputError);
}

TEST(Job_script, keys_set_on_the_command_line_are_set_in_every_start) {
  JobOptions options = some_job();
  options.changes = {"solver.iterations=50", "name=it's"};
  const std::string script = job_script(options);
  const std::string run = R"("$program" run "$study" --set 'solver.iterations=50' --set 'name=it'\''s' -o)";
  const std::size_t first = script.find(run);
  ASSERT_NE(first, std::string::npos) << script;
  EXPECT_NE(script.find(run, first + 1), std::string::npos) << script;
}

TEST(Job_script, a_signal_that_would_come_before_the_start_is_refused) {
  JobOptions options = some_job();
  options.time = "2";
  EXPECT_THROW(job_script(options), InputError);
}

}  // namespace
}  // namespace drumsweep

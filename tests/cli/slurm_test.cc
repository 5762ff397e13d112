/// The printed job script in a real Slurm: time limit, requeue, lost ranks, refusals.
#include <gtest/gtest.h>

#include "cli/local_slurm.h"

namespace drumsweep {
namespace {

// In the body of a test, as GTEST_SKIP returns from there.
#define NEEDS_SLURM() \
  if (const std::string why = LocalSlurm::missing(); !why.empty()) GTEST_SKIP() << "NOT TESTED: " << why

void print_job(const TestFolder& folder, const std::string& study) {
  write_text(folder / "study.toml", study);
  const Finished printed =
      drumsweep(folder, {"slurm", "study.toml", "-N", "1", "-t", "10", "--tasks-per-node", "2", "-o", "out"});
  ASSERT_EQ(printed.code, 0) << printed.err;
  write_text(folder / "job.sh", printed.out);
}

/// Table of the study of print_job() without any interruption.
std::string undisturbed_table(const TestFolder& folder) {
  Program program(folder, under_mpirun(2, {"run", "study.toml", "-o", "reference"}));
  EXPECT_EQ(program.wait(), 0) << program.err();
  return file_text(folder / "reference/results.csv");
}

/// Process ids of the ranks: the holder of the lock and those with the same parent.
std::vector<pid_t> ranks_of(const std::string& out) {
  std::ifstream lock(out + "/lock");
  std::string word;
  pid_t first = 0;
  lock >> word >> first;  // "pid N on ..."
  std::ifstream stat("/proc/" + std::to_string(first) + "/stat");
  std::string parent;
  stat >> word >> word >> word >> parent;
  std::ifstream children("/proc/" + parent + "/task/" + parent + "/children");
  std::vector<pid_t> ranks;
  for (pid_t rank = 0; children >> rank;) ranks.push_back(rank);
  return ranks;
}

bool said(const std::string& log, const std::string& text) { return log.find(text) != std::string::npos; }

TEST(Slurm, a_job_that_reaches_its_time_limit_is_requeued_and_gives_the_undisturbed_table) {
  NEEDS_SLURM();
  const TestFolder folder;
  print_job(folder, tiny_study(40, 2));
  if (HasFatalFailure()) return;
  const std::string table = undisturbed_table(folder);

  // Slurm's shortest limit is a minute and it looks every 30 s: the ranks stand still meanwhile, to save CPU time.
  LocalSlurm slurm;
  const std::string job = slurm.submit(folder, {"--time=1", "--signal=B:USR2@50", "job.sh"});
  const auto log = [&] { return file_text(folder / "out.log"); };
  ASSERT_TRUE(wait_until([&] { return count_files(folder / "out/designs", ".h5") > 0; })) << log();
  const std::vector<pid_t> ranks = ranks_of(folder / "out");
  ASSERT_EQ(ranks.size(), 2u) << log();
  for (const pid_t rank : ranks) ::kill(rank, SIGSTOP);
  const auto signalled = [&] { return said(log(), "the time limit is near, stopping"); };
  EXPECT_TRUE(slurm.eventually(signalled)) << log();
  for (const pid_t rank : ranks) ::kill(rank, SIGCONT);

  EXPECT_LT(count_files(folder / "out/designs", ".h5"), 4u) << "nothing was left to do";
  ASSERT_TRUE(slurm.restart_requeued(job)) << log();
  EXPECT_EQ(slurm.wait_for_end(job), "COMPLETED") << log();
  EXPECT_EQ(slurm.about(job, "Restarts"), "1");
  EXPECT_EQ(file_text(folder / "out/results.csv"), table);
  // Appended: both starts are in it, the doctor's word once.
  for (const char* text :
       {"start 1: on n1", "2 see each other", "stopped early", "start 2: on n1", "finished, exit code 0"})
    EXPECT_TRUE(said(log(), text)) << text << "\n" << log();
  EXPECT_EQ(log().find("see each other"), log().rfind("see each other"));

  // Submitted again, a finished study is left as it is.
  const std::string again = slurm.submit(folder, {"job.sh"});
  EXPECT_EQ(slurm.wait_for_end(again), "COMPLETED") << log();
  EXPECT_EQ(file_text(folder / "out/results.csv"), table);
}

TEST(Slurm, a_killed_rank_leads_back_into_the_queue_and_a_cancelled_job_does_not) {
  NEEDS_SLURM();
  const TestFolder folder;
  print_job(folder, tiny_study(80, 2));
  if (HasFatalFailure()) return;
  LocalSlurm slurm;
  const std::string job = slurm.submit(folder, {"job.sh"});
  const auto log = [&] { return file_text(folder / "out.log"); };
  ASSERT_TRUE(slurm.eventually([&] { return count_files(folder / "out/designs", ".h5") > 0; })) << log();
  for (const pid_t rank : ranks_of(folder / "out")) ::kill(rank, SIGKILL);
  ASSERT_TRUE(slurm.restart_requeued(job)) << log();
  ASSERT_TRUE(slurm.eventually([&] { return said(log(), "are there already"); })) << log();

  slurm.ask({"scancel", job});
  EXPECT_EQ(slurm.wait_for_end(job), "CANCELLED") << log();
  EXPECT_TRUE(slurm.eventually([&] { return said(log(), "not finished; submit this script again"); })) << log();
  EXPECT_EQ(slurm.about(job, "Restarts"), "1");
  EXPECT_EQ(slurm.ask({"squeue", "-h"}), "");
}

TEST(Slurm, a_job_that_would_fail_again_is_not_requeued) {
  NEEDS_SLURM();
  const TestFolder folder;
  print_job(folder, tiny_study(2, 2));
  if (HasFatalFailure()) return;
  ASSERT_EQ(drumsweep(folder, {"run", "study.toml", "-o", "out"}).code, 0);
  LocalSlurm slurm;
  const auto log = [&] { return file_text(folder / "out.log"); };
  // Other physics than what is stored.
  write_text(folder / "study.toml", replaced(tiny_study(2, 3), "seed = 7", "seed = 8"));
  const std::string refused = slurm.submit(folder, {"job.sh"});
  EXPECT_EQ(slurm.wait_for_end(refused), "FAILED") << log();
  EXPECT_EQ(slurm.about(refused, "ExitCode"), "5:0") << log();
  EXPECT_TRUE(said(log(), "starting again would not help")) << log();

  // A launcher that does not work.
  write_text(folder / "job.sh", replaced(file_text(folder / "job.sh"), "launch=(mpirun", "launch=(no-such-mpirun"));
  const std::string unfit = slurm.submit(folder, {"job.sh"});
  EXPECT_EQ(slurm.wait_for_end(unfit), "FAILED") << log();
  EXPECT_EQ(slurm.about(unfit, "ExitCode"), "2:0") << log();
  EXPECT_EQ(slurm.about(unfit, "Restarts"), "0");

  // Copies that do not know each other: the doctor says so, once, before MPI ends them.
  Program copies(folder, {"srun", "--ntasks=2", "--mpi=none", DRUMSWEEP_BINARY, "doctor"});
  EXPECT_EQ(copies.wait(), 2) << copies.out();
  EXPECT_TRUE(said(copies.out(), "srun has started 2 processes without PMIx")) << copies.out();
  EXPECT_EQ(copies.out().find("NOT USABLE"), copies.out().rfind("NOT USABLE"));
}

}  // namespace
}  // namespace drumsweep

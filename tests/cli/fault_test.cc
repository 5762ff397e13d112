/// What a sweep survives, by the real program: dying ranks, signals at any time, designs that kill their process, torn
/// ledgers. The table must be that of an uninterrupted run, bit for bit, and nothing that was done is done again.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <map>
#include <random>
#include <set>
#include <sstream>

#include "cli/program.h"
#include "sweep/store/provenance.h"

namespace drumsweep {
namespace {

using Words = std::vector<std::string>;

Words run_words(const std::string& out, const Words& more = {}) {
  Words words = {"run", "study.toml", "-o", out};
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

Finished run_alone(const TestFolder& folder, const std::string& out, const Words& more = {}) {
  return drumsweep(folder, run_words(out, more));
}

/// With a test fault (test_fault.h) in the environment.
Words with_fault(const std::string& fault, const Words& words) {
  Words all = {"env", "DRUMSWEEP_TEST_FAULT=" + fault};
  all.insert(all.end(), words.begin(), words.end());
  return all;
}

Words under_mpirun_with_recovery(int ranks, const Words& arguments) {
  Words words = under_mpirun(ranks, arguments);
  const Words flags = {"--enable-recovery", "--mca", "orte_abort_on_non_zero_status", "0"};
  words.insert(words.begin() + 1, flags.begin(), flags.end());
  return words;
}

/// Process ids of the ranks under an mpirun, in order.
std::vector<pid_t> ranks_of(pid_t mpirun) {
  const std::string id = std::to_string(mpirun);
  std::istringstream list(file_text("/proc/" + id + "/task/" + id + "/children"));
  std::vector<pid_t> ranks;
  for (pid_t rank = 0; list >> rank;) ranks.push_back(rank);
  return ranks;
}

std::size_t count_events(const std::string& out, const std::string& event) {
  const auto lines = read_provenance(out + "/provenance.csv");
  return static_cast<std::size_t>(
      std::count_if(lines.begin(), lines.end(), [&](const ProvenanceLine& l) { return l.event == event; }));
}

/// Two ranks are in the middle of designs.
bool under_way(const TestFolder& folder) {
  if (count_events(folder / "out", "started") < 2) return false;
  sleep_ms(60);
  return true;
}

/// Table and recordings are those of the reference.
void expect_same_results(const std::string& reference, const std::string& out) {
  EXPECT_EQ(file_text(reference + "/results.csv"), file_text(out + "/results.csv"));
  for (const auto& entry : std::filesystem::directory_iterator(reference + "/designs")) {
    const std::string name = entry.path().filename().string();
    if (name.ends_with(".h5")) {
      EXPECT_TRUE(file_text(entry.path().string()) == file_text(out + "/designs/" + name)) << name << " differs";
    }
  }
  EXPECT_EQ(count_files(out + "/designs", ".part"), 0u);
}

TEST(Fault, a_design_that_crashes_its_process_twice_is_quarantined_with_its_input_and_all_others_complete) {
  const TestFolder folder;
  write_text(folder / "study.toml", tiny_study(4, 2));
  for (const char* fault : {"segv:1", "abort:1"}) {
    const std::string out = folder / fault;
    std::vector<int> codes;
    for (int i = 0; i < 3; ++i) {
      Program program(folder, with_fault(fault, under_mpirun(2, run_words(fault))));
      codes.push_back(program.wait());
    }
    EXPECT_NE(codes[0], 0);
    EXPECT_NE(codes[1], 0);
    EXPECT_EQ(codes[2], 4);
    const std::string table = file_text(out + "/results.csv"), name = fault[0] == 's' ? "SIGSEGV" : "SIGABRT";
    EXPECT_NE(table.find("quarantined: crashed its process 2 times (" + name + ")"), std::string::npos) << table;
    EXPECT_EQ(count_files(out + "/designs", ".h5"), 3u);
    EXPECT_EQ(count_files(out + "/quarantine", ".toml"), 1u);
  }

  // Its input simulates the same design from the same warm drum.
  std::string input;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "segv:1/quarantine"))
    if (entry.path().extension() == ".toml") input = file_text(entry.path().string());
  const std::size_t begin = input.find("drumsweep simulate ") + 10;
  std::istringstream command(input.substr(begin, input.find('\n', begin) - begin));
  Words words;
  for (std::string word; command >> word;) words.push_back(word);
  const Finished again = drumsweep(folder, words);
  ASSERT_EQ(again.code, 0) << again.err;
  EXPECT_NE(again.err.find("warm drum: "), std::string::npos) << again.err;

  // Taken back, it is simulated as any other; the recording is the one that the command gave.
  EXPECT_EQ(run_alone(folder, "segv:1").code, 4);
  EXPECT_EQ(run_alone(folder, "segv:1", {"--retry", "failed"}).code, 4);
  EXPECT_EQ(run_alone(folder, "segv:1", {"--retry", "failed,lost"}).code, 0);
  ASSERT_EQ(run_alone(folder, "reference").code, 0);
  expect_same_results(folder / "reference", folder / "segv:1");
}

TEST(Fault, a_hang_is_ended_and_counts_as_a_crash_and_a_sleep_does_not) {
  const TestFolder folder;
  write_text(folder / "study.toml", tiny_study(4, 2));
  std::vector<int> codes;
  for (int i = 0; i < 3; ++i) {
    Program program(folder, with_fault("hang:1", under_mpirun(2, run_words("out", {"--hang", "2"}))));
    codes.push_back(program.wait());
    if (i < 2) {
      EXPECT_NE(program.err().find("no step for 2 s: it hangs"), std::string::npos) << program.err();
    }
  }
  EXPECT_NE(codes[0], 0);
  EXPECT_NE(codes[1], 0);
  EXPECT_EQ(codes[2], 4);
  const std::string table = file_text(folder / "out/results.csv");
  EXPECT_NE(table.find("quarantined: crashed its process 2 times (hang)"), std::string::npos) << table;
  EXPECT_EQ(count_files(folder / "out/designs", ".h5"), 3u);

  Program program(folder, {DRUMSWEEP_BINARY, "run", "study.toml", "-o", "asleep", "--hang", "2"});
  for (int i = 0; i < 2000 && !std::filesystem::exists(folder / "asleep/provenance.csv"); ++i) sleep_ms(5);
  program.signal(SIGSTOP);
  sleep_ms(3000);
  program.signal(SIGCONT);
  EXPECT_EQ(program.wait(), 0);
}

TEST(Fault, a_design_whose_process_is_killed_five_times_without_getting_further_is_quarantined) {
  const TestFolder folder;
  write_text(folder / "study.toml", tiny_study(4, 2));
  int runs = 0;
  for (int code = -1; code != 4 && runs < 10; ++runs) {
    Program program(folder, with_fault("kill:2", {DRUMSWEEP_BINARY, "run", "study.toml", "-o", "out"}));
    code = program.wait();
  }
  EXPECT_EQ(runs, 6);
  EXPECT_EQ(count_events(folder / "out", "lost"), 5u);
  EXPECT_EQ(count_files(folder / "out/designs", ".h5"), 3u);
  EXPECT_NE(file_text(folder / "out/results.csv").find("killed 5 times in a row"), std::string::npos);
}

TEST(Fault, a_result_that_is_not_a_number_or_an_exception_is_a_failed_row_and_retry_takes_it_back) {
  const TestFolder folder;
  write_text(folder / "study.toml", tiny_study(2, 2));
  Program program(folder, with_fault("nan:0,throw:3", {DRUMSWEEP_BINARY, "run", "study.toml", "-o", "out"}));
  EXPECT_EQ(program.wait(), 4) << program.err();
  const std::string table = file_text(folder / "out/results.csv");
  EXPECT_NE(table.find("not a finite number"), std::string::npos) << table;
  EXPECT_NE(table.find("exception asked for"), std::string::npos) << table;
  EXPECT_EQ(count_files(folder / "out/designs", ".h5"), 2u);
  EXPECT_EQ(run_alone(folder, "out", {"--retry", "failed"}).code, 0);
  ASSERT_EQ(run_alone(folder, "reference").code, 0);
  expect_same_results(folder / "reference", folder / "out");
}

TEST(Fault, USR1_writes_checkpoints_and_goes_on_and_a_kill_after_it_loses_nothing_before_it) {
  const TestFolder folder;
  write_text(folder / "study.toml", tiny_study(20, 2));
  ASSERT_EQ(run_alone(folder, "reference").code, 0);
  {
    Program program(folder, under_mpirun(2, run_words("out")));
    ASSERT_TRUE(wait_until([&] { return under_way(folder); }));
    program.signal(SIGUSR1);
    ASSERT_TRUE(wait_until([&] { return count_files(folder / "out/designs", ".part") == 2; }));
    EXPECT_TRUE(program.running());
    program.kill_all();
  }
  Program again(folder, under_mpirun(3, run_words("out")));
  EXPECT_EQ(again.wait(), 0) << again.err();
  EXPECT_NE(again.err().find("goes on from its checkpoint"), std::string::npos) << again.err();
  expect_same_results(folder / "reference", folder / "out");
}

TEST(Fault, stop_signals_at_any_time_keep_the_state_and_the_result) {
  const TestFolder folder;
  // Never steady, so that the signals find the warm-up too.
  const std::string study =
      replaced(replaced(tiny_study(6, 2), "tolerance = 0.2", "tolerance = 0.0001"), "windows = 1", "windows = 50");
  write_text(folder / "study.toml", study);
  ASSERT_EQ(run_alone(folder, "reference").code, 0);
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  int code = 3, warm_ups = 0;
  for (int i = 0; i < 40 && code == 3; ++i) {
    Program program(folder, {DRUMSWEEP_BINARY, "run", "study.toml", "-o", "out"});
    ASSERT_TRUE(wait_until([&] { return program.err().find("on 1 rank, into") != std::string::npos; }));
    sleep_ms(static_cast<int>(random() % 300));
    program.signal(std::array{SIGUSR1, SIGUSR2, SIGTERM, SIGINT}[random() % 4]);
    sleep_ms(static_cast<int>(random() % 100));
    program.signal(std::array{SIGUSR2, SIGTERM, SIGINT}[random() % 3]);
    code = program.wait();
    if (code >= 128) code = 3;  // the same signal twice ends the process at once
    warm_ups += program.err().find("warm-up: going on at turn") != std::string::npos ? 1 : 0;
  }
  if (code == 3) code = run_alone(folder, "out").code;
  EXPECT_EQ(code, 0);
  expect_same_results(folder / "reference", folder / "out");
  EXPECT_EQ(file_text(folder / "reference/warm_state.h5"), file_text(folder / "out/warm_state.h5"));
  EXPECT_GE(warm_ups, 1) << "no signal came during the warm-up";
}

TEST(Fault, stop_before_ends_in_time_with_exit_3_and_is_checked) {
  const TestFolder folder;
  write_text(folder / "study.toml", tiny_study(400, 2));
  const auto begin = std::chrono::steady_clock::now();
  const Finished run = run_alone(folder, "out", {"--stop-before", "0:00:03"});
  EXPECT_EQ(run.code, 3) << run.err;
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(3));
  EXPECT_EQ(count_files(folder / "out/designs", ".part"), 1u);
  for (const char* bad : {"soon", "1:60:00", "0", "-5", "1:2:3:4"})
    EXPECT_EQ(run_alone(folder, "out", {"--stop-before", bad}).code, 2) << bad;
}

TEST(Fault, kill_9_of_one_worker_or_of_rank_0_ends_the_job_and_the_next_run_continues) {
  const TestFolder folder;
  write_text(folder / "study.toml", tiny_study(20, 2));
  ASSERT_EQ(run_alone(folder, "reference").code, 0);
  for (const std::size_t victim : {1u, 0u}) {
    std::filesystem::remove_all(folder / "out");
    Program program(folder, under_mpirun(3, run_words("out")));
    ASSERT_TRUE(wait_until([&] { return under_way(folder); }));
    ASSERT_EQ(ranks_of(program.pid()).size(), 3u);
    ::kill(ranks_of(program.pid())[victim], SIGKILL);
    EXPECT_NE(program.wait(), 0);
    Program again(folder, under_mpirun(3, run_words("out")));
    EXPECT_EQ(again.wait(), 0) << again.err();
    expect_same_results(folder / "reference", folder / "out");
  }
}

TEST(Fault, with_survive_the_others_go_on_redo_the_design_and_finish) {
  const TestFolder folder;
  write_text(folder / "study.toml", tiny_study(20, 2));
  ASSERT_EQ(run_alone(folder, "reference").code, 0);
  for (const char* master : {"--no-dedicated-master", "--dedicated-master"}) {
    std::filesystem::remove_all(folder / "out");
    Program program(folder, under_mpirun_with_recovery(3, run_words("out", {"--survive", master})));
    ASSERT_TRUE(wait_until([&] { return under_way(folder); }));
    ::kill(ranks_of(program.pid())[1], SIGKILL);
    EXPECT_EQ(program.wait(), 0) << program.err();
    EXPECT_NE(program.err().find("was lost with rank 1"), std::string::npos) << program.err();
    expect_same_results(folder / "reference", folder / "out");
    EXPECT_EQ(count_events(folder / "out", "lost"), 1u);
    EXPECT_EQ(count_events(folder / "out", "started"), 5u);
  }

  // Nobody dies: the same, and everybody leaves. Rank 0 dies: the others leave too.
  Program whole(folder, under_mpirun_with_recovery(3, run_words("whole", {"--survive"})));
  EXPECT_EQ(whole.wait(), 0) << whole.err();
  expect_same_results(folder / "reference", folder / "whole");
  std::filesystem::remove_all(folder / "out");
  Program headless(folder, under_mpirun_with_recovery(3, run_words("out", {"--survive"})));
  ASSERT_TRUE(wait_until([&] { return under_way(folder); }));
  ::kill(ranks_of(headless.pid())[0], SIGKILL);
  headless.wait();
  EXPECT_NE(headless.err().find("rank 0 is gone"), std::string::npos) << headless.err();
}

TEST(Fault, a_ledger_torn_at_every_byte_of_its_last_record_is_read_and_the_result_is_the_same) {
  const TestFolder folder;
  write_text(folder / "study.toml", tiny_study(1, 2));
  ASSERT_EQ(run_alone(folder, "out").code, 0);
  const std::string ledger = file_text(folder / "out/provenance.csv"), table = file_text(folder / "out/results.csv");
  const std::size_t last = ledger.rfind('\n', ledger.size() - 2) + 1;
  const std::string id = read_provenance(folder / "out/provenance.csv").back().design_id;
  // Every byte in the unit test of the ledger; here the whole program at every eighth.
  for (std::size_t cut = last; cut < ledger.size(); cut += 8) {
    write_text(folder / "out/provenance.csv", ledger.substr(0, cut));
    std::filesystem::remove(folder / ("out/designs/" + id + ".h5"));
    const Finished again = run_alone(folder, "out");
    ASSERT_EQ(again.code, 0) << "cut at " << cut << ": " << again.err;
    ASSERT_EQ(file_text(folder / "out/results.csv"), table) << cut;
    EXPECT_EQ(read_provenance(folder / "out/provenance.csv").back().event, "done");
  }
}

/// Random kills -9 of a worker, of rank 0, of mpirun, or of all. DRUMSWEEP_TEST_KILLS sets how many, DRUMSWEEP_TEST_SEED
/// repeats a case.
TEST(Fault, random_kills_change_nothing_and_no_completed_design_is_run_twice) {
  const char* kills_text = std::getenv("DRUMSWEEP_TEST_KILLS");
  const char* seed_text = std::getenv("DRUMSWEEP_TEST_SEED");
  const int num_kills = kills_text != nullptr ? std::atoi(kills_text) : 12;
  const unsigned seed = seed_text != nullptr ? static_cast<unsigned>(std::atoi(seed_text)) : std::random_device{}();
  std::printf("seed %u, %d kills\n", seed, num_kills);
  std::mt19937 random(seed);
  const TestFolder folder;
  const int turns = 8, nodes = num_kills > 50 ? 14 : 4;  // 196 recordings are not packed yet
  write_text(folder / "study.toml", tiny_study(turns, nodes));
  ASSERT_EQ(run_alone(folder, "reference").code, 0);

  int kills = 0, ended = 0;
  std::size_t lost_at_most = 0;
  std::map<std::string, std::string> done;
  for (int i = 0; i < 3 * num_kills && kills < num_kills; ++i) {
    const int ranks = 1 + static_cast<int>(random() % 3);
    Program program(folder, under_mpirun(ranks, run_words("out", {"--checkpoint", "0"})));
    const std::size_t before = count_events(folder / "out", "started");
    wait_until([&] { return count_events(folder / "out", "started") > before || !program.running(); });
    sleep_ms(static_cast<int>(random() % 400));
    if (!program.running()) {
      // Finished before the kill: begin anew with another folder's worth of work.
      ++ended;
      EXPECT_EQ(program.wait(), 0) << program.err();
      expect_same_results(folder / "reference", folder / "out");
      std::filesystem::remove_all(folder / "out");
      done.clear();
      lost_at_most = 0;
      continue;
    }
    const std::vector<pid_t> victims = ranks_of(program.pid());
    const auto whom = static_cast<std::size_t>(random() % 5);
    if (whom >= 3 || victims.size() != static_cast<std::size_t>(ranks)) {
      program.kill_all();
    } else {
      ::kill(victims[whom % victims.size()], SIGKILL);
      program.wait();
    }
    ++kills;
    lost_at_most += static_cast<std::size_t>(ranks);
    // What was complete is there as it was; and the ledger shows that it was not begun again.
    for (const auto& [path, bytes] : done) EXPECT_TRUE(file_text(path) == bytes) << path;
    for (const auto& entry : std::filesystem::directory_iterator(folder / "out/designs"))
      if (entry.path().extension() == ".h5") done[entry.path().string()] = file_text(entry.path().string());
    std::set<std::string> completed;
    for (const ProvenanceLine& line : read_provenance(folder / "out/provenance.csv")) {
      EXPECT_FALSE(line.event == "started" && completed.count(line.design_id) == 1) << line.design_id << " begun again";
      if (line.event == "done") completed.insert(line.design_id);
    }
    EXPECT_LE(count_events(folder / "out", "started"), done.size() + lost_at_most);
  }
  std::printf("%d runs ended before their kill\n", ended);
  EXPECT_GE(kills, num_kills) << ended << " runs ended before their kill";
  Program last(folder, under_mpirun(2, run_words("out")));
  EXPECT_EQ(last.wait(), 0) << last.err();
  expect_same_results(folder / "reference", folder / "out");
  EXPECT_EQ(count_files(folder / "out/designs", ".failed"), 0u);
}

}  // namespace
}  // namespace drumsweep

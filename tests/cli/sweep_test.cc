/// Whole sweeps by the real program: ranks, kills, signals, resuming, refusals.
#include <gtest/gtest.h>
#include <sys/mount.h>

#include <regex>

#include "cli/mini_json.h"
#include "cli/program.h"

namespace drumsweep {
namespace {

/// Table and recordings of an output folder, to be compared byte for byte.
std::map<std::string, std::string> results_of(const std::string& out) {
  std::map<std::string, std::string> files{{"results.csv", file_text(out + "/results.csv")},
                                           {"warm_state.h5", file_text(out + "/warm_state.h5")}};
  for (const auto& entry : std::filesystem::directory_iterator(out + "/designs"))
    files[entry.path().filename().string()] = file_text(entry.path().string());
  return files;
}

void expect_same(const std::map<std::string, std::string>& a, const std::map<std::string, std::string>& b) {
  EXPECT_EQ(a.at("results.csv"), b.at("results.csv"));
  ASSERT_EQ(a.size(), b.size());
  for (const auto& [name, bytes] : a) EXPECT_TRUE(b.count(name) == 1 && b.at(name) == bytes) << name << " differs";
}

int run_with_ranks(const TestFolder& folder, int ranks, const std::string& out) {
  Program program(folder, under_mpirun(ranks, {"run", "study.toml", "-o", out}));
  const int code = program.wait();
  EXPECT_EQ(code, 0) << program.err();
  return code;
}

TEST(Sweep, table_and_recordings_are_bitwise_the_same_for_any_number_of_ranks) {
  const TestFolder folder;
  write_text(folder / "study.toml", tiny_study(2, 3));
  const Finished alone = drumsweep(folder, {"run", "study.toml", "-o", "alone"});
  ASSERT_EQ(alone.code, 0) << alone.err;
  for (const int ranks : {1, 2, 4}) {
    const std::string out = "ranks" + std::to_string(ranks);
    run_with_ranks(folder, ranks, out);
    expect_same(results_of(folder / "alone"), results_of(folder / out));
  }
  EXPECT_EQ(count_files(folder / "alone/designs", ".h5"), 9u);
}

TEST(Sweep, more_ranks_than_designs_is_fine) {
  const TestFolder folder;
  write_text(folder / "study.toml", tiny_study(2, 1 + 1));
  run_with_ranks(folder, 6, "out");
  EXPECT_EQ(count_files(folder / "out/designs", ".h5"), 4u);
}

TEST(Sweep, killed_at_random_and_resumed_gives_the_uninterrupted_table) {
  const TestFolder folder;
  write_text(folder / "study.toml", tiny_study(30, 3));
  run_with_ranks(folder, 2, "reference");
  const auto reference = results_of(folder / "reference");

  // Every other design, a kill -9 of mpirun and all ranks; nothing that was complete may go or change.
  std::size_t complete = 0;
  int rounds = 0;
  for (; rounds < 20 && complete < 9; ++rounds) {
    Program program(folder, under_mpirun(2 + rounds % 2, {"run", "study.toml", "-o", "out"}));
    wait_until([&] { return count_files(folder / "out/designs", ".h5") >= complete + 2 || !program.running(); });
    if (!program.running()) break;
    program.kill_all();
    const std::size_t now = count_files(folder / "out/designs", ".h5");
    EXPECT_GE(now, complete);
    complete = now;
  }
  EXPECT_GE(rounds, 2) << "the job was never killed in the middle";
  run_with_ranks(folder, 2, "out");
  expect_same(reference, results_of(folder / "out"));
  EXPECT_EQ(count_files(folder / "out", ".tmp") + count_files(folder / "out/designs", ".tmp"), 0u);
}

TEST(Sweep, a_kill_during_the_warm_up_changes_nothing) {
  const TestFolder folder;
  // Never steady, so that the warm-up lasts; its state is saved every two turns.
  const std::string study =
      replaced(replaced(tiny_study(2, 2), "tolerance = 0.2", "tolerance = 0.0001"), "windows = 1", "windows = 50");
  write_text(folder / "study.toml", replaced(study, "max_turns = 12", "max_turns = 40"));
  ASSERT_EQ(drumsweep(folder, {"run", "study.toml", "-o", "reference"}).code, 0);
  {
    Program program(folder, {DRUMSWEEP_BINARY, "run", "study.toml", "-o", "out"});
    ASSERT_TRUE(wait_until([&] { return std::filesystem::exists(folder / "out/warm_state.h5"); }));
    program.kill_all();
  }
  const Finished again = drumsweep(folder, {"run", "study.toml", "-o", "out"});
  EXPECT_EQ(again.code, 0);
  EXPECT_NE(again.err.find("warm-up: going on at turn"), std::string::npos) << again.err;
  expect_same(results_of(folder / "reference"), results_of(folder / "out"));

  // A warm drum that is not steady is said loudly and marks every row.
  EXPECT_NE(again.err.find("NOT STEADY"), std::string::npos);
  const Json status = JsonReader::parse(drumsweep(folder, {"status", "out", "--json"}).out);
  EXPECT_EQ(status["state"]["untrusted"].number, 4);
  EXPECT_EQ(status["state"]["done"].number, 0);
}

TEST(Sweep, signals_stop_within_a_step_and_the_next_run_goes_on) {
  const TestFolder folder;
  write_text(folder / "study.toml", tiny_study(40, 2));
  const auto recording = [&] { return file_text(folder / "out/lock").find("recording") != std::string::npos; };
  for (const int number : {SIGUSR2, SIGTERM, SIGINT}) {
    std::filesystem::remove(folder / "out/lock");  // what the last run has said
    Program program(folder, {DRUMSWEEP_BINARY, "run", "study.toml", "-o", "out"});
    ASSERT_TRUE(wait_until(recording));
    const auto begin = std::chrono::steady_clock::now();
    program.signal(number);
    EXPECT_EQ(program.wait(), 3) << program.err();
    EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(2));
    EXPECT_NE(program.err().find("run the same command again"), std::string::npos);
  }
  const Json stopped = JsonReader::parse(drumsweep(folder, {"status", "out", "--json"}).out);
  EXPECT_GE(stopped["state"]["stopped"].number, 1);
  EXPECT_EQ(stopped["finished"].number, 0);

  // To mpirun, which passes USR2 on to all ranks.
  std::filesystem::remove(folder / "out/lock");
  Program job(folder, under_mpirun(2, {"run", "study.toml", "-o", "out"}));
  ASSERT_TRUE(wait_until(recording)) << job.err();
  job.signal(SIGUSR2);
  EXPECT_EQ(job.wait(), 3) << job.err();
  EXPECT_EQ(drumsweep(folder, {"run", "study.toml", "-o", "out"}).code, 0);
}

TEST(Sweep, a_second_run_on_the_same_folder_exits_6_and_names_the_holder) {
  const TestFolder folder;
  write_text(folder / "study.toml", tiny_study(60, 2));
  Program first(folder, {DRUMSWEEP_BINARY, "run", "study.toml", "-o", "out"});
  ASSERT_TRUE(wait_until([&] { return file_text(folder / "out/lock").find("recording") != std::string::npos; }));

  const TestFolder elsewhere;
  const Finished second = drumsweep(elsewhere, {"run", folder / "study.toml", "-o", folder / "out"});
  EXPECT_EQ(second.code, 6) << second.err;
  EXPECT_NE(second.err.find("pid "), std::string::npos) << second.err;

  // Status needs no lock.
  const Finished status = drumsweep(elsewhere, {"status", folder / "out", "--json"});
  EXPECT_EQ(status.code, 0);
  EXPECT_EQ(JsonReader::parse(status.out)["state"]["running"].number, 1);
  EXPECT_TRUE(first.running());

  // A dead holder's lock is free at once.
  first.kill_all();
  EXPECT_EQ(JsonReader::parse(drumsweep(elsewhere, {"status", folder / "out", "--json"}).out)["state"]["lost"].number,
            1);
  Program third(folder, {DRUMSWEEP_BINARY, "run", "study.toml", "-o", "out"});
  ASSERT_TRUE(wait_until([&] { return third.err().find("on 1 rank, into") != std::string::npos; }));
  third.kill_all();
}

TEST(Sweep, running_again_after_the_end_changes_nothing) {
  const TestFolder folder;
  write_text(folder / "study.toml", tiny_study());
  ASSERT_EQ(drumsweep(folder, {"run", "study.toml", "-o", "out"}).code, 0);
  const auto before = results_of(folder / "out");
  const std::string provenance = file_text(folder / "out/provenance.csv");
  const auto time = std::filesystem::last_write_time(folder / "out/results.csv");
  EXPECT_EQ(drumsweep(folder, {"run", "study.toml", "-o", "out"}).code, 0);
  expect_same(before, results_of(folder / "out"));
  EXPECT_EQ(provenance, file_text(folder / "out/provenance.csv"));
  EXPECT_EQ(time, std::filesystem::last_write_time(folder / "out/results.csv"));
}

TEST(Sweep, a_changed_physics_key_is_refused_key_by_key_and_nothing_changes) {
  const TestFolder folder;
  write_text(folder / "study.toml", tiny_study());
  ASSERT_EQ(drumsweep(folder, {"run", "study.toml", "-o", "out"}).code, 0);
  const auto before = results_of(folder / "out");
  const std::string frozen = file_text(folder / "out/study.toml"), log = file_text(folder / "out/run.log");
  write_text(folder / "study.toml", replaced(replaced(tiny_study(), "rate_kg_s = 0.15", "rate_kg_s = 0.16"),
                                             "outlet_begin_m = 0.05", "outlet_begin_m = 0.04"));
  const Finished refused = drumsweep(folder, {"run", "study.toml", "-o", "out"});
  EXPECT_EQ(refused.code, 5);
  EXPECT_NE(refused.err.find("feed.rate_kg_s: stored 0.15, now 0.16"), std::string::npos) << refused.err;
  EXPECT_NE(refused.err.find("belt.outlet_begin_m: stored 0.05, now 0.04"), std::string::npos) << refused.err;
  expect_same(before, results_of(folder / "out"));
  EXPECT_EQ(frozen, file_text(folder / "out/study.toml"));
  EXPECT_EQ(log, file_text(folder / "out/run.log"));
}

TEST(Sweep, evaluation_keys_and_stages_may_change_and_nothing_is_simulated_twice) {
  const TestFolder folder;
  write_text(folder / "study.toml", tiny_study());
  ASSERT_EQ(drumsweep(folder, {"run", "study.toml", "-o", "out"}).code, 0);
  const auto before = results_of(folder / "out");

  // Other weights: other numbers from the same landings.
  const std::string objective = "[objective]\nweights = \"uniform\"\n";
  write_text(folder / "study.toml", replaced(tiny_study(), "[record]", objective + "[record]"));
  ASSERT_EQ(drumsweep(folder, {"run", "study.toml", "-o", "out"}).code, 0);
  auto after = results_of(folder / "out");
  EXPECT_NE(before.at("results.csv"), after.at("results.csv"));
  EXPECT_EQ(count_files(folder / "out/designs", ".h5"), 4u);

  // Another stage: its centre is new, a corner is shared; and back to the first weights.
  write_text(folder / "study.toml", tiny_study(2, 2, R"([[stage]]
name = "more"
type = "points"
variables = [ { key = "outlet.opening_angle_deg", values = [2, 3] }, { key = "outlet.base_width_m", values = [0.025, 0.03] } ]
)"));
  const Finished third = drumsweep(folder, {"run", "study.toml", "-o", "out"});
  ASSERT_EQ(third.code, 0) << third.err;
  after = results_of(folder / "out");
  EXPECT_EQ(count_files(folder / "out/designs", ".h5"), 5u);
  EXPECT_EQ(after.at("results.csv").substr(0, before.at("results.csv").size()), before.at("results.csv"));
  const std::string provenance = file_text(folder / "out/provenance.csv");
  std::size_t started = 0;
  for (std::size_t at = 0; (at = provenance.find("started", at)) != std::string::npos; ++at) ++started;
  EXPECT_EQ(started, 5u);
}

/// Grid of 9, then every kind of search.
std::string searching_study() {
  return tiny_study(2, 3, R"([[stage]]
name = "learn"
type = "adaptive"
budget = 4
batch = 2
[[stage]]
name = "search"
type = "refine"
[[stage]]
name = "confirm"
type = "replicate"
replicates = 3
[refine]
only_if_smooth = false
starts = 2
max_evaluations = 4
)");
}

TEST(Sweep, designs_of_a_search_that_begins_the_study_are_known_before_its_first_batch_has_ended) {
  const TestFolder folder;
  std::string study = searching_study();
  study.erase(study.find("[[stage]]"), study.find("[[stage]]\nname = \"learn\"") - study.find("[[stage]]"));
  study = replaced(study, "budget = 4", R"(budget = 8
initial = 4
variables = [
  { key = "outlet.opening_angle_deg", from = 1, to = 3 },
  { key = "outlet.base_width_m", from = 0.02, to = 0.03 },
])");
  write_text(folder / "study.toml", study);
  Program program(folder, {DRUMSWEEP_BINARY, "run", "study.toml", "-o", "out"});
  ASSERT_TRUE(wait_until([&] { return count_files(folder / "out/designs", ".h5") > 0 || !program.running(); }));
  program.signal(SIGINT);
  EXPECT_EQ(program.wait(), 3) << program.err();
  const Json status = JsonReader::parse(drumsweep(folder, {"status", "out", "--json"}).out);
  EXPECT_EQ(status["designs"].number, 8);
  EXPECT_GT(status["state"]["done"].number, 0);
  const Finished rescored = drumsweep(folder, {"rescore", "out", "--set", "objective.modes=10", "-o", "new.csv"});
  EXPECT_EQ(rescored.code, 0) << rescored.err;
}

TEST(Sweep, searches_give_the_same_table_and_findings_for_any_ranks_and_interruptions) {
  const TestFolder folder;
  write_text(folder / "study.toml", searching_study());
  const Finished alone = drumsweep(folder, {"run", "study.toml", "-o", "alone"});
  ASSERT_EQ(alone.code, 0) << alone.err;
  EXPECT_NE(alone.out.find("optimum of the fit"), std::string::npos) << alone.out;
  EXPECT_NE(alone.out.find("confirmed by 3 fresh runs"), std::string::npos) << alone.out;
  const std::size_t designs = count_files(folder / "alone/designs", ".h5");
  EXPECT_GT(designs, 9u + 4u + 2u + 3u - 1u);
  const std::string findings = file_text(folder / "alone/findings.toml");

  run_with_ranks(folder, 3, "ranks3");
  expect_same(results_of(folder / "alone"), results_of(folder / "ranks3"));
  EXPECT_EQ(findings, file_text(folder / "ranks3/findings.toml"));

  // Killed in every search.
  for (const std::size_t stop_at : {11u, 14u, 18u}) {
    Program program(folder, under_mpirun(2, {"run", "study.toml", "-o", "killed"}));
    wait_until([&] { return count_files(folder / "killed/designs", ".h5") >= stop_at || !program.running(); });
    program.kill_all();
  }
  const Json status = JsonReader::parse(drumsweep(folder, {"status", "killed", "--json"}).out);
  EXPECT_EQ(status["finished"].number, 0);
  run_with_ranks(folder, 2, "killed");
  expect_same(results_of(folder / "alone"), results_of(folder / "killed"));
  EXPECT_EQ(findings, file_text(folder / "killed/findings.toml"));
  const Json finished = JsonReader::parse(drumsweep(folder, {"status", "killed", "--json"}).out);
  EXPECT_EQ(finished["finished"].number, 1);
  EXPECT_EQ(finished["designs"].number, static_cast<double>(designs));
}

TEST(Plan, says_what_would_run_what_is_there_and_what_searches_may_ask_for) {
  const TestFolder folder;
  write_text(folder / "study.toml", tiny_study(2, 3));
  const Json before =
      JsonReader::parse(drumsweep(folder, {"plan", "study.toml", "-o", "out", "-n", "4", "--json"}).out);
  EXPECT_EQ(before["to_run"].number, 9);
  EXPECT_EQ(before["reused"].number, 0);
  EXPECT_FALSE(std::filesystem::exists(folder / "out")) << "plan made something";
  ASSERT_EQ(drumsweep(folder, {"run", "study.toml", "-o", "out"}).code, 0);

  // Searches appended: the first has all it needs to decide, the second waits for it.
  const auto results = results_of(folder / "out");
  write_text(folder / "study.toml", searching_study());
  const Json after = JsonReader::parse(drumsweep(folder, {"plan", "study.toml", "-o", "out", "-n", "4", "--json"}).out);
  EXPECT_EQ(after["reused"].number, 9);
  EXPECT_GE(after["to_run"].number, 2);
  EXPECT_LE(after["to_run"].number + after["at_most_more"].number, 4 + 8 + 3);
  EXPECT_EQ(after["measured"].number, 1);
  expect_same(results, results_of(folder / "out"));
  write_text(folder / "study.toml", replaced(tiny_study(2, 3), "rate_kg_s = 0.15", "rate_kg_s = 0.16"));
  EXPECT_EQ(drumsweep(folder, {"plan", "study.toml", "-o", "out"}).code, 5);
}

TEST(Sweep, points_come_from_a_csv_file_beside_the_study) {
  const TestFolder folder;
  std::filesystem::create_directory(folder / "study");
  write_text(folder / "study/study.toml",
             tiny_study(2, 2, "[[stage]]\nname = \"own\"\ntype = \"points\"\nfile = \"mine.csv\"\n"));
  write_text(folder / "study/mine.csv", "# my designs\nopening_angle_deg, base_width_m\n2, 0.025\n1.5,0.021\n");
  const Finished run = drumsweep(folder, {"run", "study/study.toml", "-o", "out"});
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(count_files(folder / "out/designs", ".h5"), 6u);
  write_text(folder / "study/mine.csv", "opening_angle_deg,base_width_m\n2,0.025\n1.5,wide\n");
  const Finished bad = drumsweep(folder, {"run", "study/study.toml", "-o", "out"});
  EXPECT_EQ(bad.code, 2);
  EXPECT_NE(bad.err.find("mine.csv:3: outlet.base_width_m = \"wide\" is not a number"), std::string::npos) << bad.err;
}

TEST(Sweep, impossible_designs_are_holes_and_give_exit_4) {
  const TestFolder folder;
  // Slots of 0.03 m + 2 * 0.15 m * tan(35 deg) = 0.24 m overlap on a pitch of 0.209 m.
  write_text(folder / "study.toml", replaced(tiny_study(), "from = 1, to = 3", "from = 1, to = 70"));
  const Finished run = drumsweep(folder, {"run", "study.toml", "-o", "out"});
  EXPECT_EQ(run.code, 4) << run.err;
  const Json status = JsonReader::parse(drumsweep(folder, {"status", "out", "--json"}).out);
  EXPECT_EQ(status["state"]["failed"].number, 2);
  EXPECT_EQ(status["state"]["done"].number, 2);
  EXPECT_EQ(status["finished"].number, 1);
  EXPECT_NE(file_text(folder / "out/results.csv").find("overlap"), std::string::npos);
}

TEST(Sweep, damaged_recordings_and_warm_states_are_set_aside_and_made_again) {
  const TestFolder folder;
  write_text(folder / "study.toml", tiny_study());
  ASSERT_EQ(drumsweep(folder, {"run", "study.toml", "-o", "out"}).code, 0);
  const auto before = results_of(folder / "out");
  std::vector<std::string> recordings;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "out/designs"))
    recordings.push_back(entry.path().string());
  std::sort(recordings.begin(), recordings.end());

  // One truncated, one with a flipped bit, one empty; the warm state truncated.
  std::string flipped = file_text(recordings[1]);
  flipped[flipped.size() / 2] = static_cast<char>(flipped[flipped.size() / 2] ^ 1);
  write_text(recordings[0], file_text(recordings[0]).substr(0, 3000));
  write_text(recordings[1], flipped);
  write_text(recordings[2], "");
  write_text(folder / "out/warm_state.h5", before.at("warm_state.h5").substr(0, 5000));
  const Finished again = drumsweep(folder, {"run", "study.toml", "-o", "out"});
  EXPECT_EQ(again.code, 0) << again.err;
  EXPECT_NE(again.err.find("damaged"), std::string::npos);
  EXPECT_EQ(count_files(folder / "out/designs", ".damaged"), 3u);
  for (const std::string& path : recordings) std::filesystem::remove(path + ".damaged");
  expect_same(before, results_of(folder / "out"));
}

TEST(Sweep, a_foreign_folder_or_recording_is_refused) {
  const TestFolder folder;
  write_text(folder / "study.toml", tiny_study());
  std::filesystem::create_directory(folder / "thesis");
  write_text(folder / "thesis/chapter1.txt", "do not touch");
  EXPECT_EQ(drumsweep(folder, {"run", "study.toml", "-o", "thesis"}).code, 5);
  EXPECT_EQ(count_files(folder / "thesis", ""), 1u);

  // A user's own study.toml in the folder does not make it ours.
  std::filesystem::create_directory(folder / "mine");
  write_text(folder / "mine/study.toml", tiny_study());
  EXPECT_EQ(drumsweep(folder, {"run", "study.toml", "-o", "mine"}).code, 5);
  EXPECT_EQ(count_files(folder / "mine", ""), 1u);

  // Another version's folder.
  ASSERT_EQ(drumsweep(folder, {"run", "study.toml", "-o", "out"}).code, 0);
  const std::string frozen = file_text(folder / "out/study.toml");
  write_text(folder / "out/study.toml", std::regex_replace(frozen, std::regex("program [0-9.]+"), "program 99.0.0"));
  const Finished version = drumsweep(folder, {"run", "study.toml", "-o", "out"});
  EXPECT_EQ(version.code, 5);
  EXPECT_NE(version.err.find("99.0.0"), std::string::npos) << version.err;
  write_text(folder / "out/study.toml", frozen);

  // Two recordings swapped.
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "out/designs")) paths.push_back(entry.path());
  std::filesystem::rename(paths[0], folder / "swap");
  std::filesystem::rename(paths[1], paths[0]);
  std::filesystem::rename(folder / "swap", paths[1]);
  EXPECT_EQ(drumsweep(folder, {"run", "study.toml", "-o", "out"}).code, 5);
}

TEST(Sweep, a_full_disk_stops_the_job_and_the_next_run_completes_it) {
  const TestFolder folder;
  write_text(folder / "study.toml", tiny_study(2, 3));
  ASSERT_EQ(drumsweep(folder, {"run", "study.toml", "-o", "reference"}).code, 0);
  std::filesystem::create_directory(folder / "small");
  const std::string mounted = folder / "small";
  if (::mount("tmpfs", mounted.c_str(), "tmpfs", 0, "size=160k") != 0)
    GTEST_SKIP() << "NOT TESTED: a full disk (needs root to mount a small tmpfs)";
  for (const int ranks : {1, 3}) {
    const std::string out = mounted + "/out";
    std::filesystem::remove_all(out);
    Program full(folder, ranks == 1 ? std::vector<std::string>{DRUMSWEEP_BINARY, "run", "study.toml", "-o", out}
                                    : under_mpirun(ranks, {"run", "study.toml", "-o", out}));
    EXPECT_EQ(full.wait(), 3) << full.err();
    EXPECT_NE(full.err().find(out), std::string::npos) << full.err();
    EXPECT_NE(full.err().find("No space left on device"), std::string::npos) << full.err();
    const std::size_t complete = count_files(out + "/designs", ".h5");
    EXPECT_GE(complete, 1u);
    EXPECT_LT(complete, 9u);

    // Room again: what was complete is not simulated again.
    ASSERT_EQ(::mount("tmpfs", mounted.c_str(), "tmpfs", MS_REMOUNT, "size=10m"), 0);
    const Finished again = drumsweep(folder, {"run", "study.toml", "-o", out});
    EXPECT_EQ(again.code, 0) << again.err;
    EXPECT_NE(again.err.find(std::to_string(complete) + " of 9 designs are there already"), std::string::npos)
        << again.err;
    expect_same(results_of(folder / "reference"), results_of(out));
    std::filesystem::remove_all(out);
    ASSERT_EQ(::mount("tmpfs", mounted.c_str(), "tmpfs", MS_REMOUNT, "size=160k"), 0);
  }
  ::umount(mounted.c_str());
}

TEST(Sweep, an_output_that_cannot_be_made_or_vanishes_gives_exit_3_and_its_path) {
  const TestFolder folder;
  write_text(folder / "study.toml", tiny_study(60));
  write_text(folder / "file", "");
  const Finished blocked = drumsweep(folder, {"run", "study.toml", "-o", "file/out"});
  EXPECT_EQ(blocked.code, 3) << blocked.err;
  EXPECT_NE(blocked.err.find("file/out"), std::string::npos) << blocked.err;

  Program program(folder, {DRUMSWEEP_BINARY, "run", "study.toml", "-o", "out"});
  ASSERT_TRUE(wait_until([&] { return file_text(folder / "out/lock").find("recording") != std::string::npos; }));
  std::filesystem::rename(folder / "out", folder / "gone");
  EXPECT_EQ(program.wait(), 3) << program.err();
  EXPECT_NE(program.err().find("out/designs"), std::string::npos) << program.err();
}

TEST(Sweep, copies_that_do_not_see_each_other_are_refused) {
  const TestFolder folder;
  write_text(folder / "study.toml", tiny_study());
  // What srun without the right MPI plug-in does: a step of four tasks, each a world of its own.
  Program program(folder, {"env", "SLURM_STEP_NUM_TASKS=4", DRUMSWEEP_BINARY, "run", "study.toml", "-o", "out"});
  EXPECT_NE(program.wait(), 0);
  EXPECT_NE(program.err().find("4 processes"), std::string::npos) << program.err();
  EXPECT_FALSE(std::filesystem::exists(folder / "out"));
}

TEST(Sweep, piped_progress_is_plain_lines_and_the_log_has_one_a_design) {
  const TestFolder folder;
  write_text(folder / "study.toml", tiny_study());
  const Finished run = drumsweep(folder, {"run", "study.toml", "-o", "out"});
  ASSERT_EQ(run.code, 0);
  for (const std::string& text : {run.err, run.out, file_text(folder / "out/run.log")}) {
    EXPECT_EQ(text.find('\r'), std::string::npos);
    EXPECT_EQ(text.find('\x1b'), std::string::npos);
  }
  const std::string log = file_text(folder / "out/run.log");
  for (const char* line : {"design 1/4", "design 2/4", "design 3/4", "design 4/4"})
    EXPECT_NE(log.find(line), std::string::npos) << line;
  EXPECT_NE(run.out.find("out/results.csv"), std::string::npos);
}

TEST(Sweep, on_a_terminal_one_line_is_updated_and_NO_COLOR_is_honoured) {
  const TestFolder folder;
  write_text(folder / "study.toml", tiny_study(10));
  const std::string command = std::string(DRUMSWEEP_BINARY) + " run study.toml -o out";
  for (const char* colour : {"NO_COLOR=1", "NO_COLOR"}) {
    // script(1) gives the program a terminal of its own.
    const std::vector<std::string> set = colour == std::string("NO_COLOR")
                                             ? std::vector<std::string>{"env", "-u", colour}
                                             : std::vector<std::string>{"env", colour};
    std::vector<std::string> words = set;
    for (const std::string& word : {std::string("script"), std::string("-qec"), command, folder / "typescript"})
      words.push_back(word);
    Program program(folder, words);
    ASSERT_EQ(program.wait(), 0) << program.out();
    const std::string text = program.out();
    EXPECT_NE(text.find("designs 0/4, ETA"), std::string::npos) << text;
    EXPECT_NE(text.find(set.size() == 2 ? "\r[" : "\r\x1b["), std::string::npos) << text;
    EXPECT_EQ(text.find('\x1b') == std::string::npos, set.size() == 2) << text;
    EXPECT_EQ(file_text(folder / "out/run.log").find('\r'), std::string::npos);
    std::filesystem::remove_all(folder / "out");
  }
}

TEST(Sweep, default_output_is_the_name_of_the_study) {
  const TestFolder folder;
  write_text(folder / "study.toml", tiny_study());
  EXPECT_EQ(drumsweep(folder, {"run", "study.toml"}).code, 0);
  EXPECT_TRUE(std::filesystem::exists(folder / "study_result/results.csv"));
}

}  // namespace
}  // namespace drumsweep

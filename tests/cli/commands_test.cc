/// init, check, status, simulate, contour and bad input, by the real program.
#include <gtest/gtest.h>

#include <cmath>

#include "cli/mini_json.h"
#include "cli/program.h"

namespace drumsweep {
namespace {

struct BadInput {
  std::string from, to;                ///< change of the tiny study
  std::vector<std::string> must_name;  ///< what the message has to contain
};

TEST(Check, every_wrong_study_is_refused_with_key_value_and_range) {
  const TestFolder folder;
  const std::vector<BadInput> cases = {
      {"seed = 7", "seed = ", {"study.toml:2"}},
      {"friction = 0.7", "friction = \"high\"", {"study.toml:", "material.friction", "number"}},
      {"friction = 0.7", "friction = -1.0", {"material.friction", "-1", "0 to 10"}},
      {"friction = 0.7", "friction = nan", {"material.friction", "nan", "0 to 10"}},
      {"friction = 0.7", "fricton = 0.7", {"material.fricton", "did you mean", "material.friction"}},
      {"opening_angle_deg = 2.0", "opening_angle = 2.0", {"outlet.opening_angle"}},
      {"opening_angle_deg = 2.0", "opening_angle_deg = 2.0\nopening_angle_rad = 0.1", {"deg", "rad", "one of the two"}},
      {"diameter_m = 0.2", "diameter_mm = 200", {"drum.diameter_mm", "did you mean"}},
      {"\"outlet.base_width_m\"", "\"outlet.base_width\"", {"outlet.base_width", "did you mean"}},
      {"\"outlet.base_width_m\"", "\"drum.length_m\"", {"drum.length_m", "warm drum"}},
      {"count = 2", "count = 0", {"count", "1 to"}},
  };
  const std::string study = replaced(tiny_study(), "[solver]", "[material]\nfriction = 0.7\n[solver]");
  for (const BadInput& bad : cases) {
    write_text(folder / "study.toml", replaced(study, bad.from, bad.to));
    for (const char* command : {"check", "run"}) {
      const Finished result = drumsweep(folder, {command, "study.toml"});
      EXPECT_EQ(result.code, 2) << bad.to << "\n" << result.err;
      for (const std::string& word : bad.must_name)
        EXPECT_NE(result.err.find(word), std::string::npos) << word << " is not in: " << result.err;
    }
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "study_result"));
  const Finished missing = drumsweep(folder, {"check", "nowhere.toml"});
  EXPECT_EQ(missing.code, 2);
  EXPECT_NE(missing.err.find("nowhere.toml"), std::string::npos);
}

TEST(Check, bad_input_under_mpirun_gives_one_message_and_exit_2) {
  const TestFolder folder;
  Program program(folder, under_mpirun(3, {"run", "nowhere.toml"}));
  EXPECT_EQ(program.wait(), 2);
  const std::string text = program.err();
  const std::size_t first = text.find("nowhere.toml");
  ASSERT_NE(first, std::string::npos);
  EXPECT_EQ(text.find("nowhere.toml", first + 1), std::string::npos) << text;
}

TEST(Check, prints_mass_balance_and_designs) {
  const TestFolder folder;
  write_text(folder / "study.toml", tiny_study());
  const Finished result = drumsweep(folder, {"check", "study.toml"});
  EXPECT_EQ(result.code, 0) << result.err;
  // Balls of 1.309 g; 0.15 kg/s over 0.3 m of belt at 0.25 m/s, packing 0.7: 1.143 mm.
  for (const char* word : {"1.309 g", "114.6 balls/s", "0.001143 m", "\"coarse\": 4 designs", "core-hours", "Froude"})
    EXPECT_NE(result.out.find(word), std::string::npos) << word << " is not in: " << result.out;
}

TEST(CommandLine, wrong_usage_is_exit_2_and_every_help_has_an_example) {
  const TestFolder folder;
  for (const std::vector<std::string>& words :
       std::vector<std::vector<std::string>>{{},
                                             {"runn"},
                                             {"run"},
                                             {"run", "--fast", "x.toml"},
                                             {"simulate", "x.toml", "-o", "d", "--at", "a,b"},
                                             {"contour", "out"}})
    EXPECT_EQ(drumsweep(folder, words).code, 2);
  for (const char* command : {"init", "check", "run", "status", "why", "simulate", "contour", "sample", "bench"}) {
    const Finished help = drumsweep(folder, {command, "--help"});
    EXPECT_EQ(help.code, 0);
    EXPECT_NE(help.out.find("xample"), std::string::npos) << command << ": " << help.out;
    EXPECT_NE(help.out.find(std::string("drumsweep ") + command), std::string::npos) << command;
  }
  EXPECT_EQ(drumsweep(folder, {"--version"}).code, 0);
}

TEST(Init, writes_studies_that_are_valid_and_overwrites_nothing) {
  const TestFolder folder;
  const Finished init = drumsweep(folder, {"init", "--preset", "quick", "new"});
  ASSERT_EQ(init.code, 0) << init.err;
  std::size_t number = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "new")) {
    EXPECT_EQ(drumsweep(folder, {"check", entry.path().string()}).code, 0) << entry.path();
    ++number;
  }
  EXPECT_GE(number, 1u);
  write_text(folder / "new/quick.toml", "mine");
  EXPECT_EQ(drumsweep(folder, {"init", "--preset", "quick", "new"}).code, 2);
  EXPECT_EQ(file_text(folder / "new/quick.toml"), "mine");
  EXPECT_EQ(drumsweep(folder, {"init", "--preset", "nonsense", "other"}).code, 2);
  EXPECT_FALSE(std::filesystem::exists(folder / "other"));
}

TEST(Status, refuses_what_is_not_an_output_folder) {
  const TestFolder folder;
  EXPECT_EQ(drumsweep(folder, {"status", "nowhere"}).code, 2);
  EXPECT_EQ(drumsweep(folder, {"status", "."}).code, 2);
  EXPECT_EQ(drumsweep(folder, {"contour", ".", "-o", "c.csv"}).code, 2);
}

TEST(Status, json_has_the_keys_that_others_rely_on_and_writes_nothing) {
  const TestFolder folder;
  write_text(folder / "study.toml", tiny_study());
  ASSERT_EQ(drumsweep(folder, {"run", "study.toml", "-o", "out"}).code, 0);
  const auto snapshot = [&] {
    std::string all;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder / "out"))
      if (entry.is_regular_file()) all += entry.path().string() + file_text(entry.path().string());
    return all;
  };
  const std::string before = snapshot();
  const Finished status = drumsweep(folder, {"status", "out", "--json"});
  ASSERT_EQ(status.code, 0) << status.err;
  const Json json = JsonReader::parse(status.out);
  for (const char* key : {"pending", "running", "done", "untrusted", "failed", "lost", "stopped"})
    EXPECT_EQ(json["state"][key].number, std::string(key) == "done" ? 4 : 0) << key;
  EXPECT_EQ(json["finished"].number, 1);
  EXPECT_GT(json["cpu_s"].number, 0);
  EXPECT_GT(json["best"]["f_m"].number, 0);
  EXPECT_EQ(json["best"]["design_id"].text.size(), 10u);
  EXPECT_EQ(snapshot(), before);
}

/// A study of which one design is impossible: its slots are as wide as the outlet's circumference.
std::string study_with_a_hole() { return replaced(tiny_study(), "from = 0.02, to = 0.03", "from = 0.03, to = 0.5"); }

TEST(Status, timeline_and_watch_of_a_finished_sweep) {
  const TestFolder folder;
  write_text(folder / "study.toml", tiny_study());
  Program run(folder, under_mpirun(2, {"run", "study.toml", "-o", "out"}));
  ASSERT_EQ(run.wait(), 0) << run.err();
  const Finished watched = drumsweep(folder, {"status", "out", "--watch", "--timeline"});
  EXPECT_EQ(watched.code, 0);
  EXPECT_EQ(watched.out.find('\033'), std::string::npos);
  for (const char* word : {"finished", "run of 20", "ranks idle", "tail", "    1 ", "% busy"})
    EXPECT_NE(watched.out.find(word), std::string::npos) << word << "\n" << watched.out;

  const Json json = JsonReader::parse(drumsweep(folder, {"status", "out", "--json", "--timeline"}).out);
  const Json& timeline = json["timeline"]["runs"].list.at(0);
  EXPECT_EQ(timeline["ranks"].number, 2);
  EXPECT_EQ(timeline["designs"].number, 4);
  EXPECT_EQ(timeline["begin"].text.size(), 24u);
  for (const char* key : {"wall_s", "idle_s", "tail_s", "designs_s"}) EXPECT_GE(timeline[key].number, 0) << key;
  EXPECT_GT(timeline["wall_s"].number, timeline["designs_s"].number);
  EXPECT_NEAR(timeline["idle_share"].number, timeline["idle_s"].number / (2 * timeline["designs_s"].number), 1e-9);
}

TEST(Status, watch_follows_a_run_line_by_line_until_it_is_over) {
  const TestFolder folder;
  write_text(folder / "study.toml", tiny_study(10, 3));
  Program run(folder, {DRUMSWEEP_BINARY, "run", "study.toml", "-o", "out"});
  ASSERT_TRUE(wait_until([&] { return count_files(folder / "out/designs", ".h5") > 0; }));
  // Its own files for output: a folder beside the first.
  const TestFolder other;
  Program watch(other, {DRUMSWEEP_BINARY, "status", folder / "out", "--watch", "--json"});
  EXPECT_EQ(run.wait(), 0);
  EXPECT_EQ(watch.wait(), 0);
  std::istringstream lines(watch.out());
  std::size_t number = 0;
  Json last;
  for (std::string line; std::getline(lines, line); ++number) last = JsonReader::parse(line);
  EXPECT_GE(number, 2u) << watch.out();
  EXPECT_EQ(last["finished"].number, 1);
}

TEST(Why, tells_a_designs_story_by_id_beginning_or_values) {
  const TestFolder folder;
  write_text(folder / "study.toml", study_with_a_hole());
  ASSERT_EQ(drumsweep(folder, {"run", "study.toml", "-o", "out"}).code, 4);
  const Finished good = drumsweep(folder, {"why", "out", "--at", "1,0.03", "--json"});
  ASSERT_EQ(good.code, 0) << good.err;
  const Json json = JsonReader::parse(good.out);
  EXPECT_EQ(json["state"].text, "done");
  EXPECT_EQ(json["reason"].text, "");
  EXPECT_EQ(json["values"]["base_width_m"].number, 0.03);
  EXPECT_GT(json["f_m"].number, 0);
  ASSERT_EQ(json["attempts"].list.size(), 1u);
  EXPECT_EQ(json["attempts"].list[0]["event"].text, "done");
  EXPECT_GT(json["attempts"].list[0]["wall_s"].number, 0);
  ASSERT_EQ(json["files"].list.size(), 1u);

  const std::string id = json["design_id"].text;
  const Finished text = drumsweep(folder, {"why", "out", id.substr(0, 5)});
  EXPECT_EQ(text.code, 0) << text.err;
  EXPECT_NE(text.out.find(id), std::string::npos);

  const Finished hole = drumsweep(folder, {"why", "out", "--at", "1,0.5"});
  EXPECT_EQ(hole.code, 0) << hole.err;
  EXPECT_NE(hole.out.find("state      failed: "), std::string::npos) << hole.out;
  EXPECT_NE(hole.out.find("change the stage"), std::string::npos) << hole.out;

  // A damaged recording.
  const std::string path = folder / ("out/designs/" + id + ".h5");
  std::string bytes = file_text(path);
  bytes[bytes.size() - 5] ^= 1;
  write_text(path, bytes);
  const Finished damaged = drumsweep(folder, {"why", "out", id});
  EXPECT_NE(damaged.out.find("state      damaged: "), std::string::npos) << damaged.out;

  EXPECT_EQ(drumsweep(folder, {"why", "out"}).code, 2);
  EXPECT_EQ(drumsweep(folder, {"why", "out", "zz"}).code, 2);
  EXPECT_EQ(drumsweep(folder, {"why", "out", "--at", "1"}).code, 2);
  EXPECT_EQ(drumsweep(folder, {"why", "out", "--at", "1,0.031"}).code, 2);
  EXPECT_EQ(drumsweep(folder, {"why", "nowhere", id}).code, 2);
}

TEST(Run, a_finished_folder_is_read_again_without_a_change) {
  const TestFolder folder;
  write_text(folder / "study.toml", tiny_study());
  ASSERT_EQ(drumsweep(folder, {"run", "study.toml", "-o", "out"}).code, 0);
  const std::string csv = file_text(folder / "out/results.csv"), image = file_text(folder / "out/results.h5");
  ASSERT_GT(image.size(), 1000u);
  ASSERT_EQ(drumsweep(folder, {"run", "study.toml", "-o", "out"}).code, 0);
  EXPECT_TRUE(file_text(folder / "out/results.csv") == csv);
  EXPECT_TRUE(file_text(folder / "out/results.h5") == image);
  std::filesystem::remove(folder / "out/results.h5");
  std::filesystem::remove(folder / "out/results.csv");
  ASSERT_EQ(drumsweep(folder, {"run", "study.toml", "-o", "out"}).code, 0);
  EXPECT_TRUE(file_text(folder / "out/results.csv") == csv);
  EXPECT_TRUE(file_text(folder / "out/results.h5") == image);
}

TEST(Simulate, json_is_complete_the_mass_balance_closes_and_it_agrees_with_the_sweep) {
  const TestFolder folder;
  write_text(folder / "study.toml", tiny_study());
  const Finished one = drumsweep(folder, {"simulate", "study.toml", "--at", "1,0.03", "-o", "one", "--json"});
  ASSERT_EQ(one.code, 0) << one.err;
  const Json json = JsonReader::parse(one.out);
  const Json& balance = json["mass_balance"];
  EXPECT_EQ(balance["fed"].number, balance["landed"].number + balance["spilled"].number + balance["inside"].number +
                                       balance["removed"].number);
  EXPECT_GT(balance["fed"].number, 500);
  EXPECT_EQ(json["lost_balls"].number, 0);
  EXPECT_EQ(json["state_hash"].text.size(), 16u);
  EXPECT_GT(json["residual"].number, 0);
  EXPECT_GT(json["cpu_s"].number, 0);

  std::map<std::string, double> value;
  double shares = 0;
  std::size_t heights = 0;
  for (const Json& o : json["observables"].list) {
    const std::string& name = o["name"].text;
    value[name] = o["value"].number;
    EXPECT_FALSE(o["unit"].text.empty());
    if (name.rfind("outflow_share", 0) == 0) shares += o["value"].number;
    if (name == "bed_height") {
      ++heights;
      EXPECT_EQ(o["position"].type, Json::Type::number);
    } else {
      EXPECT_EQ(o["position"].type, Json::Type::null);
    }
  }
  EXPECT_NEAR(shares, 1, 1e-12);
  EXPECT_EQ(heights, 12u);  // 0.3 m of belt in cells of 2.5 balls
  for (const char* name : {"f", "f_belt", "f_footprint", "max_an_over_a0", "mean_height", "holdup", "lost_balls"})
    EXPECT_EQ(value.count(name), 1u) << name;

  // The same design in a sweep: the same bits.
  ASSERT_EQ(drumsweep(folder, {"run", "study.toml", "-o", "out"}).code, 0);
  EXPECT_NE(file_text(folder / "out/results.csv").find(json["state_hash"].text), std::string::npos);
  const std::string id = json["design_id"].text;
  EXPECT_TRUE(file_text(folder / ("one/" + id + ".h5")) == file_text(folder / ("out/designs/" + id + ".h5")));

  // Its warm drum is used again, and refused when the study is another.
  const Finished again = drumsweep(folder, {"simulate", "study.toml", "--at", "3,0.03", "-o", "one"});
  EXPECT_EQ(again.code, 0);
  EXPECT_EQ(again.err.find("warm-up"), std::string::npos) << again.err;
  write_text(folder / "study.toml", replaced(tiny_study(), "rate_kg_s = 0.15", "rate_kg_s = 0.2"));
  EXPECT_EQ(drumsweep(folder, {"simulate", "study.toml", "--at", "1,0.03", "-o", "one"}).code, 5);
}

TEST(Simulate, the_shipped_quick_drum_gets_steady_and_loses_no_ball) {
  const TestFolder folder;
  const std::string study = std::string(DRUMSWEEP_SOURCE_DIR) + "/schedules/quick.toml";
  const Finished one = drumsweep(folder, {"simulate", study, "--at", "3,0.035", "-o", "one", "--json"});
  ASSERT_EQ(one.code, 0) << one.err;
  const Json json = JsonReader::parse(one.out);
  EXPECT_EQ(json["lost_balls"].number, 0);
  EXPECT_EQ(json["mass_balance"]["removed"].number, 0);
  EXPECT_EQ(json["state"].text, "done");
}

TEST(Simulate, a_blocked_feed_is_said) {
  const TestFolder folder;
  write_text(folder / "study.toml", replaced(tiny_study(), "rate_kg_s = ", "rate_kg_s = 9"));
  const Finished one = drumsweep(folder, {"simulate", "study.toml", "-o", "one", "--json"});
  ASSERT_EQ(one.code, 0) << one.err;
  EXPECT_EQ(JsonReader::parse(one.out)["state"].text, "untrusted");
}

TEST(Check, every_shipped_schedule_is_valid) {
  const TestFolder folder;
  int num = 0;
  for (const auto& entry : std::filesystem::directory_iterator(std::string(DRUMSWEEP_SOURCE_DIR) + "/schedules")) {
    // A campaign is for `diagnose`; tests/diagnosis reads those.
    if (entry.path().extension() != ".toml" || entry.path().stem().string().ends_with("_campaign")) continue;
    EXPECT_EQ(drumsweep(folder, {"check", entry.path().string()}).code, 0) << entry.path();
    ++num;
  }
  EXPECT_GE(num, 3);
}

TEST(Check, one_quantity_twice_in_a_stage_is_refused) {
  const TestFolder folder;
  write_text(folder / "study.toml", replaced(tiny_study(), "\"outlet.base_width_m\"", "\"outlet.opening_angle_rad\""));
  const Finished result = drumsweep(folder, {"check", "study.toml"});
  EXPECT_EQ(result.code, 2);
  EXPECT_NE(result.err.find("same quantity"), std::string::npos) << result.err;
}

TEST(Simulate, wrong_values_are_exit_2) {
  const TestFolder folder;
  write_text(folder / "study.toml", tiny_study());
  const Finished number = drumsweep(folder, {"simulate", "study.toml", "--at", "1", "-o", "one"});
  EXPECT_EQ(number.code, 2);
  EXPECT_NE(number.err.find("outlet.opening_angle_deg, outlet.base_width_m"), std::string::npos) << number.err;
  EXPECT_EQ(drumsweep(folder, {"simulate", "study.toml", "--at", "1,nan", "-o", "one"}).code, 2);
  EXPECT_EQ(drumsweep(folder, {"simulate", "study.toml", "--at", "1,0.5", "-o", "one"}).code, 2);
  EXPECT_FALSE(std::filesystem::exists(folder / "one"));
}

TEST(Contour, table_and_matrix_of_a_sweep) {
  const TestFolder folder;
  write_text(folder / "study.toml", tiny_study());
  ASSERT_EQ(drumsweep(folder, {"run", "study.toml", "-o", "out"}).code, 0);
  EXPECT_EQ(drumsweep(folder, {"contour", "out", "-o", "c.csv"}).code, 0);
  EXPECT_EQ(file_text(folder / "c.csv").rfind("stage,opening_angle_deg,base_width_m,f_m", 0), 0u)
      << file_text(folder / "c.csv");
  EXPECT_EQ(drumsweep(folder, {"contour", "out", "-o", "m.csv", "--matrix", "--stage", "coarse"}).code, 0);
  EXPECT_EQ(drumsweep(folder, {"contour", "out", "-o", "c.pdf"}).code, 2);
  EXPECT_EQ(drumsweep(folder, {"contour", "out", "-o", "c.csv", "--stage", "none"}).code, 2);
}

}  // namespace
}  // namespace drumsweep

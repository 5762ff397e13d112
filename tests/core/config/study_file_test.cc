#include <gtest/gtest.h>

#include <cmath>

#include "core/config/schema.h"
#include "core/config/toml_reader.h"
#include "support/complaint.h"
#include "support/small_drum.h"

namespace drumsweep {
namespace {

const std::string angle = "[outlet]\nopening_angle_deg = 0.2\n";

/// The message that reading `text` ends with.
std::string refusal(const std::string& text) {
  return complaint([&] { parse_study(text, "a.toml"); });
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST(StudyFile, defaults_are_the_lab_drum_of_s1) {
  const Study s = parse_study(angle, "a.toml");
  EXPECT_EQ(s.drum.diameter_m, 0.75);
  EXPECT_EQ(s.drum.length_m, 2.5);
  EXPECT_EQ(s.feed.rate_kg_s, 4.4);
  EXPECT_EQ(s.material.stiffness_N_m15, 25000);
}

TEST(StudyFile, is_written_and_read_back_without_loss) {
  Study s = small_drum();
  s.name = "with \"quotes\" and \\ back";
  s.outlet.base_width_m = 0.1 / 3;
  s.stages.push_back({"one", "grid", {{"outlet.base_width_m", 0.01, 0.02, 3, {}}}});
  s.stages.push_back({"two", "points", {{"outlet.opening_angle_deg", not_given, not_given, 1, {0.1, 1.0 / 3}}}});
  for (const bool comments : {false, true}) {
    const Study back = parse_study(write_study(s, comments), "written");
    EXPECT_TRUE(differences(s, back).empty());
    EXPECT_EQ(write_study(back, comments), write_study(s, comments));
    ASSERT_EQ(back.stages.size(), 2u);
    EXPECT_EQ(back.stages[1].variables[0].values[1], 1.0 / 3);
  }
}

TEST(StudyFile, an_unknown_key_is_an_error_with_the_nearest_known_one) {
  EXPECT_TRUE(has(refusal(angle + "[drum]\ndiametre_m = 1.0\n"), "a.toml:4:"));
  EXPECT_TRUE(has(refusal(angle + "[drum]\ndiametre_m = 1.0\n"), "did you mean drum.diameter_m?"));
  EXPECT_TRUE(has(refusal(angle + "[drum]\ndiameter_mm = 750\n"), "did you mean drum.diameter_m?"));
  EXPECT_TRUE(has(refusal(angle + "[drun]\n"), "did you mean drum?"));
  EXPECT_TRUE(has(refusal(angle + "[[stage]]\nname='a'\nvariabels=[]\n"), "did you mean stage.variables?"));
}

TEST(StudyFile, wrong_toml_names_line_and_column) { EXPECT_TRUE(has(refusal(angle + "[drum\n"), "a.toml:3:")); }

TEST(StudyFile, a_value_out_of_range_names_place_key_value_and_range) {
  const std::string text = refusal(angle + "[drum]\ndiameter_m = -1\n");
  EXPECT_TRUE(has(text, "a.toml:4:")) << text;
  EXPECT_TRUE(has(text, "drum.diameter_m = -1.0: accepted is 0.02 to 20")) << text;
  EXPECT_TRUE(has(refusal(angle + "[drum]\ndiameter_m = nan\n"), "accepted is"));
  EXPECT_TRUE(has(refusal(angle + "[drum]\ndiameter_m = \"wide\"\n"), "needs a number"));
  EXPECT_TRUE(has(refusal(angle + "[belt]\nedge = \"wall\"\n"), "accepted is skirt | open"));
  EXPECT_TRUE(has(refusal(angle + "[solver]\niterations = 2.5\n"), "whole number"));
  EXPECT_TRUE(has(refusal(angle + "[solver]\nwarm_start = 1\n"), "true or false"));
}

TEST(StudyFile, the_opening_angle_is_given_once_and_with_its_unit) {
  EXPECT_TRUE(has(refusal(""), "missing"));
  EXPECT_TRUE(has(refusal("[outlet]\nopening_angle_deg = 1\nopening_angle_rad = 0.1\n"), "one of the two"));
  EXPECT_TRUE(has(refusal("[outlet]\nopening_angle_rad = 0.6\nbase_width_m = 0.4\n"), "overlap"));
}

TEST(StudyFile, stages_are_checked) {
  const auto stage = [](const std::string& variables) {
    return angle + "[[stage]]\nname = \"a\"\ntype = \"grid\"\nvariables = [" + variables + "]\n";
  };
  EXPECT_EQ(refusal(stage("{key='outlet.base_width_m', from=0.01, to=0.05, count=3}")), "");
  EXPECT_TRUE(has(refusal(stage("{key='outlet.base_widht_m', from=0.01, to=0.05, count=3}")),
                  "did you mean outlet.base_width_m?"));
  EXPECT_TRUE(has(refusal(stage("{key='outlet.base_width_m', from=0.05, to=0.01, count=3}")), "from <= to"));
  EXPECT_TRUE(
      has(refusal(stage("{key='outlet.base_width_m', from=0.01, to=500, count=3}")), "accepted is 0.001 to 10"));
  EXPECT_TRUE(has(refusal(stage("{key='outlet.base_width_m', values=[0.01]}")), "not values"));
  EXPECT_TRUE(has(refusal(stage("{key='material.friction', from=0.1, to=0.5, count=3}")), "one warm drum"));
  EXPECT_TRUE(has(refusal(stage("")), "at least one"));
}

TEST(StudyFile, a_missing_file_is_named) {
  EXPECT_TRUE(has(complaint([] { read_study("/no/such/file.toml"); }), "/no/such/file.toml"));
}

TEST(StudyFile, keys_set_on_the_command_line_stand_over_the_file) {
  const std::string path = DRUMSWEEP_SOURCE_DIR "/schedules/quick.toml";
  const Study changed = read_study(path, {"solver.iterations=77", "outlet.bisector_sense=against_rotation"});
  const std::vector<Difference> changes = differences(read_study(path), changed);
  ASSERT_EQ(changes.size(), 2u);
  EXPECT_EQ(changed.solver.iterations, 77);
  EXPECT_EQ(changed.outlet.bisector_sense, "against_rotation");
  EXPECT_EQ(changed.stages.size(), read_study(path).stages.size());
  EXPECT_TRUE(has(complaint([&] { read_study(path, {"solver.iteration=7"}); }), "did you mean solver.iterations?"));
  const auto refusal = [&](const std::string& change) { return complaint([&] { read_study(path, {change}); }); };
  EXPECT_TRUE(has(refusal("solver.iterations=0"), "--set: solver.iterations = 0: accepted is"));
  EXPECT_TRUE(has(refusal("solver.iterations"), "needs KEY=VALUE"));
  EXPECT_TRUE(has(refusal("seed=1\nsolver.iterations=5"), "needs KEY=VALUE"));
  EXPECT_TRUE(has(refusal("stage=[]"), "in the file only"));
  EXPECT_TRUE(has(refusal("outlet.base_width_m=0.03"), "each design has its own"));
  EXPECT_EQ(read_study(path, {"name=3 mm"}).name, "3 mm");
  // All at once: each of these alone does not fit the other.
  EXPECT_EQ(
      read_study(path, {"drum.texture.height_min_m=0.02", "drum.texture.height_max_m=0.03"}).drum.texture.height_min_m,
      0.02);
}

TEST(StudyFile, an_angle_set_on_the_command_line_may_be_in_the_other_unit) {
  const std::string path = DRUMSWEEP_SOURCE_DIR "/schedules/scenes/../campaign/study.toml";
  const Study before = read_study(path), after = read_study(path, {"warmup.opening_angle_rad=0.01"});
  EXPECT_TRUE(std::isnan(after.warmup.opening_angle_deg));
  EXPECT_EQ(opening_angle_rad(warmup_outlet(after)), 0.01);
  const Study small = changed_study(small_drum(), {"outlet.opening_angle_rad=0.1"}, "--set");
  EXPECT_EQ(opening_angle_rad(small.outlet), 0.1);
}

TEST(StudyFile, setting_the_angle_in_one_unit_clears_the_other) {
  Study s = small_drum();
  set_number(s, "outlet.opening_angle_rad", 0.1);
  EXPECT_TRUE(std::isnan(s.outlet.opening_angle_deg));
  EXPECT_EQ(opening_angle_rad(s.outlet), 0.1);
}

}  // namespace
}  // namespace drumsweep

/// contour and sample on the folders of real sweeps, by the real program.
#include <gtest/gtest.h>
#include <stdlib.h>

#include <algorithm>

#include "cli/program.h"

namespace drumsweep {
namespace {

bool has_gnuplot() { return std::system("gnuplot --version > /dev/null 2>&1") == 0; }

/// 2 x 2 outlets at two belt speeds.
std::string cube_study() {
  return replaced(tiny_study(), "{ key = \"outlet.base_width_m\"",
                  "{ key = \"belt.speed_m_s\", from = 0.2, to = 0.3, count = 2 },\n  { key = \"outlet.base_width_m\"");
}

TEST(ContourSlice, holds_the_third_variable_and_says_what_is_wrong_with_it) {
  const TestFolder folder;
  write_text(folder / "study.toml", cube_study());
  ASSERT_EQ(drumsweep(folder, {"run", "study.toml", "-o", "out"}).code, 0);

  // Three vary.
  const Finished three = drumsweep(folder, {"contour", "out", "-o", "c.csv"});
  EXPECT_EQ(three.code, 2);
  EXPECT_NE(three.err.find("speed_m_s (0.2, 0.3)"), std::string::npos) << three.err;
  EXPECT_NE(three.err.find("--slice"), std::string::npos) << three.err;

  const std::vector<std::string> words = {"contour", "out",           "-o",      "m.csv",
                                          "--x",     "base_width_m",  "--y",     "outlet.opening_angle_deg",
                                          "--slice", "speed_m_s=0.3", "--matrix"};
  ASSERT_EQ(drumsweep(folder, words).code, 0);
  const std::string matrix = file_text(folder / "m.csv");
  EXPECT_TRUE(matrix.starts_with("opening_angle_deg\\base_width_m,0.02,0.03\n1,")) << matrix;
  EXPECT_EQ(std::count(matrix.begin(), matrix.end(), '\n'), 3);

  for (const auto& [slice, message] : {std::pair{"speed_m_s=0.4", "accepted: 0.2 to 0.3"},
                                       {"speed_m_s=0.25", "0.2, 0.3"},
                                       {"speed=0.3", "speed_m_s"},
                                       {"speed_m_s", "KEY=VALUE"},
                                       {"speed_m_s=fast", "KEY=VALUE"}}) {
    const Finished refused = drumsweep(folder, {"contour", "out", "-o", "x.csv", "--slice", slice});
    EXPECT_EQ(refused.code, 2) << slice;
    EXPECT_NE(refused.err.find(message), std::string::npos) << slice << ": " << refused.err;
  }
  EXPECT_EQ(drumsweep(folder, {"contour", "out", "-o", "x.png", "--matrix"}).code, 2);
  EXPECT_FALSE(std::filesystem::exists(folder / "x.csv"));
  if (!has_gnuplot()) GTEST_SKIP() << "NO GNUPLOT ON THIS MACHINE: the figures are NOT tested";
  const Finished figure = drumsweep(folder, {"contour", "out", "-o", "c.svg", "--slice", "speed_m_s=0.3"});
  EXPECT_EQ(figure.code, 0) << figure.err;
  EXPECT_NE(figure.err.find("no fit is drawn"), std::string::npos) << "4 of 8 designs are too few";
  const std::string svg = file_text(folder / "c.svg");
  EXPECT_NE(svg.find("4 of 8 designs lie in it"), std::string::npos);
  EXPECT_NE(svg.find("no fit is drawn"), std::string::npos);
}

TEST(Sample, shows_a_finished_design_and_takes_no_other_in_its_place) {
  if (!has_gnuplot()) GTEST_SKIP() << "NO GNUPLOT ON THIS MACHINE: the figures are NOT tested";
  const TestFolder folder;
  write_text(folder / "study.toml", tiny_study());
  ASSERT_EQ(drumsweep(folder, {"run", "study.toml", "-o", "out"}).code, 0);
  const std::string results = file_text(folder / "out/results.csv");

  const Finished text = drumsweep(folder, {"sample", "out", "--at", "1,0.02", "-o", "a/b"});
  ASSERT_EQ(text.code, 0) << text.err;
  EXPECT_NE(text.out.find("opening_angle_deg = 1, base_width_m = 0.02"), std::string::npos) << text.out;
  for (const char* name :
       {"landings.csv", "surface.csv", "profile.csv", "spectrum.csv", "sample.gp", "sample.png", "sample.svg"})
    EXPECT_GT(file_text(folder / "a/b/" + name).size(), 100u) << name;

  // The same numbers as in the table, by id and as JSON.
  const std::string id = text.out.substr(text.out.find_first_of("0123456789abcdef", 7), 10);
  const Finished json = drumsweep(folder, {"sample", "out", "--id", id.substr(0, 8), "--json", "-o", "c"});
  ASSERT_EQ(json.code, 0) << json.err;
  EXPECT_NE(json.out.find("\"design_id\": \"" + id + "\""), std::string::npos) << json.out;
  const std::size_t row = results.find(id);
  ASSERT_NE(row, std::string::npos);
  const std::string f = results.substr(results.find("0.", results.find("0.02,", row) + 5), 12);
  EXPECT_NE(json.out.find("\"f_m\": " + f.substr(0, 8)), std::string::npos) << json.out << f;
  EXPECT_EQ(file_text(folder / "c/landings.csv"), file_text(folder / "a/b/landings.csv"));
  EXPECT_EQ(file_text(folder / "c/sample.png"), file_text(folder / "a/b/sample.png"));
  EXPECT_EQ(file_text(folder / "out/results.csv"), results) << "looking changes nothing";

  // Not there, not given, or not finished.
  const Finished near = drumsweep(folder, {"sample", "out", "--at", "1.1,0.021", "-o", "d"});
  EXPECT_EQ(near.code, 2);
  EXPECT_NE(near.err.find("the nearest are\n  " + id), std::string::npos) << near.err;
  EXPECT_EQ(drumsweep(folder, {"sample", "out", "-o", "d"}).code, 2);
  EXPECT_EQ(drumsweep(folder, {"sample", "out", "--id", id, "--replicate", "1", "-o", "d"}).code, 2);
  std::filesystem::remove(folder / ("out/designs/" + id + ".h5"));
  const Finished gone = drumsweep(folder, {"sample", "out", "--id", id, "-o", "d"});
  EXPECT_EQ(gone.code, 2);
  EXPECT_NE(gone.err.find("has no landings: it has not ended yet"), std::string::npos) << gone.err;
  EXPECT_FALSE(std::filesystem::exists(folder / "d"));
}

TEST(Sample, without_gnuplot_the_tables_are_there_and_the_missing_picture_is_said) {
  const TestFolder folder;
  write_text(folder / "study.toml", tiny_study());
  ASSERT_EQ(drumsweep(folder, {"run", "study.toml", "-o", "out"}).code, 0);
  Program program(folder,
                  {"env", "PATH=" + folder.path, DRUMSWEEP_BINARY, "sample", "out", "--at", "1,0.02", "-o", "bare"});
  EXPECT_EQ(program.wait(), 0) << program.err();
  EXPECT_NE(program.err().find("no picture: gnuplot cannot be started"), std::string::npos) << program.err();
  for (const char* name : {"landings.csv", "surface.csv", "profile.csv", "spectrum.csv", "sample.gp"})
    EXPECT_FALSE(file_text(folder / "bare/" + name).empty()) << name;
  EXPECT_FALSE(std::filesystem::exists(folder / "bare/sample.png"));
}

}  // namespace
}  // namespace drumsweep

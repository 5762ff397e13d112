#include "postproc/sample_figure.h"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "postproc/child_process.h"
#include "tests/postproc/synthetic.h"

namespace drumsweep {
namespace {

/// Landings of a drum with three slots: each makes a stripe once a turn; every fifth ball goes over the end.
std::vector<Landing> striped_landings(const Study& study, std::size_t count) {
  const double turn_s = 2 * M_PI / study.drum.angular_velocity_rad_s;
  std::vector<Landing> landings;
  for (std::size_t i = 0; i < count; ++i) {
    const double u = std::fmod(0.618034 * static_cast<double>(i), 1.0);
    const double time = 2.0 * turn_s * static_cast<double>(i) / static_cast<double>(count);
    const auto slot = static_cast<std::uint8_t>(1 + static_cast<int>(3 * std::fmod(time / turn_s, 1.0)));
    Landing landing = landing_at(5.0 + time, 0.0, i % 5 == 0 ? 0.93 : 0.15 + 0.74 * u, static_cast<std::uint32_t>(i));
    landing.exit = i % 5 == 0 ? 255 : slot;
    landings.push_back(landing);
  }
  return landings;
}

DesignSample striped_sample(const std::string& window = "belt") {
  Study study;
  study.name = "stripes";
  study.objective.window = window;
  DesignSample sample = design_sample(striped_landings(study, 3000), 5.0, 2.0, study);
  sample.notes = {"opening angle 0.2 deg"};
  return sample;
}

std::vector<std::vector<double>> numbers(const std::string& csv) {
  std::vector<std::vector<double>> rows;
  std::istringstream lines(csv);
  std::string line;
  std::getline(lines, line);
  while (std::getline(lines, line)) {
    rows.emplace_back();
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');)
      rows.back().push_back(cell.empty() ? std::nan("") : std::stod(cell));
  }
  return rows;
}

TEST(SampleTables, have_units_in_their_headers_and_all_numbers) {
  const DesignSample sample = striped_sample();
  const auto tables = sample_tables(sample);
  ASSERT_EQ(tables.size(), 4u);
  EXPECT_TRUE(tables.at("landings.csv").starts_with("time_s,along_m,across_m,slot\n"));
  EXPECT_TRUE(tables.at("surface.csv").starts_with("along_m,across_m,height_m\n"));
  EXPECT_TRUE(tables.at("profile.csv").starts_with("across_m,height_m,sigma_height_m,under_outlet\n"));
  EXPECT_TRUE(tables.at("spectrum.csv").starts_with("mode,wavelength_m,amplitude_m,amplitude_over_a0\n"));

  const auto landings = numbers(tables.at("landings.csv"));
  EXPECT_EQ(landings.size(), 3000u);
  EXPECT_EQ(std::count_if(landings.begin(), landings.end(), [](const auto& row) { return row[3] == 0; }), 600);
  for (const auto& row : landings) {
    EXPECT_GE(row[1], 0.0);
    EXPECT_LE(row[1], sample.strip_length_m + 1e-6);
  }
}

TEST(SampleTables, surface_profile_and_spectrum_are_of_one_bed) {
  const DesignSample sample = striped_sample();
  const auto tables = sample_tables(sample);
  // The profile is the mean of the surface's rows.
  const auto surface = numbers(tables.at("surface.csv")), profile = numbers(tables.at("profile.csv"));
  double volume = 0, mean = 0;
  for (const auto& row : surface) volume += row[2] / static_cast<double>(surface.size());
  for (const auto& row : profile) mean += row[1] / static_cast<double>(profile.size());
  EXPECT_NEAR(volume, mean, 1e-12);
  EXPECT_NEAR(mean, sample.evaluation.objective.mean_height_m, 1e-12);
  // a_0 is the sum of the heights.
  const auto spectrum = numbers(tables.at("spectrum.csv"));
  ASSERT_EQ(spectrum.size(), profile.size() / 2 + 1);
  EXPECT_NEAR(spectrum[0][2], mean * static_cast<double>(profile.size()), 1e-9);
  EXPECT_EQ(spectrum[0][3], 1.0);
  EXPECT_DOUBLE_EQ(spectrum[4][1], 0.25) << "wavelength of mode 4 on a belt of 1 m";
  double largest = 0;
  for (std::size_t n = 1; n < spectrum.size(); ++n) largest = std::max(largest, spectrum[n][3]);
  EXPECT_NEAR(largest, sample.evaluation.objective.max_an_over_a0, 1e-12);
}

TEST(SampleTables, spectrum_is_that_of_the_window_that_counts) {
  const auto belt = numbers(sample_tables(striped_sample()).at("spectrum.csv"));
  const auto footprint = numbers(sample_tables(striped_sample("footprint")).at("spectrum.csv"));
  EXPECT_GT(belt.size(), footprint.size());
  EXPECT_LT(footprint[1][3], belt[1][3]) << "the heap at the end lies outside the footprint";
}

TEST(SampleFigure, marks_footprint_window_even_bed_and_a_tenth_of_a0_and_names_the_stripes) {
  const std::string script = sample_figure(striped_sample(), "sample.png").script;
  for (const char* words : {"y₁", "y₂", "window of f", "even bed", "a₀/10", "'slot 1'", "'slot 3'", "'end 20 %'",
                            "height (mm)", "1 of 2 turns", "across the belt (m)", "opening angle 0.2 deg"})
    EXPECT_NE(script.find(words), std::string::npos) << words;
}

TEST(SampleFigure, thinned_landings_are_said_to_be) {
  EXPECT_EQ(sample_figure(striped_sample(), "a.svg").script.find("is drawn"), std::string::npos);
  const std::string script = sample_figure(striped_sample(), "a.svg", {false, 500}).script;
  EXPECT_NE(script.find("is drawn"), std::string::npos);
  EXPECT_EQ(script.find("every 1 using"), std::string::npos);
}

TEST(SampleFigure, is_the_same_every_time_and_drawn_for_files_and_pages) {
  if (std::system("gnuplot --version > /dev/null 2>&1") != 0)
    GTEST_SKIP() << "NO GNUPLOT ON THIS MACHINE: the figures are NOT tested";
  const ScratchFolder scratch;
  const std::filesystem::path folder = scratch.path;
  const SampleFiles files = write_sample(striped_sample(), folder);
  EXPECT_EQ(files.names.size(), 7u);
  EXPECT_EQ(files.no_picture, "");
  const std::string first = file_content(folder / "sample.png");
  EXPECT_GT(first.size(), 40000u);
  // The script draws the same picture from the tables.
  std::filesystem::remove(folder / "sample.png");
  ASSERT_EQ(std::system(("cd \"" + folder.string() + "\" && gnuplot -d sample.gp").c_str()), 0);
  EXPECT_EQ(file_content(folder / "sample.png"), first);

  const std::string page = sample_for_page(striped_sample(), {"s1-", "one design"}, {.most_landings = 400});
  EXPECT_TRUE(page.starts_with("<svg role=\"img\" aria-label=\"one design\""));
  EXPECT_EQ(page.find("black"), std::string::npos);
  EXPECT_NE(page.find("currentColor"), std::string::npos);
  EXPECT_LT(page.size(), 150000u);
  EXPECT_EQ(sample_for_page(striped_sample(), {"s2-", "maps"}, {.maps_only = true}).find("modes of the height"),
            std::string::npos);
}

TEST(SampleFigure, of_a_design_from_which_nothing_landed_is_drawn) {
  if (std::system("gnuplot --version > /dev/null 2>&1") != 0)
    GTEST_SKIP() << "NO GNUPLOT ON THIS MACHINE: the figures are NOT tested";
  const DesignSample nothing = design_sample({}, 0.0, 2.0, Study{});
  EXPECT_EQ(mode_ratios(nothing)[1], 0.0);
  EXPECT_NE(sample_for_page(nothing, {"n-", "nothing"}, {}).find("</svg>"), std::string::npos);
}

}  // namespace
}  // namespace drumsweep

#include "postproc/contour.h"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <tuple>
#include <utility>

#include "core/config/schema.h"
#include "postproc/child_process.h"
#include "postproc/contour_figure.h"
#include "support/complaint.h"
#include "tests/postproc/synthetic.h"

namespace drumsweep {
namespace {

/// A valley like that of S1 with noise, on an evenly spaced grid.
void add_stage(ResultTable& table, const std::string& stage, std::pair<double, double> angle, int num_angles,
               std::pair<double, double> width, int num_widths, double noise_m = 0.0) {
  std::mt19937_64 random(table.rows.size() + 1);
  std::normal_distribution<double> noise(0.0, noise_m > 0.0 ? noise_m : 1.0);
  for (int i = 0; i < num_angles; ++i) {
    for (int j = 0; j < num_widths; ++j) {
      const double a = num_angles > 1 ? angle.first + (angle.second - angle.first) * i / (num_angles - 1) : angle.first;
      const double w = num_widths > 1 ? width.first + (width.second - width.first) * j / (num_widths - 1) : width.first;
      const double u = (a - 0.2) / 0.4, v = (w - 0.048) / 0.1;
      ResultRow row;
      row.design_id = stage + "-" + std::to_string(i) + "-" + std::to_string(j);
      row.stage = stage;
      row.state = "done";
      row.variables = {a, w};
      row.f_m = std::max(0.0, 0.006 + 0.05 * u * u + 0.09 * v * v + (noise_m > 0.0 ? noise(random) : 0.0));
      row.sigma_f_m = 0.0005;
      row.f_footprint_m = 0.5 * row.f_m;
      table.rows.push_back(row);
    }
  }
}

ResultTable empty_table() { return {{"opening_angle_deg", "base_width_m"}, {}}; }

ResultTable three_by_three() {
  ResultTable table = empty_table();
  add_stage(table, "coarse", {0.0, 0.6}, 3, {0.02, 0.2}, 3);
  return table;
}

TEST(ContourAxes, are_the_first_two_variables_that_vary) {
  ResultTable table{{"length_m", "opening_angle_deg", "base_width_m"}, {}};
  for (int k = 0; k < 4; ++k) {
    ResultRow row;
    row.variables = {0.75, 0.1 * (k % 2), 0.04 + 0.01 * (k / 2)};
    table.rows.push_back(row);
  }
  const ContourAxes axes = contour_axes(table, {});
  EXPECT_EQ(axes.x, 1U);
  EXPECT_EQ(axes.y, 2U);
  EXPECT_TRUE(axes.plane);

  ContourOptions turned;
  turned.x_variable = "base_width_m";
  EXPECT_EQ(contour_axes(table, turned).x, 2U);
  EXPECT_EQ(contour_axes(table, turned).y, 1U);
}

TEST(ContourAxes, more_than_two_that_vary_are_named) {
  ResultTable table{{"length_m", "opening_angle_deg", "base_width_m"}, {}};
  for (int k = 0; k < 3; ++k) {
    ResultRow row;
    row.stage = k < 2 ? "plane" : "other";
    row.variables = {0.75 + 0.1 * (k / 2), 0.1 * k, 0.04 + 0.01 * k};
    table.rows.push_back(row);
  }
  EXPECT_NE(complaint([&] { contour_axes(table, {}); }).find("length_m (0.75, 0.85), opening_angle_deg"),
            std::string::npos);
  ContourOptions one_stage;
  one_stage.stage = "plane";
  EXPECT_EQ(contour_axes(table, one_stage).x, 1U);
}

TEST(ContourAxes, unknown_variable_is_refused_with_those_there_are) {
  ContourOptions options;
  options.x_variable = "width_m";
  EXPECT_NE(complaint([&] { contour_axes(three_by_three(), options); }).find("opening_angle_deg, base_width_m"),
            std::string::npos);
}

TEST(ContourLabel, has_words_and_unit) {
  EXPECT_EQ(axis_label("opening_angle_deg"), "opening angle (deg)");
  EXPECT_EQ(axis_label("outlet.base_width_m"), "base width (m)");
  EXPECT_EQ(axis_label("drum.angular_velocity_rad_s"), "angular velocity (rad/s)");
  EXPECT_EQ(axis_label("feed.rate_kg_s"), "rate (kg/s)");
  EXPECT_EQ(axis_label("material.friction"), "friction");
}

TEST(ContourTable, long_form_is_sorted_and_independent_of_the_order_of_rows) {
  ResultTable table = empty_table();
  add_stage(table, "fine", {0.1, 0.3}, 2, {0.04, 0.05}, 1);
  add_stage(table, "coarse", {0.0, 0.6}, 1, {0.02, 0.2}, 2);
  table.rows[1].state = "failed";
  table.rows[1].f_m = table.rows[1].f_footprint_m = table.rows[1].sigma_f_m = std::nan("");
  const std::string csv = contour_csv(table, {});
  std::reverse(table.rows.begin(), table.rows.end());
  EXPECT_EQ(contour_csv(table, {}), csv);
  EXPECT_EQ(csv.substr(0, csv.find('\n')), "stage,opening_angle_deg,base_width_m,f_m,sigma_f_m,f_footprint_m,state");
  EXPECT_LT(csv.find("coarse,0,0.02,"), csv.find("coarse,0,0.2,"));
  EXPECT_LT(csv.find("coarse,0,0.2,"), csv.find("fine,0.1,0.04,"));
  EXPECT_NE(csv.find("fine,0.3,0.04,,,,failed\n"), std::string::npos);
}

TEST(ContourTable, matrix_has_the_coordinates_in_front_and_empty_cells_for_failed_designs) {
  ResultTable table = empty_table();
  add_stage(table, "coarse", {0.0, 0.5}, 2, {0.02, 0.2}, 2);
  for (std::size_t k = 0; k < 4; ++k) table.rows[k].f_m = 0.001 * static_cast<double>(k + 1);
  table.rows[2].state = "failed";
  EXPECT_EQ(contour_matrix_csv(table, {}), "base_width_m\\opening_angle_deg,0,0.5\n0.02,0.001,\n0.2,0.002,0.004\n");
  table.rows.pop_back();
  EXPECT_NE(complaint([&] { contour_matrix_csv(table, {}); }).find("3 of the 2 x 2"), std::string::npos);
}

TEST(ContourTable, matrix_of_two_stages_asks_which) {
  ResultTable table = three_by_three();
  add_stage(table, "fine", {0.1, 0.3}, 2, {0.04, 0.05}, 2);
  EXPECT_NE(complaint([&] { contour_matrix_csv(table, {}); }).find("coarse, fine"), std::string::npos);
  ContourOptions options;
  options.stage = "fine";
  const std::string csv = contour_matrix_csv(table, options);
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 3);
}

TEST(ContourFigure, source_is_the_same_every_time) {
  const FigureFiles first = contour_figure(three_by_three(), {}, "a.dat", "a.png");
  const FigureFiles second = contour_figure(three_by_three(), {}, "a.dat", "a.png");
  EXPECT_EQ(first.script, second.script);
  EXPECT_EQ(first.data, second.data);
}

TEST(ContourFigure, has_a_bold_line_where_f_crosses_the_tolerance_and_only_then) {
  ResultTable table = empty_table();
  add_stage(table, "grid", {0.0, 0.6}, 14, {0.02, 0.2}, 14, 0.0005);
  EXPECT_NE(contour_figure(table, {}, "a.dat", "a.png").script.find("f = 10 mm (tolerance)"), std::string::npos);
  ContourOptions far;
  far.tolerance_m = 10.0;
  EXPECT_EQ(contour_figure(table, far, "a.dat", "a.png").script.find("tolerance"), std::string::npos);
}

TEST(ContourFigure, best_is_the_lowest_trusted_design) {
  ResultTable table = three_by_three();
  table.rows[0].f_m = 0.001;
  table.rows[0].state = "untrusted";
  table.rows[8].f_m = 0.002;
  const std::string script = contour_figure(table, {}, "a.dat", "a.png").script;
  EXPECT_NE(script.find("best design: f = 2.0 ± 0.5 mm at opening angle 0.6 deg, base width 0.2 m"), std::string::npos)
      << script;
  EXPECT_NE(script.find("'untrusted'"), std::string::npos);
}

TEST(ContourFigure, table_without_a_value_is_refused) {
  ResultTable table = three_by_three();
  for (ResultRow& row : table.rows) row.state = "failed";
  EXPECT_NE(complaint([&] { contour_figure(table, {}, "a.dat", "a.png"); }).find("nothing to draw"), std::string::npos);
}

TEST(ContourFigure, names_cannot_break_out_of_the_script) {
  ContourOptions options;
  options.title = "it's; system('false')\nquit";
  const std::string script = contour_figure(three_by_three(), options, "a'b.dat", "a.png").script;
  EXPECT_NE(script.find("set label 1 'it''s; system(''false'') quit'"), std::string::npos) << script;
  EXPECT_NE(script.find("'a''b.dat'"), std::string::npos);
}

TEST(ContourFigure, unknown_ending_is_refused) {
  EXPECT_NE(complaint([&] { write_contour(three_by_three(), {}, "/tmp/figure.jpg"); }).find(".jpg"), std::string::npos);
}

class DrawnFigure : public testing::Test {
 protected:
  void SetUp() override {
    if (std::system("gnuplot --version > /dev/null 2>&1") != 0)
      GTEST_SKIP() << "NO GNUPLOT ON THIS MACHINE: the figures are NOT tested";
    std::filesystem::create_directory(folder_);
  }

  /// Draws both formats and checks that there is something in them.
  void expect_drawn(const ResultTable& table, const std::string& name) {
    ContourOptions options;
    options.title = name;
    write_contour(table, options, folder_ / (name + ".png"));
    write_contour(table, options, folder_ / (name + ".svg"));

    // A white canvas of this size packs to 4 kB; axes, text and symbols make 20 kB.
    const std::string png = file_content(folder_ / (name + ".png"));
    ASSERT_GT(png.size(), 15000U) << name;
    EXPECT_EQ(png.substr(1, 3), "PNG");
    const std::string svg = file_content(folder_ / (name + ".svg"));
    EXPECT_NE(svg.find("</svg>"), std::string::npos) << name;
    EXPECT_NE(svg.find(">" + name + "<"), std::string::npos) << name << ": title";
    EXPECT_NE(svg.find("best design: f = "), std::string::npos) << name;
    EXPECT_NE(svg.find("xlink:href='#gpPt"), std::string::npos) << name << ": symbols";
  }

  ScratchFolder scratch_;
  std::filesystem::path folder_ = scratch_.path / "it's a figure";
};

TEST_F(DrawnFigure, of_every_kind_of_table_is_there_and_not_blank) {
  expect_drawn(three_by_three(), "three");

  ResultTable smooth = empty_table();
  add_stage(smooth, "grid", {0.0, 0.6}, 14, {0.02, 0.2}, 14, 0.0008);
  expect_drawn(smooth, "fourteen");
  for (std::size_t k : {0U, 30U, 100U, 101U, 102U, 116U}) {
    smooth.rows[k].state = "failed";
    smooth.rows[k].f_m = std::nan("");
  }
  expect_drawn(smooth, "holes");

  ResultTable stages = three_by_three();
  add_stage(stages, "fine", {0.1, 0.3}, 9, {0.03, 0.08}, 9, 0.0003);
  add_stage(stages, "refine", {0.21, 0.21}, 1, {0.05, 0.05}, 1);
  expect_drawn(stages, "stages");

  ResultTable level = three_by_three();
  for (ResultRow& row : level.rows) row.f_m = 0.02;
  expect_drawn(level, "level");
  for (ResultRow& row : level.rows) row.f_m = 0.0;
  expect_drawn(level, "zero");

  for (const auto& [name, num_angles, num_widths] : {std::tuple{"row", 7, 1}, {"column", 1, 7}, {"point", 1, 1}}) {
    ResultTable line = empty_table();
    add_stage(line, "line", {0.1, 0.3}, num_angles, {0.03, 0.08}, num_widths);
    expect_drawn(line, name);
  }

  ResultTable scattered = three_by_three();
  for (std::size_t k = 0; k < scattered.rows.size(); ++k)
    scattered.rows[k].variables[1] += 0.001 * static_cast<double>(k);
  expect_drawn(scattered, "scattered");

  ResultTable sparse = three_by_three();
  for (std::size_t k : {1U, 3U, 4U, 5U, 7U}) sparse.rows[k].f_m = std::nan("");
  expect_drawn(sparse, "corners");
}

TEST_F(DrawnFigure, script_beside_its_data_draws_the_same_picture) {
  write_contour(three_by_three(), {}, folder_ / "map.gp");
  write_contour(three_by_three(), {}, folder_ / "direct.png");
  ASSERT_TRUE(std::filesystem::exists(folder_ / "map.dat"));
  const std::string command = "cd \"" + folder_.string() + "\" && gnuplot -d map.gp 2> /dev/null";
  ASSERT_EQ(std::system(command.c_str()), 0);
  EXPECT_EQ(file_content(folder_ / "map.png"), file_content(folder_ / "direct.png"));
}

TEST_F(DrawnFigure, failure_of_gnuplot_leaves_no_file_and_says_why) {
  // A gnuplot that fails, then none at all.
  const std::string path = getenv("PATH") != nullptr ? getenv("PATH") : "";
  const std::filesystem::path programs = folder_ / "programs";
  std::filesystem::create_directories(programs);
  std::ofstream(programs / "gnuplot") << "#!/bin/sh\necho 'no such terminal' >&2\nexit 7\n";
  std::filesystem::permissions(programs / "gnuplot", std::filesystem::perms::owner_all);
  const auto message = [&] {
    try {
      write_contour(three_by_three(), {}, folder_ / "figure.png");
    } catch (const std::runtime_error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  setenv("PATH", programs.c_str(), 1);
  const std::string failed = message();
  std::filesystem::remove(programs / "gnuplot");
  const std::string missing = message();
  setenv("PATH", path.c_str(), 1);
  EXPECT_NE(failed.find("exit code 7"), std::string::npos) << failed;
  EXPECT_NE(failed.find("no such terminal"), std::string::npos) << failed;
  EXPECT_NE(missing.find("install gnuplot"), std::string::npos) << missing;
  EXPECT_FALSE(std::filesystem::exists(folder_ / "figure.png"));
}

TEST(Contour, a_grid_stage_gets_back_the_nodes_that_an_earlier_stage_holds) {
  ResultTable table{{"opening_angle_deg", "base_width_m"}, {}};
  const auto add = [&](const char* stage, double x, double y) {
    ResultRow row;
    row.stage = stage;
    row.state = "done";
    row.variables = {x, y};
    row.f_m = 0.01 + x + y;
    table.rows.push_back(row);
  };
  for (const double x : {0.0, 3.0})
    for (const double y : {0.0, 3.0}) add("coarse", x, y);
  // The fine stage's corners are the coarse stage's.
  for (const double x : {0.0, 1.0, 2.0, 3.0})
    for (const double y : {0.0, 1.0, 2.0, 3.0})
      if (x == 1.0 || x == 2.0 || y == 1.0 || y == 2.0) add("fine", x, y);
  ContourOptions options;
  EXPECT_EQ(with_shared_designs(table, options).rows.size(), 4u + 16u);
  options.stage = "fine";
  EXPECT_THROW(contour_matrix_csv(table, options), InputError);
  EXPECT_NO_THROW(contour_matrix_csv(with_shared_designs(table, options), options));
}

}  // namespace
}  // namespace drumsweep

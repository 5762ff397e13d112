#include "postproc/contour_content.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/config/schema.h"

namespace drumsweep {
namespace {

/// f = 10 mm + 20 mm x + 10 mm y + 5 mm z on 0, 0.25 ... 1; z varies if more than one is asked for.
ResultTable plane_table(const std::vector<double>& z_values = {0.0}) {
  ResultTable table{{"x", "y", "z"}, {}};
  for (const double z : z_values)
    for (int i = 0; i < 5; ++i)
      for (int j = 0; j < 5; ++j) {
        ResultRow row;
        row.design_id = std::to_string(table.rows.size());
        row.stage = "grid";
        row.state = "done";
        row.variables = {0.25 * i, 0.25 * j, z};
        row.f_m = 0.01 + 0.02 * row.variables[0] + 0.01 * row.variables[1] + 0.005 * z;
        row.sigma_f_m = 0.001;
        table.rows.push_back(row);
      }
  return table;
}

void fail(ResultTable& table, double x, double y) {
  for (ResultRow& row : table.rows)
    if (row.variables[0] == x && row.variables[1] == y) {
      row.state = "failed";
      row.f_m = row.sigma_f_m = std::nan("");
    }
}

/// A fit that says 7 mm everywhere on a mesh larger than the designs.
ContourFit flat_fit() {
  ContourFit fit;
  fit.usable = true;
  fit.num_fitted = fit.num_designs = 25;
  fit.x = fit.y = {-1.0, 2.0};
  fit.value_m.assign(4, 0.007);
  fit.optimum = {{"x", "y"}, {0.5, 0.5}, {0.4, 0.3}, {0.6, 0.7}, 0.007, 0.001, {}};
  for (int i = 0; i < 200; ++i) fit.optimum->draws.push_back({0.5 + 0.1 * std::cos(i), 0.5 + 0.2 * std::sin(i)});
  return fit;
}

ContourContent content_of(const ResultTable& table, const ContourOptions& options) {
  return contour_content(table, options, contour_axes(table, options));
}

/// Colour at a place, NaN for none.
double colour(const ContourContent& content, double x, double y) {
  const Raster& raster = content.raster;
  const auto node = [&](double low, double high, double at) {
    return static_cast<std::size_t>(std::lround((at - low) / (high - low) * (raster.size - 1)));
  };
  return raster.value[node(raster.low.y, raster.high.y, y) * static_cast<std::size_t>(raster.size) +
                      node(raster.low.x, raster.high.x, x)];
}

double hatched_near(const ContourContent& content, double x, double y, double reach) {
  double length = 0;
  for (const auto& line : content.hatching) {
    const PlanePoint middle{0.5 * (line[0].x + line[1].x), 0.5 * (line[0].y + line[1].y)};
    if (std::abs(middle.x - x) < reach && std::abs(middle.y - y) < reach)
      length += std::hypot(line[1].x - line[0].x, line[1].y - line[0].y);
  }
  return length;
}

TEST(ContourContent, without_a_fit_the_map_is_what_lies_between_neighbours) {
  const ContourContent content = content_of(plane_table(), {});
  EXPECT_TRUE(content.interpolation_is_drawn);
  EXPECT_FALSE(content.fit_is_drawn);
  EXPECT_NEAR(colour(content, 0.6, 0.3), 25.0, 0.1);
  EXPECT_TRUE(content.hatching.empty());
  EXPECT_TRUE(content.region.empty());
}

TEST(ContourContent, a_fit_to_trust_is_drawn_inside_the_designs_only) {
  ResultTable table = plane_table();
  // A triangle of designs.
  std::erase_if(table.rows, [](const ResultRow& row) { return row.variables[0] + row.variables[1] > 1.0; });
  ContourOptions options;
  options.fit = flat_fit();
  const ContourContent content = content_of(table, options);
  EXPECT_TRUE(content.fit_is_drawn);
  EXPECT_FALSE(content.interpolation_is_drawn);
  EXPECT_EQ(content.hull.size(), 3u);
  EXPECT_DOUBLE_EQ(colour(content, 0.4, 0.4), 7.0);
  EXPECT_TRUE(std::isnan(colour(content, 0.6, 0.6))) << "outside the hull of the designs";
}

TEST(ContourContent, a_fit_that_is_not_to_be_trusted_is_not_drawn) {
  ContourOptions options;
  options.fit = flat_fit();
  options.fit->usable = false;
  const ContourContent content = content_of(plane_table(), options);
  EXPECT_FALSE(content.fit_is_drawn);
  EXPECT_TRUE(content.region.empty());
  EXPECT_NEAR(colour(content, 0.6, 0.3), 25.0, 0.1);
}

TEST(ContourContent, the_cell_of_a_failed_design_is_hatched_and_has_no_colour) {
  for (const bool with_fit : {false, true}) {
    ResultTable table = plane_table();
    fail(table, 0.5, 0.5);
    ContourOptions options;
    if (with_fit) options.fit = flat_fit();
    const ContourContent content = content_of(table, options);
    ASSERT_EQ(content.failed.size(), 1u);
    // Half way to the neighbours, 0.125 each side; the lines are 0.014 apart.
    for (const double dx : {-0.1, 0.0, 0.1})
      for (const double dy : {-0.1, 0.0, 0.1}) EXPECT_TRUE(std::isnan(colour(content, 0.5 + dx, 0.5 + dy)));
    EXPECT_TRUE(std::isfinite(colour(content, 0.3, 0.3)));
    double hatched = 0;
    for (const auto& line : content.hatching) hatched += std::hypot(line[1].x - line[0].x, line[1].y - line[0].y);
    // Without a fit the four triangles between failed design and neighbours are blank too, and hatched: a diamond.
    const double blank = with_fit ? 0.25 * 0.25 : 2 * 0.25 * 0.25;
    EXPECT_NEAR(hatched * 0.014, blank, 0.15 * blank) << with_fit;
    EXPECT_GT(hatched_near(content, 0.5, 0.5, 0.125), 0.0);
  }
}

TEST(ContourContent, a_whole_line_of_failed_designs_is_not_bridged) {
  ResultTable table = plane_table();
  for (int j = 0; j < 5; ++j) fail(table, 0.5, 0.25 * j);
  const ContourContent content = content_of(table, {});
  EXPECT_TRUE(std::isnan(colour(content, 0.5, 0.6)));
  EXPECT_TRUE(std::isnan(colour(content, 0.35, 0.6)));
  EXPECT_TRUE(std::isfinite(colour(content, 0.2, 0.6)));
}

TEST(ContourContent, a_corner_of_failed_designs_is_hatched_without_a_gap) {
  ResultTable table = plane_table();
  for (const double x : {0.5, 0.75, 1.0})
    for (const double y : {0.75, 1.0}) fail(table, x, y);
  ContourOptions options;
  options.fit = flat_fit();
  const ContourContent content = content_of(table, options);
  double hatched = 0;
  for (const auto& line : content.hatching) hatched += std::hypot(line[1].x - line[0].x, line[1].y - line[0].y);
  EXPECT_NEAR(hatched * 0.014, 0.625 * 0.375, 0.015);
}

TEST(ContourContent, a_design_without_a_ball_under_the_outlet_is_not_the_best_one) {
  ResultTable table = plane_table();
  for (ResultRow& row : table.rows) row.f_footprint_m = 0.5 * row.f_m;
  table.rows[7].f_footprint_m = 0.0;
  ContourOptions options;
  options.value = "f_footprint_m";
  const ContourContent content = content_of(table, options);
  ASSERT_TRUE(content.best);
  EXPECT_NEAR(content.best->f_mm, 5.0, 1e-9);
}

TEST(ContourContent, steps_of_a_search_are_no_grid) {
  ResultTable table = plane_table();
  // A cross: three of its points are corners of a cell.
  std::erase_if(table.rows, [](const ResultRow& row) {
    const double x = row.variables[0], y = row.variables[1];
    return x != 0.25 && y != 0.25;
  });
  std::erase_if(table.rows, [](const ResultRow& row) { return row.variables[0] == 1.0; });
  table.rows.push_back(table.rows.front());
  table.rows.back().variables = {0.9, 0.8, 0.0};
  table.rows.push_back(table.rows.front());
  table.rows.back().variables = {0.8, 0.9, 0.0};
  const ContourContent content = content_of(table, {});
  EXPECT_EQ(content.raster.size, 0);
  EXPECT_FALSE(content.interpolation_is_drawn);
}

TEST(ContourContent, the_region_of_the_optimum_holds_its_draws_in_the_plane) {
  ContourOptions options;
  options.fit = flat_fit();
  const Polygon region = content_of(plane_table(), options).region;
  ASSERT_GT(region.size(), 4u);
  // An ellipse with half axes 0.1 and 0.2.
  EXPECT_NEAR(area(region), M_PI * 0.1 * 0.2, 0.1 * M_PI * 0.1 * 0.2);
  EXPECT_TRUE(inside(region, {0.5, 0.65}));
  EXPECT_FALSE(inside(region, {0.65, 0.5}));
}

TEST(ContourContent, designs_outside_the_slice_are_projected_and_give_no_colour) {
  const ResultTable table = plane_table({0.0, 0.5, 1.0});
  ContourOptions options;
  options.slice = {{"z", 0.5}};
  const ContourContent content = content_of(table, options);
  EXPECT_EQ(content.elsewhere.size(), 50u);
  EXPECT_NEAR(colour(content, 0.5, 0.5), 27.5, 0.1) << "of the designs at z = 0.5";
  ASSERT_TRUE(content.best);
  EXPECT_NEAR(content.best->f_mm, 12.5, 1e-9);
}

TEST(ContourContent, between_the_designs_only_a_fit_knows_anything) {
  const ResultTable table = plane_table({0.0, 1.0});
  ContourOptions options;
  options.slice = {{"z", 0.3}};
  EXPECT_THROW(contour_axes(table, options), InputError);
  options.fit = flat_fit();
  const ContourContent content = content_of(table, options);
  EXPECT_TRUE(content.stages.empty());
  EXPECT_EQ(content.elsewhere.size(), 50u);
  EXPECT_DOUBLE_EQ(colour(content, 0.9, 0.9), 7.0) << "the hull of the designs is a cube";
  EXPECT_FALSE(content.best);
}

TEST(ContourContent, over_one_variable_failed_designs_leave_a_gap_in_the_fit) {
  ResultTable table{{"x"}, {}};
  for (int i = 0; i < 5; ++i) {
    ResultRow row;
    row.stage = "line";
    row.state = i == 2 ? "failed" : "done";
    row.variables = {0.25 * i};
    row.f_m = i == 2 ? std::nan("") : 0.01;
    table.rows.push_back(row);
  }
  ContourOptions options;
  options.fit = flat_fit();
  options.fit->y = {0.0};
  options.fit->x.clear();
  for (int i = 0; i <= 100; ++i) options.fit->x.push_back(0.01 * i);
  options.fit->value_m.assign(101, 0.007);
  options.fit->sigma_m.assign(101, 0.001);
  options.fit->optimum->variables = {"x", "other"};
  const ContourContent content = content_of(table, options);
  ASSERT_EQ(content.failed_ranges.size(), 1u);
  EXPECT_DOUBLE_EQ(content.failed_ranges[0].first, 0.375);
  EXPECT_DOUBLE_EQ(content.failed_ranges[0].second, 0.625);
  ASSERT_EQ(content.fit_curve.size(), 2u);
  EXPECT_NEAR(content.fit_curve[0].back().x, 0.37, 0.011);
  EXPECT_NEAR(content.fit_curve[1].front().x, 0.63, 0.011);
  EXPECT_NEAR(content.fit_curve[0].front().sigma_mm, 1.0, 1e-12);
}

}  // namespace
}  // namespace drumsweep

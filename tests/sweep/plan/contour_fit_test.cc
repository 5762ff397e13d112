#include "sweep/plan/contour_fit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/config/schema.h"
#include "postproc/contour_content.h"
#include "postproc/contour_figure.h"

namespace drumsweep {
namespace {

/// A grid of rows x columns over angle and width, and of belt speeds where there are several.
Study grid_of(std::int64_t rows, std::int64_t columns, std::int64_t speeds = 1) {
  Study study;
  study.seed = 3;
  StageConfig stage{
      "grid",
      "grid",
      {{"outlet.opening_angle_deg", 0.1, 0.6, rows, {}}, {"outlet.base_width_m", 0.04, 0.08, columns, {}}}};
  if (speeds > 1) stage.variables.push_back({"belt.speed_m_s", 0.2, 0.3, speeds, {}});
  study.stages = {stage};
  return study;
}

/// Valley at (0.3, 0.055) of 5 mm; noise of 0.05 mm, or of `noise_m`.
ResultTable valley(const Plan& plan, double noise_m = 5e-5) {
  ResultTable table{plan.columns, {}};
  for (const std::size_t i : table_order(plan)) {
    const PlannedDesign& design = plan.designs[i];
    ResultRow row;
    row.design_id = design.id;
    row.stage = design.stage;
    row.state = design.impossible.empty() ? "done" : "failed";
    row.variables = design.row;
    const double u = (design.row[0] - 0.3) / 0.5, v = (design.row[1] - 0.055) / 0.04;
    const double noise = std::fmod(0.618034 * static_cast<double>(table.rows.size()), 1.0) - 0.5;
    row.f_m = 0.005 + 0.02 * u * u + 0.03 * v * v + noise_m * noise;
    row.f_footprint_m = 0.5 * row.f_m;
    row.sigma_f_m = row.sigma_f_footprint_m = std::max(5e-5, noise_m);
    table.rows.push_back(row);
  }
  return table;
}

double mesh_value(const ContourFit& fit, double x, double y) { return GridSurface{fit.x, fit.y, fit.value_m}.at(x, y); }

TEST(ContourFit, is_the_surface_with_its_optimum_in_the_units_of_the_table) {
  const Study study = grid_of(6, 6);
  const Plan plan = plan_designs(study);
  const ResultTable table = valley(plan);
  const StudyFit fitted = fit_of_study(study, plan, table, "f_m", 1);
  const std::optional<ContourFit> fit = contour_fit(fitted, table, {});
  ASSERT_TRUE(fit);
  ASSERT_TRUE(fit->usable) << fit->verdict;
  EXPECT_EQ(fit->num_fitted, 36u);
  EXPECT_EQ(fit->num_designs, 36u);
  EXPECT_DOUBLE_EQ(fit->x.front(), 0.1);
  EXPECT_DOUBLE_EQ(fit->y.back(), 0.08);
  EXPECT_NEAR(mesh_value(*fit, 0.3, 0.055), 0.005, 2e-4);
  EXPECT_NEAR(mesh_value(*fit, 0.6, 0.08), 0.005 + 0.02 * 0.36 + 0.03 * 0.390625, 5e-4);
  ASSERT_TRUE(fit->optimum);
  EXPECT_EQ(fit->optimum->variables, (std::vector<std::string>{"opening_angle_deg", "base_width_m"}));
  EXPECT_NEAR(fit->optimum->at[0], 0.3, 0.03);
  EXPECT_NEAR(fit->optimum->at[1], 0.055, 0.003);
  EXPECT_GE(fit->optimum->draws.size(), 400u);
  const StudyFit under_outlet = fit_of_study(study, plan, table, "f_footprint_m", 1);
  EXPECT_NEAR(under_outlet.optimum->f_m, 0.5 * fit->optimum->f_m, 1e-4);

  // The figure takes it: the region lies around the optimum.
  ContourOptions options;
  options.fit = fit;
  const ContourContent content = contour_content(table, options, contour_axes(table, options));
  EXPECT_TRUE(content.fit_is_drawn);
  ASSERT_GT(content.region.size(), 2u);
}

TEST(ContourFit, says_why_where_the_gate_trusts_none) {
  const Study study = grid_of(6, 6);
  const Plan plan = plan_designs(study);
  const ResultTable noise = valley(plan, 0.1);
  const std::optional<ContourFit> fit = contour_fit(fit_of_study(study, plan, noise, "f_m", 1), noise, {});
  ASSERT_TRUE(fit);
  EXPECT_FALSE(fit->usable);
  EXPECT_FALSE(fit->verdict.empty());
  EXPECT_FALSE(fit->optimum);

  const Study few = grid_of(2, 2);
  const Plan few_plan = plan_designs(few);
  const ResultTable four = valley(few_plan);
  EXPECT_NE(contour_fit(fit_of_study(few, few_plan, four, "f_m", 1), four, {})->verdict.find("4 points are too few"),
            std::string::npos);
}

TEST(ContourFit, of_many_designs_is_that_of_some_spread_over_all) {
  const Study study = grid_of(21, 21);
  const Plan plan = plan_designs(study);
  const ResultTable table = valley(plan);
  const std::optional<ContourFit> fit = contour_fit(fit_of_study(study, plan, table, "f_m", 1), table, {});
  ASSERT_TRUE(fit->usable) << fit->verdict;
  EXPECT_EQ(fit->num_designs, 441u);
  EXPECT_EQ(fit->num_fitted, 300u);
  EXPECT_NEAR(mesh_value(*fit, 0.3, 0.055), 0.005, 1e-4);
  EXPECT_NEAR(mesh_value(*fit, 0.6, 0.08), 0.005 + 0.02 * 0.36 + 0.03 * 0.390625, 2e-4) << "the highest corner too";
  ContourOptions options;
  options.fit = fit;
  EXPECT_NE(contour_figure(table, options, "a.dat", "a.png").script.find("300 of 441 designs: those"),
            std::string::npos);
}

TEST(ContourFit, knows_slices_between_the_designs_and_none_outside) {
  const Study study = grid_of(4, 4, 3);
  const Plan plan = plan_designs(study);
  const ResultTable table = valley(plan);
  const StudyFit fitted = fit_of_study(study, plan, table, "f_m", 1);
  ContourOptions options;
  options.slice = {{"belt.speed_m_s", 0.22}};
  const std::optional<ContourFit> fit = contour_fit(fitted, table, options);
  ASSERT_TRUE(fit->usable) << fit->verdict;
  EXPECT_NEAR(mesh_value(*fit, 0.3, 0.055), 0.005, 5e-4);
  options.slice = {{"belt.speed_m_s", 0.4}};
  EXPECT_THROW(contour_fit(fitted, table, options), InputError);
}

}  // namespace
}  // namespace drumsweep

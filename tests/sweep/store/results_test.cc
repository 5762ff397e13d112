#include "sweep/store/results.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/config/schema.h"
#include "sweep/single_design.h"

namespace drumsweep {
namespace {

Study some_study() {
  Study study;
  study.outlet.opening_angle_deg = 1;
  study.stages = {{"s", "grid", {{"outlet.base_width_m", 0.04, 0.05, 2, {}}}}};
  return study;
}

/// Balls spread over the belt and the recorded time; every fourth leaves over the end.
Recording even_recording(const Study& study) {
  Recording r;
  r.begin_s = 3;
  r.turns = 2;
  const double duration = 2 * 2 * M_PI / study.drum.angular_velocity_rad_s;
  for (std::uint32_t i = 0; i < 4000; ++i) {
    const double u = static_cast<double>(i % 40) / 40;
    const auto exit = static_cast<std::uint8_t>(i % 4 == 0 ? 255u : i % 4);
    r.landings.push_back({3 + duration * (i + 0.5) / 4000, 0, u, 0, 0, -1, 0.005f, i, exit});
  }
  r.hash = 0xabcull;
  return r;
}

TEST(Results, a_recording_becomes_a_row) {
  const Study study = some_study();
  const PlannedDesign design = plan_designs(study).designs[1];
  const ResultRow row = evaluated_row(study, design, even_recording(study), true);
  EXPECT_EQ(row.state, "done");
  EXPECT_EQ(row.design_id, design.id);
  EXPECT_EQ(row.landed, 4000);
  EXPECT_EQ(row.state_hash, "0000000000000abc");
  EXPECT_TRUE(std::isfinite(row.f_m));
  EXPECT_EQ(row.variables, std::vector<double>{0.05});
}

TEST(Results, an_unsteady_drum_or_a_blocked_feed_is_untrusted_with_its_reason) {
  const Study study = some_study();
  const PlannedDesign design = plan_designs(study).designs[0];
  Recording recording = even_recording(study);
  EXPECT_EQ(evaluated_row(study, design, recording, false).state, "untrusted");
  recording.feed_debt_kg = 0.9 * study.feed.rate_kg_s;
  EXPECT_EQ(evaluated_row(study, design, recording, true).state, "done");
  recording.feed_debt_kg = 1.1 * study.feed.rate_kg_s;
  const ResultRow row = evaluated_row(study, design, recording, true);
  EXPECT_EQ(row.state, "untrusted");
  EXPECT_NE(row.reason.find("feed blocked"), std::string::npos);
}

TEST(Results, a_solver_that_has_not_converged_makes_a_design_untrusted) {
  Study study = some_study();
  Recording recording = even_recording(study);
  recording.quality.residual.mean = 0.03;
  EXPECT_EQ(evaluated_row(study, plan_designs(study).designs[0], recording, true).state, "untrusted");
  study.solver.residual_limit_m_s = 0.04;
  EXPECT_EQ(evaluated_row(study, plan_designs(study).designs[0], recording, true).state, "done");
}

TEST(Results, what_cannot_be_evaluated_is_failed_with_its_reason) {
  const Study study = some_study();
  Recording recording = even_recording(study);
  recording.landings[5].y = NAN;
  const ResultRow row = evaluated_row(study, plan_designs(study).designs[0], recording, true);
  EXPECT_EQ(row.state, "failed");
  EXPECT_FALSE(row.reason.empty());
}

TEST(Results, the_best_is_the_lowest_f_that_is_done_and_untrusted_only_if_none_is) {
  const auto row = [](const char* state, double f) {
    ResultRow r;
    r.state = state;
    r.f_m = f;
    return r;
  };
  EXPECT_FALSE(best_row({}).has_value());
  EXPECT_FALSE(best_row({row("failed", NAN)}).has_value());
  EXPECT_EQ(best_row({row("failed", NAN), row("done", 3), row("untrusted", 1), row("done", 2), row("done", 2)}), 3u);
  EXPECT_EQ(best_row({row("untrusted", 3), row("untrusted", 1)}), 1u);
}

TEST(Results, observables_hold_shares_that_add_up_and_errors) {
  const Study study = some_study();
  const PlannedDesign design = plan_designs(study).designs[0];
  double sum = 0;
  for (const Observable& o : observables(study, design, even_recording(study)))
    if (o.name.rfind("outflow_share", 0) == 0) {
      EXPECT_NEAR(o.value, 0.25, 1e-12);
      EXPECT_LT(o.sigma, 0.01);  // the exits come in turn, so the blocks hardly differ
      sum += o.value;
    }
  EXPECT_NEAR(sum, 1, 1e-12);
}

TEST(Results, values_on_the_command_line_are_those_of_the_stages_or_of_the_outlet) {
  Study study = some_study();
  EXPECT_EQ(keys_of_values(study), std::vector<std::string>{"outlet.base_width_m"});
  EXPECT_EQ(design_at(study, {0.05}).id, plan_designs(study).designs[1].id);
  study.stages.clear();
  EXPECT_EQ(keys_of_values(study), (std::vector<std::string>{"outlet.opening_angle_deg", "outlet.base_width_m"}));
  EXPECT_THROW(design_at(study, {1}), InputError);
  EXPECT_THROW(design_at(study, {1, 0.9}), InputError);
}

}  // namespace
}  // namespace drumsweep

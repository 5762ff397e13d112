/// A report of a campaign that nobody has simulated: its runs are a linear response with noise.
#include "diagnosis/report/report.h"

#include <gtest/gtest.h>

#include "diagnosis/model/draws.h"

namespace drumsweep {
namespace {

Datum datum(const std::string& condition, const std::string& quantity, double position, Use use) {
  Datum d;
  d.condition = condition;
  d.quantity = quantity;
  d.position = position;
  d.use = use;
  d.unit = "mm";
  d.group = "belt";
  return d;
}

/// Two causes that act alike on a profile, and two measurements that would separate them, the better one costly.
struct TwoTwins {
  Campaign campaign;
  MeasuredData measured;
  CampaignOutputs outputs;

  explicit TwoTwins(bool with_costs) {
    campaign.name = "<b>belts & drums</b>";
    for (const char* id : {"profile", "weak", "strong"}) {
      Condition c;
      c.id = id;
      c.path = std::string(id) + ".toml";
      c.text = "[scene]\ntype = \"incline\"\nangle_deg = 20.0\n";
      campaign.conditions.push_back(c);
    }
    if (with_costs) {
      campaign.conditions[0].cost = 5;
      campaign.conditions[1].cost = 1;
      campaign.conditions[2].cost = 20;
    }
    campaign.parameters.push_back({{"friction", "1", 0.5, 0.05}, {}});
    for (const char* id : {"coating", "tolerance_of_slots"}) {
      Candidate c;
      c.effect.id = id;
      c.effect.unit = "mm";
      campaign.candidates.push_back(c);
    }
    for (int i = 0; i < 6; ++i) measured.data.push_back(datum("profile", "bed_height", 0.1 * i, Use::fit));
    measured.data.push_back(datum("weak", "slot_width", std::nan(""), Use::available));
    measured.data.push_back(datum("strong", "slot_width", std::nan(""), Use::available));
    // Responses in sigma: of friction, and of the two effects.
    Eigen::MatrixXd response(3, 8);
    response << 0.5, 0.4, 0.3, 0.2, 0.1, 0.0, 0.0, 0.0,  //
        -2, -4, 6, 8, 6, 3, 5, 12,                       //
        -2, -4, 6, 8, 6, 3, 0, 0;
    constexpr Eigen::Index num_runs = 80;
    outputs.runs.parameters.resize(num_runs, 1);
    outputs.runs.strengths = Eigen::MatrixXd::Zero(num_runs, 2);
    outputs.runs.outputs.resize(num_runs, 8);
    for (Eigen::Index i = 0; i < num_runs; ++i) {
      const Eigen::VectorXd draws = normal_draws(1, Purpose::feed, static_cast<std::uint64_t>(i), 11);
      outputs.runs.parameters(i, 0) = std::clamp(draws[0], -2.2, 2.2);
      for (Eigen::Index k = 0; k < 2; ++k)
        if (i % 4 == k || i % 4 == 2) outputs.runs.strengths(i, k) = std::min(1.0, std::abs(draws[1 + k]));
      Eigen::RowVectorXd x(3);
      x << outputs.runs.parameters.row(i), outputs.runs.strengths.row(i);
      outputs.runs.outputs.row(i) = 20 * Eigen::RowVectorXd::Ones(8) + x * response + 0.3 * draws.tail(8).transpose();
    }
    for (Eigen::Index j = 0; j < 6; ++j) measured.data[static_cast<std::size_t>(j)].value = 20 + 0.7 * response(1, j);
  }
  DiagnosisReport report() const {
    DiagnosisOptions how;
    how.num_bootstraps = 199;
    return make_report(campaign, measured, outputs, how);
  }
};

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

}  // namespace

TEST(DiagnosisReport, advice_goes_by_distance_and_where_costs_are_known_by_what_is_gained_per_cost) {
  const DiagnosisReport free = TwoTwins(false).report(), priced = TwoTwins(true).report();
  ASSERT_EQ(free.result.verdict, Verdict::ambiguous) << report_text(free);
  ASSERT_EQ(free.result.advice.size(), 3u);
  EXPECT_EQ(free.result.advice.front().measurement, "strong");
  EXPECT_FALSE(has(report_text(free), "per cost"));
  EXPECT_EQ(priced.result.advice.front().measurement, "weak");
  ASSERT_EQ(priced.advice_cost.size(), 3u);
  EXPECT_EQ(priced.advice_cost.front(), 1);
  EXPECT_TRUE(has(report_text(priced), "gained per cost"));
  // Repeating the campaign costs what was fitted.
  for (std::size_t i = 0; i < 3; ++i) {
    if (priced.result.advice[i].measurement == "repeat the campaign") {
      EXPECT_EQ(priced.advice_cost[i], 5);
    }
  }
}

TEST(DiagnosisReport, text_and_page_say_the_same_and_names_stay_text) {
  const DiagnosisReport report = TwoTwins(false).report();
  const std::string text = report_text(report), page = report_html(report);
  for (const char* words : {"AMBIGUOUS", "coating", "tolerance of slots", "What would separate them", "bed height",
                            "cannot be told apart by these data at all", "no condition was held out"}) {
    EXPECT_TRUE(has(text, words)) << words << text;
    EXPECT_TRUE(has(page, words)) << words;
  }
  EXPECT_FALSE(has(page, "<b>belts"));
  EXPECT_TRUE(has(page, "&lt;b&gt;belts &amp; drums&lt;/b&gt;"));
  // A quantity with positions has a profile and its z.
  EXPECT_TRUE(has(page, "position (m)"));
  EXPECT_TRUE(has(page, "z of the bed height of profile"));
  EXPECT_FALSE(has(page, "nan"));
  EXPECT_FALSE(has(text, "nan"));
}

}  // namespace drumsweep

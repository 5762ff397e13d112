#include "postproc/report/chart.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace drumsweep {
namespace {

TEST(Chart, ticks_are_round_and_inside) {
  EXPECT_EQ(round_ticks(0, 10, 5), (std::vector<double>{0, 2, 4, 6, 8, 10}));
  for (const auto& [low, high] : {std::pair(0.013, 0.0145), {-3.0, 8.0}, {0.0, 1e-7}, {1e5, 3e5}}) {
    const std::vector<double> ticks = round_ticks(low, high, 5);
    EXPECT_GE(ticks.size(), 3u) << low;
    EXPECT_LE(ticks.size(), 8u) << low;
    for (const double tick : ticks) {
      EXPECT_GE(tick, low - 1e-9 * (high - low));
      EXPECT_LE(tick, high + 1e-9 * (high - low));
    }
  }
}

TEST(Chart, numbers_have_the_digits_asked_for) {
  EXPECT_EQ(number_text(0.0123456, 3), "0.0123");
  EXPECT_EQ(number_text(11.4567, 4), "11.46");
  EXPECT_EQ(number_text(123456, 3), "123456");
  EXPECT_EQ(number_text(0, 3), "0.000");
  EXPECT_EQ(number_text(-1.5, 2), "−1.5");
  EXPECT_EQ(number_text(2.5e-7, 2), "2.5e-07");
  EXPECT_EQ(number_text(std::nan(""), 3), "–");
}

TEST(Chart, axes_are_never_empty_and_ignore_what_is_not_finite) {
  for (const std::vector<double>& values :
       {std::vector<double>{}, {3.0}, {0.0, 0.0}, {std::nan(""), 2.0, std::numeric_limits<double>::infinity()}}) {
    const ChartAxis axis = axis_over("x", values);
    EXPECT_LT(axis.low, axis.high);
    EXPECT_TRUE(std::isfinite(axis.low) && std::isfinite(axis.high));
  }
  EXPECT_EQ(axis_over("x", {5, 7}, true).low, 0);
}

TEST(Chart, marks_say_their_values_and_no_text_becomes_markup) {
  Chart chart("a <title>", {"x (<m>)", 0, 1}, {"y", 0, 1});
  chart.points({{0.5, 0.5, 0.1, "value <1> & more"}, {std::nan(""), 0.5, 0, "not drawn"}}, "a");
  chart.line({{0, 0, 0, ""}, {std::nan(""), 0, 0, ""}, {1, 1, 0, ""}}, "b");
  chart.rule(0.2, "<limit>", "limit");
  chart.rule(7, "outside", "limit");
  const std::string svg = chart.svg();
  EXPECT_NE(svg.find("<title>value &lt;1&gt; &amp; more</title>"), std::string::npos);
  EXPECT_EQ(svg.find("not drawn"), std::string::npos);
  EXPECT_EQ(svg.find("outside"), std::string::npos);
  for (const char* word : {"nan", "inf", "<limit>", "<m>"}) EXPECT_EQ(svg.find(word), std::string::npos) << word;
}

}  // namespace
}  // namespace drumsweep

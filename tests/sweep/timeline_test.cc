#include "sweep/timeline.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace drumsweep {
namespace {

/// Time of day, in seconds after noon.
std::string at(double s) {
  const int ms = static_cast<int>(s * 1000 + 0.5);
  return fmt::format("2026-01-02T12:{:02}:{:02}.{:03}Z", ms / 60000, ms / 1000 % 60, ms % 1000);
}

ProvenanceLine line(double s, const char* event, const char* id, int rank, double wall_s = 0, int ranks = 0) {
  return {event, id, 1, rank, "n", wall_s, 0, at(s), "", ranks};
}

/// Two ranks: warm-up of 2 s, then rank 0 works from 2 to 10, rank 1 from 3 to 5 of the time of designs 2 to 10.
std::vector<ProvenanceLine> one_run() {
  return {line(0, "run_begin", "", 0, 0, 2), line(2, "warm_up", "", 0, 2),   line(2, "started", "a", 0),
          line(2, "started", "b", 1),        line(5, "done", "b", 1, 2),     line(6, "done", "a", 0, 4),
          line(6, "started", "c", 0),        line(10, "stopped", "c", 0, 4), line(10, "run_end", "", 0)};
}

TEST(Timeline, shares_of_busy_and_idle_time_and_the_tail) {
  const auto runs = timeline_of(one_run(), false, 0);
  ASSERT_EQ(runs.size(), 1u);
  const RunTimeline& run = runs[0];
  EXPECT_TRUE(run.orderly);
  EXPECT_DOUBLE_EQ(run.wall_s, 10);
  EXPECT_DOUBLE_EQ(run.warm_up_s, 2);
  EXPECT_DOUBLE_EQ(run.designs_s, 8);
  ASSERT_EQ(run.ranks.size(), 2u);
  EXPECT_DOUBLE_EQ(run.ranks[0].busy_s, 8);
  EXPECT_DOUBLE_EQ(run.ranks[1].busy_s, 2);
  EXPECT_DOUBLE_EQ(run.ranks[1].idle_share, 0.75);
  EXPECT_DOUBLE_EQ(run.idle_s, 6);
  EXPECT_DOUBLE_EQ(run.idle_share, 6.0 / 16);
  EXPECT_DOUBLE_EQ(run.tail_s, 5);
  EXPECT_EQ(run.designs, 3u);
}

TEST(Timeline, a_killed_run_ends_with_its_last_trace_and_a_running_one_now) {
  auto lines = one_run();
  lines.resize(7);  // c has begun, then nothing
  const auto killed = timeline_of(lines, false, 0);
  EXPECT_FALSE(killed[0].orderly);
  EXPECT_DOUBLE_EQ(killed[0].wall_s, 6);
  const auto running = timeline_of(lines, true, seconds_of(at(20)));
  EXPECT_TRUE(running[0].active);
  EXPECT_NEAR(running[0].wall_s, 20, 1e-6);
  EXPECT_NEAR(running[0].ranks[0].busy_s, 18, 1e-6);
  EXPECT_TRUE(running[0].ranks[0].spans.back().event.empty());

  // Only the last of several runs can be going on.
  auto two = lines;
  two.push_back(line(100, "run_begin", "", 0, 0, 4));
  two.push_back(line(101, "started", "c", 2));
  const auto runs = timeline_of(two, true, seconds_of(at(105)));
  ASSERT_EQ(runs.size(), 2u);
  EXPECT_DOUBLE_EQ(runs[0].wall_s, 6);
  EXPECT_FALSE(runs[0].active);
  EXPECT_EQ(runs[1].ranks.size(), 4u);
  EXPECT_NEAR(runs[1].idle_share, 0.75, 1e-6);
  EXPECT_TRUE(timeline_of({}, false, 0).empty());
}

TEST(Timeline, a_run_without_designs_has_nothing_to_share) {
  const auto runs = timeline_of({line(0, "run_begin", "", 0, 0, 3), line(1, "run_end", "", 0)}, false, 0);
  EXPECT_EQ(runs[0].idle_share, 0);
  EXPECT_EQ(runs[0].ranks.size(), 3u);
  EXPECT_NE(chart_of(runs[0], 60).find("."), std::string::npos);
}

TEST(Timeline, the_chart_has_a_row_a_rank_of_the_width_asked_for) {
  const RunTimeline run = timeline_of(one_run(), false, 0)[0];
  const std::string chart = chart_of(run, 70);
  const std::string first = chart.substr(0, chart.find('\n'));
  EXPECT_LE(first.size(), 70u);
  EXPECT_GE(first.size(), 65u);
  for (const char* mark : {"ww", "##", "==", "..", "100.0 % busy", " 25.0 % busy"})
    EXPECT_NE(chart.find(mark), std::string::npos) << mark << "\n" << chart;
  EXPECT_EQ(std::count(chart.begin(), chart.end(), '\n'), 2);

  RunTimeline many = run;
  for (int i = 2; i < 100; ++i) {
    many.ranks.push_back(many.ranks[1]);
    many.ranks.back().rank = i;
  }
  EXPECT_EQ(std::count_if(chart.begin(), chart.end(), [](char c) { return c == '\n'; }), 2);
  EXPECT_NE(chart_of(many, 70).find("and 36 ranks with less idle time"), std::string::npos);
}

TEST(Timeline, times_are_read_to_the_millisecond) {
  EXPECT_NEAR(seconds_of("1970-01-02T00:00:01.250Z"), 86401.25, 1e-9);
  EXPECT_TRUE(std::isnan(seconds_of("yesterday")));
}

}  // namespace
}  // namespace drumsweep

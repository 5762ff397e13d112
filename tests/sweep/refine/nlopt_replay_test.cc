#include "sweep/refine/nlopt_replay.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "core/config/schema.h"
#include "tests/sweep/fit/synthetic.h"

namespace drumsweep {
namespace {

const Box box = two_variables();
const Point minimum = {2.6, 0.0385};

double bowl(const Point& at) {
  const Point u = to_unit(box, at), m = to_unit(box, minimum);
  return 0.01 + 0.02 * std::pow(u[0] - m[0], 2) + 0.02 * std::pow(u[1] - m[1], 2) +
         0.01 * (u[0] - m[0]) * (u[1] - m[1]);
}

struct Finished {
  Replay replay;
  std::vector<Point> asked;
};

/// Answers one point at a time until the search ends.
Finished finished(const ReplayOptions& options, const Point& start, const std::function<Known(const Point&)>& answer) {
  Finished out;
  std::map<Point, Known> known;
  for (;;) {
    out.replay = replay(box, options, start, [&](const Point& at) {
      const auto found = known.find(at);
      return found == known.end() ? Known{} : found->second;
    });
    if (!out.replay.asks) return out;
    out.asked.push_back(*out.replay.asks);
    known[*out.replay.asks] = answer(*out.replay.asks);
  }
}

Known value(double f) { return {Known::State::value, f}; }

TEST(NloptReplay, every_method_finds_the_minimum_within_its_tolerance) {
  for (const std::string& method : replay_methods())
    for (const Point& start : {Point{7, 0.025}, Point{0, 0.065}, Point{4.5, 0.04}}) {
      const Finished f = finished({method, 200, 1, 0.2}, start, [](const Point& at) { return value(bowl(at)); });
      ASSERT_EQ(f.replay.end, ReplayEnd::converged) << method << ": " << f.replay.why;
      EXPECT_NEAR((*f.replay.best)[0], minimum[0], 0.5) << method << ": " << f.replay.why;
      EXPECT_NEAR((*f.replay.best)[1], minimum[1], 0.0025) << method << ": " << f.replay.why;
      EXPECT_EQ(f.replay.path.size(), f.asked.size());
    }
}

TEST(NloptReplay, asked_points_are_lattice_points_inside_and_none_comes_twice) {
  for (const std::string& method : replay_methods()) {
    // The minimum lies outside, so that the search leans on the bounds.
    const Finished f =
        finished({method, 60, 1, 0.5}, {8.9, 0.021}, [](const Point& at) { return value(at[0] - 100 * at[1]); });
    EXPECT_EQ(std::set<Point>(f.asked.begin(), f.asked.end()).size(), f.asked.size());
    for (const Point& at : f.asked) {
      EXPECT_EQ(at, quantised(box, at));
      for (std::size_t k = 0; k < 2; ++k) EXPECT_TRUE(at[k] >= box[k].low && at[k] <= box[k].high);
    }
    EXPECT_EQ(*f.replay.best, (Point{0, 0.065})) << method << ": " << f.replay.why;
  }
}

TEST(NloptReplay, what_else_is_known_changes_nothing_and_resumed_is_uninterrupted) {
  for (const std::string& method : replay_methods()) {
    const ReplayOptions options{method, 40, 1, 0.2};
    const auto answer = [](const Point& at) { return value(bowl(at)); };
    const Finished one_by_one = finished(options, {7, 0.025}, answer);
    // Everything known beforehand: the same path in one go.
    const Replay at_once = replay(box, options, {7, 0.025}, answer);
    EXPECT_EQ(at_once.path, one_by_one.asked);
    EXPECT_EQ(at_once.best, one_by_one.replay.best);
    EXPECT_EQ(at_once.why, one_by_one.replay.why);
    // Every other point known beforehand, as by another start that came that way.
    const std::set<Point> later(at_once.path.begin() + 7, at_once.path.end());
    const Replay stopped =
        replay(box, options, {7, 0.025}, [&](const Point& at) { return later.contains(at) ? Known{} : answer(at); });
    ASSERT_TRUE(stopped.asks);
    EXPECT_EQ(*stopped.asks, at_once.path[7]);
    EXPECT_EQ(stopped.end, ReplayEnd::asks);
  }
}

TEST(NloptReplay, a_hole_or_a_value_that_is_no_number_ends_the_search_with_its_best) {
  for (const std::string& method : replay_methods())
    for (const Known& hole :
         {Known{Known::State::hole, 0}, value(NAN), value(std::numeric_limits<double>::infinity())}) {
      int num = 0;
      const Finished f = finished({method, 40, 1, 0.2}, {7, 0.025},
                                  [&](const Point& at) { return ++num == 6 ? hole : value(bowl(at)); });
      EXPECT_EQ(f.replay.end, ReplayEnd::hole);
      EXPECT_EQ(f.replay.path.size(), 5u);
      ASSERT_TRUE(f.replay.best);
      EXPECT_EQ(f.replay.best_f_m, bowl(*f.replay.best));
      EXPECT_NE(f.replay.why.find("without a value"), std::string::npos);
    }
  const Replay nothing = replay(box, {}, {7, 0.025}, [](const Point&) { return Known{Known::State::hole, 0}; });
  EXPECT_FALSE(nothing.best);
}

TEST(NloptReplay, no_more_points_than_allowed_are_asked_and_a_flat_surface_ends) {
  for (const std::string& method : replay_methods()) {
    const Finished few = finished({method, 9, 0.1, 0.2}, {7, 0.025}, [](const Point& at) { return value(bowl(at)); });
    EXPECT_EQ(few.asked.size(), 9u);
    EXPECT_EQ(few.replay.end, ReplayEnd::exhausted) << few.replay.why;
    const Finished flat = finished({method, 60, 1, 0.2}, {7, 0.025}, [](const Point&) { return value(0.01); });
    EXPECT_FALSE(flat.replay.asks);
  }
}

TEST(NloptReplay, one_variable_is_searched_too) {
  const Box line = {{"x", 0, 1, 0.01}};
  for (const std::string& method : replay_methods()) {
    const Replay found =
        replay(line, {method, 80, 1, 0.2}, {0.9}, [](const Point& at) { return value(std::pow(at[0] - 0.3, 2)); });
    ASSERT_TRUE(found.best);
    EXPECT_NEAR((*found.best)[0], 0.3, 0.03) << method << ": " << found.why;
  }
}

TEST(NloptReplay, wrong_options_are_refused_by_name) {
  const auto unknown = [](const Point&) { return Known{}; };
  EXPECT_THROW(replay(box, {"newton", 9, 1, 0.2}, minimum, unknown), InputError);
  EXPECT_THROW(replay(box, {"bobyqa", 0, 1, 0.2}, minimum, unknown), InputError);
  EXPECT_THROW(replay(box, {"bobyqa", 9, 0, 0.2}, minimum, unknown), InputError);
  EXPECT_THROW(replay(box, {"bobyqa", 9, 1, 0.6}, minimum, unknown), InputError);
  EXPECT_THROW(replay(box, {"bobyqa", 9, 1, 0.2}, {9.1, 0.04}, unknown), InputError);
}

}  // namespace
}  // namespace drumsweep

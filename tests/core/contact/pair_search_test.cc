#include "core/contact/pair_search.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "core/geometry/random.h"

namespace drumsweep {
namespace {

DrumState cloud(std::uint32_t num, double size) {
  DrumState state;
  for (std::uint32_t i = 0; i < num; ++i) {
    const auto r = uniform4(3, Purpose::fill, i), v = uniform4(3, Purpose::fill, i, 1);
    state.balls.add(Eigen::Vector3d(r[0] - 0.5, r[1] - 0.5, r[2] - 0.5) * size, 0.004 + 0.001 * r[3], i);
    state.balls.velocity.back() = Eigen::Vector3d(v[0] - 0.5, v[1] - 0.5, v[2] - 0.5);
  }
  return state;
}

/// As PairSearch describes: the nearest approach within the horizon, and what collisions add.
bool may_meet(const PairSearch& search, Eigen::Vector3d apart, const Eigen::Vector3d& closing, double touching) {
  const Eigen::Vector3d way = closing * search.horizon;
  const double when = std::clamp(-apart.dot(way) / std::max(way.squaredNorm(), 1e-20), 0.0, 1.0);
  return (apart + when * way).norm() <= touching + search.margin + search.extra_speed * search.horizon;
}

using IdPair = std::pair<std::uint32_t, std::uint32_t>;

std::vector<BallPair> all(const PairList& list) {
  std::vector<BallPair> out = list.apart;
  for (std::size_t s = 0; s < list.num_slabs; ++s)
    for (const auto* pairs : {&list.slabs[s].near, &list.slabs[s].far}) {
      for (const BallPair& p : *pairs) {
        EXPECT_LT(p[0], p[1]);
        EXPECT_GE(p[0], list.slabs[s].begin);
        EXPECT_LT(p[0], list.slabs[s].end);
        EXPECT_LT(p[1], list.reach_end(s));
      }
      out.insert(out.end(), pairs->begin(), pairs->end());
    }
  return out;
}

std::set<IdPair> ids(const DrumState& state, const PairList& list) {
  std::set<IdPair> out;
  for (const BallPair& p : all(list)) {
    const auto [low, high] = std::minmax(state.balls.id[p[0]], state.balls.id[p[1]]);
    EXPECT_TRUE(out.insert({low, high}).second) << "listed twice";
  }
  return out;
}

TEST(PairSearch, lists_exactly_the_pairs_that_brute_force_finds) {
  // A crowd; and a few that fly so fast that they meet others several cells away.
  for (const auto& [crowd, slope] : {std::pair{true, 0.0}, {false, 0.0}, {true, -0.3}, {false, 0.4}}) {
    PairSearch search{0.016, 0.001, crowd ? 0.002 : 0.010, 0.1};
    search.slope = slope;
    DrumState state = crowd ? cloud(1500, 0.12) : cloud(300, 0.25);
    if (!crowd)
      for (Eigen::Vector3d& v : state.balls.velocity) v *= 5;
    std::set<IdPair> expected;
    const Balls& b = state.balls;
    for (std::uint32_t i = 0; i < b.size(); ++i)
      for (std::uint32_t j = i + 1; j < b.size(); ++j) {
        if (may_meet(search, b.position[i] - b.position[j], b.velocity[i] - b.velocity[j], b.radius[i] + b.radius[j]))
          expected.insert({b.id[i], b.id[j]});
      }
    PairList list;
    sort_and_find_pairs(search, 2, state, list);
    EXPECT_EQ(ids(state, list), expected);
    EXPECT_GT(expected.size(), crowd ? 1000u : 20u);
  }
}

TEST(PairSearch, lists_periodic_pairs_by_their_nearest_image_and_once) {
  for (const double period : {0.12, 0.033}) {
    // Of a crowd those far apart are left out where both balls are enclosed, so its speeds stay low.
    for (const bool crowd : {true, false}) {
      if (!crowd && period < 0.1) continue;
      PairSearch search{0.016, 0.001, crowd ? 0.002 : 0.010, 0.1};
      search.period = period;
      DrumState state = crowd ? cloud(1200, 0.12) : cloud(220, 0.25);
      if (!crowd)
        for (Eigen::Vector3d& v : state.balls.velocity) v *= 4;
      std::set<IdPair> expected;
      std::size_t across = 0;
      const Balls b = state.balls;
      for (std::uint32_t i = 0; i < b.size(); ++i)
        for (std::uint32_t j = i + 1; j < b.size(); ++j) {
          Eigen::Vector3d apart = b.position[i] - b.position[j];
          apart[1] -= period * std::round(apart[1] / period);
          if (!may_meet(search, apart, b.velocity[i] - b.velocity[j], b.radius[i] + b.radius[j])) continue;
          expected.insert({b.id[i], b.id[j]});
          const auto wrapped = [&](double y) { return y - period * std::floor(y / period); };
          across += std::abs(wrapped(b.position[i][1]) - wrapped(b.position[j][1])) > 0.5 * period ? 1 : 0;
        }
      PairList list;
      sort_and_find_pairs(search, 1, state, list);
      EXPECT_EQ(ids(state, list), expected) << period << ' ' << crowd;
      EXPECT_GT(across, crowd ? 50u : 3u);
    }
  }
}

TEST(PairSearch, impulses_follow_their_balls_through_sorting_and_removal) {
  const PairSearch search{0.016, 0.001, 0.002, 0.1};
  DrumState state = cloud(400, 0.07);
  PairList list;
  sort_and_find_pairs(search, 1, state, list);

  // Mark each pair's impulse by its ids, with the sign of the lower id.
  const auto mark = [](std::uint32_t low, std::uint32_t high) { return static_cast<float>(low * 1000 + high + 1); };
  for (const BallPair& p : all(list)) {
    const std::uint32_t a = state.balls.id[p[0]], b = state.balls.id[p[1]];
    const float normal = mark(std::min(a, b), std::max(a, b));
    state.pairs.push_back({p[0], p[1], {a < b ? normal : -normal, 0, 0}, normal});
  }
  // Turn the cloud around so that the order of cells, and of many pairs, is reversed; drop some.
  for (Eigen::Vector3d& x : state.balls.position) x = -x;
  for (Eigen::Vector3d& v : state.balls.velocity) v = -v;
  std::vector<char> gone(state.balls.size(), 0);
  for (std::size_t i = 0; i < gone.size(); i += 7) gone[i] = 1;
  drop_gone(state, gone);
  sort_and_find_pairs(search, 1, state, list);
  const std::vector<BallPair> pairs = all(list);
  ASSERT_GT(pairs.size(), 100u);
  for (const BallPair& p : pairs) {
    const std::uint32_t a = state.balls.id[p[0]], b = state.balls.id[p[1]], old = list.old_place(p);
    ASSERT_NE(old, PairList::none);
    EXPECT_EQ(list.old[old].normal, mark(std::min(a, b), std::max(a, b)));
    EXPECT_EQ(list.old[old].tangent[0], a < b ? list.old[old].normal : -list.old[old].normal);
  }
}

TEST(PairSearch, a_ball_that_falls_on_another_at_any_speed_of_a_drum_lands_on_it) {
  for (const double speed : {0.5, 1.0, 1.5, 2.0, 2.5})
    for (const double gap : {0.001, 0.005, 0.012, 0.02, 0.024}) {
      const PairSearch search{0.0185, 0.001, 0.010, 0.2};
      DrumState state;
      state.balls.add({0, 0, 0}, 0.005, 0);
      state.balls.add({0, 0, 0.010 + gap}, 0.005, 1);
      state.balls.velocity[1][2] = -speed;
      PairList list;
      sort_and_find_pairs(search, 1, state, list);
      if (gap < speed * search.horizon) {
        EXPECT_EQ(all(list).size(), 1u) << speed << " " << gap;
      }
    }
}

}  // namespace
}  // namespace drumsweep

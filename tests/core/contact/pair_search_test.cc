#include "core/contact/pair_search.h"

#include <gtest/gtest.h>

#include <map>
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

using IdPair = std::pair<std::uint32_t, std::uint32_t>;

std::set<IdPair> ids(const DrumState& state) {
  std::set<IdPair> out;
  for (const PairImpulse& p : state.pairs) {
    const auto [low, high] = std::minmax(state.balls.id[p.a], state.balls.id[p.b]);
    EXPECT_TRUE(out.insert({low, high}).second) << "listed twice";
  }
  return out;
}

TEST(PairSearch, lists_exactly_the_pairs_that_brute_force_finds) {
  // A crowd; and a few that fly so fast that they meet others several cells away.
  for (const bool crowd : {true, false}) {
    const PairSearch search{0.016, 0.001, crowd ? 0.002 : 0.010, 0.1};
    DrumState state = crowd ? cloud(1500, 0.12) : cloud(150, 0.25);
    if (!crowd)
      for (Eigen::Vector3d& v : state.balls.velocity) v *= 5;
    std::set<IdPair> expected;
    const Balls& b = state.balls;
    for (std::uint32_t i = 0; i < b.size(); ++i)
      for (std::uint32_t j = i + 1; j < b.size(); ++j) {
        const double distance = (b.position[i] - b.position[j]).norm();
        const double reach = b.radius[i] + b.radius[j] + search.margin +
                             (search.extra_speed + (b.velocity[i] - b.velocity[j]).norm()) * search.horizon;
        if (distance <= reach) expected.insert({b.id[i], b.id[j]});
      }
    PairSearchScratch scratch;
    sort_and_find_pairs(search, state, scratch);
    EXPECT_EQ(ids(state), expected);
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
      DrumState state = crowd ? cloud(1200, 0.12) : cloud(40, 0.25);
      if (!crowd)
        for (Eigen::Vector3d& v : state.balls.velocity) v *= 4;
      std::set<IdPair> expected;
      std::size_t across = 0;
      const Balls b = state.balls;
      for (std::uint32_t i = 0; i < b.size(); ++i)
        for (std::uint32_t j = i + 1; j < b.size(); ++j) {
          Eigen::Vector3d apart = b.position[i] - b.position[j];
          apart[1] -= period * std::round(apart[1] / period);
          const double reach = b.radius[i] + b.radius[j] + search.margin +
                               (search.extra_speed + (b.velocity[i] - b.velocity[j]).norm()) * search.horizon;
          if (apart.norm() > reach) continue;
          expected.insert({b.id[i], b.id[j]});
          const auto wrapped = [&](double y) { return y - period * std::floor(y / period); };
          across += std::abs(wrapped(b.position[i][1]) - wrapped(b.position[j][1])) > 0.5 * period ? 1 : 0;
        }
      PairSearchScratch scratch;
      sort_and_find_pairs(search, state, scratch);
      EXPECT_EQ(ids(state), expected) << period << ' ' << crowd;
      EXPECT_GT(across, crowd ? 50u : 3u);
    }
  }
}

TEST(PairSearch, impulses_follow_their_balls_through_sorting_and_removal) {
  const PairSearch search{0.016, 0.001, 0.002, 0.1};
  DrumState state = cloud(400, 0.07);
  PairSearchScratch scratch;
  sort_and_find_pairs(search, state, scratch);

  // Mark each pair's impulse by its ids, with the sign of the lower id.
  const auto mark = [](std::uint32_t low, std::uint32_t high) { return static_cast<float>(low * 1000 + high + 1); };
  for (PairImpulse& p : state.pairs) {
    const std::uint32_t a = state.balls.id[p.a], b = state.balls.id[p.b];
    p.normal = mark(std::min(a, b), std::max(a, b));
    p.tangent[0] = a < b ? p.normal : -p.normal;
  }
  // Turn the cloud around so that the order of cells, and of many pairs, is reversed; drop some.
  for (Eigen::Vector3d& x : state.balls.position) x = -x;
  std::vector<char> gone(state.balls.size(), 0);
  for (std::size_t i = 0; i < gone.size(); i += 7) gone[i] = 1;
  drop_gone(state, gone);
  sort_and_find_pairs(search, state, scratch);
  ASSERT_GT(state.pairs.size(), 100u);
  for (const PairImpulse& p : state.pairs) {
    const std::uint32_t a = state.balls.id[p.a], b = state.balls.id[p.b];
    EXPECT_EQ(p.normal, mark(std::min(a, b), std::max(a, b)));
    EXPECT_EQ(p.tangent[0], a < b ? p.normal : -p.normal);
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
      PairSearchScratch scratch;
      sort_and_find_pairs(search, state, scratch);
      if (gap < speed * search.horizon) {
        EXPECT_EQ(state.pairs.size(), 1u) << speed << " " << gap;
      }
    }
}

}  // namespace
}  // namespace drumsweep

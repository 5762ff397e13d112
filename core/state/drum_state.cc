#include "core/state/drum_state.h"

#include <algorithm>
#include <bit>

namespace drumsweep {
namespace {

/// Finaliser of SplitMix64 (Steele et al. 2014).
std::uint64_t mix(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9ull;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBull;
  return x ^ (x >> 31);
}

template <class T>
void pick(std::vector<T>& values, const std::vector<std::uint32_t>& order) {
  std::vector<T> sorted;
  sorted.reserve(order.size() + order.size() / 16 + 64);  // room for what the next steps feed
  for (const std::uint32_t i : order) sorted.push_back(values[i]);
  values.swap(sorted);
}

}  // namespace

void Balls::add(const Eigen::Vector3d& at, double ball_radius, std::uint32_t ball_id) {
  position.push_back(at);
  velocity.emplace_back(Eigen::Vector3d::Zero());
  spin.emplace_back(Eigen::Vector3d::Zero());
  radius.push_back(ball_radius);
  id.push_back(ball_id);
  exit.push_back(static_cast<std::uint8_t>(Exit::inside));
}

void Balls::reorder(const std::vector<std::uint32_t>& order) {
  pick(position, order);
  pick(velocity, order);
  pick(spin, order);
  pick(radius, order);
  pick(id, order);
  pick(exit, order);
}

void drop_gone(DrumState& state, const std::vector<char>& gone) {
  if (std::find(gone.begin(), gone.end(), 1) == gone.end()) return;
  constexpr std::uint32_t dropped = 0xFFFFFFFFu;
  std::vector<std::uint32_t> order, place(gone.size(), dropped);
  for (std::uint32_t i = 0; i < gone.size(); ++i)
    if (gone[i] == 0) {
      place[i] = static_cast<std::uint32_t>(order.size());
      order.push_back(i);
    }
  state.balls.reorder(order);
  for (PairImpulse& p : state.pairs) {
    p.a = place[p.a];
    p.b = place[p.b];
  }
  for (WallImpulse& w : state.walls) w.ball = place[w.ball];
  std::erase_if(state.pairs, [](const PairImpulse& p) { return p.a == dropped || p.b == dropped; });
  std::erase_if(state.walls, [](const WallImpulse& w) { return w.ball == dropped; });
}

std::uint64_t state_hash(const DrumState& state) {
  std::uint64_t sum = 0;
  const Balls& balls = state.balls;
  for (std::size_t i = 0; i < balls.size(); ++i) {
    std::uint64_t h = mix(balls.id[i] + 0x9E3779B97F4A7C15ull);
    for (const Eigen::Vector3d* v : {&balls.position[i], &balls.velocity[i], &balls.spin[i]})
      for (int k = 0; k < 3; ++k) h = mix(h ^ std::bit_cast<std::uint64_t>((*v)[k]));
    h = mix(h ^ std::bit_cast<std::uint64_t>(balls.radius[i]));
    sum += mix(h ^ balls.exit[i]);
  }
  for (const std::int64_t n :
       {state.num_steps, state.counts.fed, state.counts.landed, state.counts.spilled, state.counts.removed})
    sum = mix(sum ^ static_cast<std::uint64_t>(n));
  return sum;
}

}  // namespace drumsweep

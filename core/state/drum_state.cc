#include "core/state/drum_state.h"

#include <algorithm>
#include <bit>

#include "core/parallel/parallel_for.h"

namespace drumsweep {
namespace {

/// Finaliser of SplitMix64 (Steele et al. 2014).
std::uint64_t mix(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9ull;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBull;
  return x ^ (x >> 31);
}

template <class T>
void pick(std::vector<T>& values, const std::vector<std::uint32_t>& order, int threads, std::vector<T>& sorted) {
  if (sorted.capacity() < order.size()) sorted.reserve(order.size() + order.size() / 16 + 64);  // room for what is fed
  sorted.resize(order.size());
  constexpr std::size_t chunk = 4096;
  parallel_ranges(threads, order.size(), chunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) sorted[i] = values[order[i]];
  });
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

void Balls::reorder(const std::vector<std::uint32_t>& order, int threads, BallScratch& scratch) {
  pick(position, order, threads, scratch.vectors);
  pick(velocity, order, threads, scratch.vectors);
  pick(spin, order, threads, scratch.vectors);
  pick(radius, order, threads, scratch.numbers);
  pick(id, order, threads, scratch.ids);
  pick(exit, order, threads, scratch.bytes);
}

void Balls::keep(const std::vector<std::uint32_t>& ascending) {
  const auto compact = [&](auto& values) {
    for (std::size_t i = 0; i < ascending.size(); ++i) values[i] = values[ascending[i]];
    values.resize(ascending.size());
  };
  compact(position);
  compact(velocity);
  compact(spin);
  compact(radius);
  compact(id);
  compact(exit);
}

void drop_gone(BallState& state, const std::vector<char>& gone) {
  if (std::find(gone.begin(), gone.end(), 1) == gone.end()) return;
  constexpr std::uint32_t dropped = 0xFFFFFFFFu;
  std::vector<std::uint32_t> order, place(gone.size(), dropped);
  for (std::uint32_t i = 0; i < gone.size(); ++i)
    if (gone[i] == 0) {
      place[i] = static_cast<std::uint32_t>(order.size());
      order.push_back(i);
    }
  state.balls.keep(order);

  // Keeps the entries that `keep` accepts, and the turns beside them.
  const auto sieve = [](auto& contacts, std::vector<Turn>& turns, const auto& keep) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      if (!keep(contacts[i])) continue;
      if (!turns.empty()) turns[kept] = turns[i];
      contacts[kept++] = contacts[i];
    }
    contacts.resize(kept);
    if (!turns.empty()) turns.resize(kept);
  };
  for (PairImpulse& p : state.pairs) {
    p.a = place[p.a];
    p.b = place[p.b];
  }
  for (WallImpulse& w : state.walls) w.ball = place[w.ball];
  sieve(state.pairs, state.pair_turns, [](const PairImpulse& p) { return p.a != dropped && p.b != dropped; });
  sieve(state.walls, state.wall_turns, [](const WallImpulse& w) { return w.ball != dropped; });
}

namespace {

/// Sum over the balls, so that their order does not matter.
std::uint64_t hash_of_balls(const Balls& balls) {
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < balls.size(); ++i) {
    std::uint64_t h = mix(balls.id[i] + 0x9E3779B97F4A7C15ull);
    for (const Eigen::Vector3d* v : {&balls.position[i], &balls.velocity[i], &balls.spin[i]})
      for (int k = 0; k < 3; ++k) h = mix(h ^ std::bit_cast<std::uint64_t>((*v)[k]));
    h = mix(h ^ std::bit_cast<std::uint64_t>(balls.radius[i]));
    sum += mix(h ^ balls.exit[i]);
  }
  return sum;
}

}  // namespace

std::uint64_t state_hash(const DrumState& state) {
  std::uint64_t sum = hash_of_balls(state.balls);
  for (const std::int64_t n :
       {state.num_steps, state.counts.fed, state.counts.landed, state.counts.spilled, state.counts.removed})
    sum = mix(sum ^ static_cast<std::uint64_t>(n));
  return sum;
}

std::uint64_t state_hash(const BallState& state) {
  return mix(hash_of_balls(state.balls) ^ static_cast<std::uint64_t>(state.num_steps));
}

}  // namespace drumsweep

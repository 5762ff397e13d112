#include "core/step/impacts.h"

#include <algorithm>
#include <cmath>

#include "core/parallel/parallel_for.h"
#include "core/solver/projected_gauss_seidel.h"
#include "core/step/contact_rows.h"

namespace drumsweep {
namespace {

/// Calls visit(packs, pack, lane, is_wall) for every contact with an impulse.
template <class Visit>
void for_each_impulse(const Assembly& a, Visit&& visit) {
  for (std::size_t s = 0; s < a.num_blocks(); ++s)
    for (const bool wall : {false, true}) {
      const ContactPacks& packs = wall ? a.problem.blocks[s].walls : a.problem.blocks[s].pairs;
      for (const std::uint32_t p : packs.active)
        for (std::size_t lane = 0; lane < pack_width; ++lane)
          if (packs.impulse[p].normal[lane] > 0) visit(packs, p, lane, wall);
    }
}

/// Newton's law with friction may add energy where impacts are coupled (Kane and Levinson 1985). The impulses of each group of balls
/// that is joined by them are scaled down until the group gains no more than moving walls do work on it: with velocities
/// v + s dv the gain is b s + c s^2, the work w s, so s = (w - b) / c. Cones of friction and momentum are kept.
void limit_energy(const Balls& balls, Assembly& a, ImpactScratch& scratch) {
  const std::size_t num = balls.size();
  std::vector<std::uint32_t>& group = scratch.group;
  group.resize(num);
  for (std::uint32_t i = 0; i < num; ++i) group[i] = i;
  const auto root = [&](std::uint32_t i) {
    while (group[i] != i) i = group[i] = group[group[i]];
    return i;
  };
  for_each_impulse(a, [&](const ContactPacks& packs, std::size_t p, std::size_t lane, bool wall) {
    if (wall) return;
    const std::uint32_t one = root(packs.rows[p].a[lane]), two = root(packs.rows[p].b[lane]);
    group[std::max(one, two)] = std::min(one, two);
  });

  // Of each group, at its root: b, c and w.
  std::vector<std::array<double, 3>>& gain = scratch.gain;
  gain.assign(num, {0, 0, 0});
  const auto before = [&](std::size_t i, int k) { return static_cast<float>(balls.velocity[i][k]); };
  const auto spin_before = [&](std::size_t i, int k) { return static_cast<float>(balls.spin[i][k] * balls.radius[i]); };
  for (std::uint32_t i = 0; i < num; ++i) {
    const double inverse_mass = a.velocity[i].inverse_mass;
    if (inverse_mass == 0) continue;
    std::array<double, 3>& sum = gain[root(i)];
    for (int k = 0; k < 3; ++k) {
      const double v = before(i, k), dv = a.velocity[i].linear[k] - before(i, k), spin = spin_before(i, k),
                   turned = a.velocity[i].surface[k] - spin_before(i, k);
      sum[0] += (v * dv + 0.4 * spin * turned) / inverse_mass;
      sum[1] += 0.5 * (dv * dv + 0.4 * turned * turned) / inverse_mass;
    }
  }
  for_each_impulse(a, [&](const ContactPacks& packs, std::size_t p, std::size_t lane, bool wall) {
    if (!wall) return;
    double work = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const float impulse =
          packs.rows[p].normal[k][lane] * packs.impulse[p].normal[lane] + packs.impulse[p].tangent[k][lane];
      work += static_cast<double>(impulse * packs.wall_velocity[p].of[k][lane]);
      // Torque times the wall's angular velocity: turn impulse is over the arm, wall_turn has the arm in it.
      if (!packs.turn.empty()) work += static_cast<double>(packs.turn[p].of[k][lane] * packs.wall_turn[p].of[k][lane]);
    }
    gain[root(packs.rows[p].a[lane])][2] += work;
  });
  for (std::uint32_t i = 0; i < num; ++i) {
    const auto& [b, c, w] = gain[root(i)];
    if (!(b + c > w) || c == 0) continue;
    const auto scale = static_cast<float>(std::max(0.0, (w - b) / c));
    BodyVelocity& v = a.velocity[i];
    for (int k = 0; k < 3; ++k) {
      v.linear[k] = before(i, k) + (v.linear[k] - before(i, k)) * scale;
      v.surface[k] = spin_before(i, k) + (v.surface[k] - spin_before(i, k)) * scale;
    }
  }
}

}  // namespace

void resolve_impacts(const World& world, int iterations, int threads, Assembly& a, ImpactScratch& scratch,
                     Balls& balls) {
  RowInput in;
  in.velocity = a.velocity.data();
  in.time_step = world.time_step;
  scratch.impulse.resize(a.problem.blocks.size());
  scratch.turn.resize(a.problem.blocks.size());
  parallel_for(threads, a.num_blocks(), [&](std::size_t s) {
    ContactBlock& block = a.problem.blocks[s];
    scratch.impulse[s] = block.pairs.impulse;
    scratch.turn[s] = block.pairs.turn;
    for (ContactPacks* packs : {&block.pairs, &block.walls}) {
      std::fill(packs->impulse.begin(), packs->impulse.end(), ImpulsePack{});
      std::fill(packs->turn.begin(), packs->turn.end(), Pack3{});
    }
    make_impact_rows(in, world.balls, 0, block.pairs.rows.size(), false, block.pairs);
    // Packs of one wall follow each other.
    std::size_t begin = 0;
    for (std::size_t w = 0; w < world.walls.size(); ++w) {
      std::size_t end = begin;
      while (end < block.walls.rows.size() && block.walls.wall[end] == w) ++end;
      make_impact_rows(in, world.walls[w].surface, begin, end, true, block.walls);
      begin = end;
    }
  });
  solve(a.problem, iterations, threads, a.velocity);
  limit_energy(balls, a, scratch);
  store_velocities(a, 0, threads, balls);
  for (std::size_t s = 0; s < a.num_blocks(); ++s) {
    a.problem.blocks[s].pairs.impulse.swap(scratch.impulse[s]);
    a.problem.blocks[s].pairs.turn.swap(scratch.turn[s]);
  }
}

}  // namespace drumsweep

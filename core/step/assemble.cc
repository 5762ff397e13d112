#include "core/step/assemble.h"

#include <algorithm>

#include "core/parallel/parallel_for.h"
#include "core/state/arrays.h"
#include "core/step/contact_rows.h"

namespace drumsweep {
namespace {

constexpr std::size_t chunk = 2048;

void clear(ContactPacks& packs) {
  packs.rows.clear();
  packs.impulse.clear();
  packs.wall_velocity.clear();
  packs.turn.clear();
  packs.wall_turn.clear();
  packs.limits.clear();
  packs.pull.clear();
  packs.wall.clear();
  packs.active.clear();
}

/// Adds packs whose lanes are idle. @param wall  its index, or null between balls @return index of the first pack
std::size_t add_packs(const World& world, const Surface& surface, std::uint32_t idle_body, std::size_t num,
                      const std::uint32_t* wall, ContactPacks& packs) {
  ContactPack idle{};
  std::fill(std::begin(idle.a), std::end(idle.a), idle_body);
  std::fill(std::begin(idle.b), std::end(idle.b), idle_body);
  std::fill(std::begin(idle.arm), std::end(idle.arm), 1.0f);
  std::fill(std::begin(idle.bias), std::end(idle.bias), no_row);
  const std::size_t first = packs.rows.size();
  const auto extend = [&](auto& array, const auto& value) {
    make_room(array, first + num);
    array.resize(first + num, value);
  };
  extend(packs.rows, idle);
  extend(packs.impulse, ImpulsePack{});
  if (wall != nullptr) {
    extend(packs.wall, *wall);
    extend(packs.wall_velocity, Pack3{});
  }
  if (world.cohesive) extend(packs.pull, Pack1{});
  if (world.rotation_resisted) {
    extend(packs.turn, Pack3{});
    extend(packs.limits, RotationLimits{static_cast<float>(surface.rolling), static_cast<float>(surface.twisting)});
    if (wall != nullptr) extend(packs.wall_turn, Pack3{});
  }
  return first;
}

/// Packs pairs and gives them the impulses they had.
void pack_pairs(const World& world, const PairList& list, std::span<const BallPair> pairs, std::uint32_t first_ball,
                std::uint32_t end_ball, std::uint32_t idle_body, Packer& packer, ContactPacks& packs) {
  packer.begin(first_ball, end_ball);
  for (const BallPair& pair : pairs) packer.add(pair[0], pair[1]);
  const std::vector<Packer::Lanes>& lanes = packer.finish();
  std::size_t p = add_packs(world, world.balls, idle_body, lanes.size(), nullptr, packs);
  for (const Packer::Lanes& pack : lanes) {
    for (std::size_t lane = 0; lane < pack_width; ++lane) {
      if (pack[lane] == Packer::none) continue;
      const BallPair& pair = pairs[pack[lane]];
      packs.rows[p].a[lane] = pair[0];
      packs.rows[p].b[lane] = pair[1];
      const std::uint32_t old = list.old_place(pair);
      if (old == PairList::none) continue;
      const PairImpulse& impulse = list.old[old];
      packs.impulse[p].normal[lane] = impulse.normal;
      for (std::size_t k = 0; k < 3; ++k) packs.impulse[p].tangent[k][lane] = impulse.tangent[k];
      if (!list.old_turns.empty())
        for (std::size_t k = 0; k < 3; ++k) packs.turn[p].of[k][lane] = list.old_turns[old][k];
    }
    ++p;
  }
}

void set_lane(const Eigen::Vector3d& v, float (&of)[3][pack_width], std::size_t lane) {
  for (int k = 0; k < 3; ++k) of[k][lane] = static_cast<float>(v[k]);
}
Eigen::Vector3d lane_of(const float (&of)[3][pack_width], std::size_t lane) {
  return {of[0][lane], of[1][lane], of[2][lane]};
}

RowInput row_input(const World& world, const Balls& balls, const Assembly& a) {
  RowInput in;
  in.position = balls.size() > 0 ? balls.position[0].data() : nullptr;
  in.num_balls = static_cast<std::uint32_t>(balls.size());
  in.velocity = a.velocity.data();
  in.time_step = world.time_step;
  in.margin = world.margin();
  in.period = world.period;
  in.warm_start = world.physics.solver.warm_start;
  return in;
}

/// Contacts of a slab's balls with walls: found in the wall's frame, solved in the room.
bool find_wall_rows(const World& world, const RowInput& in, const Balls& balls, std::span<const Pose> poses,
                    const Slab& slab, std::uint32_t idle_body, Packer& packer, SlabWalls& w, ContactPacks& packs) {
  const double h = world.time_step, range = world.search.margin;
  clear(packs);
  w.old_impulse.swap(w.impulse);
  w.old_turn.swap(w.turn);
  w.impulse.clear();
  w.turn.clear();
  w.place.clear();
  w.normal.clear();
  w.velocity.clear();
  w.overlap.clear();
  WallMemory memory(w.old_impulse);
  bool impacts = false;

  for (std::size_t n = 0; n < w.candidates.balls.size();) {
    // One wall: its contacts, then their packs.
    const std::uint32_t index = w.candidates.balls[n].wall;
    const Pose& pose = poses[index];
    const Surface& surface = world.walls[index].surface;
    const std::size_t first_contact = w.impulse.size();
    packer.begin(slab.begin, slab.end);
    for (; n < w.candidates.balls.size() && w.candidates.balls[n].wall == index; ++n) {
      NearWall& near = w.candidates.balls[n];
      const Eigen::Vector3d& place = balls.position[near.ball];
      const Eigen::Vector3d relative = balls.velocity[near.ball] - pose.wall_velocity(place);
      const double radius = balls.radius[near.ball];
      contacts_of(world, balls, near, w.candidates, pose, radius + std::max(range, relative.norm() * h), w.contacts);
      memory.turn_to(near.wall, near.ball);
      for (const WallContact& contact : w.contacts) {
        const Eigen::Vector3d normal = pose.rotation * contact.normal;
        const Eigen::Vector3d wall_velocity = pose.wall_velocity(place - normal * contact.distance);
        const double gap = contact.distance - radius,
                     separating = normal.dot(balls.velocity[near.ball] - wall_velocity);
        if (gap > range && gap + separating * h > 0) continue;
        packer.add(near.ball, near.ball);
        append(w.normal, normal);
        append(w.velocity, wall_velocity);
        append(w.overlap, static_cast<float>(-gap));
        const Eigen::Vector3f direction = contact.normal.cast<float>();
        WallImpulse kept{near.ball, near.wall, {direction[0], direction[1], direction[2]}, {0, 0, 0}, 0};
        Turn turn{};
        const std::ptrdiff_t from = memory.take(direction);
        if (from >= 0) {
          const auto o = static_cast<std::size_t>(from);
          kept.normal = w.old_impulse[o].normal;
          for (int k = 0; k < 3; ++k) kept.tangent[k] = w.old_impulse[o].tangent[k];
          if (o < w.old_turn.size()) turn = w.old_turn[o];
        }
        append(w.impulse, kept);
        if (world.rotation_resisted) append(w.turn, turn);
      }
    }

    const std::vector<Packer::Lanes>& lanes = packer.finish();
    const std::size_t first = add_packs(world, surface, idle_body, lanes.size(), &index, packs);
    w.place.resize(w.impulse.size());
    for (std::size_t k = 0; k < lanes.size(); ++k)
      for (std::size_t lane = 0; lane < pack_width; ++lane) {
        if (lanes[k][lane] == Packer::none) continue;
        const std::size_t c = first_contact + lanes[k][lane], p = first + k;
        const WallImpulse& kept = w.impulse[c];
        w.place[c] = static_cast<std::uint32_t>(pack_width * p + lane);
        packs.rows[p].a[lane] = kept.ball;
        packs.rows[p].overlap[lane] = w.overlap[c];
        set_lane(w.normal[c], packs.rows[p].normal, lane);
        set_lane(w.velocity[c], packs.wall_velocity[p].of, lane);
        packs.impulse[p].normal[lane] = kept.normal;
        set_lane(pose.rotation * Eigen::Vector3d(kept.tangent[0], kept.tangent[1], kept.tangent[2]),
                 packs.impulse[p].tangent, lane);
        if (world.rotation_resisted) {
          for (std::size_t x = 0; x < 3; ++x) packs.turn[p].of[x][lane] = w.turn[c][x];
          set_lane(balls.radius[kept.ball] * pose.angular_velocity, packs.wall_turn[p].of, lane);
        }
      }
    impacts = make_wall_rows(in, surface, first, packs.rows.size(), packs) || impacts;
  }
  return impacts;
}

void list_inverse_masses(const World& world, const Balls& balls, std::vector<double>& out) {
  out.resize(balls.size());
  // Most balls are alike.
  const double radius = 0.5 * world.physics.material.diameter_m, typical = world.inverse_mass(radius);
  for (std::size_t i = 0; i < balls.size(); ++i) {
    const bool fixed = balls.exit[i] == static_cast<std::uint8_t>(Exit::fixed);
    out[i] = fixed ? 0 : balls.radius[i] == radius ? typical : world.inverse_mass(balls.radius[i]);
  }
}

}  // namespace

bool Assembly::any_impact() const { return std::find(impacts.begin(), impacts.end(), 1) != impacts.end(); }

void find_contacts(const World& world, std::span<const Pose> poses, int threads, BallState& state,
                   std::vector<double>& inverse_mass, Assembly& a) {
  sort_and_find_pairs(world.search, threads, state, a.pairs);
  const Balls& balls = state.balls;
  const PairList& list = a.pairs;
  list_inverse_masses(world, balls, inverse_mass);

  const std::size_t num_slabs = list.num_slabs, num_blocks = a.num_blocks();
  const auto num = static_cast<std::uint32_t>(balls.size());
  if (a.walls.size() < num_slabs) a.walls.resize(num_slabs);
  if (a.problem.blocks.size() < num_blocks) a.problem.blocks.resize(num_blocks);
  a.packers.resize(static_cast<std::size_t>(std::max(1, threads)));
  a.problem.rotation_resisted = world.rotation_resisted;
  a.problem.num_slabs = num_slabs;
  a.impacts.assign(num_blocks, 0);
  a.problem.phases.resize(3);
  for (auto& phase : a.problem.phases) phase.clear();
  for (std::uint32_t s = 0; s < num_slabs; ++s) a.problem.phases[s % 2].push_back(s);
  a.problem.phases[2].push_back(static_cast<std::uint32_t>(num_slabs));

  // Impulses of walls go to the slab of their ball. The smooth step keeps its own lists.
  const bool smooth = world.physics.step.method == "smooth";
  for (std::size_t s = 0; s < num_slabs; ++s) {
    a.walls[s].impulse.clear();
    a.walls[s].turn.clear();
  }
  for (std::size_t i = 0; i < state.walls.size() && !smooth; ++i) {
    SlabWalls& w = a.walls[list.slab_of(state.walls[i].ball)];
    append(w.impulse, state.walls[i]);
    if (!state.wall_turns.empty()) append(w.turn, state.wall_turns[i]);
  }

  parallel_for(threads, num_blocks, [&](std::size_t s) {
    ContactBlock& block = a.problem.blocks[s];
    Packer& packer = a.packers[static_cast<std::size_t>(thread_number())];
    const auto idle = static_cast<std::uint32_t>(num + s);
    clear(block.pairs);
    clear(block.walls);
    if (s < num_slabs) find_wall_candidates(world, balls, list, s, inverse_mass, poses, a.walls[s].candidates);
    if (smooth) return;
    if (s == num_slabs) {
      if (!list.apart.empty()) pack_pairs(world, list, list.apart, 0, num, idle, packer, block.pairs);
      return;
    }
    // Near pairs first and by themselves: packs of far ones mostly have no row and are passed over.
    const Slab& slab = list.slabs[s];
    const std::uint32_t end = list.reach_end(s);
    pack_pairs(world, list, slab.near, slab.begin, end, idle, packer, block.pairs);
    pack_pairs(world, list, slab.far, slab.begin, end, idle, packer, block.pairs);
    sort_wall_impulses(a.walls[s].impulse, a.walls[s].turn);
  });
}

void load_velocities(const Balls& balls, std::span<const double> inverse_mass, int threads, Assembly& a) {
  const std::size_t num = balls.size();
  make_room(a.velocity, num + a.num_blocks());
  a.velocity.resize(num + a.num_blocks());
  for (std::size_t i = num; i < a.velocity.size(); ++i) a.velocity[i] = {{0, 0, 0}, 0, {0, 0, 0}, 1};
  parallel_ranges(threads, num, chunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      BodyVelocity& body = a.velocity[i];
      const double radius = balls.radius[i];
      for (int k = 0; k < 3; ++k) {
        body.linear[k] = static_cast<float>(balls.velocity[i][k]);
        body.surface[k] = static_cast<float>(balls.spin[i][k] * radius);
      }
      body.inverse_mass = static_cast<float>(inverse_mass[i]);
      body.radius = static_cast<float>(radius);
    }
  });
}

void make_rows(const World& world, const Balls& balls, std::span<const Pose> poses, int threads, Assembly& a) {
  const RowInput in = row_input(world, balls, a);
  parallel_for(threads, a.num_blocks(), [&](std::size_t s) {
    ContactBlock& block = a.problem.blocks[s];
    bool impacts = make_pair_rows(in, world.balls, block.pairs);
    if (s < a.pairs.num_slabs)
      impacts = find_wall_rows(world, in, balls, poses, a.pairs.slabs[s], static_cast<std::uint32_t>(balls.size() + s),
                               a.packers[static_cast<std::size_t>(thread_number())], a.walls[s], block.walls) ||
                impacts;
    a.impacts[s] = impacts ? 1 : 0;
  });
}

void store_velocities(const Assembly& a, double h, int threads, Balls& balls) {
  // The solver works in float on velocities rounded from the state's; only its changes are added back.
  parallel_ranges(threads, balls.size(), chunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const BodyVelocity& after = a.velocity[i];
      const double radius = balls.radius[i];
      for (int k = 0; k < 3; ++k) {
        balls.velocity[i][k] +=
            static_cast<double>(after.linear[k]) - static_cast<double>(static_cast<float>(balls.velocity[i][k]));
        balls.spin[i][k] += (static_cast<double>(after.surface[k]) -
                             static_cast<double>(static_cast<float>(balls.spin[i][k] * radius))) /
                            radius;
      }
      balls.position[i] += h * balls.velocity[i];
    }
  });
}

void keep_wall_impulses(const World& world, std::span<const Pose> poses, int threads, Assembly& a) {
  parallel_for(threads, a.pairs.num_slabs, [&](std::size_t s) {
    SlabWalls& w = a.walls[s];
    const ContactPacks& packs = a.problem.blocks[s].walls;
    for (std::size_t c = 0; c < w.impulse.size(); ++c) {
      const std::size_t p = w.place[c] / pack_width, lane = w.place[c] % pack_width;
      WallImpulse& kept = w.impulse[c];
      kept.normal = packs.impulse[p].normal[lane];
      const Eigen::Vector3d tangent = poses[kept.wall].rotation.transpose() * lane_of(packs.impulse[p].tangent, lane);
      for (int k = 0; k < 3; ++k) kept.tangent[k] = static_cast<float>(tangent[k]);
      if (world.rotation_resisted)
        for (std::size_t k = 0; k < 3; ++k) w.turn[c][k] = packs.turn[p].of[k][lane];
    }
  });
}

void store_impulses(const Assembly& a, BallState& state) {
  state.pairs.clear();
  state.pair_turns.clear();
  state.walls.clear();
  state.wall_turns.clear();
  for (std::size_t s = 0; s < a.num_blocks(); ++s) {
    const ContactPacks& packs = a.problem.blocks[s].pairs;
    for (const std::uint32_t p : packs.active)
      for (std::size_t lane = 0; lane < pack_width; ++lane) {
        const ImpulsePack& impulse = packs.impulse[p];
        if (!(impulse.normal[lane] > 0)) continue;
        append(state.pairs, PairImpulse{packs.rows[p].a[lane],
                                        packs.rows[p].b[lane],
                                        {impulse.tangent[0][lane], impulse.tangent[1][lane], impulse.tangent[2][lane]},
                                        impulse.normal[lane]});
        if (!packs.turn.empty())
          append(state.pair_turns,
                 Turn{packs.turn[p].of[0][lane], packs.turn[p].of[1][lane], packs.turn[p].of[2][lane]});
      }
    if (s == a.pairs.num_slabs) continue;
    for (const WallImpulse& w : a.walls[s].impulse) append(state.walls, w);
    for (const Turn& t : a.walls[s].turn) append(state.wall_turns, t);
  }
}

}  // namespace drumsweep

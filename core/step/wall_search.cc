#include "core/step/wall_search.h"

#include <algorithm>
#include <cmath>

#include "core/state/arrays.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/step/wall_search.cc"
#include <hwy/foreach_target.h>

#include "core/simd/rows-inl.h"

#ifndef DRUMSWEEP_WALL_SEARCH_ONCE
#define DRUMSWEEP_WALL_SEARCH_ONCE
namespace drumsweep {

/// From the frame of the flights to that of a wall: place = turn (x - origin), way = turn (way - slip (x - origin) + drift).
struct ToWall {
  float turn[3][3], origin[3], slip[3][3], drift[3];
};

/// A ball's way in the frame of a wall [m].
struct alignas(64) WallFlight {
  float place[3][pack_width], way[3][pack_width];
};

}  // namespace drumsweep
#endif

HWY_BEFORE_NAMESPACE();
namespace drumsweep {
namespace HWY_NAMESPACE {

HWY_INLINE Vector3V Times(const float (&m)[3][3], Vector3V v) {
  const FloatTag d;
  const auto row = [&](int k) HWY_ATTR {
    return Dot({hn::Set(d, m[k][0]), hn::Set(d, m[k][1]), hn::Set(d, m[k][2])}, v);
  };
  return {row(0), row(1), row(2)};
}

/// Sixteen balls from `first` on.
void FlyPast(const Flights& f, const ToWall& to, std::uint32_t first, WallFlight& out) {
  const FloatTag d;
  for (std::size_t lane = 0; lane < pack_width; lane += simd_lanes) {
    const std::size_t i = first + lane;
    const Vector3V place{hn::LoadU(d, f.x + i), hn::LoadU(d, f.y + i), hn::LoadU(d, f.z + i)},
        way{hn::LoadU(d, f.way_x + i), hn::LoadU(d, f.way_y + i), hn::LoadU(d, f.way_z + i)};
    const Vector3V from =
        place - Vector3V{hn::Set(d, to.origin[0]), hn::Set(d, to.origin[1]), hn::Set(d, to.origin[2])};
    const Vector3V drift{hn::Set(d, to.drift[0]), hn::Set(d, to.drift[1]), hn::Set(d, to.drift[2])};
    Store3(Times(to.turn, from), out.place, lane);
    Store3(Times(to.turn, way - Times(to.slip, from) + drift), out.way, lane);
  }
}

/// Triangles whose bounding sphere comes within reach of the way from p to p + way.
/// @param spheres  of all triangles x, then y, z and radii; @return number written to `out`, which has room for all
std::size_t NearTriangles(const std::int32_t* HWY_RESTRICT triangles, const float* HWY_RESTRICT spheres,
                          std::size_t num, const float* p, const float* way, float reach,
                          std::int32_t* HWY_RESTRICT out) {
  const FloatTag d;
  const Vector3V from{hn::Set(d, p[0]), hn::Set(d, p[1]), hn::Set(d, p[2])},
      along{hn::Set(d, way[0]), hn::Set(d, way[1]), hn::Set(d, way[2])};
  const FloatV zero = hn::Zero(d), one = hn::Set(d, 1.0f);
  const FloatV per_length = hn::Div(one, hn::Max(Dot(along, along), hn::Set(d, 1e-20f)));
  const float *x = spheres, *y = x + num, *z = y + num, *r = z + num;
  std::size_t found = 0;
  for (std::size_t k = 0; k < num; k += simd_lanes) {
    const Vector3V away = Vector3V{hn::LoadU(d, x + k), hn::LoadU(d, y + k), hn::LoadU(d, z + k)} - from;
    const FloatV when = hn::Min(hn::Max(hn::Mul(Dot(away, along), per_length), zero), one);
    const Vector3V then = away - along * when;
    const FloatV within = hn::Add(hn::LoadU(d, r + k), hn::Set(d, reach));
    const MaskV in_list = hn::FirstN(d, HWY_MIN(simd_lanes, num - k));
    std::uint32_t bits = BitsOf(hn::And(in_list, hn::Le(Dot(then, then), hn::Mul(within, within))));
    while (bits != 0) {
      out[found++] = triangles[k + static_cast<std::size_t>(__builtin_ctz(bits))];
      bits &= bits - 1;
    }
  }
  return found;
}

}  // namespace HWY_NAMESPACE
}  // namespace drumsweep
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace drumsweep {

HWY_EXPORT(FlyPast);
HWY_EXPORT(NearTriangles);

namespace {

// A wall contact takes over the impulse of an old one whose normal was this near.
constexpr float carried_direction = 0.8f;

/// @param low  origin of the flights in the room
ToWall to_wall(const World& world, const Pose& pose, const Eigen::Vector3d& low) {
  const double horizon = world.search.horizon;
  const Eigen::Matrix3d turn = pose.rotation.transpose();
  const Eigen::Vector3d origin = pose.origin - low, w = pose.angular_velocity * horizon;
  const Eigen::Vector3d drift = world.gravity_vector * (horizon * horizon) - pose.velocity * horizon;
  Eigen::Matrix3d slip;
  slip << 0, -w[2], w[1], w[2], 0, -w[0], -w[1], w[0], 0;
  ToWall out;
  for (int i = 0; i < 3; ++i) {
    out.origin[i] = static_cast<float>(origin[i]);
    out.drift[i] = static_cast<float>(drift[i]);
    for (int k = 0; k < 3; ++k) {
      out.turn[i][k] = static_cast<float>(turn(i, k));
      out.slip[i][k] = static_cast<float>(slip(i, k));
    }
  }
  return out;
}

}  // namespace

void find_wall_candidates(const World& world, const Balls& balls, const PairList& list, std::size_t slab,
                          std::span<const double> inverse_mass, std::span<const Pose> poses, WallCandidates& out) {
  const auto fly_past = HWY_DYNAMIC_DISPATCH(FlyPast);
  const auto near_triangles = HWY_DYNAMIC_DISPATCH(NearTriangles);
  out.balls.clear();
  std::size_t num = 0;  // of triangles; the array has room for more
  // A ball's centre moves along a segment in the wall's frame; what it can touch lies within `beyond` and its radius of
  // that segment.
  const double beyond = world.search.margin + world.search.extra_speed * world.search.horizon;
  const std::uint32_t end = list.slabs[slab].end;
  for (std::uint32_t w = 0; w < world.walls.size(); ++w) {
    const Wall& wall = world.walls[w];
    const ToWall to = to_wall(world, poses[w], list.low);
    WallFlight flight;
    for (std::uint32_t first = list.slabs[slab].begin; first < end; first += pack_width) {
      fly_past(list.flights, to, first, flight);
      for (std::uint32_t i = first; i < std::min<std::uint32_t>(end, first + pack_width); ++i) {
        if (inverse_mass[i] == 0) continue;
        const std::size_t lane = i - first;
        const Eigen::Array3f from(flight.place[0][lane], flight.place[1][lane], flight.place[2][lane]),
            way(flight.way[0][lane], flight.way[1][lane], flight.way[2][lane]), to_place = from + way;
        // What rebounds may go anywhere as far as it is fast.
        const float turned = world.search.rebounds ? way.matrix().norm() : 0;
        const float reach = static_cast<float>(balls.radius[i] + beyond) + turned;
        const std::size_t begin = num;
        int lists = 0;
        wall.grid.near(from.min(to_place) - turned, from.max(to_place) + turned,
                       [&](const WallGrid::Triangles& list_of_cell) {
                         const std::size_t most = list_of_cell.index.size();
                         if (out.triangles.size() < num + most) out.triangles.resize(num + most + num / 8);
                         num += near_triangles(list_of_cell.index.data(), list_of_cell.spheres, most, from.data(),
                                               way.data(), reach, out.triangles.data() + num);
                         ++lists;
                       });
        if (lists > 1) {
          const auto at = out.triangles.begin() + static_cast<std::ptrdiff_t>(begin),
                     past = out.triangles.begin() + static_cast<std::ptrdiff_t>(num);
          std::sort(at, past);
          num = begin + static_cast<std::size_t>(std::unique(at, past) - at);
        }
        if (num > begin)
          append(out.balls, NearWall{i, w, static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(num)});
      }
    }
  }
  out.reached_after.assign(world.search.horizon > 1.5 * world.time_step ? num : 0, 0.0f);
}

void contacts_of(const World& world, const Balls& balls, NearWall& near, WallCandidates& candidates, const Pose& pose,
                 double max_distance, std::vector<WallContact>& contacts) {
  const Wall& wall = world.walls[near.wall];
  const bool in_front = wall.one_sided && balls.exit[near.ball] == static_cast<std::uint8_t>(Exit::inside);
  const Eigen::Vector3d centre = pose.to_body(balls.position[near.ball]);
  const std::size_t num = near.end - near.begin;
  WallSight sight;
  if (!candidates.reached_after.empty()) {
    near.travelled = near.travelled < 0 ? 0 : near.travelled + (centre - near.last).norm();
    near.last = centre;
    sight = {{candidates.reached_after.data() + near.begin, num}, near.travelled};
  }
  wall_contacts(wall.mesh, {candidates.triangles.data() + near.begin, num}, centre, max_distance, in_front, contacts,
                sight);
}

void WallMemory::turn_to(std::uint32_t wall, std::uint32_t ball) {
  const auto is_before = [&](const WallImpulse& w) { return w.wall != wall ? w.wall < wall : w.ball < ball; };
  begin_ = end_;
  while (begin_ < old_.size() && is_before(old_[begin_])) ++begin_;
  end_ = begin_;
  while (end_ < old_.size() && old_[end_].wall == wall && old_[end_].ball == ball) ++end_;
  taken_ = 0;
}

std::ptrdiff_t WallMemory::take(const Eigen::Vector3f& direction) {
  float best = carried_direction;
  std::ptrdiff_t from = -1;
  for (std::size_t o = begin_; o < end_; ++o) {
    const float(&d)[3] = old_[o].direction;
    const float alike = direction[0] * d[0] + direction[1] * d[1] + direction[2] * d[2];
    if (alike > best && (taken_ >> (o - begin_) & 1u) == 0) {
      best = alike;
      from = static_cast<std::ptrdiff_t>(o);
    }
  }
  if (from >= 0) taken_ |= 1u << (static_cast<std::size_t>(from) - begin_);
  return from;
}

void sort_wall_impulses(std::vector<WallImpulse>& walls, std::vector<Turn>& turns) {
  const auto before = [](const WallImpulse& l, const WallImpulse& r) {
    return l.wall != r.wall ? l.wall < r.wall : l.ball < r.ball;
  };
  if (turns.empty()) {
    std::stable_sort(walls.begin(), walls.end(), before);
    return;
  }
  std::vector<std::uint32_t> order(walls.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t l, std::uint32_t r) { return before(walls[l], walls[r]); });
  const std::vector<WallImpulse> old_walls = walls;
  const std::vector<Turn> old_turns = turns;
  for (std::size_t i = 0; i < order.size(); ++i) {
    walls[i] = old_walls[order[i]];
    turns[i] = old_turns[order[i]];
  }
}

}  // namespace drumsweep
#endif

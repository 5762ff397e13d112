#include "core/contact/pair_search.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/parallel/parallel_for.h"
#include "core/simd/targets.h"
#include "core/state/arrays.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/contact/pair_search.cc"
#include <hwy/foreach_target.h>

#include "core/simd/rows-inl.h"

#ifndef DRUMSWEEP_PAIR_SEARCH_ONCE
#define DRUMSWEEP_PAIR_SEARCH_ONCE
namespace drumsweep {

/// Runs of places to look through.
struct Runs {
  std::uint32_t begin[5], end[5];
  int num = 5;
};

}  // namespace drumsweep
#endif

HWY_BEFORE_NAMESPACE();
namespace drumsweep {
namespace HWY_NAMESPACE {

/// Squares and products that tell how near two balls come as they fly: at the beginning, at the end, or in between.
struct ApproachV {
  FloatV begin, end, closing, product;
  MaskV between;
  HWY_INLINE MaskV Within(FloatV distance) const {
    const FloatV squared = hn::Mul(distance, distance);
    const MaskV at_ends = hn::Le(hn::Min(begin, end), squared);
    const MaskV on_the_way = hn::Le(hn::Mul(hn::Sub(begin, squared), closing), hn::Mul(product, product));
    return hn::Or(at_ends, hn::And(between, on_the_way));
  }
};

template <bool with_far>
HWY_INLINE std::size_t FindIn(const Flights& f, std::uint32_t i, const Runs& runs, std::uint32_t* HWY_RESTRICT hits) {
  const FloatTag d;
  const FloatV zero = hn::Zero(d);
  const Vector3V from{hn::Set(d, f.x[i]), hn::Set(d, f.y[i]), hn::Set(d, f.z[i])};
  const Vector3V way{hn::Set(d, f.way_x[i]), hn::Set(d, f.way_y[i]), hn::Set(d, f.way_z[i])};
  const FloatV near_reach = hn::Set(d, f.radius[i] + f.near_gap), more = hn::Set(d, f.far_gap - f.near_gap),
               turn = hn::Set(d, f.turn[i]);
  std::size_t num = 0;
  for (int r = 0; r < runs.num; ++r)
    for (std::uint32_t j = runs.begin[r]; j < runs.end[r]; j += static_cast<std::uint32_t>(simd_lanes)) {
      const Vector3V apart = Vector3V{hn::LoadU(d, f.x + j), hn::LoadU(d, f.y + j), hn::LoadU(d, f.z + j)} - from;
      const Vector3V closing =
          Vector3V{hn::LoadU(d, f.way_x + j), hn::LoadU(d, f.way_y + j), hn::LoadU(d, f.way_z + j)} - way;
      // Squared distance begin + 2 t product + t^2 closing for t in [0, 1].
      ApproachV a;
      a.begin = Dot(apart, apart);
      a.closing = Dot(closing, closing);
      a.product = Dot(apart, closing);
      a.end = hn::Add(hn::Add(a.begin, a.product), hn::Add(a.product, a.closing));
      a.between = hn::And(hn::Lt(a.product, zero), hn::Lt(hn::Neg(a.product), a.closing));

      const FloatV near = hn::Add(hn::LoadU(d, f.radius + j), near_reach);
      const MaskV in_run = hn::FirstN(d, HWY_MIN(simd_lanes, runs.end[r] - j)),
                  is_near = hn::And(in_run, a.Within(near));
      const std::uint32_t near_bits = BitsOf(is_near);
      std::uint32_t bits = near_bits;
      if constexpr (with_far) {
        const FloatV far = hn::Add(near, more);
        MaskV listed = a.Within(far);
        if (f.rebounds) {
          const FloatV reach = hn::Add(far, hn::Add(turn, hn::LoadU(d, f.turn + j)));
          listed = hn::Or(listed, hn::Le(a.begin, hn::Mul(reach, reach)));
        }
        bits |= BitsOf(hn::And(in_run, listed));
      }
      while (bits != 0) {
        const int lane = __builtin_ctz(bits);
        hits[num++] = 2 * (j + static_cast<std::uint32_t>(lane)) + (near_bits >> lane & 1u);
        bits &= bits - 1;
      }
    }
  return num;
}

/// Balls in the runs that ball i may meet: their places times two, plus one where the pair is near.
/// @param hits  room for all places of the runs
/// @return number of hits
std::size_t FindNear(const Flights& f, std::uint32_t i, const Runs& runs, std::uint32_t* hits) {
  return f.far_gap > f.near_gap || f.rebounds ? FindIn<true>(f, i, runs, hits) : FindIn<false>(f, i, runs, hits);
}

}  // namespace HWY_NAMESPACE
}  // namespace drumsweep
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace drumsweep {

HWY_EXPORT(FindNear);

namespace {

// Farther than this many cells nothing is looked for: a ball that fast is not a ball of a drum.
constexpr std::int64_t most_layers = 6;

// A ball with this many others listed around it does not fly.
constexpr std::uint8_t enclosed_by = 4;

// Of a slab, about: small enough that it stays in a core's cache, large enough to fill packs.
constexpr std::uint32_t balls_per_slab = 600;

constexpr std::size_t chunk = 4096;

struct Cells {
  std::array<std::int64_t, 3> low, size;  ///< in the order x, y, z
  std::array<double, 3> edge;             ///< of a cell; z is counted from the slope [m]
  double slope;

  /// Coordinate along axis k, in cells from the corner of the room.
  std::int64_t coordinate(const Eigen::Vector3d& p, int k) const {
    const double x = k == 2 ? p[2] - slope * p[1] : p[k];
    return static_cast<std::int64_t>(std::floor(x / edge[static_cast<std::size_t>(k)]));
  }
  std::int64_t row() const { return size[0]; }
  std::int64_t slab() const { return size[0] * size[2]; }
};

/// Fastest and largest of all balls, for how far the fast ones look.
struct Extremes {
  double speed = 0, radius = 0;
};

/// Gap at which a pair is listed, beyond touching, when it closes at this speed.
double listed_gap(const PairSearch& search, double speed) {
  return search.margin + (search.extra_speed + speed) * search.horizon;
}

/// Of two balls this far apart along y.
bool other_image_is_nearer(const PairSearch& search, double apart) {
  return search.period > 0 && std::abs(apart) > 0.5 * search.period;
}

/// @param shift  added to j's y: 0, or the period for a pair across the periodic boundary
/// @return 0: not to be listed, 1: far, 2: near
int listed(const PairSearch& search, const Balls& balls, std::size_t i, std::size_t j, double shift = 0) {
  Eigen::Vector3d apart = balls.position[j] - balls.position[i];
  apart[1] += shift;
  if (other_image_is_nearer(search, apart[1])) return 0;
  const Eigen::Vector3d closing = (balls.velocity[j] - balls.velocity[i]) * search.horizon;
  const double when = std::clamp(-apart.dot(closing) / std::max(closing.squaredNorm(), 1e-20), 0.0, 1.0);
  const double distance = (apart + closing * when).norm();
  const double reach = balls.radius[i] + balls.radius[j] + search.margin, more = search.extra_speed * search.horizon;
  if (distance <= reach) return 2;
  if (distance <= reach + more) return 1;
  if (!search.rebounds) return 0;
  const double turns = (balls.velocity[i].norm() + balls.velocity[j].norm()) * search.horizon;
  return apart.norm() <= reach + more + turns ? 1 : 0;
}

void count_near(PairList& list, std::uint32_t a, std::uint32_t b) {
  for (const std::uint32_t i : {a, b})
    list.num_near[i] = static_cast<std::uint8_t>(std::min(255, list.num_near[i] + 1));
}

/// Adds a pair whose lower ball is not known to be in a given slab.
void list_anywhere(PairList& list, std::uint32_t a, std::uint32_t b, int how) {
  const BallPair pair{std::min(a, b), std::max(a, b)};
  const std::size_t s = list.slab_of(pair[0]);
  if (pair[1] >= list.reach_end(s))
    append(list.apart, pair);
  else
    append(how == 2 ? list.slabs[s].near : list.slabs[s].far, pair);
}

/// Pairs of a slab: each ball with those after it in its own cell and with the 13 cells behind, which are 5 runs of places.
void list_near_pairs(const PairSearch& search, const Flights& flights, const Cells& cells, const Balls& balls,
                     std::size_t s, PairList& list) {
  const auto find = HWY_DYNAMIC_DISPATCH(FindNear);
  Slab& slab = list.slabs[s];
  std::vector<std::uint32_t>& hits = list.hits[static_cast<std::size_t>(thread_number())];
  const std::int64_t row = cells.row(), layer = cells.slab();
  Runs runs;
  std::int64_t cell = -1;
  for (std::uint32_t i = slab.begin; i < slab.end; ++i) {
    const std::int64_t c = list.cell_of[list.order[i]];
    if (c != cell) {
      cell = c;
      const std::int64_t first[5] = {c, c + row - 1, c + layer - row - 1, c + layer - 1, c + layer + row - 1},
                         past[5] = {c + 2, c + row + 2, c + layer - row + 2, c + layer + 2, c + layer + row + 2};
      std::size_t most = 0;
      for (std::size_t r = 0; r < 5; ++r) {
        runs.begin[r] = list.cell_begin[static_cast<std::size_t>(first[r])];
        runs.end[r] = list.cell_begin[static_cast<std::size_t>(past[r])];
        most += runs.end[r] - runs.begin[r];
      }
      if (hits.size() < most) hits.resize(most + most / 2);
    }
    runs.begin[0] = i + 1;
    const std::size_t num = find(flights, i, runs, hits.data());
    for (std::size_t k = 0; k < num; ++k) {
      const std::uint32_t j = hits[k] / 2;
      if (other_image_is_nearer(search, balls.position[j][1] - balls.position[i][1])) continue;
      append(hits[k] % 2 == 1 ? slab.near : slab.far, BallPair{i, j});
      count_near(list, i, j);
    }
  }
}

/// Pairs two or more cells apart that are fast enough to meet within the horizon, one of them loose. Two balls that are both enclosed
/// by others cannot come together from that far, so only the few that fly are looked after.
void list_far_pairs(const PairSearch& search, const Flights& flights, const Cells& cells, const Extremes& most,
                    const Balls& balls, std::size_t s, PairList& list) {
  const auto find = HWY_DYNAMIC_DISPATCH(FindNear);
  Slab& own = list.slabs[s];
  std::vector<std::uint32_t>& hits = list.hits[static_cast<std::size_t>(thread_number())];
  const std::int64_t row = cells.row(), slab = cells.slab();
  const auto is_loose = [&](std::size_t i) { return list.num_near[i] < enclosed_by; };
  for (std::uint32_t i = own.begin; i < own.end; ++i) {
    if (!is_loose(i)) continue;
    // Where another ball must be now to be met: along the way, as far off as the fastest comes.
    const Eigen::Vector3d way = balls.velocity[i] * search.horizon;
    const double around =
        balls.radius[i] + most.radius + listed_gap(search, most.speed) + (search.rebounds ? way.norm() : 0);
    const std::int64_t c = list.cell_of[list.order[i]], at[3] = {c % row, c / slab, c % slab / row};
    std::int64_t from[3], to[3];
    const Eigen::Vector3d low = balls.position[i].array() + way.array().min(0.0) - around,
                          high = balls.position[i].array() + way.array().max(0.0) + around;
    for (int k = 0; k < 3; ++k) {
      const auto axis = static_cast<std::size_t>(k);
      // Along z the slope adds what it climbs across the box.
      const Eigen::Vector3d other_end(0, k == 2 ? high[1] - low[1] : 0, 0);
      const std::int64_t first = std::min(cells.coordinate(low, k), cells.coordinate(low + other_end, k)),
                         last = std::max(cells.coordinate(high, k), cells.coordinate(high - other_end, k));
      from[k] = std::max({std::int64_t{0}, at[k] - most_layers, first - cells.low[axis]});
      to[k] = std::min({cells.size[axis] - 1, at[k] + most_layers, last - cells.low[axis]});
    }

    Runs runs;
    runs.num = 0;
    std::size_t most_hits = 0;
    const auto look = [&] {
      if (hits.size() < most_hits) hits.resize(most_hits + most_hits / 2);
      const std::size_t num = find(flights, i, runs, hits.data());
      for (std::size_t k = 0; k < num; ++k) {
        const std::uint32_t j = hits[k] / 2;
        if (j < i && is_loose(j)) continue;  // of two loose ones the first has listed the pair
        if (other_image_is_nearer(search, balls.position[j][1] - balls.position[i][1])) continue;
        const BallPair pair{std::min(i, j), std::max(i, j)};
        if (pair[0] < own.begin || pair[1] >= list.reach_end(s))
          append(own.apart, pair);
        else
          append(hits[k] % 2 == 1 ? own.near : own.far, pair);
      }
      runs.num = 0;
      most_hits = 0;
    };
    const auto visit = [&](std::int64_t first_cell, std::int64_t last_cell) {
      if (first_cell > last_cell) return;
      const std::uint32_t begin = list.cell_begin[static_cast<std::size_t>(first_cell)],
                          end = list.cell_begin[static_cast<std::size_t>(last_cell) + 1];
      if (begin == end) return;
      runs.begin[runs.num] = begin;
      runs.end[runs.num++] = end;
      most_hits += end - begin;
      if (runs.num == 5) look();
    };
    for (std::int64_t y = from[1]; y <= to[1]; ++y)
      for (std::int64_t z = from[2]; z <= to[2]; ++z) {
        const std::int64_t line = y * slab + z * row;
        if (std::abs(y - at[1]) > 1 || std::abs(z - at[2]) > 1) {
          visit(line + from[0], line + to[0]);
        } else {  // the near search has the three in the middle
          visit(line + from[0], line + at[0] - 2);
          visit(line + at[0] + 2, line + to[0]);
        }
      }
    if (runs.num > 0) look();
  }
}

/// Pairs across the periodic boundary: balls near its upper end with those near its lower one.
/// @param far  false: those within one cell of each other; true: all others, see list_far_pairs()
void list_pairs_across(const PairSearch& search, const Cells& cells, const Extremes& most, bool far, const Balls& balls,
                       PairList& list) {
  const std::int64_t row = cells.row(), slab = cells.slab();
  for (std::size_t i = 0; i < balls.size(); ++i) {
    const double reach = balls.radius[i] + most.radius + listed_gap(search, balls.velocity[i].norm() + most.speed);
    const auto layers =
        far ? std::min(most_layers, static_cast<std::int64_t>(std::ceil(reach / search.cell_size))) : std::int64_t{1};
    if (far && layers < 2) continue;
    Eigen::Vector3d image = balls.position[i];
    image[1] -= search.period;
    std::array<std::int64_t, 3> at{}, from{}, to{};
    for (std::size_t k = 0; k < 3; ++k) {
      at[k] = cells.coordinate(image, static_cast<int>(k)) - cells.low[k];
      from[k] = std::max<std::int64_t>(0, at[k] - layers);
      to[k] = std::min(cells.size[k] - 1, at[k] + layers);
    }
    for (std::int64_t y = from[1]; y <= to[1]; ++y)
      for (std::int64_t z = from[2]; z <= to[2]; ++z)
        for (std::int64_t x = from[0]; x <= to[0]; ++x) {
          const bool near = std::abs(x - at[0]) <= 1 && std::abs(y - at[1]) <= 1 && std::abs(z - at[2]) <= 1;
          if (near == far) continue;
          const auto c = static_cast<std::size_t>(y * slab + z * row + x);
          for (std::uint32_t j = list.cell_begin[c]; j < list.cell_begin[c + 1]; ++j) {
            const auto k = static_cast<std::uint32_t>(i);
            const int how = j == k ? 0 : listed(search, balls, i, j, search.period);
            if (how == 0 || (far && list.num_near[i] >= enclosed_by && list.num_near[j] >= enclosed_by)) continue;
            if (!far) count_near(list, j, k);
            list_anywhere(list, j, k, how);
          }
        }
  }
}

/// Bounding box in cells, one empty layer around it so that neighbours need no test.
Cells bounding_cells(const PairSearch& search, const std::vector<Eigen::Vector3d>& positions) {
  Cells cells{};
  cells.slope = search.slope;
  // Two balls this far apart along y are more than that apart in z over the slope.
  cells.edge = {search.cell_size, search.cell_size, search.cell_size * (1 + std::abs(search.slope))};
  std::array<std::int64_t, 3> high{};
  for (std::size_t k = 0; k < 3; ++k) {
    const auto axis = static_cast<int>(k);
    cells.low[k] = high[k] = positions.empty() ? 0 : cells.coordinate(positions[0], axis);
    for (const Eigen::Vector3d& p : positions) {
      const std::int64_t c = cells.coordinate(p, axis);
      cells.low[k] = std::min(cells.low[k], c);
      high[k] = std::max(high[k], c);
    }
    cells.low[k] -= 1;
    cells.size[k] = high[k] - cells.low[k] + 2;
  }
  return cells;
}

/// Counting sort by cell; stable, so the order is a function of positions and of the order before. x runs fastest, y (along the
/// axis) slowest.
void sort_by_cell(const Cells& cells, int threads, Balls& balls, PairList& list) {
  const std::size_t num = balls.size();
  const auto num_cells = static_cast<std::size_t>(cells.slab() * cells.size[1]);
  list.cell_of.resize(num);
  list.cell_begin.assign(num_cells + 1, 0);
  parallel_ranges(threads, num, chunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto cell = [&](int k) {
        return cells.coordinate(balls.position[i], k) - cells.low[static_cast<std::size_t>(k)];
      };
      list.cell_of[i] = static_cast<std::uint32_t>(cell(1) * cells.slab() + cell(2) * cells.row() + cell(0));
    }
  });
  for (const std::uint32_t c : list.cell_of) ++list.cell_begin[c + 1];
  for (std::size_t c = 0; c < num_cells; ++c) list.cell_begin[c + 1] += list.cell_begin[c];
  list.order.resize(num);
  list.place_of.resize(num);
  for (std::size_t i = 0; i < num; ++i)
    list.order[list.place_of[i] = list.cell_begin[list.cell_of[i]]++] = static_cast<std::uint32_t>(i);
  for (std::size_t c = num_cells; c > 0; --c) list.cell_begin[c] = list.cell_begin[c - 1];
  list.cell_begin[0] = 0;
  balls.reorder(list.order, threads, list.spare);
}

/// Whole layers of cells across the axis, until there are enough balls.
void cut_slabs(const Cells& cells, PairList& list) {
  list.num_slabs = 0;
  std::uint32_t begin = 0;
  for (std::int64_t y = 0; y < cells.size[1]; ++y) {
    const std::uint32_t end = list.cell_begin[static_cast<std::size_t>((y + 1) * cells.slab())];
    const bool last = y + 1 == cells.size[1];
    if (end - begin < balls_per_slab && !last) continue;
    if (list.num_slabs == list.slabs.size()) list.slabs.emplace_back();
    Slab& slab = list.slabs[list.num_slabs++];
    slab.begin = begin;
    slab.end = begin = end;
    slab.near.clear();
    slab.far.clear();
    slab.apart.clear();
  }
}

/// Old impulses by the lower of their balls' new places.
void sort_impulses(const PairSearch& search, BallState& state, PairList& list) {
  const std::size_t num = state.balls.size();
  list.old_begin.assign(num + 1, 0);
  const auto lower = [&](const PairImpulse& p) { return std::min(list.place_of[p.a], list.place_of[p.b]); };
  for (const PairImpulse& p : state.pairs)
    if (p.normal > 0) ++list.old_begin[lower(p) + 1];
  for (std::size_t i = 0; i < num; ++i) list.old_begin[i + 1] += list.old_begin[i];
  list.old.resize(list.old_begin[num]);
  list.old_turns.assign(search.turns ? list.old.size() : 0, Turn{});
  for (std::size_t k = 0; k < state.pairs.size(); ++k) {
    PairImpulse p = state.pairs[k];
    if (!(p.normal > 0)) continue;
    const std::uint32_t to = list.old_begin[lower(p)]++;
    p.a = list.place_of[p.a];
    p.b = list.place_of[p.b];
    float sign = 1;
    if (p.a > p.b) {  // the impulse is that on the first of the two
      std::swap(p.a, p.b);
      for (float& t : p.tangent) t = -t;
      sign = -1;
    }
    list.old[to] = p;
    if (search.turns && k < state.pair_turns.size())
      for (std::size_t x = 0; x < 3; ++x) list.old_turns[to][x] = sign * state.pair_turns[k][x];
  }
  for (std::size_t i = num; i > 0; --i) list.old_begin[i] = list.old_begin[i - 1];
  list.old_begin[0] = 0;
  state.pairs.clear();
  state.pair_turns.clear();
  for (WallImpulse& w : state.walls) w.ball = list.place_of[w.ball];
}

/// Arrays for the near search, with room behind them for a vector's reach.
void list_flights(const PairSearch& search, int threads, const Balls& balls, PairList& list) {
  const std::size_t num = balls.size();
  for (std::vector<float>& array : list.flight)
    if (array.size() < num + pack_width) array.resize(num + num / 16 + pack_width);
  const Eigen::Vector3d low = list.low = num > 0 ? balls.position[0] : Eigen::Vector3d::Zero();
  parallel_ranges(threads, num, chunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Eigen::Vector3d place = balls.position[i] - low, way = balls.velocity[i] * search.horizon;
      for (std::size_t k = 0; k < 3; ++k) {
        list.flight[k][i] = static_cast<float>(place[static_cast<int>(k)]);
        list.flight[3 + k][i] = static_cast<float>(way[static_cast<int>(k)]);
      }
      list.flight[6][i] = static_cast<float>(balls.radius[i]);
      list.flight[7][i] = search.rebounds ? static_cast<float>(way.norm()) : 0;
    }
  });
  const auto& f = list.flight;
  const auto near_gap = static_cast<float>(search.margin);
  list.flights = {f[0].data(),    f[1].data(),
                  f[2].data(),    f[3].data(),
                  f[4].data(),    f[5].data(),
                  f[6].data(),    f[7].data(),
                  near_gap,       near_gap + static_cast<float>(search.extra_speed * search.horizon),
                  search.rebounds};
}

}  // namespace

std::size_t PairList::slab_of(std::uint32_t ball) const {
  const auto end = slabs.begin() + static_cast<std::ptrdiff_t>(num_slabs);
  return static_cast<std::size_t>(
      std::upper_bound(slabs.begin(), end, ball, [](std::uint32_t b, const Slab& s) { return b < s.end; }) -
      slabs.begin());
}

void sort_and_find_pairs(const PairSearch& search, int threads, BallState& state, PairList& list) {
  Balls& balls = state.balls;
  if (search.period > 0)
    for (Eigen::Vector3d& p : balls.position) p[1] -= search.period * std::floor(p[1] / search.period);
  const Cells cells = bounding_cells(search, balls.position);
  if (cells.slab() * cells.size[1] >= 0xFFFFFFFF)
    throw std::runtime_error("the drum is too large for its balls: more than 4 billion cells of the contact search");

  sort_by_cell(cells, threads, balls, list);
  sort_impulses(search, state, list);
  cut_slabs(cells, list);

  // Neighbours in space. A ball counts its pairs in its own slab and the one before, so every other slab goes at a time.
  list_flights(search, threads, balls, list);
  const Flights& flights = list.flights;
  list.apart.clear();
  list.num_near.assign(balls.size(), 0);
  list.hits.resize(static_cast<std::size_t>(std::max(1, threads)));
  for (const std::size_t parity : {0u, 1u})
    parallel_for(threads, (list.num_slabs + 1 - parity) / 2,
                 [&](std::size_t k) { list_near_pairs(search, flights, cells, balls, 2 * k + parity, list); });

  // What flies far, and what meets across the ends of a periodic scene.
  Extremes most;
  for (std::size_t i = 0; i < balls.size(); ++i) {
    most.speed = std::max(most.speed, balls.velocity[i].squaredNorm());
    most.radius = std::max(most.radius, balls.radius[i]);
  }
  most.speed = std::sqrt(most.speed);
  if (search.period > 0) list_pairs_across(search, cells, most, false, balls, list);
  parallel_for(threads, list.num_slabs,
               [&](std::size_t s) { list_far_pairs(search, flights, cells, most, balls, s, list); });
  for (std::size_t s = 0; s < list.num_slabs; ++s)
    list.apart.insert(list.apart.end(), list.slabs[s].apart.begin(), list.slabs[s].apart.end());
  if (search.period > 0) list_pairs_across(search, cells, most, true, balls, list);
}

}  // namespace drumsweep
#endif

#include "core/contact/pair_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "core/state/arrays.h"

namespace drumsweep {
namespace {

// Farther than this many cells nothing is looked for: a ball that fast is not a ball of a drum.
constexpr std::int64_t most_layers = 6;

// A ball with this many others listed around it does not fly.
constexpr std::uint8_t enclosed_by = 4;

struct Cells {
  std::array<std::int64_t, 3> low, size;  ///< in the order x, y, z
};

/// Gap at which a pair is listed, beyond touching, at this relative speed.
double listed_gap(const PairSearch& search, double speed) {
  return search.margin + (search.extra_speed + speed) * search.horizon;
}

/// @param shift  added to j's y: 0, or the period for a pair across the periodic boundary
bool is_listed(const PairSearch& search, const Balls& balls, std::size_t i, std::size_t j, double shift = 0) {
  Eigen::Vector3d way = balls.position[j] - balls.position[i];
  way[1] += shift;
  if (search.period > 0 && std::abs(way[1]) > 0.5 * search.period) return false;  // the other image is nearer
  const double squared = way.squaredNorm(), touching = balls.radius[i] + balls.radius[j];
  const double least = touching + listed_gap(search, 0);
  if (squared <= least * least) return true;
  const double speed = search.rebounds ? balls.velocity[i].norm() + balls.velocity[j].norm()
                                       : (balls.velocity[j] - balls.velocity[i]).norm();
  const double reach = touching + listed_gap(search, speed);
  return squared <= reach * reach;
}

/// Adds a pair with the impulse it had, if it had one.
void list_pair(const PairSearch& search, std::uint32_t a, std::uint32_t b, BallState& state,
               PairSearchScratch& scratch) {
  PairImpulse pair{a, b, {0, 0, 0}, 0};
  Turn turn{};
  for (std::uint32_t o = scratch.old_begin[a]; o < scratch.old_begin[a + 1]; ++o)
    if (scratch.old[o].b == b) {
      pair = scratch.old[o];
      if (search.turns) turn = scratch.old_turns[o];
    }
  append(state.pairs, pair);
  if (search.turns) append(state.pair_turns, turn);
  for (const std::uint32_t i : {a, b})
    scratch.num_near[i] = static_cast<std::uint8_t>(std::min(255, scratch.num_near[i] + 1));
}

/// Adds a pair that cannot have touched yet.
void list_far_pair(const PairSearch& search, std::uint32_t a, std::uint32_t b, BallState& state) {
  append(state.pairs, PairImpulse{std::min(a, b), std::max(a, b), {0, 0, 0}, 0});
  if (search.turns) append(state.pair_turns, Turn{});
}

/// Pairs two or more cells apart that are fast enough to meet within the horizon, one of them loose. Two balls that are both enclosed
/// by others cannot come together from that far, so only the few that fly are looked after.
void list_far_pairs(const PairSearch& search, const Cells& cells, BallState& state, PairSearchScratch& scratch) {
  const Balls& balls = state.balls;
  const std::int64_t row = cells.size[0], slab = row * cells.size[2];
  double fastest = 0, largest = 0;
  for (std::size_t i = 0; i < balls.size(); ++i) {
    fastest = std::max(fastest, balls.velocity[i].norm());
    largest = std::max(largest, balls.radius[i]);
  }
  const auto is_loose = [&](std::size_t i) { return scratch.num_near[i] < enclosed_by; };

  for (std::size_t i = 0; i < balls.size(); ++i) {
    if (!is_loose(i)) continue;
    const double reach = balls.radius[i] + largest + listed_gap(search, balls.velocity[i].norm() + fastest);
    const auto layers = std::min(most_layers, static_cast<std::int64_t>(std::ceil(reach / search.cell_size)));
    if (layers < 2) continue;
    const std::int64_t c = scratch.cell_of[scratch.order[i]], y = c / slab, z = c % slab / row, x = c % row;
    const auto visit = [&](std::int64_t first_cell, std::int64_t last_cell) {
      if (first_cell > last_cell) return;
      const std::uint32_t begin = scratch.cell_begin[static_cast<std::size_t>(first_cell)];
      const std::uint32_t end = scratch.cell_begin[static_cast<std::size_t>(last_cell) + 1];
      for (std::uint32_t j = begin; j < end; ++j) {
        if ((j < i && is_loose(j)) || !is_listed(search, balls, i, j))
          continue;  // of two loose ones the first has listed the pair
        list_far_pair(search, static_cast<std::uint32_t>(i), j, state);
      }
    };
    for (std::int64_t ny = std::max<std::int64_t>(0, y - layers); ny <= std::min(cells.size[1] - 1, y + layers); ++ny)
      for (std::int64_t nz = std::max<std::int64_t>(0, z - layers); nz <= std::min(cells.size[2] - 1, z + layers);
           ++nz) {
        const std::int64_t line = ny * slab + nz * row;
        const std::int64_t from = line + std::max<std::int64_t>(0, x - layers),
                           to = line + std::min(row - 1, x + layers);
        if (std::abs(ny - y) > 1 || std::abs(nz - z) > 1) {
          visit(from, to);
        } else {  // the near search has the three in the middle
          visit(from, line + x - 2);
          visit(line + x + 2, to);
        }
      }
  }
}

/// Pairs across the periodic boundary: balls near its upper end with those near its lower one.
/// @param far  false: those within one cell of each other; true: all others, see list_far_pairs()
void list_pairs_across(const PairSearch& search, const Cells& cells, bool far, BallState& state,
                       PairSearchScratch& scratch) {
  const Balls& balls = state.balls;
  const std::int64_t row = cells.size[0], slab = row * cells.size[2];
  double fastest = 0, largest = 0;
  for (std::size_t i = 0; i < balls.size(); ++i) {
    fastest = std::max(fastest, balls.velocity[i].norm());
    largest = std::max(largest, balls.radius[i]);
  }
  for (std::size_t i = 0; i < balls.size(); ++i) {
    const double reach = balls.radius[i] + largest + listed_gap(search, balls.velocity[i].norm() + fastest);
    const auto layers =
        far ? std::min(most_layers, static_cast<std::int64_t>(std::ceil(reach / search.cell_size))) : std::int64_t{1};
    if (far && layers < 2) continue;
    Eigen::Vector3d image = balls.position[i];
    image[1] -= search.period;
    std::array<std::int64_t, 3> at{}, from{}, to{};
    for (std::size_t k = 0; k < 3; ++k) {
      at[k] = static_cast<std::int64_t>(std::floor(image[static_cast<int>(k)] / search.cell_size)) - cells.low[k];
      from[k] = std::max<std::int64_t>(0, at[k] - layers);
      to[k] = std::min(cells.size[k] - 1, at[k] + layers);
    }
    for (std::int64_t y = from[1]; y <= to[1]; ++y)
      for (std::int64_t z = from[2]; z <= to[2]; ++z)
        for (std::int64_t x = from[0]; x <= to[0]; ++x) {
          const bool near = std::abs(x - at[0]) <= 1 && std::abs(y - at[1]) <= 1 && std::abs(z - at[2]) <= 1;
          if (near == far) continue;
          const auto c = static_cast<std::size_t>(y * slab + z * row + x);
          for (std::uint32_t j = scratch.cell_begin[c]; j < scratch.cell_begin[c + 1]; ++j) {
            const auto k = static_cast<std::uint32_t>(i);
            if (j == k || !is_listed(search, balls, i, j, search.period)) continue;
            if (far && scratch.num_near[i] >= enclosed_by && scratch.num_near[j] >= enclosed_by) continue;
            if (far)
              list_far_pair(search, j, k, state);
            else
              list_pair(search, std::min(j, k), std::max(j, k), state, scratch);
          }
        }
  }
}

/// Renames the balls of the wall impulses and sorts them by wall and ball.
void sort_walls(BallState& state, PairSearchScratch& scratch) {
  const auto before = [](const WallImpulse& l, const WallImpulse& r) {
    return l.wall != r.wall ? l.wall < r.wall : l.ball < r.ball;
  };
  for (WallImpulse& w : state.walls) w.ball = scratch.place_of[w.ball];
  if (state.wall_turns.empty()) {
    std::stable_sort(state.walls.begin(), state.walls.end(), before);
    return;
  }
  std::vector<std::uint32_t> order(state.walls.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t l, std::uint32_t r) { return before(state.walls[l], state.walls[r]); });
  const std::vector<WallImpulse> walls = state.walls;
  const std::vector<Turn> turns = state.wall_turns;
  for (std::size_t i = 0; i < order.size(); ++i) {
    state.walls[i] = walls[order[i]];
    state.wall_turns[i] = turns[order[i]];
  }
}

}  // namespace

void sort_and_find_pairs(const PairSearch& search, BallState& state, PairSearchScratch& scratch) {
  Balls& balls = state.balls;
  const std::size_t num = balls.size();
  if (search.period > 0)
    for (Eigen::Vector3d& p : balls.position) p[1] -= search.period * std::floor(p[1] / search.period);
  const auto cell_coordinate = [&](std::size_t i, int k) {
    return static_cast<std::int64_t>(std::floor(balls.position[i][k] / search.cell_size));
  };

  // Bounding box in cells, one empty layer around it so that neighbours need no test.
  Cells cells{};
  std::array<std::int64_t, 3> high{};
  bool first = true;
  for (std::size_t i = 0; i < num; ++i) {
    for (int k = 0; k < 3; ++k) {
      const auto j = static_cast<std::size_t>(k);
      const std::int64_t c = cell_coordinate(i, k);
      cells.low[j] = first ? c : std::min(cells.low[j], c);
      high[j] = first ? c : std::max(high[j], c);
    }
    first = false;
  }
  for (std::size_t j = 0; j < 3; ++j) {
    cells.low[j] -= 1;
    cells.size[j] = high[j] - cells.low[j] + 2;
  }
  // x runs fastest, y (along the axis) slowest.
  const std::int64_t row = cells.size[0], slab = row * cells.size[2];
  const auto num_cells = static_cast<std::size_t>(slab * cells.size[1]);
  if (num_cells >= 0xFFFFFFFFu)
    throw std::runtime_error("the drum is too large for its balls: more than 4 billion cells of the contact search");

  // Counting sort by cell; stable, so the order is a function of positions and of the order before.
  scratch.cell_of.resize(num);
  scratch.cell_begin.assign(num_cells + 1, 0);
  for (std::size_t i = 0; i < num; ++i) {
    const std::int64_t c = (cell_coordinate(i, 1) - cells.low[1]) * slab +
                           (cell_coordinate(i, 2) - cells.low[2]) * row + (cell_coordinate(i, 0) - cells.low[0]);
    scratch.cell_of[i] = static_cast<std::uint32_t>(c);
    ++scratch.cell_begin[static_cast<std::size_t>(c) + 1];
  }
  for (std::size_t c = 0; c < num_cells; ++c) scratch.cell_begin[c + 1] += scratch.cell_begin[c];
  scratch.order.resize(num);
  scratch.place_of.resize(num);
  for (std::size_t i = 0; i < num; ++i)
    scratch.order[scratch.place_of[i] = scratch.cell_begin[scratch.cell_of[i]]++] = static_cast<std::uint32_t>(i);
  for (std::size_t c = num_cells; c > 0; --c) scratch.cell_begin[c] = scratch.cell_begin[c - 1];
  scratch.cell_begin[0] = 0;
  balls.reorder(scratch.order);

  // Old impulses by the lower of their balls' new places.
  scratch.old_begin.assign(num + 1, 0);
  const auto lower = [&](const PairImpulse& p) { return std::min(scratch.place_of[p.a], scratch.place_of[p.b]); };
  for (const PairImpulse& p : state.pairs)
    if (p.normal > 0) ++scratch.old_begin[lower(p) + 1];
  for (std::size_t i = 0; i < num; ++i) scratch.old_begin[i + 1] += scratch.old_begin[i];
  scratch.old.resize(scratch.old_begin[num]);
  scratch.old_turns.assign(search.turns ? scratch.old.size() : 0, Turn{});
  for (std::size_t k = 0; k < state.pairs.size(); ++k) {
    PairImpulse p = state.pairs[k];
    if (!(p.normal > 0)) continue;
    const std::uint32_t to = scratch.old_begin[lower(p)]++;
    p.a = scratch.place_of[p.a];
    p.b = scratch.place_of[p.b];
    float sign = 1;
    if (p.a > p.b) {  // the impulse is that on the first of the two
      std::swap(p.a, p.b);
      for (float& t : p.tangent) t = -t;
      sign = -1;
    }
    scratch.old[to] = p;
    if (search.turns && k < state.pair_turns.size())
      for (std::size_t x = 0; x < 3; ++x) scratch.old_turns[to][x] = sign * state.pair_turns[k][x];
  }
  for (std::size_t i = num; i > 0; --i) scratch.old_begin[i] = scratch.old_begin[i - 1];
  scratch.old_begin[0] = 0;
  sort_walls(state, scratch);

  // Pairs: each ball with those after it in its own cell and with the 13 cells behind, which are 5 runs of places.
  state.pairs.clear();
  state.pair_turns.clear();
  scratch.num_near.assign(num, 0);
  for (std::size_t i = 0; i < num; ++i) {
    const std::int64_t c = scratch.cell_of[scratch.order[i]];
    const auto visit = [&](std::size_t begin, std::size_t end) {
      for (std::size_t j = begin; j < end; ++j)
        if (is_listed(search, balls, i, j))
          list_pair(search, static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j), state, scratch);
    };
    const auto run = [&](std::int64_t from, std::int64_t to) {
      visit(scratch.cell_begin[static_cast<std::size_t>(from)], scratch.cell_begin[static_cast<std::size_t>(to) + 1]);
    };
    visit(i + 1, scratch.cell_begin[static_cast<std::size_t>(c) + 2]);
    run(c + row - 1, c + row + 1);
    run(c + slab - row - 1, c + slab - row + 1);
    run(c + slab - 1, c + slab + 1);
    run(c + slab + row - 1, c + slab + row + 1);
  }
  if (search.period > 0) list_pairs_across(search, cells, false, state, scratch);
  list_far_pairs(search, cells, state, scratch);
  if (search.period > 0) list_pairs_across(search, cells, true, state, scratch);
}

}  // namespace drumsweep

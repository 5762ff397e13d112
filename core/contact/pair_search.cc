#include "core/contact/pair_search.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/state/arrays.h"

namespace drumsweep {
namespace {

struct Cells {
  std::array<std::int64_t, 3> low, size;
};

}  // namespace

void sort_and_find_pairs(const PairSearch& search, DrumState& state, PairSearchScratch& scratch) {
  Balls& balls = state.balls;
  const std::size_t num = balls.size();
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
  const auto renamed = [&](const PairImpulse& p) {
    PairImpulse q = p;
    q.a = scratch.place_of[p.a];
    q.b = scratch.place_of[p.b];
    if (q.a > q.b) {  // the impulse is that on the first of the two
      std::swap(q.a, q.b);
      for (float& t : q.tangent) t = -t;
    }
    return q;
  };
  for (const PairImpulse& p : state.pairs)
    if (p.normal > 0) ++scratch.old_begin[renamed(p).a + 1];
  for (std::size_t i = 0; i < num; ++i) scratch.old_begin[i + 1] += scratch.old_begin[i];
  scratch.old.resize(scratch.old_begin[num]);
  for (const PairImpulse& p : state.pairs)
    if (p.normal > 0) {
      const PairImpulse q = renamed(p);
      scratch.old[scratch.old_begin[q.a]++] = q;
    }
  for (std::size_t i = num; i > 0; --i) scratch.old_begin[i] = scratch.old_begin[i - 1];
  scratch.old_begin[0] = 0;
  for (WallImpulse& w : state.walls) w.ball = scratch.place_of[w.ball];
  std::stable_sort(state.walls.begin(), state.walls.end(),
                   [](const WallImpulse& l, const WallImpulse& r) { return l.ball < r.ball; });

  // Pairs: each ball with those after it in its own cell and with the 13 cells behind, which are 5 runs of places.
  state.pairs.clear();
  const double farthest = search.cell_size * search.cell_size;
  for (std::size_t i = 0; i < num; ++i) {
    const Eigen::Vector3d p = balls.position[i], v = balls.velocity[i];
    const std::int64_t c = scratch.cell_of[scratch.order[i]];
    const auto visit = [&](std::size_t begin, std::size_t end) {
      for (std::size_t j = begin; j < end; ++j) {
        const double squared = (balls.position[j] - p).squaredNorm();
        if (squared > farthest) continue;
        const double touching = balls.radius[i] + balls.radius[j];
        const double least = touching + search.margin + search.extra_speed * search.horizon;
        if (squared > least * least) {
          const double reach = least + (balls.velocity[j] - v).norm() * search.horizon;
          if (squared > reach * reach) continue;
        }
        PairImpulse pair{static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j), {0, 0, 0}, 0};
        for (std::uint32_t o = scratch.old_begin[i]; o < scratch.old_begin[i + 1]; ++o)
          if (scratch.old[o].b == pair.b) pair = scratch.old[o];
        append(state.pairs, pair);
      }
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
}

}  // namespace drumsweep

#include "core/step/memory.h"

namespace drumsweep {
namespace {

template <class... T>
std::size_t held(const std::vector<T>&... arrays) {
  return (... + (arrays.capacity() * sizeof(T)));
}

}  // namespace

MemoryUse memory_use(const DrumModel& model, const DrumState& state, const Workspace& work) {
  const Balls& b = state.balls;
  const PairSearchScratch& p = work.pair_search;
  const Assembly& a = work.assembly;
  const TriangleMesh& m = model.wall.mesh;
  return {held(b.position, b.velocity, b.spin, b.radius, b.id, b.exit, state.pairs, state.walls),
          held(p.cell_of, p.cell_begin, p.order, p.place_of, p.old_begin, p.old, p.num_near, work.feed.in_zone,
               work.candidates.balls, work.candidates.triangles, a.problem.rows, a.impulse, a.velocity, a.pair_of,
               a.walls, a.contacts, work.gone, work.pressed, work.impulse_sum),
          held(m.vertices, m.triangles, m.border, model.bounds) + model.grid.bytes()};
}

}  // namespace drumsweep

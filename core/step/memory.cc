#include "core/step/memory.h"

namespace drumsweep {
namespace {

template <class... T>
std::size_t held(const std::vector<T>&... arrays) {
  return (... + (arrays.capacity() * sizeof(T)));
}

}  // namespace

MemoryUse memory_use(const DrumModel& model, const DrumState& state, const DrumWorkspace& work) {
  const Balls& b = state.balls;
  const PairSearchScratch& p = work.pair_search;
  const Assembly& a = work.assembly;
  const Wall& wall = model.world.walls.front();
  const TriangleMesh& m = wall.mesh;
  return {held(b.position, b.velocity, b.spin, b.radius, b.id, b.exit, state.pairs, state.walls, state.pair_turns,
               state.wall_turns),
          held(p.cell_of, p.cell_begin, p.order, p.place_of, p.old_begin, p.old, p.old_turns, p.num_near,
               work.feed.in_zone, work.candidates.balls, work.candidates.triangles, a.problem.rows, a.overlap,
               a.impulse, a.velocity, a.pair_of, a.walls, a.contacts, a.problem.rotation, a.turn, a.attracted,
               a.impact_problem.rows, a.impact_impulse, work.gone, work.inverse_mass, work.smooth.force,
               work.smooth.torque, work.smooth.overlaps, work.pressed, work.impulse_sum),
          held(m.vertices, m.triangles, m.border, wall.bounds) + wall.grid.bytes()};
}

}  // namespace drumsweep

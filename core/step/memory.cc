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
  const Assembly& a = work.assembly;
  const PairList& l = a.pairs;
  const Wall& wall = model.world.walls.front();
  const TriangleMesh& m = wall.mesh;
  MemoryUse use;
  use.state = held(b.position, b.velocity, b.spin, b.radius, b.id, b.exit, state.pairs, state.walls, state.pair_turns,
                   state.wall_turns);
  use.work =
      held(l.cell_of, l.cell_begin, l.order, l.place_of, l.old_begin, l.old, l.old_turns, l.num_near, l.apart,
           l.spare.vectors, l.spare.numbers, l.spare.ids, l.spare.bytes, a.velocity, work.feed.in_zone, work.gone,
           work.inverse_mass, work.smooth.force, work.smooth.torque, work.smooth.overlaps, work.check, work.overlaps);
  for (const auto& array : l.flight) use.work += held(array);
  for (const Slab& s : l.slabs) use.work += held(s.near, s.far, s.apart);
  for (const SlabWalls& w : a.walls)
    use.work += held(w.candidates.balls, w.candidates.triangles, w.candidates.reached_after, w.impulse, w.turn,
                     w.old_impulse, w.old_turn, w.place, w.normal, w.velocity, w.overlap);
  for (const ContactBlock& block : a.problem.blocks)
    for (const ContactPacks* packs : {&block.pairs, &block.walls})
      use.work += held(packs->rows, packs->impulse, packs->wall_velocity, packs->turn, packs->wall_turn, packs->limits,
                       packs->wall, packs->pull, packs->active);
  use.wall = held(m.vertices, m.triangles, m.border) + wall.grid.bytes();
  return use;
}

}  // namespace drumsweep

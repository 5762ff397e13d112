/// Impact stage for restitution.
#pragma once

#include "core/step/assemble.h"

namespace drumsweep {

/// Scratch memory of the stage.
struct ImpactScratch {
  std::vector<std::vector<ImpulsePack>> impulse;  ///< (blocks) of the pairs, kept for the regular stage
  std::vector<std::vector<Pack3>> turn;           ///< likewise
  std::vector<std::uint32_t> group;               ///< (balls)
  std::vector<std::array<double, 3>> gain;        ///< (balls)
};

/// Velocities at which all rows that collide obey Newton's law u+ = -e u- and no other row approaches; friction and resistance to
/// rolling act under the impulses of the impact as under any other, and no energy is gained. The rows are then to be made anew.
/// @param iterations  of Gauss-Seidel
void resolve_impacts(const World& world, int iterations, int threads, Assembly& assembly, ImpactScratch& scratch,
                     Balls& balls);

}  // namespace drumsweep

/// Memory of a running drum, counted from what its arrays hold.
#pragma once

#include "core/step/drum_step.h"

namespace drumsweep {

struct MemoryUse {
  std::size_t state = 0, work = 0, wall = 0;  ///< bytes
  std::size_t total() const { return state + work + wall; }
};

MemoryUse memory_use(const DrumModel& model, const DrumState& state, const DrumWorkspace& work);

}  // namespace drumsweep

/// One design on one rank: simulated, stored, and the outcome in words that travel between ranks.
#pragma once

#include <cstddef>
#include <string>

#include "core/scene/drum.h"
#include "sweep/plan/designs.h"
#include "sweep/store/store.h"

namespace drumsweep {

struct DesignOutcome {
  enum class Kind { done, failed, stopped };
  std::size_t index = 0;  ///< in the plan
  Kind kind = Kind::done;
  double wall_s = 0, cpu_s = 0;
  std::string host, reason;
};

/// Simulates the design and writes its recording (or its failure) durably before it returns.
/// An exception out of the engine is this design's failure. @throws WriteError, std::bad_alloc: the machine's fault
DesignOutcome simulate_and_store(const OutputPaths& paths, const Study& study, const DrumState& warm, const Plan& plan,
                                 std::size_t index, const std::string& host, const Observer& observer, int threads = 1);

/// As text for a message, and back.
std::string pack_outcome(const DesignOutcome& outcome);
DesignOutcome unpack_outcome(const std::string& text);

}  // namespace drumsweep

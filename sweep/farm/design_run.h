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
  std::string note;  ///< what people should know: a checkpoint that was used, or could not be
};

/// How a rank simulates a design.
struct RunHow {
  int threads = 1;
  int attempt = 1;  ///< how often the design has been begun, this time included
  double checkpoint_interval_s = 10;
  double hang_s = 600;  ///< see hang_watch.h
};

/// Simulates the design, from its checkpoint where there is one, and writes its recording (or its failure) durably before
/// it returns; a stop leaves a checkpoint. An exception out of the engine is this design's failure.
/// @throws WriteError, std::bad_alloc: the machine's fault
DesignOutcome simulate_and_store(const OutputPaths& paths, const Study& study, const DrumState& warm,
                                 const PlannedDesign& design, std::size_t index, const std::string& host,
                                 const Observer& observer, const RunHow& how = {});

/// What a rank has to know of a design, as text for a message, and back.
struct Assignment {
  std::size_t index = 0;  ///< in the plan of rank 0
  int attempt = 1;
  PlannedDesign design;  ///< id and values only
};
std::string pack_assignment(const Assignment& assignment);
Assignment unpack_assignment(const std::string& text);

/// The same for the outcome.
std::string pack_outcome(const DesignOutcome& outcome);
DesignOutcome unpack_outcome(const std::string& text);

}  // namespace drumsweep

/// How a sweep stands, read from its folder alone: works while a run is going on, takes no lock, writes nothing.
#pragma once

#include <cstddef>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "postproc/result_table.h"
#include "sweep/plan/designs.h"
#include "sweep/store/store.h"
#include "sweep/timeline.h"

namespace drumsweep {

/// Designs by state; each counts once.
struct StateCounts {
  std::size_t pending = 0;  ///< never begun
  std::size_t running = 0;  ///< on a rank now
  std::size_t done = 0;
  std::size_t untrusted = 0;  ///< has a result that should not be believed, see results.h
  std::size_t failed = 0;
  std::size_t lost = 0;     ///< begun, and its process died; will be begun again
  std::size_t stopped = 0;  ///< begun, and stopped in good order; will be begun again
};

/// A stage, with the designs that no earlier stage has.
struct StageStatus {
  std::string name, type;
  std::size_t designs = 0, ended = 0;
  bool complete = false;  ///< no results will make it ask for more
};

struct SweepStatus {
  StateCounts state;
  std::vector<StageStatus> stages;
  std::size_t total = 0;
  bool active = false;    ///< a run holds the folder now
  std::string phase;      ///< what rank 0 of that run is at
  bool finished = false;  ///< every design has a result or has failed
  double cpu_s = 0;       ///< of all attempts so far, the warm-up included
  std::vector<std::string> variable_names;
  std::vector<ResultRow> rows;  ///< of the designs that have ended, in the plan's order
  std::optional<ResultRow> best;
  std::vector<RunTimeline> timeline;  ///< of all runs so far
};

/// What the lock file says of the run that holds the folder now; nothing while there is none.
struct ActiveRun {
  std::string phase;              ///< what rank 0 is at
  std::set<std::string> designs;  ///< on ranks, by id
};
std::optional<ActiveRun> active_run(const OutputPaths& paths);

/// The plan of a folder as far as its runs have got: what searches have asked for is in findings.toml.
Plan plan_of_folder(const OutputPaths& paths, const Study& study);

/// @throws InputError when the folder is not a sweep's, MismatchError when it is of another version
SweepStatus read_status(const std::string& folder);

}  // namespace drumsweep

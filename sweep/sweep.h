/// A sweep from study to table: warm-up, all designs on all ranks, results.csv. Run again, it goes on where it stopped.
#pragma once

#include <chrono>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "postproc/result_table.h"
#include "sweep/farm/farm.h"
#include "sweep/plan/findings.h"

namespace drumsweep {

struct SweepOptions {
  std::string study_path;
  std::vector<std::string> changes;  ///< of its keys, see read_study()
  int threads = 1;                   ///< of each rank
  std::string output;                ///< empty: the study file's stem + "_result" in the current folder

  double checkpoint_interval_s = 10;  ///< of the state inside a design, see checkpoint.h
  std::chrono::steady_clock::time_point begin = std::chrono::steady_clock::now();  ///< of the program
  double hang_s = 600;                  ///< a rank whose engine takes longer for a step is ended; 0: never
  std::optional<double> stop_before_s;  ///< since `begin`; then all has ended in good order
  bool retry_failed = false, retry_lost = false;
  std::optional<bool> dedicated_master;  ///< rank 0 only serves; not given: above 32 ranks
  bool survive = false;                  ///< go on when a rank dies; needs mpirun --enable-recovery
  double silence_s = 60;                 ///< survive: a rank that was not heard for so long is taken for dead
};

struct SweepOutcome {
  bool finished = false;   ///< every design has a result or has failed
  std::string stop_cause;  ///< signal or error that stopped it early
  std::size_t failed = 0;
  std::string output;  ///< the folder
  ResultTable table;
  std::optional<Findings> findings;  ///< of a sweep that was not stopped
};

/// The whole job as rank 0 sees it. Rank 0 hands out one design at a time and simulates too: it answers the others
/// between its own steps, through the observer of run_design(), so R ranks run R designs.
///
/// A design is called done when its recording is in the folder, durably. The table is then a function of the folder.
/// A design whose simulation throws is failed and stays so; an error in writing stops the whole job, keeping what is
/// there; so does a signal (stop.h), within a step. With `survive` a rank that dies is missed (roll_call.h), its design is
/// simulated by another one, and nobody waits for the dead; without, the launcher ends the job. All other ranks have left when this returns or throws.
/// @throws InputError, MismatchError, LockHeldError, WriteError
SweepOutcome run_sweep(Farm& farm, const SweepOptions& options);

/// The job of every other rank: simulates what it is given until it is told to stop.
void serve_sweep(Farm& farm, const SweepOptions& options);

}  // namespace drumsweep

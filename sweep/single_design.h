/// One design of a study by itself: warm-up or a stored warm drum, run, observables.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/scene/drum.h"
#include "core/scene/observable.h"
#include "sweep/plan/designs.h"
#include "sweep/progress.h"

namespace drumsweep {

struct SingleDesign {
  PlannedDesign design;
  bool stopped = false;       ///< by a signal; nothing below is filled in then
  bool steady = false;        ///< the warm drum was
  std::string state, reason;  ///< as in results.csv: done, or untrusted and why
  Recording recording;
  std::vector<Observable> observables;
  std::string recording_path, observables_path;
  double cpu_s = 0;  ///< of warm-up (if there was one) and design
};

/// The keys that a list of values on the command line stands for: those of the stages, or without stages the outlet's
/// angle (in the unit that the study gives) and its base width.
std::vector<std::string> keys_of_values(const Study& study);

/// The design with these values. @throws InputError for another number of values or an impossible geometry
PlannedDesign design_at(const Study& study, const std::vector<double>& values);

/// f in both windows, height of the bed across the belt, shares of the outflow, holdup, lost balls. Standard errors: of f
/// and heights from blocks of one slot's passage (postproc/objective.h), of shares from whole turns; none from one turn.
std::vector<Observable> observables(const Study& study, const PlannedDesign& design, const Recording& recording);

/// Share of the landed balls that left over the outlet's end, with an error from whole turns.
Observable outflow_share_over_end(const Study& study, const Recording& recording);

/// Runs it in a folder of its own: FOLDER/warm_state.h5 is used where it fits and made where it is not, FOLDER/ID.h5
/// and FOLDER/ID_observables.csv are written. @throws InputError, MismatchError, LockHeldError, WriteError
SingleDesign run_single_design(const Study& study, const std::vector<double>& values, const std::string& folder,
                               int threads, Reporter& reporter);

}  // namespace drumsweep

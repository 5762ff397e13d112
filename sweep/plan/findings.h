/// What a study has found: the optimum with its error, whether it was confirmed, and what its searches have decided.
/// A function of study and results alone, so findings.toml is the same for any ranks and interruptions.
#pragma once

#include <optional>
#include <string>

#include "sweep/fit/gate.h"
#include "sweep/fit/optimum.h"
#include "sweep/plan/planner.h"

namespace drumsweep {

/// Runs of one design with random numbers that no earlier choice has seen (the last stage of type replicate).
struct Confirmation {
  Point at;
  int num_runs = 0;
  double f_m = 0, sigma_m = 0;          ///< mean and its standard error from the scatter of the runs
  double max_an_over_a0 = 0;            ///< mean
  bool stop_test = false;               ///< S1: all |a_n| <= a_0 / 10, on average
  std::optional<bool> below_tolerance;  ///< f < refine.tolerance_f_m, where that is given
};

struct Findings {
  Box box;
  Gate gate;
  double shared_noise_gain = 0;    ///< of neighbours, see SharedNoise; NaN where there are few replicates
  std::optional<Optimum> optimum;  ///< of the fit; none where there are too few designs for one
  std::optional<Confirmation> confirmation;
};

/// From everything that is known; nothing where no stage varies anything.
std::optional<Findings> find(const Study& study, const Plan& plan, const RowOf& row_of);

/// ", at the lower end of the range that was searched", where the fit's optimum lies at an end in this variable; else empty.
/// An optimum there may be lower still beyond it.
std::string at_end_of_range(const Findings& findings, std::size_t variable);

/// In words, a line each.
std::string describe(const Findings& findings);

/// findings.toml: stages with their decisions and, for searches, their designs; then the findings.
std::string to_toml(const Plan& plan, const std::optional<Findings>& findings);

/// Adds the designs of searches, as to_toml() has written them, to a fresh plan: for looking at a folder without
/// deciding anything anew. @throws InputError when the text is not of this study
void restore_searches(Plan& plan, const Study& study, const std::string& text, const std::string& source);

}  // namespace drumsweep

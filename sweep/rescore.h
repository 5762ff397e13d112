/// Other objectives from stored landings: every design of a folder evaluated as the study says and as it would be with
/// other keys, side by side. Nothing is simulated, nothing in the folder changes.
///
/// The old values are evaluated from the landings too and not read from results.csv, which may be older than the study
/// beside it; so both sides differ in the changed keys and in nothing else.
///
/// Heights scale with 1 / belt speed, as the same balls lie on a shorter or longer strip. So where the belt speed (or the
/// packing) changes, f / mean height tells whether the bed is more even, and f alone does not.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "postproc/result_table.h"

namespace drumsweep {

/// Changes that are made together, each as "belt.speed_m_s=0.1".
using KeyChanges = std::vector<std::string>;

/// A design with its lowest f, by its row in the tables; means of replicates where the study has them.
struct RescoredOptimum {
  ResultRow before, after;  ///< the same design evaluated in both ways
};

/// One set of changes.
struct Rescoring {
  std::string changes;                         ///< "belt.speed_m_s=0.1 objective.packing=0.6"
  std::vector<ResultRow> rows;                 ///< (num_rows), beside Rescored::before
  std::size_t compared = 0;                    ///< designs that are done both before and after
  double rank_correlation = ResultRow::none;   ///< of f over these (Spearman, mean ranks for ties); NaN below two
  std::optional<RescoredOptimum> old_optimum;  ///< none where no design is done
  std::optional<RescoredOptimum> new_optimum;
};

struct Rescored {
  std::vector<std::string> variable_names;
  std::vector<ResultRow> before;  ///< designs with a recording, in the table's order
  std::vector<Rescoring> cases;
  std::size_t without_landings = 0;   ///< designs of the plan that are not simulated, failed, or damaged
  std::vector<std::string> warnings;  ///< damaged recordings, one sentence each
};

/// Old and new side by side, one line a design and set of changes.
std::string to_csv(const Rescored& rescored);
/// One line a set of changes: rank correlation, f, f / mean height and place of the optimum before and after.
std::string summary_csv(const Rescored& rescored);

/// 100 (after / before - 1) [%] of f of a design.
double change_of_f_percent(const RescoredOptimum& optimum);
/// The same of f / mean height.
double change_of_f_over_height_percent(const RescoredOptimum& optimum);

/// Rank correlation of two lists of the same length (Spearman 1904); NaN where either is constant.
double rank_correlation(const std::vector<double>& a, const std::vector<double>& b);

/// @param sets  at least one; each is tried by itself
/// @throws InputError for a folder that is not a sweep's, an unknown key, a value out of range, a key that stored
/// landings depend on, a key that the study's stages vary; MismatchError for a folder of another version
Rescored rescore(const std::string& folder, const std::vector<KeyChanges>& sets);

}  // namespace drumsweep

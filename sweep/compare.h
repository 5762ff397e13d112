/// Output folders of several studies side by side, with the keys that they differ in as columns: a convergence study, a
/// sensitivity study, a reproduction. Nothing is simulated, nothing in the folders changes.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "postproc/result_table.h"

namespace drumsweep {

/// One design that has ended.
struct ComparedDesign {
  std::vector<double>
      variables;  ///< (Comparison::variable_names); the study's own value where its stages do not vary it
  ResultRow row;  ///< evaluated from the landings; its own variables are those of its study
  double over_end = ResultRow::none, sigma_over_end = ResultRow::none;  ///< share of the outflow
  std::optional<std::int64_t> holdup;                                   ///< balls inside at the end
  double cpu_s = ResultRow::none;                                       ///< of all attempts
};

struct ComparedFolder {
  std::string path;
  std::vector<std::string> values;         ///< (Comparison::keys); empty: left out in the study
  std::optional<std::int64_t> warm_balls;  ///< inside at the end of the warm-up; none before that
  double warm_turns = ResultRow::none;
  bool steady = false;
  std::vector<ComparedDesign> designs;  ///< in the order of its table
};

struct Comparison {
  /// In which studies differ, in the order of the file. Design variables have columns of their own; those that the warm drum
  /// depends on too (the outlet) are here as well where the studies' own values differ.
  std::vector<std::string> keys;
  std::vector<std::string> variable_names;  ///< of all studies, in order of appearance
  std::vector<ComparedFolder> folders;
  std::vector<std::string> warnings;  ///< what is missing or damaged, one sentence each
};

/// @throws InputError for a folder that is not a sweep's, MismatchError for one of another version
Comparison compare(const std::vector<std::string>& folders);

/// One line a design; numbers in full. A folder where no design has ended has a line with its warm drum alone.
std::string to_csv(const Comparison& comparison);

}  // namespace drumsweep

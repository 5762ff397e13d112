/// Output folders of several studies side by side, with the keys that they differ in as columns: a convergence study, a
/// sensitivity study, a reproduction. Nothing is simulated, nothing in the folders changes.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "postproc/result_table.h"

namespace drumsweep {

/// One finished design of one folder.
struct ComparedDesign {
  std::size_t folder = 0;  ///< into Comparison::folders
  std::vector<double>
      variables;  ///< (Comparison::variable_names); the study's own value where its stages do not vary this one
  ResultRow row;  ///< evaluated from the landings; its own variables are those of its study
  double over_end = ResultRow::none, sigma_over_end = ResultRow::none;  ///< share of the outflow
  std::int64_t holdup = 0;                                              ///< balls inside at the end
  double cpu_s = 0;                                                     ///< of all attempts
};

struct ComparedFolder {
  std::string path;
  std::vector<std::string> values;         ///< (Comparison::keys)
  std::optional<std::int64_t> warm_balls;  ///< inside at the end of the warm-up; none before that
  double warm_turns = ResultRow::none;
  bool steady = false;
};

struct Comparison {
  std::vector<std::string> keys;            ///< in which studies differ, without variables, in the order of the file
  std::vector<std::string> variable_names;  ///< of all studies, in order of appearance
  std::vector<ComparedFolder> folders;
  std::vector<ComparedDesign> designs;  ///< folder by folder, each in the order of its table
  std::vector<std::string> warnings;    ///< what is missing or damaged, one sentence each
};

/// @throws InputError for a folder that is not a sweep's, MismatchError for one of another version
Comparison compare(const std::vector<std::string>& folders);

/// One line a design; numbers in full. A folder without a finished design has a line with its warm drum alone.
std::string to_csv(const Comparison& comparison);

}  // namespace drumsweep

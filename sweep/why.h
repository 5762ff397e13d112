/// The story of one design, from the folder alone: what it is, what became of it, and what to do.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "postproc/result_table.h"
#include "sweep/plan/designs.h"
#include "sweep/store/provenance.h"

namespace drumsweep {

struct DesignStory {
  PlannedDesign design;
  std::vector<std::string> columns;  ///< names of design.row
  std::string state;                 ///< pending, running, done, untrusted, failed, lost, stopped or damaged
  std::string reason;                ///< why it is not done; empty when it is
  std::optional<ResultRow> row;      ///< its result
  struct Attempt {
    int number = 1, rank = 0;
    std::string host, begin_utc;
    std::string end_utc;  ///< empty: no trace of an end
    std::string event;    ///< done, failed, stopped ...; "running" or "lost" where there is no end
    double wall_s = 0, cpu_s = 0;
  };
  std::vector<Attempt> attempts;
  std::vector<std::string> files;  ///< paths that belong to it
  std::string retry;               ///< how to have it tried (again)
};

/// @param which  the id, an unambiguous beginning of it, or empty where `at` is given
/// @param at     values in the order of the table's columns
/// @throws InputError when no design or more than one fits, or the folder is not a sweep's
DesignStory story_of(const std::string& folder, const std::string& which, const std::vector<double>& at);

}  // namespace drumsweep

/// From recordings to rows of results.csv. A row is a function of the study and the recording, so the table does not
/// know which rank did what, when, or how often it was interrupted.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/scene/drum.h"
#include "postproc/result_table.h"
#include "sweep/plan/designs.h"

namespace drumsweep {

/// Evaluates the landings of one design. State "done"; "untrusted" (with the reason) when the warm drum was not steady,
/// or when more than one second of feed found no room at the end, as the flow is then not the study's; "failed" when f
/// is not a number or the landings cannot be evaluated.
ResultRow evaluated_row(const Study& study, const PlannedDesign& design, const Recording& recording, bool steady);

ResultRow failed_row(const PlannedDesign& design, const std::string& reason);

/// The row with the lowest f_m that is done; of the untrusted ones where none is. The first of equals.
std::optional<std::size_t> best_row(const std::vector<ResultRow>& rows);

}  // namespace drumsweep

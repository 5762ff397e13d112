/// Which design of a plan somebody means.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sweep/plan/designs.h"

namespace drumsweep {

/// @param which  its id, or an unambiguous beginning of it. @throws InputError when none or more than one fits
const PlannedDesign& design_with_id(const Plan& plan, const std::string& which);

/// @param at  values in the order of the table's columns. Those of [record] (replicate, turns) may be left out: then the
///            study's own are meant, or the only ones that there are.
/// @param replicate  its number, where `at` leaves it out
/// @throws InputError with the nearest designs when none fits, with the ids when more than one does
const PlannedDesign& design_with_values(const Plan& plan, const Study& study, const std::vector<double>& at,
                                        std::optional<double> replicate = {});

}  // namespace drumsweep

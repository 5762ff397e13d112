/// The fit of a study as plain numbers for a contour figure (postproc/contour.h), which knows no fits.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "postproc/contour.h"
#include "sweep/fit/optimum.h"
#include "sweep/plan/planner.h"

namespace drumsweep {

/// Fit, gate and optimum, as in findings.toml.
struct StudyFit {
  Study study;
  std::vector<std::string> keys, columns;  ///< of the plan
  Box box;                                 ///< empty: no stage varies anything
  std::size_t num_points = 0;              ///< of the box that have a value; those that are fitted are in fit.points
  Fit fit;
  std::optional<Optimum> optimum;  ///< none where the gate trusts no fit
};

/// Costs some seconds.
/// @param table       results, before any mean over replicates
/// @param value       "f_m" or "f_footprint_m"
/// @param num_stages  results of so many stages, from the first
StudyFit fit_of_study(const Study& study, const Plan& plan, const ResultTable& table, const std::string& value,
                      std::size_t num_stages);

/// The fit over the plane that a figure of this table with these options shows, on a mesh over the box. A gate that
/// trusts no fit, and a plane outside the box, make a fit that is not usable and says why.
/// @param table  as given to the figure: means over replicates
/// @return nothing where no stage varies anything. @throws InputError as contour_axes()
std::optional<ContourFit> contour_fit(const StudyFit& fit, const ResultTable& table, ContourOptions options);

}  // namespace drumsweep

/// What an extension changes in the design: the optimum of the sweep's fit with the plain study and with the extended one.
#pragma once

#include <string>
#include <vector>

#include "sweep/fit/optimum.h"

namespace drumsweep {

struct DesignChange {
  std::vector<std::string> variables;  ///< names with unit
  Optimum before, after;
  double regret_m = 0,
         regret_sigma_m = 0;  ///< f of the old optimum over that of the new one, both with the extended study
  double spread =
      0;  ///< most that the optimum moves in one variable, over the joint half width of the two 95 % regions
};

/// @param before, after  output folders of two finished sweeps over the same variables
/// @throws InputError: other variables, too few designs
DesignChange change_of_design(const std::string& before, const std::string& after, std::int64_t seed);

std::string describe(const DesignChange& change);

}  // namespace drumsweep

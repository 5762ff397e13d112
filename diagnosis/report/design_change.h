/// What an extension changes in the design: the optimum of the sweep's fit with the plain study and with each member of
/// the set of causes, what keeping the old design costs, and whether the members agree on what to build.
#pragma once

#include <string>
#include <vector>

#include "sweep/fit/optimum.h"

namespace drumsweep {

/// A difference of f with its standard error.
struct Regret {
  double f_m = 0, sigma_m = 0;
};

struct DesignChange {
  std::vector<std::string> variables;  ///< names with unit
  Optimum before;
  struct Member {
    Optimum after;
    Regret of_old;      ///< f of the old optimum over that of the new one, both with this member's study
    double spread = 0;  ///< most that the optimum moves in one variable, over the joint half width of the 95 % regions
  };
  std::vector<Member> members;  ///< of the set of causes, best first
  /// regret[i][j]: building the optimum of member i where j is the truth.
  std::vector<std::vector<Regret>> regret;
  std::size_t safest = 0;  ///< member whose optimum costs least where it costs most
  double apart = 0;        ///< as spread, between the two members that differ most

  /// Whether there is a design that these sweeps cannot tell from the optimum, whichever member is the truth.
  bool agree() const;
};

/// @param before  output folder of the finished sweep of the plain study
/// @param after   of the extended studies, best member first; over the same variables
/// @throws InputError: other variables, too few designs
DesignChange change_of_design(const std::string& before, const std::vector<std::string>& after, std::int64_t seed);

}  // namespace drumsweep

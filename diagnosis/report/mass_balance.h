/// What goes into a condition against what comes out of it and is held: identities between measured numbers and known
/// inputs that no friction can change, so they are looked at before anything is fitted.
///   drum, fed: outflow / feed = 1;  holdup m = feed t_residence;  holdup m v_axial / length = feed   (m: mass of a ball)
///   belt, of a study or alone: mean height x width x belt speed x packing x density = feed
///   pile: on the base + left = poured
#pragma once

#include <string>
#include <vector>

#include "diagnosis/campaign/campaign.h"
#include "diagnosis/model/verdict.h"

namespace drumsweep {

/// One identity in one condition. 1 where mass is conserved.
struct MassBalance {
  std::string condition;
  std::string what;                 ///< "holdup / residence time over the feed"
  double measured, sigma;           ///< share, and its standard error from those of the measurements
  double simulated = std::nan("");  ///< by the plain model at the bench's values

  bool closes() const { return std::abs(measured - 1) < 2 * sigma; }
};

/// Those that the fitted and held-out data allow.
/// @param misfits  of all data, or empty
std::vector<MassBalance> mass_balances(const Campaign& campaign, const Problem& problem,
                                       const std::vector<DatumMisfit>& misfits);

}  // namespace drumsweep

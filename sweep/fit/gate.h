/// Smooth enough to search? Figures of a fitted surface and the verdict on them.
#pragma once

#include <string>

#include "sweep/fit/surface.h"

namespace drumsweep {

struct GateFigures {
  int num_rows = 0, num_points = 0;
  double points_per_variable = 0;
  double loo_rms_m = 0;             ///< rows predicted from all others
  double loo_over_sigma = 0;        ///< over the rows' own sigma (rms); rough surfaces are far above 1
  double loo_chi2 = 0;              ///< mean square of LOO errors over their predicted sd; 1 when the fit is honest
  double q2 = 0;                    ///< share of the rows' variance that LOO predictions explain
  double amplitude_over_run = 0;    ///< range of F at the rows over what is left to one run beside its neighbours
  double amplitude_over_error = 0;  ///< the same over the whole error of a run, the replicate's shared one included
  int quadratic_dof = 0;
  double quadratic_chi2 = 0;  ///< per degree of freedom; NaN without degrees of freedom
  double quadratic_p = 0;     ///< a small one: no quadratic, which is no fault
};

enum class GateVerdict {
  smooth,      ///< NLopt may start on simulations
  noisy,       ///< the surface shows, but noise is too large for NLopt's small steps: optimise the fit
  unresolved,  ///< noise hides the surface: replicates, or a larger box
  rough,       ///< changes between neighbours that noise does not explain: more points, or a smaller box
  few_points
};

struct Gate {
  GateFigures figures;
  GateVerdict verdict = GateVerdict::few_points;
  std::string reason;  ///< one sentence, with the figure that decided
  bool smooth() const { return verdict == GateVerdict::smooth; }
  bool fit_is_usable() const { return smooth() || verdict == GateVerdict::noisy; }
};

/// Thresholds; error rates over seeds are in tests/sweep/fit/gate_test.cc.
struct GateLimits {
  double points_per_variable = 5;  ///< half of what Loeppky, Sacks and Welch (2009) ask of a whole design
  double q2 = 0.5;                 ///< less: no better than half way between a constant and the truth
  double q2_whatever_noise = 0.9;  ///< a surface explained so well is smooth although its sigma is stated smaller
  double loo_over_sigma = 3;
  double loo_chi2 = 2;
  double amplitude_over_run = 12;   ///< NLopt's last steps compare differences of a few per cent of the range
  double amplitude_over_error = 4;  ///< a smooth shared error alone ranges over 2 to 3 of its sd
};

Gate gate(const FittedSurface& surface, const GateLimits& limits = {});

/// For a surface that cannot be fitted for want of points. @param num_points distinct ones with a value
Gate too_few_points(const Box& box, int num_rows, int num_points, const GateLimits& limits = {});

/// At least so many distinct points before a fit is tried.
int points_for_a_fit(const Box& box, const GateLimits& limits = {});

}  // namespace drumsweep

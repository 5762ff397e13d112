/// Where the fitted surface is lowest, and how sure that is.
///
/// The region comes from the posterior of F: whole surfaces are drawn at candidate points and each one's lowest point
/// taken; 95 % of these in each variable is the region. Candidates are drawn twice, over the box and then where the first
/// argmins fell, and some of them lie on the faces, where a minimum often is. The fit's parameters (lengths, noise) are
/// drawn too: with the most likely ones alone a fit of few rows is surer than it should be. Coverage in
/// tests/sweep/fit/optimum_test.cc.
#pragma once

#include <cstdint>
#include <vector>

#include "sweep/fit/surface.h"

namespace drumsweep {

struct Optimum {
  Point at;                    ///< lattice point with the lowest mean of F near its minimum
  double f_m = 0;              ///< F there
  double sigma_m = 0;          ///< of F there
  Point low, high;             ///< 2.5 % and 97.5 % of the argmins a variable; not on the lattice
  std::vector<Point> argmins;  ///< the cloud; not on the lattice
};

struct OptimumOptions {
  int num_candidates = 400;  ///< in each of the two rounds
  int num_draws = 400;
  int num_surfaces = 10;  ///< sets of parameters among which the draws are divided; 1: the most likely only
};

/// Global: the lowest of the candidates is polished. Deterministic in (surface, seed).
Optimum optimum(const FittedSurface& surface, std::int64_t seed, const OptimumOptions& options = {});

}  // namespace drumsweep

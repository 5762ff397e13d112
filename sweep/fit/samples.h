/// From measured rows to one sample a point of design space, with an error that can be believed.
///
/// A row's own sigma is a jackknife over few blocks: it scatters by a third by itself, and it misses or counts twice
/// whatever the blocks have in common. The scatter between replicates is right on average but has one degree of freedom
/// less than replicates. Both are moderated (Smyth, Stat. Appl. Genet. Mol. Biol. 3, 3, 2004):
///   1. log own variance = linear trend over the box + prior scatter + scatter of a chi^2 with `own_dof`;
///      each own variance is shrunk to the trend by the ratio of the two scatters.
///   2. rho^2 = scatter between replicates over own variance, pooled over all points with replicates, shrunk to 1 by
///      `ratio_prior_dof`.
///   3. variance of one run = (own_dof n rho^2 own + (n - 1) scatter) / (own_dof n + n - 1), of the mean: over n.
/// Pooled samples are for people, the quadratic and the noise figures. The surface (surface.h) is fitted to the rows
/// themselves, because rows of one replicate number share much of their error.
#pragma once

#include <vector>

#include "sweep/fit/box.h"

namespace drumsweep {

/// One row of the table that is done.
struct Measurement {
  Point at;              ///< the box's variables only
  double replicate = 0;  ///< its number; the same number shares random streams
  double f_m = 0;
  double sigma_m = 0;  ///< own; not finite or <= 0: unknown, the trend is used
};

/// One point of design space.
struct Sample {
  Point at;
  double f_m = 0;      ///< mean over the replicates
  double sigma_m = 0;  ///< of that mean
  int count = 1;       ///< replicates
};

/// log sigma of one run as linear function over the box; least squares, a constant where there are fewer than three
/// points a coefficient.
class NoiseTrend {
 public:
  NoiseTrend() = default;
  /// @param sigma of one run each; values that are not finite or <= 0 are left out. Without any: `fallback`.
  NoiseTrend(const Box& box, const std::vector<Point>& points, const std::vector<double>& sigma, double fallback);
  double sigma(const Box& box, const Point& at) const;
  double scatter() const { return scatter_; }  ///< variance of log sigma^2 about the trend

 private:
  std::vector<double> coefficients_;  ///< constant, then one a variable on [0, 1]
  double scatter_ = 0;
};

/// What the replicates say about the noise. NaN where there are too few.
struct SharedNoise {
  double scatter_over_own = 1;  ///< rho above, before shrinking; sigma, not variance
  int scatter_dof = 0;
  /// var(f_i - f_j) with different replicates over the same replicate; > 1: shared streams make differences smoother.
  double gain = 0, gain_neighbours = 0;  ///< all pairs of designs; each design with its nearest
};

struct Pooled {
  std::vector<Sample> samples;  ///< ascending by point
  SharedNoise noise;
  NoiseTrend trend;                 ///< of the rows' own sigma
  std::vector<double> own_sigma_m;  ///< (num_rows) shrunk to the trend; without rho
};

inline constexpr double own_dof = 5;          ///< six blocks
inline constexpr double ratio_prior_dof = 5;  ///< as much as five replicates more than points

/// @pre finite f_m; points inside the box. Two rows of the same point and replicate count as two replicates.
Pooled pool(const Box& box, const std::vector<Measurement>& rows);

}  // namespace drumsweep

/// A smooth surface through noisy rows: Gaussian process (Rasmussen and Williams 2006) with common random numbers (Chen,
/// Ankenman and Nelson, ACM TOMACS 22, 7, 2012; Pearce, Poloczek and Branke, Winter Simulation Conference 2019), and a
/// quadratic.
///
///   row i:  f_i = F(x_i) + C_r(x_i) + e_i,   r the row's replicate number,
///   F(x)   = h(x)' beta + GP(amplitude^2 k(r_F)), what is looked for: the mean over all random numbers
///   C_r(x) = rho s(x) sqrt(w) GP(k(r_C)), one smooth error for all designs of a replicate, as they share feed places
///            and texture
///   e_i    = N(0, rho^2 (1 - w) s_i^2), what is left to each run
///   k(r) = (1 + sqrt5 r + 5 r^2 / 3) exp(-sqrt5 r), Matern 5/2, r^2 = sum_j ((x_j - x'_j) / length_j)^2, x on [0, 1].
/// s_i: own sigma of the row, shrunk (samples.h); s(x): its trend. Beta is integrated out (flat prior; restricted
/// likelihood). The other parameters maximise the restricted likelihood times weak log-normal priors: from one
/// replicate alone F and C cannot be told apart, and then the stated sigma says how much may be C.
///
/// On the quick drum the rows' error is 1 to 2 times their own sigma but neighbours of one replicate share over nine
/// tenths of it: a fit of one replicate looks five times as exact as it is, which is why C is in the model.
/// Rejected, on the same data without C: log f (log score of left-out rows 0.15 a row worse with the footprint window,
/// 0.04 better with the belt).
#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <optional>
#include <vector>

#include "sweep/fit/box.h"
#include "sweep/fit/samples.h"

namespace drumsweep {

struct SurfaceParameters {
  std::vector<double> length;  ///< of F (num_axes), of the box
  double amplitude_m = 0;      ///< of F about its trend
  double rho = 1;              ///< sd of one run's error over its own sigma
  double shared = 0.5;         ///< w: share of that variance common to a replicate
  double shared_length = 1;    ///< of C, of the box, in every variable
};

/// What a run would measure (F + C_r) or what is looked for (F).
struct Site {
  Point at;
  std::optional<double> replicate;  ///< none: F
};

/// Joint distribution of sites [m], [m^2]; without the runs' own error e.
struct Posterior {
  Eigen::VectorXd mean;
  Eigen::MatrixXd covariance;
};

/// One row predicted from all others, parameters kept (Dubrule 1983).
struct LeftOut {
  double error_m = 0;  ///< row - prediction
  double sd_m = 0;     ///< of that difference, the row's own error included
};

class FittedSurface {
 public:
  /// Deterministic. @pre at least num_axes + 2 rows, finite f_m, points inside the box
  FittedSurface(const Box& box, std::vector<Measurement> rows);

  double mean_m(const Point& at) const;  ///< of F
  double sd_m(const Point& at) const;    ///< of F
  Posterior posterior(const std::vector<Site>& sites) const;
  Posterior posterior(const std::vector<Point>& points) const;  ///< of F
  /// Covariance between sites of two lists (na x nb), given the rows.
  Eigen::MatrixXd covariance(const std::vector<Site>& a, const std::vector<Site>& b) const;
  Eigen::VectorXd mean(const std::vector<Site>& sites) const;
  Eigen::VectorXd variance(const std::vector<Site>& sites) const;  ///< the diagonal of covariance(sites, sites)
  std::vector<LeftOut> leave_one_out() const;

  double run_sd_m(const Point& at) const;     ///< sd of e of one more run
  double shared_sd_m(const Point& at) const;  ///< sd of C
  /// The same rows with other parameters, drawn from their posterior by a Metropolis walk from the most likely ones: what
  /// few rows leave open about lengths and noise. Deterministic in the seed. Cost: 20 likelihoods a surface.
  std::vector<FittedSurface> drawn(int count, std::int64_t seed) const;
  /// The same parameters with one more row. For batches: a row not yet measured, at its prediction.
  FittedSurface with_row(const Measurement& row) const;

  const Box& box() const { return box_; }
  const std::vector<Measurement>& rows() const { return rows_; }
  const SurfaceParameters& parameters() const { return parameters_; }
  const NoiseTrend& noise_trend() const { return trend_; }

 private:
  struct Places;
  struct Given;
  static Places places_of(const Box& box, const NoiseTrend& trend, const std::vector<Site>& sites);
  Eigen::MatrixXd kernel(const Places& a, const Places& b) const;
  Given given(const std::vector<Site>& sites) const;
  void set_parameters(const std::vector<double>& theta);
  double cost(const std::vector<double>& theta, const std::vector<std::size_t>& subset);
  void choose_parameters(const std::vector<std::size_t>& subset);
  std::vector<std::size_t> rows_for_parameters() const;
  bool factorise(const std::vector<std::size_t>& subset);
  Places row_places(const std::vector<std::size_t>& subset) const;
  std::vector<std::size_t> all_rows() const;

  Box box_;
  std::vector<Measurement> rows_;
  std::vector<double> own_sigma_;  ///< shrunk [m]
  NoiseTrend trend_;
  double center_ = 0, spread_ = 1;  ///< f = center + spread z; the fit works on z
  SurfaceParameters parameters_;
  std::vector<double> theta_;                 ///< the parameters' logarithms, as searched
  Eigen::LLT<Eigen::MatrixXd> factor_;        ///< K of the rows, on z
  Eigen::MatrixXd basis_, solved_basis_;      ///< H and K^-1 H
  Eigen::LLT<Eigen::MatrixXd> trend_factor_;  ///< of H' K^-1 H
  Eigen::VectorXd beta_, weights_;            ///< weights: K^-1 (z - H beta)
  double log_likelihood_ = 0;
};

/// Weighted least squares of f [m] by a full quadratic.
struct QuadraticFit {
  int num_coefficients = 0;
  int dof = 0;                   ///< samples - coefficients; the residual test needs > 0
  double chi2_per_dof = 0;       ///< with the samples' sigma
  double p_value = 1;            ///< chance of a larger chi^2 (Wilson and Hilferty 1931)
  bool convex = false;           ///< has a minimum, which may lie outside the box
  std::optional<Point> minimum;  ///< inside the box
};

/// @return nothing where there are fewer samples than coefficients
std::optional<QuadraticFit> quadratic_fit(const Box& box, const std::vector<Sample>& samples);

}  // namespace drumsweep

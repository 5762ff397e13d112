/// The diagnosis itself, from measured data and an emulated campaign: is anything wrong, where, why, and what is gained.
///
///  1. Misfit. Q_0 of the model without any effect, theta recalibrated. p = min(1, 2 min(p_omnibus, p_directed)) with the statistics
///     Q_0 and max_k (Q_0 - Q_k); both null laws from a parametric bootstrap on the emulator at the fitted theta, in which data and
///     bench measurements are drawn anew and everything is fitted again.
///  2. Adequate is a model whose Q is below its own bootstrapped 99 % point. Singles first; pairs where no single is adequate, or
///     where pairs hold more than 90 % of the posterior.
///  3. Named is a set: the 95 % credible set of the adequate models (Laplace evidence, effect priors), and whatever lies within 3.84
///     of the best in Q, so that a wrong unique name stays below 2.5 % for rivals at any distance.
///  4. Held-out conditions, never used so far, refuse members that predict them badly (p < 0.01). A set in which every member would
///     have to be stronger than its range allows is refused as a whole.
///  5. Gain of the best member: log predictive density of each held-out condition over that of the plain model.
#pragma once

#include <optional>

#include "diagnosis/model/fit.h"

namespace drumsweep {

enum class Verdict { nothing_wrong, established, suspected, ambiguous, none_of_these };
const char* to_text(Verdict verdict);

/// For tests of the tests: each of these must make the suite fail. The program never sets any.
struct Mutation {
  bool drop_simulation_noise = false, skip_refit = false, swap_labels = false, flip_sign = false,
       halve_covariance = false, skip_held_out = false, share_seeds = false;
};

struct DiagnosisOptions {
  std::int64_t seed = 1;
  int num_bootstraps = 1000;
  double alpha = 0.05;
  double adequate_level = 0.99;  ///< of a model's own Q
  double held_out_level = 0.01;
  int adequate_bootstraps = 300;
  bool details = true;  ///< steps that no verdict needs: detection limits, isolation, advice
  Mutation mutation{};
};

/// One datum before and after recalibration, in the data's units.
struct DatumMisfit {
  double simulated_before, simulated_after, sigma_before, sigma_after;
  double z_before, z_after;  ///< measured - simulated, over the error of the difference
  double off_before;         ///< the same before recalibration, with the parameters taken as the bench has them
};

struct GroupMisfit {
  std::string group;
  std::size_t num_data;
  double chi2, p;
};

struct NamedEffect {
  int effect;
  double strength, low, high;  ///< with the 95 % interval, in the effect's unit
};

/// One model that can explain the data.
struct Explanation {
  std::vector<NamedEffect> effects;
  double q, weight;  ///< weight: posterior among adequate models
  double held_out_p = std::nan("");
  double held_out_nats = std::nan("");
  ModelFit fit;
};

struct Detection {
  double limit_low,
      limit_high;   ///< strength that is found in 9 of 10 campaigns like this one; NaN where not in the range
  double d_at_end;  ///< effect in sigma at the end of its range, after recalibration
};

struct Twins {
  int a, b;
  double distance;  ///< in sigma, at the strength where they would be seen with certainty
  bool exact;
};

struct Advice {
  std::string measurement;  ///< a condition with use = available, or "repeat the campaign"
  double distance;          ///< least predicted distance of two members of the set, in sigma
  double power;             ///< of telling the truth apart from the nearest other member
  double gained = 0;        ///< what it adds to the square of that distance
};

struct HeldOutGain {
  std::vector<std::string> conditions;
  std::vector<double> nats;                                             ///< of each condition
  double mean = std::nan(""), low = std::nan(""), high = std::nan("");  ///< 95 % t interval, skewness taken out
  double rms_z_before = std::nan(""), rms_z_after = std::nan("");
  double coverage_before = std::nan(""), coverage_after = std::nan("");  ///< of 90 % bands
  struct Quantity {
    std::string quantity, unit;
    double rms_before, rms_after;
  };
  std::vector<Quantity> quantities;
  bool adopted = false;
};

struct Diagnosis {
  Verdict verdict = Verdict::nothing_wrong;
  double p_value = 1, p_omnibus = 1, p_directed = 1, q0 = 0, birge = 1;
  Eigen::Index num_fitted_data = 0;
  ModelFit plain;                    ///< theta recalibrated, no effect
  std::vector<double> theta_z;       ///< of the recalibrated parameters against their bench priors
  std::vector<DatumMisfit> misfits;  ///< of all data
  std::vector<GroupMisfit> groups;
  std::vector<Explanation> causes;   ///< the set, best first; empty unless something is wrong and explained
  std::vector<Explanation> refused;  ///< adequate, but not on the held-out conditions, or only at the end of its range
  std::vector<ModelFit> singles;     ///< one fit an effect
  std::vector<Detection> detection;
  Eigen::MatrixXd isolation;  ///< D (truth x rival) [sigma] where the truth is as strong as d = 5, or at its end
  std::vector<Twins> twins;
  std::vector<double>
      pattern_cosine;          ///< of the residual with each effect's signature, a hint when nothing explains it
  std::vector<Advice> advice;  ///< best first
  HeldOutGain gain;
  bool at_edge = false;  ///< a fitted parameter lies at the edge of what the campaign covers

  /// Whether this unordered set of effects is among the causes.
  bool names(const std::vector<int>& effects) const;
};

/// @param runs  the campaign  @throws InputError: fewer data than free parameters, ...
Diagnosis diagnose(const Problem& problem, const Emulator& emulator, const DiagnosisOptions& options = {});

/// Gain of a fit over that of the plain model on the data with use = holdout.
HeldOutGain held_out_gain(const Problem& problem, const Emulator& emulator, const ModelFit& plain, const ModelFit& best,
                          const DiagnosisOptions& options = {});

/// Scale for an emulator of this problem: the data's sigma.
Eigen::VectorXd scale_of(const Problem& problem);

double normal_cdf(double x);
/// P(chi^2_k > x)
double chi2_tail(double x, double k);
/// Two-sided 95 % point of Student's t.
double student_95(double dof);

}  // namespace drumsweep

/// Tier A of the tests that hide an effect: the truth is a synthetic machine with a quadratic response, so that thousands of cases
/// take minutes. The diagnosis sees it only through an emulator trained on noisy runs, as in a real campaign.
///
/// Machine: 4 free parameters; 8 candidate effects, of which 4 and 5 are near twins and 6 and 7 exact ones on all that is measured;
/// 4 outsiders that are not on the list. 32 fitted data; 64 held-out conditions of 3 data, of which each case has 8; one more
/// measurement that could be made and separates the near twins. Simulation noise: Student's t with 5 degrees of freedom, as large as
/// the measurement's, 840 runs (the budget law's 9 n_coef).
#pragma once

#include <string>
#include <vector>

#include "diagnosis/model/verdict.h"

namespace drumsweep {

enum class Hidden {
  nothing,
  single,
  pair,
  outsider,
  impostor,  ///< looks like a listed effect on the fitted data and differs on those held out
};

struct SyntheticMachine {
  std::int64_t seed = 1;
  Problem problem;                 ///< without values
  Eigen::MatrixXd truth;           ///< (features x data)
  Eigen::MatrixXd outsider_slope;  ///< (outsiders x data), at strength 1

  Eigen::MatrixXd
      kink_slope;  ///< (effects x data): beyond half of its range an effect acts more (or less), which no quadratic follows

  /// @param kink  size of what the emulator cannot follow; 0: it follows all
  explicit SyntheticMachine(std::int64_t machine_seed, double kink = 0);
  /// @param share_seeds  only in tests that must fail: noise that is the same in all runs
  CampaignRuns campaign(Eigen::Index num_runs, bool share_seeds) const;
  /// Runs of a second wave in one box.
  LocalRuns local_runs(const LocalCentre& box, Eigen::Index num_runs, std::uint64_t number) const;
  /// d of a change of the data (in sigma) at theta after recalibration, and after one of the effects was fitted too (linearised).
  double detectability(const Eigen::VectorXd& u, const Eigen::VectorXd& change) const;
  double distance_to(const Eigen::VectorXd& u, const Eigen::VectorXd& change, int rival) const;
  Eigen::VectorXd mean(const Eigen::VectorXd& u, const Eigen::VectorXd& p) const;
};

struct SealedCase {
  Hidden kind = Hidden::nothing;
  std::vector<int> effects;
  std::vector<double> strengths;
  double
      d = 0,
      nearest =
          0;  ///< effect after recalibration; the nearest single rival after refitting it (pair: nearest single member)
  int nearest_rival = -1;
  Eigen::VectorXd u;
  Problem problem;     ///< with values
  Problem population;  ///< all held-out conditions, with other noise
};

SealedCase draw_case(const SyntheticMachine& machine, Hidden kind, std::uint64_t number, double d_low, double d_high,
                     const std::vector<int>& among);

struct Count {
  int yes = 0, of = 0;
  void add(bool hit) {
    ++of;
    yes += hit ? 1 : 0;
  }
  double rate() const { return of > 0 ? static_cast<double>(yes) / of : 0; }
};

struct TierAScore {
  Count false_alarm;
  Count clear_right, clear_misnamed;  ///< d >= 5 and all D >= 5
  Count weak_in_set;                  ///< d in [4, 5)
  Count pair_in_set;                  ///< pairs, both at least 6 sigma from any single
  Count outsider_named;               ///< d >= 6
  Count outsider_named_8;             ///< d >= 8
  Count impostor_named;
  Count exact_both, exact_apart;  ///< both named; one named without the other
  Count near_misnamed, near_resolved;
  Count gain_covers, strength_covers;
  std::vector<double> strength_off;  ///< relative to the truth
  Count control_gain;                ///< null data: a gain was adopted
  Eigen::MatrixXi
      confusion;  ///< (hidden single effect, nothing, outsider) x (named uniquely, set with the truth, set without, none of these, nothing wrong)

  std::string table() const;
  /// Gates of the method that are missed beyond what chance allows (one-sided 99 %), each with its number; empty: all met.
  std::vector<std::string> missed() const;
};

struct TierAOptions {
  int machines = 6, cases_per_class = 20, num_bootstraps = 200;
  std::int64_t first_seed = 1;
  Eigen::Index num_runs = 840;   ///< of each campaign
  bool only_null = false;        ///< false alarms alone
  double kink = 0;               ///< lack of fit of the machines
  Eigen::Index second_wave = 0;  ///< runs a box; 0: none
  Mutation mutation{};
};

TierAScore run_tier_a(const TierAOptions& options);

/// One-sided: probability of at most (at least) `yes` of `of` when the true rate is `rate`.
double binomial_at_most(int yes, int of, double rate);
double binomial_at_least(int yes, int of, double rate);

}  // namespace drumsweep

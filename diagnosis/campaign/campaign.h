/// The campaign file and the measured data: what a diagnosis is asked to do.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "diagnosis/campaign/candidate.h"

namespace drumsweep {

struct CampaignParameter {
  FreeParameter prior;
  std::vector<std::string> keys;  ///< set to the same value wherever a condition has them
};

struct Campaign {
  std::string name = "campaign", path, folder;  ///< folder of the file; names in it are relative to that
  std::int64_t seed = 1;
  std::int64_t runs = 0;            ///< of the design; 0: three per coefficient
  std::int64_t second_wave = -1;    ///< runs round each leading explanation; -1: ten a coefficient there; 0: none
  std::int64_t numerics_runs = 20;  ///< seeds with which h/2 and 4 x iterations are compared; 0: not checked
  std::int64_t bootstraps = 1000;
  std::string measured;  ///< path of the data
  std::string study;     ///< path of the study that is extended; may be empty
  std::vector<Condition> conditions;
  std::vector<CampaignParameter> parameters;
  std::vector<Candidate> candidates;
  /// Where data have no sigma (the word `assumed` in its place), this share of the value stands for it, and no cause is called
  /// established. NaN: such data are refused.
  double assumed_relative_sigma = std::nan("");

  std::size_t index_of(const std::string& condition) const;
  /// Coefficients of the emulator.
  std::int64_t num_coefficients() const;
  std::int64_t num_runs() const { return runs > 0 ? runs : 3 * num_coefficients(); }
  /// All that decides what is simulated, as text: a folder with another one is not this campaign's.
  std::string fingerprint() const;
  /// What to change in a condition's input at u and p (in the inner units).
  std::vector<KeyChange> changes(const Condition& condition, const Eigen::VectorXd& u, const Eigen::VectorXd& p) const;
};

/// @throws InputError: unknown keys and names with "did you mean", impossible values at the edge of the design, ...
Campaign read_campaign(const std::string& path);

struct MeasuredData {
  std::vector<Datum> data;  ///< as written: value and sigma in the file's units, group empty
  std::vector<int> line;    ///< of each in the file
  std::size_t num_assumed = 0;
};
/// Reads condition,quantity,position,value,sigma,unit,use. @throws InputError with file and line
MeasuredData read_measured(const Campaign& campaign);
MeasuredData parse_measured(const std::string& text, const std::string& source, const Campaign& campaign);

/// Puts the data into the simulation's units and finds their groups, looking at what the conditions offer.
/// @param offered  observables of each condition from one run  @throws InputError: unknown quantity, unit or position
void match_measured(MeasuredData& measured, const std::string& source, const Campaign& campaign,
                    const std::vector<std::vector<Observable>>& offered);

/// The number that the observables have for this quantity and position (linear between neighbours); NaN where none.
double read_off(const std::vector<Observable>& observables, const std::string& quantity, double position);

/// The problem without covariance and runs.
Problem make_problem(const Campaign& campaign, const MeasuredData& measured);

}  // namespace drumsweep

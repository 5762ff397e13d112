/// A diagnosis in the forms that people and programs read.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "diagnosis/campaign/runs.h"
#include "diagnosis/model/verdict.h"
#include "diagnosis/report/design_change.h"

namespace drumsweep {

/// h/2 and 4 x iterations against what the campaign has used.
struct NumericsCheck {
  std::size_t datum;
  double difference, error;  ///< finer - as is, and its standard error, in the data's units
  double in_sigma;           ///< difference / sigma of the measurement; above 0.3 the campaign is not converged for it
};

/// A datum as the extended model has it.
struct ExtendedValue {
  double value, sigma;  ///< in the datum's units
};

struct DiagnosisReport {
  Campaign campaign;
  Problem problem;
  Diagnosis result;
  std::vector<NumericsCheck> numerics;    ///< one a datum; empty: not checked
  std::vector<ExtendedValue> with_cause;  ///< one a datum, by the best member of the set; empty without one
  std::vector<double> advice_cost;        ///< of each measurement that is advised; NaN where the campaign names none
  std::vector<std::string> notes;         ///< what was left out, assumed, or is short
  std::vector<std::string> second_wave;   ///< one line a box of it
  std::size_t num_runs = 0;               ///< of the first wave
  std::int64_t budget = 0;                ///< runs by the budget law
  std::optional<DesignChange> change;     ///< where both sweeps were given
};

/// All in one: outputs of the campaign, the data, the diagnosis. @throws InputError
DiagnosisReport make_report(const Campaign& campaign, const MeasuredData& measured, const CampaignOutputs& outputs,
                            const DiagnosisOptions& options);

/// "rolling resistance 0.21 [0.17, 0.26]"
std::string describe(const DiagnosisReport& report, const Explanation& cause);
/// One sentence for the verdict.
std::string headline(const DiagnosisReport& report);
/// What the plain model gets wrong at the bench values, in words: "simulation too low: ...", "simulation too high: ...".
std::vector<std::string> misfits_in_words(const DiagnosisReport& report);
/// A sentence on what to measure next, empty where the set has no two members.
std::string next_measurement(const DiagnosisReport& report);

/// The gain with its interval, and whether it is adopted.
std::string gain_in_words(const HeldOutGain& gain);
/// Whoever imitates this candidate best. Nothing where there is no other.
std::optional<std::size_t> nearest_rival(const Diagnosis& diagnosis, std::size_t candidate);

std::string report_text(const DiagnosisReport& report);
std::string report_html(const DiagnosisReport& report);
std::string report_hdf5(const DiagnosisReport& report);
/// File names and contents: misfit.csv, candidates.csv, isolation.csv, gain.csv.
std::vector<std::pair<std::string, std::string>> report_tables(const DiagnosisReport& report);
/// Name of the extended study of a member of the set: extended.toml, extended_2.toml ...
std::string extended_name(std::size_t member);
/// The campaign's study with the causes at their fitted strengths: extended.toml for the best, extended_2.toml ... for the others of
/// the set. Empty without a study or a cause.
std::vector<std::pair<std::string, std::string>> extended_studies(const DiagnosisReport& report);

/// Writes everything into the folder, durably. @return the paths
std::vector<std::string> write_report(const DiagnosisReport& report, const std::string& folder);

}  // namespace drumsweep

/// Tier B and C: an effect is hidden in data that the engine makes for real. Truth has other seeds than any campaign run, is averaged
/// over many of them, and may use physics or a stepper that the campaign does not have.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "diagnosis/campaign/runs.h"
#include "diagnosis/model/verdict.h"

namespace drumsweep {

struct HiddenTruth {
  std::string name;                                     ///< of the case, for tables
  std::vector<std::pair<std::string, double>> effects;  ///< on the campaign's list: id, strength
  std::vector<KeyChange> outsider;                      ///< and what is not
  Eigen::VectorXd u;                                    ///< parameters; of the campaign's number, or empty: drawn
  bool smooth = false;                                  ///< truth from the smooth reference stepper
  int repeats = 10;
  std::int64_t seed = 1;

  bool listed() const { return outsider.empty(); }
  std::string key(const Campaign& campaign) const;      ///< as text, for the seal
  static HiddenTruth from_key(const std::string& key);  ///< without the parameters
};

/// The rows of `wanted` with values: simulated, averaged, and with the measurement's error.
MeasuredData measure_hidden(const Campaign& campaign, const MeasuredData& wanted, HiddenTruth& truth, int threads);
std::string measured_csv(const MeasuredData& measured);

/// The campaign's rows, without values.
MeasuredData wanted_of(const Campaign& campaign);

/// A case from entropy: an effect, none, a pair or an outsider, strength and parameters.
HiddenTruth draw_truth(const Campaign& campaign, const std::string& kind, std::int64_t seed);

/// Runs a campaign in this process.
std::vector<RunResult> simulate_campaign(const Campaign& campaign, int threads);
/// Runs what a second wave needs, and adds it to the outputs.
void simulate_second_wave(const Campaign& campaign, const std::vector<LocalCentre>& boxes, const MeasuredData& measured,
                          int threads, CampaignOutputs& outputs);

}  // namespace drumsweep

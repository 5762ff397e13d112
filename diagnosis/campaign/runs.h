/// The campaign's simulations: which ones, farming them out, storing them, and reading off what was measured.
///
/// Run i has parameters and strengths from a low-discrepancy sequence (sweep/fit/box.h), so a campaign can be made longer without repeating anything: 15 % without any effect, 45 % with one, 40 % with two, effects
/// in turn. Its random seed belongs to it and to the condition: noise is that of independent experiments.
/// Runs from num_runs() on compare numerics: pairs (as is, finer) at the prior's mean without effects, both with one seed.
///
/// After them may come a second wave (second_wave.h): boxes round what explains the data, each with runs of its own.
///
/// OUT: campaign.txt (fingerprint), runs/NNNNNN.h5 (one sealed file a run: all observables of all conditions), run.log, lock.
#pragma once

#include <functional>
#include <optional>

#include "diagnosis/campaign/campaign.h"
#include "diagnosis/model/second_wave.h"
#include "sweep/farm/task_farm.h"
#include "sweep/progress.h"

namespace drumsweep {

struct DesignPoint {
  Eigen::VectorXd u, p;
  bool finer = false;
  std::int64_t seed = 0;  ///< of the run; that of a condition follows from it
};
/// @param num_design_runs  of the campaign; later numbers are the numerics' pairs
DesignPoint design_point(const Campaign& campaign, std::size_t run, std::size_t num_design_runs);

/// Runs of one box of the second wave, and the points of these.
std::size_t num_local_runs(const Campaign& campaign, const LocalCentre& box);
DesignPoint local_point(const Campaign& campaign, const LocalCentre& box, std::size_t run);

/// All observables of all conditions of one run; where a condition could not be simulated, why.
struct RunResult {
  std::vector<std::vector<Observable>> observables;  ///< of each condition
  std::vector<std::string> failure;                  ///< of each condition, empty where all went well
  double cpu_s = 0;
};
/// @return nothing when it was stopped
std::optional<RunResult> simulate_run(const Campaign& campaign, const DesignPoint& point, int threads,
                                      const GoOn& go_on);

std::string pack_run(const Campaign& campaign, const RunResult& result);
RunResult unpack_run(const std::string& bytes, const Campaign& campaign, const std::string& source);

struct CampaignPlan {
  std::size_t num_runs = 0, num_numerics = 0, stored = 0;
  std::size_t most_local = 0;  ///< of the second wave, at most: how many depends on what is found
  double cpu_s_per_run = 0, cpu_s_left = 0;
};

struct CampaignStore {
  std::string folder;
  std::string run_path(std::size_t run) const;
  std::string local_path(const LocalCentre& box, std::size_t run) const;
  /// @throws MismatchError when the folder is another campaign's, or something else
  void open(const Campaign& campaign) const;
  /// As open(), changing nothing.
  void check(const Campaign& campaign) const;
  bool has(std::size_t run) const;
};

/// Asked once the design's runs are stored: the boxes of the second wave.
using PlanSecondWave = std::function<std::vector<LocalCentre>()>;

/// Runs what is missing. Results are the same bit for bit for any number of ranks and interruptions.
/// @throws MismatchError, LockHeldError, WriteError
TaskOutcome run_campaign(Farm& farm, const Campaign& campaign, const std::string& folder, int threads,
                         Reporter& reporter, const PlanSecondWave& second_wave);
/// The other ranks.
void serve_campaign(Farm& farm, int threads);

/// Looks at what one run costs (a stored one, or one made for it) without changing the folder.
CampaignPlan plan_campaign(const Campaign& campaign, const std::string& folder);

/// What the data would have been in each run.
struct CampaignOutputs {
  CampaignRuns runs;                  ///< without the runs in which a number was missing
  std::vector<LocalRuns> local;       ///< of the second wave, likewise
  Eigen::MatrixXd numerics;           ///< finer - as is (pairs x data)
  std::vector<std::string> left_out;  ///< why runs are not in there, one line each
  double cpu_s = 0;
};
CampaignOutputs read_runs(const Campaign& campaign, const std::string& folder, const MeasuredData& measured,
                          const std::vector<LocalCentre>& second_wave = {});
/// The same from runs in memory.
CampaignOutputs read_off_runs(const Campaign& campaign, const std::vector<RunResult>& results,
                              std::size_t num_design_runs, const MeasuredData& measured);
/// Adds one box of the second wave.
void read_off_local(const Campaign& campaign, const LocalCentre& box, const std::vector<RunResult>& results,
                    const MeasuredData& measured, CampaignOutputs& outputs);

}  // namespace drumsweep

#include "diagnosis/campaign/second_wave.h"

#include <fmt/format.h>

namespace drumsweep {

std::vector<LocalCentre> plan_second_wave(const Campaign& campaign, const MeasuredData& measured,
                                          const CampaignOutputs& outputs, const DiagnosisOptions& options) {
  if (campaign.second_wave == 0) return {};
  const Problem problem = make_problem(campaign, measured);
  CampaignOutputs scaled = outputs;
  std::vector<std::string> notes;
  put_on_baseline(campaign, problem, scaled, notes);
  DiagnosisOptions quick = options;
  quick.details = false;
  return second_wave_of(diagnose(problem, Emulator(scaled.runs, scale_of(problem)), quick), problem);
}

std::vector<std::string> second_wave_notes(const Problem& problem, const Emulator& emulator,
                                           const std::vector<LocalRuns>& boxes) {
  std::vector<std::string> out;
  for (const LocalRuns& box : boxes) {
    std::vector<std::string> effects;
    for (const int k : box.centre.effects) effects.push_back(problem.effects[static_cast<std::size_t>(k)].id);
    const std::string round = fmt::format("{}", fmt::join(effects, " and "));
    if (box.x.rows() < fewest_local_runs(box.centre))
      out.push_back(
          fmt::format("second wave: only {} of the runs round {} gave all numbers, too few to correct anything",
                      box.x.rows(), round));
    else
      out.push_back(
          fmt::format("second wave: {} runs round {}; the campaign's emulator was off by up to {:.1f} sigma there",
                      box.x.rows(), round, largest_shift(local_correction(emulator, box))));
  }
  return out;
}

void put_on_baseline(const Campaign& campaign, const Problem& problem, CampaignOutputs& outputs,
                     std::vector<std::string>& notes) {
  const auto has_baseline = [](const Condition& c) { return !c.baseline.empty(); };
  if (std::none_of(campaign.conditions.begin(), campaign.conditions.end(), has_baseline)) return;
  const Emulator own(outputs.runs, scale_of(problem));
  const Eigen::VectorXd plain = own.predict(Eigen::VectorXd::Zero(own.num_parameters() + own.num_effects()));
  for (Eigen::Index i = 0; i < problem.num_data(); ++i) {
    const Datum& d = problem.data[static_cast<std::size_t>(i)];
    for (const auto& [quantity, value] : campaign.conditions[campaign.index_of(d.condition)].baseline) {
      if (quantity != d.quantity) continue;
      const double here = plain[i] * own.scale()[i];
      outputs.runs.outputs.col(i) *= value / here;
      for (LocalRuns& box : outputs.local) box.outputs.col(i) *= value / here;
      notes.push_back(fmt::format(
          "{}: the campaign's baseline {:.4g} {} stands for this engine's {:.4g}; its responses are scaled with it",
          name_of(d), value, d.unit, here));
    }
  }
}

}  // namespace drumsweep

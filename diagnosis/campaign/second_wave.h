/// The second wave of a campaign (model/second_wave.h): which runs, from what the first has shown.
///
/// OUT/second_wave/BOX/NNNNNN.h5, one sealed file a run. BOX is made of the box's numbers: other data lead to another box, and nothing is
/// ever taken for a run of another one.
#pragma once

#include "diagnosis/campaign/runs.h"
#include "diagnosis/model/verdict.h"

namespace drumsweep {

/// A first diagnosis, and the boxes that it asks for; none where nothing is wrong, or the campaign wants none.
std::vector<LocalCentre> plan_second_wave(const Campaign& campaign, const MeasuredData& measured,
                                          const CampaignOutputs& outputs, const DiagnosisOptions& options);

/// One line a box: how many runs, round what, and how far off the campaign's emulator was there.
std::vector<std::string> second_wave_notes(const Problem& problem, const Emulator& emulator,
                                           const std::vector<LocalRuns>& boxes);

/// Scales outputs to what another program has simulated, where the campaign has a baseline: so that the plain model at the prior's mean
/// gives it. @param notes  one line for each that was scaled
void put_on_baseline(const Campaign& campaign, const Problem& problem, CampaignOutputs& outputs,
                     std::vector<std::string>& notes);

}  // namespace drumsweep

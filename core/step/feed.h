/// Feeds balls at the given mass flow, each placed without overlap just above what lies in the feed zone at the upper
/// end.
#pragma once

#include "core/state/drum_state.h"
#include "core/step/drum_model.h"

namespace drumsweep {

struct FeedScratch {
  std::vector<std::uint32_t> in_zone;
};

/// Adds the balls due in one outer step. Places are drawn from a stream keyed by (seed, ball id, attempt). A ball that
/// finds no room stays due (state.feed_debt_kg): nothing is dropped silently.
void feed_balls(const DrumModel& model, DrumState& state, FeedScratch& scratch);

}  // namespace drumsweep

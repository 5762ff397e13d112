/// One outer step of the drum: feed, the step of its balls, belt.
#pragma once

#include "core/step/drum_model.h"
#include "core/step/feed.h"
#include "core/step/stepper.h"

namespace drumsweep {

/// Scratch memory, kept from step to step.
struct DrumWorkspace : Workspace {
  FeedScratch feed;
  std::vector<char> gone;
};

/// Advances the state by one outer step.
/// @param landings  appended to; null when nobody listens
StepReport advance(const DrumModel& model, DrumState& state, DrumWorkspace& work,
                   std::vector<Landing>* landings = nullptr);

}  // namespace drumsweep

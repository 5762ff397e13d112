/// What happens outside the wall: which way a ball left the drum, where it lands on the belt, and what is lost.
#pragma once

#include "core/state/drum_state.h"
#include "core/step/drum_model.h"

namespace drumsweep {

/// After positions moved over one time step ending at `time`: notes through which slot (or over the end) balls have
/// left, appends landings, counts what spilled or was lost, and marks in `gone` what is to be dropped at the next
/// contact search. Lost, by design: not a number; farther away than a ball can fly; behind or outside the drum's closed wall; outside the outlet but far
/// from every slot; below the belt without having left the drum.
/// @param pose  of the drum at `time`
/// @param landings  may be null: counted all the same
void record_exits_and_landings(const DrumModel& model, const Pose& pose, double time, DrumState& state,
                               std::vector<char>& gone, std::vector<Landing>* landings);

/// For a state whose outlet was just replaced by the model's: balls that were on their way through an old slot and now
/// find a finger's sheet between them and the axis are counted as having left by the nearest new slot. Impulses against
/// the outlet are forgotten.
void adopt_outlet(const DrumModel& model, DrumState& state);

}  // namespace drumsweep

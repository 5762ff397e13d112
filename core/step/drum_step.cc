#include "core/step/drum_step.h"

#include "core/step/belt.h"

namespace drumsweep {

StepReport advance(const DrumModel& model, DrumState& state, DrumWorkspace& work, std::vector<Landing>* landings) {
  PhaseClock clock(work);
  feed_balls(model, state, work.feed);
  clock.done(Phase::feed);

  work.gone.assign(state.balls.size(), 0);
  const StepReport report = advance(model.world, state, work, [&](double time) {
    record_exits_and_landings(model, model.pose(time), time, state, work.gone, landings);
  });
  drop_gone(state, work.gone);
  return report;
}

}  // namespace drumsweep

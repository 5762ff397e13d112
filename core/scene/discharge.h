/// The drum above its belt as they are: the belt is a wall that moves, balls land on it, lie on each other and ride away. For pictures
/// and trajectories. The runs of a sweep end each ball where it meets the belt plane (core/step/belt.h); inside the drum the two are
/// the same physics, but not the same bits, as balls on the belt are part of the same contact problem.
#pragma once

#include <functional>

#include "core/scene/drum.h"

namespace drumsweep {

/// The piece of belt that is there, along x [m].
struct BeltPiece {
  double begin = 0, end = 0;
};
/// From nine tenths of a diameter before the drum's axis to as far behind it.
BeltPiece belt_piece(const Study& study);

class Discharge {
 public:
  int threads = 1;  ///< results do not depend on it

  /// @param outlet  put in place of the one that the state has come from
  Discharge(const Study& study, const OutletConfig& outlet, DrumState state);

  const DrumModel& model() const { return model_; }
  const DrumState& state() const { return state_; }
  double time() const { return time_of(model_, state_.num_steps); }
  /// z of the belt [m]
  double belt_height() const { return belt_height_; }

  /// Steps until `time`, to the nearest step. @param go_on  called after every step; false stops there
  /// @return false when it was stopped
  bool run_until(double time, const std::function<bool()>& go_on);

 private:
  void step();

  double belt_height_;
  DrumModel model_;
  DrumState state_;
  DrumWorkspace work_;
  FeedScratch feed_;
};

}  // namespace drumsweep

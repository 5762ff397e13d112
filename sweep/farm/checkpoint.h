/// A design's state on disk while it is simulated, so that a run that was killed or stopped goes on inside the design.
#pragma once

#include <chrono>
#include <string>

#include "core/scene/drum.h"
#include "sweep/plan/designs.h"
#include "sweep/store/store.h"

namespace drumsweep {

/// designs/ID.part, a sealed file that is replaced durably.
///
/// Written at the end of a turn when `interval_s` has passed since the last one and that one cost less than 1 % of the
/// time since; where turns are long, every ten minutes (or 60 intervals) within them; at once on SIGUSR1. With an
/// interval of 0 at every turn, whatever it costs.
class Checkpoint {
 public:
  /// @param attempt  how often the design has been begun, this time included
  Checkpoint(const OutputPaths& paths, const Study& study, const PlannedDesign& design, int attempt, double interval_s);

  /// What an earlier attempt has left; not begun where nothing can be used. A file that is damaged or of another study is
  /// no reason to stop: the design begins anew, and note() says so.
  DesignProgress read();
  const std::string& note() const { return note_; }

  /// To be called between two steps. @throws WriteError
  void between_steps(const DesignProgress& progress, const Progress& at);
  /// @throws WriteError
  void save(const DesignProgress& progress);
  /// When the design has its recording.
  void remove();

 private:
  using Clock = std::chrono::steady_clock;
  bool due(double turns);

  std::string path_, note_;
  const Study& study_;
  const PlannedDesign& design_;
  int attempt_;
  double interval_s_, cost_s_ = 0, whole_turns_ = -1;
  Clock::time_point saved_ = Clock::now();
  std::int64_t saved_at_step_ = -1;
  int requests_seen_;
  bool on_disk_ = false;
};

/// Attempt that has written the design's checkpoint, 0 when there is none: the last one that got further. Looks at the
/// beginning of the file only.
int last_attempt_with_progress(const OutputPaths& paths, const std::string& design_id);

/// Removes the checkpoints of designs that have their recording: of a run that was killed between the two.
void remove_stale_checkpoints(const OutputPaths& paths);

}  // namespace drumsweep

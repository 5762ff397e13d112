/// The drum: warm-up to a steady state, and the run of one outlet design that starts from it.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "core/step/drum_step.h"
#include "core/step/step_report.h"

namespace drumsweep {

/// What a run tells whoever watches it, after every outer step.
struct Progress {
  const char* what;      ///< "warm-up", "adapting", "recording"
  double turns;          ///< done
  double turns_planned;  ///< warm-up: at most
  double time_s;         ///< simulated, since the empty drum
  std::size_t balls;     ///< inside
};

/// Called after every outer step; return false to stop the run there.
using Observer = std::function<bool(const Progress&)>;

/// Inflow and outflow over one window of whole turns.
struct WarmupWindow {
  double turns_end;
  std::int64_t fed, left;  ///< balls; left: landed or spilled
  std::int64_t inside;     ///< at the window's end
};

struct WarmState {
  DrumState state;
  std::vector<WarmupWindow> windows;  ///< those complete; the state may be further
  bool finished = false;              ///< the warm-up has ended: steady, or at its cap
  bool steady = false;                ///< inflow = outflow within the tolerance in the last windows
};

/// Feeds an empty drum (or goes on from `warm`) until inflow and outflow agree over the study's windows, or the cap.
/// Works in `warm` itself: whenever the observer is called it may be saved, and a warm-up that goes on from there ends in
/// bitwise the same state.
/// @param save  called after every window: the state to keep for a restart; may be empty
/// @return false when the observer stopped it
bool warm_up(const Study& study, WarmState& warm, const Observer& observer,
             const std::function<void(const WarmState&)>& save, int threads = 1);

/// One design: values for keys of the study.
using Design = std::vector<std::pair<std::string, double>>;

/// What Recording::quality_of_steps holds of each recorded outer step, in its last sub-step.
inline constexpr std::array<const char*, 6> quality_columns = {"mean residual [m/s]", "max residual [m/s]",
                                                               "95 % overlap / d",    "max overlap / d",
                                                               "force balance [m/s]", "iterations"};

/// What a design's simulation leaves behind; all that the objective and the table need.
struct Recording {
  std::vector<Landing> landings;  ///< of the recorded turns
  double begin_s = 0;             ///< simulation time at which recording began
  double turns = 0;
  Counts counts;                        ///< since the empty drum
  std::int64_t inside = 0;              ///< balls at the end
  std::int64_t lost = 0;                ///< in this run
  double feed_debt_kg = 0;              ///< due but not placed at the end; grows when the feed zone is blocked
  StepReport quality;                   ///< means over the recorded steps (see ReportMean)
  std::vector<float> quality_of_steps;  ///< (recorded outer steps x quality_columns)
  std::uint64_t hash = 0;               ///< of the final state
  double cpu_s = 0;
  bool stopped = false;  ///< by the observer; the rest is then incomplete
};

/// The study with a design's values put in, without its stages. @throws InputError
Study study_of_design(const Study& study, const Design& design);

/// A design's run between two outer steps: all that it takes to go on.
struct DesignProgress {
  bool begun = false;  ///< else the run begins from the warm drum
  DrumState state;
  std::vector<Landing> landings;
  ReportMean quality;
  std::vector<float> quality_of_steps;
};

/// Runs one design: the warm state with its outlet replaced, adaptation, recording of whole turns.
/// Works in `progress` itself: whenever the observer is called it may be saved, and a run that goes on from there gives
/// bitwise the same recording. At the end its landings have moved into the recording.
Recording continue_design(const Study& study, const DrumState& warm, const Design& design, DesignProgress& progress,
                          const Observer& observer, int threads = 1);

/// The same from the beginning.
/// @param final_state  out, may be null: the state at the end
Recording run_design(const Study& study, const DrumState& warm, const Design& design, const Observer& observer,
                     int threads = 1, DrumState* final_state = nullptr);

/// A drum with `num_balls` laid in layers into the lower part of it, at rest and without overlap: the quick way to a
/// typical load, for benchmarks. A few turns make it flow steadily.
/// @throws InputError when they do not fit below the axis
DrumState filled_drum(const DrumModel& model, std::int64_t num_balls);

/// Kinetic energy of all balls, rotation included [J].
double kinetic_energy(const DrumModel& model, const DrumState& state);

}  // namespace drumsweep

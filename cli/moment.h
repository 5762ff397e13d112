/// What `picture` and `export` show: a state file, or an output folder with one of its designs.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/io/snapshot.h"
#include "postproc/still.h"
#include "sweep/plan/designs.h"
#include "sweep/progress.h"

namespace CLI {
class App;
}

namespace drumsweep {

struct MomentOptions {
  std::string path;              ///< of a state file or an output folder
  std::vector<double> at;        ///< folder: the design's values ...
  std::string id;                ///< ... or its id; neither: the best design
  std::optional<double> lead_s;  ///< simulated before the first picture
  int frames = 0;
  std::optional<double> seconds;  ///< of these frames; none: one turn of the drum
};

/// Adds the input and --at, --id, --lead.
void add_moment_options(CLI::App& command, MomentOptions& options);

/// A drum or a scene at one moment.
struct Moment {
  std::optional<DrumMoment> drum;
  std::optional<StoredScene> scene;     ///< where it is no drum
  std::optional<PlannedDesign> design;  ///< of a folder
  std::string text;                     ///< what it is, for people
};

/// @throws InputError (neither a state nor a folder, no such design), StoreError, MismatchError
Moment read_moment(const MomentOptions& options);

/// Simulated before anything is shown [s]: as asked for; else the adaptation to the design's outlet, where there is one, and what
/// the belt needs to get its bed where `with_bed`.
double lead_of(const MomentOptions& options, const Moment& moment, bool with_bed);

/// The moment after its lead. @return none when a signal has stopped it
std::optional<Still> still_after_lead(Moment moment, double lead_s, Reporter& reporter);

/// Calls `show` with options.frames moments spread over options.seconds after the lead.
/// @param show  still and time since the first one [s]
/// @return false when a signal has stopped it. @throws InputError for a scene, which cannot be continued
bool film(Moment moment, double lead_s, const MomentOptions& options, Reporter& reporter,
          const std::function<void(const Still&, double)>& show);
/// Of a frame to the next [s].
double frame_interval(const MomentOptions& options, const Moment& moment);

}  // namespace drumsweep

/// Drum states and recordings as sealed HDF5 images.
#pragma once

#include <string>

#include "core/io/hdf5_image.h"
#include "core/scene/drum.h"

namespace drumsweep {

/// A stored file that belongs to another study: the key-by-key difference is in the message. Exit code 5.
struct MismatchError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Warm (or warming) state with all that a restart needs: balls, ids, drum angle (by the step count), feeder, impulses,
/// windows, the study. A run restarted from it is bitwise the uninterrupted one.
/// Balls are in the layout of H5MD 1.1 with its units module, one moment of the group /particles/balls; what a restart
/// needs beyond that is in /drumsweep and in the attributes of the root.
std::string pack_warm_state(const Study& study, const WarmState& warm);

/// @throws StoreError (damaged, foreign), MismatchError (another version, or a key of the warm-up differs from `study`)
WarmState unpack_warm_state(const std::string& bytes, const Study& study, const std::string& source);

/// A stored drum together with the study it was made with.
struct StoredDrum {
  Study study;
  WarmState warm;
};
/// @throws StoreError, MismatchError (of another version)
StoredDrum unpack_drum(const std::string& bytes, const std::string& source);

/// A stored drum at one moment with the outlet that it had then: a warm state, or a design's progress.
struct DrumMoment {
  Study study;  ///< of a design's progress with the design's values
  OutletConfig outlet;
  DrumState state;
};
/// @throws StoreError, MismatchError (of another version)
DrumMoment unpack_drum_moment(const std::string& bytes, const std::string& source);

/// Recording of one design.
std::string pack_recording(const Study& study, const std::string& design_id, const Design& design,
                           const Recording& recording);

/// @throws StoreError, MismatchError (another version or design, or a key that the recording depends on differs)
Recording unpack_recording(const std::string& bytes, const Study& study, const std::string& design_id,
                           const Design& design, const std::string& source);

/// A design's run between two steps; `attempt` counts how often the design had been begun when it was written. It also
/// stands in the second line of the file.
std::string pack_progress(const Study& study, const std::string& design_id, const Design& design,
                          const DesignProgress& progress, int attempt);

/// The attempt in that line, 0 when it is not one.
int attempt_in_head(const std::string& second_line);

struct StoredProgress {
  DesignProgress progress;
  int attempt;
};
/// @throws as unpack_recording()
StoredProgress unpack_progress(const std::string& bytes, const Study& study, const std::string& design_id,
                               const Design& design, const std::string& source);
/// The same from a file that is open, such as a group of a pack.
Recording read_recording(const Hdf5Reader& file, const Study& study, const std::string& design_id, const Design& design,
                         const std::string& source);

/// The image that such a group was made from. @throws StoreError, MismatchError
std::string repack_recording(const Hdf5Reader& file, const std::string& source);

/// Differences of keys with the given scope or one that it depends on, one line each, empty when there are none.
std::string explain_differences(const Study& stored, const Study& given, bool recording_too);

}  // namespace drumsweep

/// The output folder of a sweep. Every file in it is whole or absent, and what was once called done never changes:
///
///   study.toml        frozen study; its first line makes the folder ours
///   warm_state.h5     warm drum, sealed; during the warm-up its last window
///   designs/ID.h5     recording of one design, sealed, written once by the rank that simulated it
///   designs/pack_NNNN.h5  about a hundred of these in one file, see recordings.h
///   designs/ID.failed why a design cannot be simulated; delete it to have it tried again
///   designs/ID.part   state inside a design that is not done, sealed; gone when it is
///   designs/ID.crashed  left by a process that died of a signal of its own at this design
///   quarantine/       designs that kill their process, to be reproduced; see casualties.h
///   results.csv       rebuilt from all of the above, never read back by a run
///   findings.toml     what searches have decided, the optimum and its error; rebuilt like the table
///   results.h5        the same for programs, with hosts and times; see results_image.h
///   provenance.csv    see provenance.h
///   run.log, lock     messages; see output_lock.h
///   *.damaged         set aside because a checksum did not match
///
/// No database and no live file: measured (cluster.md), a file that is written in place does not survive a kill.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/io/hdf5_image.h"
#include "core/io/snapshot.h"
#include "core/scene/drum.h"
#include "sweep/plan/designs.h"
#include "sweep/store/output_lock.h"

namespace drumsweep {

/// Places in the folder.
struct OutputPaths {
  std::string folder;
  std::string study() const { return folder + "/study.toml"; }
  std::string warm_state() const { return folder + "/warm_state.h5"; }
  std::string results() const { return folder + "/results.csv"; }
  std::string findings() const { return folder + "/findings.toml"; }
  std::string results_image() const { return folder + "/results.h5"; }
  std::string provenance() const { return folder + "/provenance.csv"; }
  std::string log() const { return folder + "/run.log"; }
  std::string lock() const { return folder + "/lock"; }
  std::string designs() const { return folder + "/designs"; }
  std::string recording(const std::string& id) const { return designs() + "/" + id + ".h5"; }
  std::string failure(const std::string& id) const { return designs() + "/" + id + ".failed"; }
  std::string checkpoint(const std::string& id) const { return designs() + "/" + id + ".part"; }
  std::string crash(const std::string& id) const { return designs() + "/" + id + ".crashed"; }
  std::string quarantine() const { return folder + "/quarantine"; }
};

/// A folder opened for a run: made if need be, locked, cleared of *.tmp, its frozen study brought up to date.
class Store {
 public:
  /// Nothing is changed before it is certain that the folder is ours (or empty), locked, and fits the study. Keys that
  /// only matter for the evaluation, and stages, may differ: the frozen study is then replaced.
  /// @throws MismatchError with a key-by-key difference; for a folder of something else, or of another version
  /// @throws LockHeldError, WriteError
  Store(const std::string& folder, const Study& study);

  const OutputPaths& paths() const { return paths_; }
  OutputLock& lock() { return *lock_; }
  /// What was found and changed, one sentence each.
  const std::vector<std::string>& notes() const { return notes_; }

 private:
  OutputPaths paths_;
  std::unique_ptr<OutputLock> lock_;
  std::vector<std::string> notes_;
};

/// The frozen study. @throws InputError when the folder is not a sweep's, MismatchError when it is of another version
Study read_frozen_study(const std::string& folder);

/// What is stored of one design.
struct StoredDesign {
  std::optional<Recording> recording;
  std::optional<std::string> failure;  ///< its reason; not looked for where there is a recording
};

/// One design, loose or packed; whoever reads many makes a RecordingIndex (recordings.h) once.
/// @throws StoreError (damaged), MismatchError (of another study or design)
StoredDesign read_design(const OutputPaths& paths, const Study& study, const PlannedDesign& design);
/// A recording that is a file of its own, as it is when it has just been written.
bool has_loose_recording(const OutputPaths& paths, const std::string& id);
bool has_failure(const OutputPaths& paths, const std::string& id);
/// The reason. @throws StoreError
std::string read_failure(const OutputPaths& paths, const std::string& id);

/// @throws WriteError
void write_recording(const OutputPaths& paths, const Study& study, const PlannedDesign& design,
                     const Recording& recording);
void write_failure(const OutputPaths& paths, const PlannedDesign& design, const std::string& reason);

/// The stored warm drum, or none; its bytes too when asked for. @throws StoreError, MismatchError
std::optional<WarmState> read_warm_state(const std::string& path, const Study& study, std::string* bytes = nullptr);

/// Renames PATH to PATH.damaged (over an older one); gives the sentence to say.
std::string set_aside(const std::string& path, const std::string& why);

/// Makes a folder and those above it. @throws WriteError naming path and cause
void make_folder(const std::string& path);

}  // namespace drumsweep

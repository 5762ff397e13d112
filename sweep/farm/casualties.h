/// Designs that die with their process: told from those that merely were there, tried again, and in the end put into
/// quarantine, so that one poisonous design costs a bounded number of attempts and all others complete.
///
/// A process that dies of a signal of its own leaves a note (crash_note.h), and so does one that hangs and is ended
/// (hang_watch.h): two such crashes are enough. One that was killed leaves nothing; the design is then suspected only if it
/// has not written a new checkpoint in that attempt, and five such attempts in a row are enough. Suspects are simulated
/// last. Where a rank has crashed, the others that mpirun ended with it are not suspected. All of this is remembered in
/// provenance.csv, so it holds across runs and requeues.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sweep/store/provenance.h"
#include "sweep/store/store.h"

namespace drumsweep {

inline constexpr int crashes_until_quarantine = 2;
inline constexpr int losses_until_quarantine = 5;
/// How the reason of a design in quarantine begins.
inline constexpr const char* quarantined = "quarantined: ";

class Casualties {
 public:
  Casualties(const OutputPaths& paths, const Study& study, Provenance& provenance)
      : paths_(paths), study_(study), provenance_(provenance) {}

  /// Designs that were on a rank when the last run ended: each gets its line crashed, aborted or lost. @return what to say
  std::vector<std::string> settle_last_run();
  /// The rank that had this design has died while the job goes on. @return what to say
  std::string bury(const PlannedDesign& design, int rank);

  /// Why this design is in quarantine from now on (it then has a failure file, and its input lies in quarantine/), or
  /// nothing.
  std::optional<std::string> judge(const PlannedDesign& design);
  /// Attempts in a row that were lost without getting further, 0 for less than two; suspects are simulated last.
  int suspicion(const std::string& design_id) const;

  /// Takes back failures, or quarantines, of this folder. @return what to say
  std::vector<std::string> retry(bool failed, bool lost);

 private:
  void dump(const PlannedDesign& design, const std::string& reason) const;

  const OutputPaths& paths_;
  const Study& study_;
  Provenance& provenance_;
};

}  // namespace drumsweep

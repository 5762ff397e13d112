/// provenance.csv: who simulated what, where and for how long. All that must not be in results.csv, because it differs
/// from run to run.
#pragma once

#include <string>
#include <unordered_map>
#include <vector>

namespace drumsweep {

/// One event. A design that was begun has a line "started"; what became of it follows, at the latest when the next run
/// begins.
///
///   run_begin, run_end   of a run that computes; run_end is missing where its process died
///   warm_up
///   started   handed to a rank; durable before the rank hears of it
///   done, failed, stopped
///   crashed   its process died of a signal of its own (SIGSEGV ...), see crash_note.h
///   lost      its process was gone and nothing says why (kill -9, memory, power)
///   aborted   its process was ended because another one had crashed
///   retry     the user wants it tried again: what it did before does not count any more
struct ProvenanceLine {
  std::string event;
  std::string design_id;  ///< empty for run and warm-up
  int attempt = 1;        ///< of this design, from 1
  int rank = 0;
  std::string host;
  double wall_s = 0;
  double cpu_s = 0;
  std::string time_utc;         ///< filled in by add(), to the millisecond
  std::string program_version;  ///< filled in by add()
  int ranks = 0;                ///< run_begin: of the run
};

/// What the lines say of one design.
struct DesignHistory {
  int attempts = 0;       ///< lines "started"
  bool open = false;      ///< the last of them has no end yet
  int crashes = 0;        ///< since the last "retry"
  std::vector<int> lost;  ///< attempts that were lost since the last that was not, or the last "retry"
};

/// All questions are answered from an index: 10,000 designs must not cost their square.
class Provenance {
 public:
  /// Reads what is there, for the histories; a line torn by a crash is ignored and the next one begins on a line of its
  /// own. @throws WriteError
  explicit Provenance(std::string path);
  /// Appends one line and makes it durable. @throws WriteError
  void add(ProvenanceLine line);
  /// The same for several, in this order, with one write.
  void add(std::vector<ProvenanceLine> lines);
  /// Lines "started" of this design so far.
  int attempts(const std::string& design_id) const { return history(design_id).attempts; }
  const DesignHistory& history(const std::string& design_id) const;
  /// Designs whose last attempt has no end, sorted.
  std::vector<std::string> open_designs() const;
  const std::vector<ProvenanceLine>& lines() const { return lines_; }

 private:
  void index(const ProvenanceLine& line);

  std::string path_;
  std::vector<ProvenanceLine> lines_;
  std::unordered_map<std::string, DesignHistory> histories_;
};

/// Whole lines of the file, none when there is no file.
std::vector<ProvenanceLine> read_provenance(const std::string& path);

/// Seconds since 1970 of a time_utc; NaN when it is not one.
double seconds_of(const std::string& time_utc);
double now_s();

}  // namespace drumsweep

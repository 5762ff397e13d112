/// provenance.csv: who simulated what, where and for how long. All that must not be in results.csv, because it differs
/// from run to run.
#pragma once

#include <string>
#include <vector>

namespace drumsweep {

/// One event. A run that computes has a line "run_begin", and "run_end" unless its process died. A design that was begun has a line
/// "started"; what became of it follows, unless its process died.
struct ProvenanceLine {
  std::string event;      ///< run_begin, run_end, warm_up, started, done, failed, stopped
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

class Provenance {
 public:
  /// Reads what is there, for the attempts; a line torn by a crash is ignored and the next one begins on a line of its
  /// own. @throws WriteError
  explicit Provenance(std::string path);
  /// Appends one line and makes it durable. @throws WriteError
  void add(ProvenanceLine line);
  /// Lines "started" of this design so far.
  int attempts(const std::string& design_id) const;
  const std::vector<ProvenanceLine>& lines() const { return lines_; }

 private:
  std::string path_;
  std::vector<ProvenanceLine> lines_;
};

/// Whole lines of the file, none when there is no file.
std::vector<ProvenanceLine> read_provenance(const std::string& path);

/// Seconds since 1970 of a time_utc; NaN when it is not one.
double seconds_of(const std::string& time_utc);
double now_s();

}  // namespace drumsweep

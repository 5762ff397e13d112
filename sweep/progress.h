/// What a run says while it runs: to standard error and to run.log.
#pragma once

#include <chrono>
#include <cstddef>
#include <memory>
#include <string>

#include "core/scene/drum.h"
#include "core/scene/scene.h"

namespace spdlog {
class logger;
}

namespace drumsweep {

/// How far a sweep is. All zero for a single design.
struct SweepCounts {
  std::size_t done = 0;  ///< designs with a result, failed ones included
  std::size_t total = 0;
  std::size_t done_now = 0;  ///< of these, in this run
  std::size_t running = 0;   ///< on all ranks
};

/// "0:07:30"
std::string clock_text(double seconds);

/// On a terminal: one line that is updated in place, messages above it. Otherwise plain lines, one a message and one a
/// minute, without any control character. Messages below the level in the environment variable DRUMSWEEP_LOG (trace,
/// debug, info, warn, error, off) are not shown; colour unless NO_COLOR is set.
class Reporter {
 public:
  Reporter();
  ~Reporter();
  Reporter(const Reporter&) = delete;
  Reporter& operator=(const Reporter&) = delete;

  /// Writes everything to this file too. @throws WriteError
  void log_to(const std::string& path);

  void info(const std::string& text);
  void warn(const std::string& text);
  void error(const std::string& text);

  /// To be called after every step; acts five times a second on a terminal, once a minute elsewhere.
  void update(const Progress& run, const SweepCounts& counts);
  void update(const SceneProgress& scene);
  /// The same for a rank that waits for others.
  void update_waiting(const SweepCounts& counts);
  /// Takes the bar off the terminal.
  void clear();

 private:
  using Clock = std::chrono::steady_clock;
  void say(int level, const std::string& text);
  void show(double fraction, const std::string& text);
  bool due() const;
  std::string remaining(const SweepCounts& counts, double fraction_of_running);

  std::shared_ptr<spdlog::logger> file_;
  int level_;
  bool terminal_, colour_;
  std::size_t bar_width_ = 0;  ///< characters on the terminal's current line
  Clock::time_point shown_ = Clock::now(), logged_ = Clock::now(), begin_{};
  bool begun_ = false;  ///< the first design of this run
};

}  // namespace drumsweep

/// Ends a process whose engine does not come back from a step.
#pragma once

#include <atomic>
#include <chrono>
#include <string>
#include <thread>

namespace drumsweep {

/// While the engine computes (a Watched lives, no Pause does), a thread of its own counts the time since the last sign of life;
/// after `limit_s` without one it says so on stderr and aborts the process, with "hang" in the note of the CrashNote that is alive. So a hang is dealt with as a
/// crash is. The time is counted in naps: a process that is stopped, or a computer that sleeps, does not age.
class HangWatch {
 public:
  /// Where no thread can be had it says so, and watches nothing.
  /// @param what     for people: what hangs if it does
  /// @param limit_s  0: does nothing
  HangWatch(const std::string& what, double limit_s);
  ~HangWatch();
  HangWatch(const HangWatch&) = delete;
  HangWatch& operator=(const HangWatch&) = delete;

  /// While it lives the engine computes.
  class Watched {
   public:
    explicit Watched(HangWatch& watch) : watch_(watch) {
      watch_.naps_ = 0;
      watch_.paused_ = false;
    }
    ~Watched() { watch_.paused_ = true; }
    Watched(const Watched&) = delete;
    Watched& operator=(const Watched&) = delete;

   private:
    HangWatch& watch_;
  };

  /// Between two steps: disks and other ranks may take their time. A sign of life too.
  class Pause {
   public:
    explicit Pause(HangWatch& watch) : watch_(watch) { watch_.paused_ = true; }
    ~Pause() {
      watch_.naps_ = 0;
      watch_.paused_ = false;
    }
    Pause(const Pause&) = delete;
    Pause& operator=(const Pause&) = delete;

   private:
    HangWatch& watch_;
  };

 private:
  void watch(const std::stop_token& end, const std::string& what, double limit_s);

  std::atomic<bool> paused_ = true;
  std::atomic<int> naps_ = 0;
  std::jthread thread_;  ///< last: ends before what it reads
};

}  // namespace drumsweep

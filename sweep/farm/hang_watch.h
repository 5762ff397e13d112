/// Ends a process whose engine does not come back from a step.
#pragma once

#include <atomic>
#include <string>
#include <thread>

namespace drumsweep {

/// While the engine computes (see Counting), a thread of its own counts the time since the last sign of life; after
/// `limit_s` without one it says so on stderr and aborts the process, with "hang" in the note of the CrashNote that is
/// alive. So a hang is dealt with as a crash is. The time is counted in naps: a process that is stopped, or a computer
/// that sleeps, does not age.
class HangWatch {
 public:
  /// Where no thread can be had it says so, and watches nothing.
  /// @param what     for people: what hangs if it does
  /// @param limit_s  0: does nothing
  HangWatch(const std::string& what, double limit_s);
  ~HangWatch();
  HangWatch(const HangWatch&) = delete;
  HangWatch& operator=(const HangWatch&) = delete;

  /// While it lives time counts, as the engine computes, or does not: between two steps disks and other ranks may take
  /// theirs. Begin and end are signs of life. Outside of any, time does not count.
  class Counting {
   public:
    Counting(HangWatch& watch, bool counts) : watch_(watch), before_(watch.counts_.exchange(counts)) {
      watch_.naps_ = 0;
    }
    ~Counting() {
      watch_.naps_ = 0;
      watch_.counts_ = before_;
    }
    Counting(const Counting&) = delete;
    Counting& operator=(const Counting&) = delete;

   private:
    HangWatch& watch_;
    bool before_;
  };

 private:
  void watch(const std::stop_token& end, const std::string& what, double limit_s);

  std::atomic<bool> counts_ = false;
  std::atomic<int> naps_ = 0;
  std::jthread thread_;  ///< last: ends before what it reads
};

}  // namespace drumsweep

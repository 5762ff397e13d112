#include "sweep/farm/hang_watch.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <system_error>

#include "sweep/farm/crash_note.h"

namespace drumsweep {
namespace {

/// Signals go to the other threads: a wait there must be woken by them.
class AllSignalsBlocked {
 public:
  AllSignalsBlocked() {
    sigset_t all;
    ::sigfillset(&all);
    ::pthread_sigmask(SIG_SETMASK, &all, &before_);
  }
  ~AllSignalsBlocked() { ::pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  AllSignalsBlocked(const AllSignalsBlocked&) = delete;
  AllSignalsBlocked& operator=(const AllSignalsBlocked&) = delete;

 private:
  sigset_t before_{};
};

}  // namespace

HangWatch::HangWatch(const std::string& what, double limit_s) {
  if (limit_s <= 0) return;
  const AllSignalsBlocked inherited_by_the_thread;
  try {
    thread_ = std::jthread([this, what, limit_s](const std::stop_token& end) { watch(end, what, limit_s); });
  } catch (const std::system_error& error) {
    fmt::print(stderr, "drumsweep: {}: a hang would not be noticed: {}\n", what, error.what());
  }
}

HangWatch::~HangWatch() = default;

void HangWatch::watch(const std::stop_token& end, const std::string& what, double limit_s) {
  const std::chrono::duration<double> nap(std::min(1.0, limit_s / 10));
  std::mutex mutex;
  std::condition_variable_any ended;
  std::unique_lock lock(mutex);
  while (!ended.wait_for(lock, end, nap, [&] { return end.stop_requested(); })) {
    if (!counts_ || ++naps_ * nap.count() < limit_s) continue;
    fmt::print(stderr, "drumsweep: {}: no step for {:g} s: it hangs. This process is ended (--hang)\n", what, limit_s);
    std::fflush(stderr);
    abort_as_hang();
  }
}

}  // namespace drumsweep

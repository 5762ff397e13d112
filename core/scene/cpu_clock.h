/// CPU time, for what a run cost.
#pragma once

#include <ctime>

namespace drumsweep {

inline double cpu_seconds(clockid_t clock) {
  timespec t{};
  ::clock_gettime(clock, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// Of the calling thread; of a run with several threads that of the process, which then runs nothing else.
inline double cpu_seconds_of_run(int threads) {
  return cpu_seconds(threads > 1 ? CLOCK_PROCESS_CPUTIME_ID : CLOCK_THREAD_CPUTIME_ID);
}

}  // namespace drumsweep

/// Threads of one simulation, over OpenMP. What runs in parallel writes to disjoint places, so results do not depend on their number.
#pragma once

#include <cstddef>

namespace drumsweep {

/// Calls task(i) for i in [0, num) on up to `threads` threads, each i once, in no particular order.
/// An exception must not leave task.
template <class Task>
void parallel_for(int threads, std::size_t num, Task&& task) {
  if (threads <= 1 || num <= 1) {
    for (std::size_t i = 0; i < num; ++i) task(i);
    return;
  }
#pragma omp parallel for num_threads(threads) schedule(dynamic)
  for (std::size_t i = 0; i < num; ++i) task(i);
}

/// As parallel_for(), over ranges: task(begin, end) with end - begin at most `chunk`.
template <class Task>
void parallel_ranges(int threads, std::size_t num, std::size_t chunk, Task&& task) {
  parallel_for(threads, (num + chunk - 1) / chunk,
               [&](std::size_t i) { task(i * chunk, num < (i + 1) * chunk ? num : (i + 1) * chunk); });
}

/// Cores that this process may run on.
int available_threads();

/// Number of the calling thread within parallel_for, for scratch memory: 0 outside.
int thread_number();

}  // namespace drumsweep

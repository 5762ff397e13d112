#include "core/parallel/parallel_for.h"

#include <omp.h>

namespace drumsweep {

int available_threads() { return omp_get_num_procs(); }

int thread_number() { return omp_get_thread_num(); }

}  // namespace drumsweep

#include "postproc/spectrum.h"

#include <fftw3.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>
#include <new>

namespace drumsweep {
namespace {

/// The one thing that outlives a call: a lock around FFTW's process-wide planner. It remembers no result.
std::mutex& planner_lock() {
  static std::mutex lock;
  return lock;
}

struct FftwFree {
  void operator()(void* memory) const { fftw_free(memory); }
};

}  // namespace

std::vector<double> amplitudes(std::span<const double> values) {
  if (values.empty()) return {};
  const std::size_t num_modes = values.size() / 2 + 1;

  // FFTW's own memory: the same alignment, hence the same plan, in every call.
  std::unique_ptr<double, FftwFree> input(fftw_alloc_real(values.size()));
  std::unique_ptr<fftw_complex, FftwFree> output(fftw_alloc_complex(num_modes));
  if (!input || !output) throw std::bad_alloc();
  std::copy(values.begin(), values.end(), input.get());

  fftw_plan plan = nullptr;
  {
    const std::lock_guard<std::mutex> guard(planner_lock());
    plan = fftw_plan_dft_r2c_1d(static_cast<int>(values.size()), input.get(), output.get(),
                                FFTW_ESTIMATE | FFTW_PRESERVE_INPUT | FFTW_NO_SIMD);
  }
  if (plan == nullptr) throw std::bad_alloc();
  fftw_execute(plan);
  {
    const std::lock_guard<std::mutex> guard(planner_lock());
    fftw_destroy_plan(plan);
  }

  std::vector<double> moduli(num_modes);
  for (std::size_t n = 0; n < num_modes; ++n) {
    // sqrt and not hypot: correctly rounded on every machine.
    const double real = output.get()[n][0], imaginary = output.get()[n][1];
    moduli[n] = std::sqrt(real * real + imaginary * imaginary);
  }
  return moduli;
}

}  // namespace drumsweep

/// This machine's speed on the steady lab drum.
#pragma once

#include "core/scene/drum.h"
#include "core/step/memory.h"

namespace drumsweep {

struct BenchOptions {
  std::int64_t balls = 34500;  ///< about; the full lab drum holds this many when it is steady
  std::int64_t steps = 200;    ///< outer steps that are timed
  double settle_turns = 2.5;   ///< before
  int threads = 1;
};

struct BenchResult {
  double balls = 0, contacts = 0, pressed = 0;  ///< means over the timed steps; contacts: rows that the solver visits
  double time_step_s = 0;
  double simulated_s = 0, cpu_s = 0, wall_s = 0;
  std::array<double, static_cast<std::size_t>(Phase::count)> phase_s{};
  StepReport quality;
  MemoryUse memory;
  std::uint64_t hash = 0;
  Study study;  ///< the drum that was run: lab drum, its length cut to the number of balls

  double cpu_s_per_1k_balls_per_sim_s() const { return cpu_s / (1e-3 * balls * simulated_s); }
  double ns_per_contact_iteration() const;
};

/// @param base  the lab drum, with the solver settings to measure
/// @throws InputError when the number of balls is too small for a drum of that load
BenchResult run_bench(const Study& base, const BenchOptions& options, const Observer& observer);

}  // namespace drumsweep

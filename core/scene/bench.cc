#include "core/scene/bench.h"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <ctime>

#include "core/config/schema.h"
#include "core/step/step_report.h"

namespace drumsweep {

double BenchResult::ns_per_contact_iteration() const {
  const double visits = contacts * static_cast<double>(study.solver.iterations) * simulated_s /
                        (study.solver.outer_step_s / static_cast<double>(study.solver.sub_steps));
  return 1e9 * phase_s[static_cast<std::size_t>(Phase::solve)] / visits;
}

BenchResult run_bench(const Study& base, const BenchOptions& options, const Observer& observer) {
  // Equal load: as many balls per length as the full drum, so only its length changes.
  BenchResult out;
  out.study = base;
  const double full = static_cast<double>(BenchOptions{}.balls);
  out.study.drum.length_m = base.drum.length_m * static_cast<double>(options.balls) / full;
  if (out.study.drum.length_m < 0.15)
    throw InputError(fmt::format(
        "--balls {}: accepted is {:.0f} and more (a drum of the lab's load shorter than 0.15 m is all end plate)",
        options.balls, std::ceil(full * 0.15 / base.drum.length_m)));
  out.study.feed.zone_length_m = std::min(base.feed.zone_length_m, 0.5 * out.study.drum.length_m);
  validate(out.study);

  const DrumModel model(out.study, out.study.outlet);
  DrumState state = filled_drum(model, options.balls);
  Workspace work;
  const std::int64_t settle = steps_for_turns(model, options.settle_turns), last = settle + options.steps;
  const auto watch = [&](const char* what) {
    return !observer || observer({what, time_of(model, state.num_steps) / model.seconds_per_turn(),
                                  time_of(model, last) / model.seconds_per_turn(), time_of(model, state.num_steps),
                                  state.balls.size()});
  };
  while (state.num_steps < settle) {
    advance(model, state, work);
    if (!watch("settling")) return out;
  }

  ReportMean quality;
  work.phase_s = {};
  const auto wall_begin = std::chrono::steady_clock::now();
  const std::clock_t cpu_begin = std::clock();
  while (state.num_steps < last) {
    const StepReport report = advance(model, state, work);
    quality.add(report);
    out.balls += static_cast<double>(state.balls.size()) / static_cast<double>(options.steps);
    if (!watch("timing")) return out;
  }
  out.cpu_s = static_cast<double>(std::clock() - cpu_begin) / CLOCKS_PER_SEC;
  out.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - wall_begin).count();
  out.simulated_s = static_cast<double>(options.steps) * out.study.solver.outer_step_s;
  out.quality = quality.mean();
  out.contacts = static_cast<double>(out.quality.num_rows);
  out.pressed = static_cast<double>(out.quality.num_contacts);
  out.phase_s = work.phase_s;
  out.memory = memory_use(model, state, work);
  out.hash = state_hash(state);
  return out;
}

}  // namespace drumsweep

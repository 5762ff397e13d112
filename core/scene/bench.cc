#include "core/scene/bench.h"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <ctime>

#include "core/config/schema.h"
#include "core/step/step_report.h"

namespace drumsweep {
namespace {

// Measured in the steady lab drum at 10 ms x 25 iterations: 34 571 balls, of them 5982 in the outlet and below it.
constexpr std::int64_t balls_in_outlet = 6000;
constexpr double balls_per_metre = 11436;

}  // namespace

double BenchResult::ns_per_contact_iteration() const {
  const double visits = contacts * quality.iterations * simulated_s / time_step_s;
  return 1e9 * phase_s[static_cast<std::size_t>(Phase::solve)] / visits;
}

BenchResult run_bench(const Study& base, const BenchOptions& options, const Observer& observer) {
  BenchResult out;
  // Equal load: as many balls per length of the drum as in the full one; the outlet always holds as many.
  out.study = base;
  out.study.drum.length_m = static_cast<double>(options.balls - balls_in_outlet) / balls_per_metre;
  if (out.study.drum.length_m < 0.2)
    throw InputError(fmt::format(
        "--balls {}: accepted is {:.0f} and more (the outlet holds {}, and a drum shorter than 0.2 m is all end plate)",
        options.balls, balls_in_outlet + 0.2 * balls_per_metre, balls_in_outlet));
  out.study.feed.zone_length_m = std::min(base.feed.zone_length_m, 0.5 * out.study.drum.length_m);
  validate(out.study);

  const DrumModel model(out.study, out.study.outlet);
  out.time_step_s = model.world.time_step;
  // What the feed brings until the outlet runs full comes on top of the first filling.
  DrumState state = filled_drum(model, options.balls - balls_in_outlet);
  DrumWorkspace work;
  work.threads = options.threads;
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
  // As a design's run begins: with the scratch of a steady drum, not of one that was just filled.
  work = DrumWorkspace{};
  work.threads = options.threads;
  state.pairs.shrink_to_fit();
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

#include "core/scene/drum.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/config/schema.h"
#include "core/geometry/random.h"
#include "core/scene/cpu_clock.h"
#include "core/step/belt.h"
#include "core/step/step_report.h"

namespace drumsweep {
bool warm_up(const Study& study, WarmState& warm, const Observer& observer,
             const std::function<void(const WarmState&)>& save, int threads) {
  Study first = study;
  first.record.replicate = 0;  // replicates start from one warm drum
  const DrumModel model(first, warmup_outlet(study));
  const WarmupConfig& config = study.warmup;
  DrumWorkspace work;
  work.threads = threads;
  while (!warm.finished) {
    // One window; its end is counted from the empty drum, so windows do not depend on interruptions.
    const double end = config.window_turns * static_cast<double>(warm.windows.size() + 1);
    if (end > config.max_turns) {
      warm.finished = true;
      break;
    }
    const std::int64_t last = steps_for_turns(model, end);
    while (warm.state.num_steps < last) {
      advance(model, warm.state, work);
      const double time = time_of(model, warm.state.num_steps);
      if (observer &&
          !observer({"warm-up", time / model.seconds_per_turn(), config.max_turns, time, warm.state.balls.size()}))
        return false;
    }
    // What came and went before this window is in the earlier ones, so that it may begin in another process.
    WarmupWindow window{end, warm.state.counts.fed, warm.state.counts.landed + warm.state.counts.spilled,
                        static_cast<std::int64_t>(warm.state.balls.size())};
    for (const WarmupWindow& earlier : warm.windows) {
      window.fed -= earlier.fed;
      window.left -= earlier.left;
    }
    warm.windows.push_back(window);

    // Steady: the last `windows` of them all balance.
    const auto balances = [&](const WarmupWindow& w) {
      return w.fed > 0 &&
             std::abs(static_cast<double>(w.fed - w.left)) <= config.tolerance * static_cast<double>(w.fed);
    };
    const auto needed = static_cast<std::ptrdiff_t>(config.windows);
    warm.steady = static_cast<std::ptrdiff_t>(warm.windows.size()) >= needed &&
                  std::all_of(warm.windows.end() - needed, warm.windows.end(), balances);
    warm.finished = warm.steady || end + config.window_turns > config.max_turns;
    if (save) save(warm);
  }
  return true;
}

Study study_of_design(const Study& study, const Design& design) {
  Study out = study;
  out.stages.clear();  // they were validated with the study, and there may be a million designs
  for (const auto& [key, value] : design) set_number(out, key, value);
  validate(out);
  return out;
}

Recording continue_design(const Study& base, const DrumState& warm, const Design& design, DesignProgress& progress,
                          const Observer& observer, int threads) {
  const double cpu_begin = cpu_seconds_of_run(threads);
  const Study study = study_of_design(base, design);
  const DrumModel model(study, study.outlet);
  DrumState& state = progress.state;
  if (!progress.begun) {
    state = warm;
    adopt_outlet(model, state);
    progress.begun = true;
  }

  Recording out;
  DrumWorkspace work;
  work.threads = threads;
  const double turns = study.record.adapt_turns + study.record.turns;
  const std::int64_t first = warm.num_steps, recorded = first + steps_for_turns(model, study.record.adapt_turns);
  // Rounded up, so that the window of the objective is filled; what lands after it does not count.
  const auto last = recorded + static_cast<std::int64_t>(std::ceil(
                                   study.record.turns * model.seconds_per_turn() / study.solver.outer_step_s - 1e-9));
  out.begin_s = time_of(model, recorded);
  out.turns = study.record.turns;
  while (state.num_steps < last && !out.stopped) {
    const bool recording = state.num_steps >= recorded;
    const StepReport report = advance(model, state, work, recording ? &progress.landings : nullptr);
    if (recording) {
      progress.quality.add(report);
      for (const double value : {report.residual.mean, report.residual.max, report.overlap_95, report.max_overlap,
                                 report.force_balance, report.iterations})
        progress.quality_of_steps.push_back(static_cast<float>(value));
    }
    const double done = (time_of(model, state.num_steps) - time_of(model, first)) / model.seconds_per_turn();
    out.stopped = observer && !observer({recording ? "recording" : "adapting", done, turns,
                                         time_of(model, state.num_steps), state.balls.size()});
  }
  // Stopped between two steps the run is not over: `progress` keeps what it has.
  if (out.stopped) return out;
  out.landings = std::move(progress.landings);
  out.quality_of_steps = std::move(progress.quality_of_steps);
  out.counts = state.counts;
  out.inside = static_cast<std::int64_t>(state.balls.size());
  out.lost = state.counts.removed - warm.counts.removed;
  out.feed_debt_kg = state.feed_debt_kg;
  out.quality = progress.quality.mean();
  out.hash = state_hash(state);
  out.cpu_s = cpu_seconds_of_run(threads) - cpu_begin;
  return out;
}

Recording run_design(const Study& study, const DrumState& warm, const Design& design, const Observer& observer,
                     int threads, DrumState* final_state) {
  DesignProgress progress;
  Recording out = continue_design(study, warm, design, progress, observer, threads);
  if (final_state != nullptr) *final_state = std::move(progress.state);
  return out;
}

DrumState filled_drum(const DrumModel& model, std::int64_t num_balls) {
  const Study& study = model.study;
  const double r = model.world.largest_radius, spacing = 2.02 * r,
               free_radius = 0.5 * study.drum.diameter_m - model.wall.highest_bump - 1.01 * r;
  const Eigen::Vector3d origin(0, study.belt.outlet_begin_m, 0), along = model.tilt.col(2), up = -model.tilt.col(1);

  // Layers of a square lattice from the bottom up; each layer is a rectangle across and along.
  DrumState state;
  const auto num_along = static_cast<std::int64_t>((study.drum.length_m - 3 * r) / spacing);
  for (double height = -free_radius; height < -r && state.counts.fed < num_balls; height += spacing) {
    const double half_width = std::sqrt(std::max(0.0, free_radius * free_radius - height * height));
    const auto num_across = static_cast<std::int64_t>(2 * half_width / spacing);
    for (std::int64_t i = 0; i < num_along * num_across && state.counts.fed < num_balls; ++i) {
      const double s = -study.drum.length_m + 1.5 * r + spacing * static_cast<double>(i / num_across);
      const double x = (static_cast<double>(i % num_across) - 0.5 * static_cast<double>(num_across - 1)) * spacing;
      // Moved a little, within the slack of the lattice, so that rows do not stand on each other.
      const auto shake = uniform4(study.seed, Purpose::fill, static_cast<std::uint64_t>(state.counts.fed));
      const Eigen::Vector3d at = origin + along * (s + 0.02 * r * (shake[0] - 0.5)) + up * height +
                                 Eigen::Vector3d(x + 0.02 * r * (shake[1] - 0.5), 0, 0);
      const auto id = static_cast<std::uint32_t>(state.counts.fed++);
      state.balls.add(at, model.world.radius_of(id), id);
    }
  }
  if (state.counts.fed < num_balls)
    throw InputError(fmt::format("{} balls do not fit below the axis of the drum; {} do", num_balls, state.counts.fed));
  return state;
}

double kinetic_energy(const DrumModel& model, const DrumState& state) {
  double sum = 0;
  const Balls& balls = state.balls;
  for (std::size_t i = 0; i < balls.size(); ++i)
    sum += 0.5 / model.world.inverse_mass(balls.radius[i]) *
           (balls.velocity[i].squaredNorm() + 0.4 * balls.radius[i] * balls.radius[i] * balls.spin[i].squaredNorm());
  return sum;
}

}  // namespace drumsweep

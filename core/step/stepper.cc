#include "core/step/stepper.h"

#include <algorithm>
#include <chrono>

#include "core/solver/projected_gauss_seidel.h"
#include "core/step/belt.h"
#include "core/step/step_report.h"

namespace drumsweep {
namespace {

/// Adds the time since the last call to a phase.
struct PhaseClock {
  Workspace& work;
  std::chrono::steady_clock::time_point last = std::chrono::steady_clock::now();
  void done(Phase phase) {
    const auto now = std::chrono::steady_clock::now();
    work.phase_s[static_cast<std::size_t>(phase)] += std::chrono::duration<double>(now - last).count();
    last = now;
  }
};

}  // namespace

StepReport advance(const DrumModel& model, DrumState& state, Workspace& work, std::vector<Landing>* landings) {
  const Study& study = model.study;
  const double h = model.time_step, begin = time_of(model, state.num_steps);
  StepReport report;
  PhaseClock clock{work};

  feed_balls(model, state, work.feed);
  clock.done(Phase::feed);

  // Contact search, once for all sub-steps: pairs and triangles that may touch before the next one.
  sort_and_find_pairs(model.search, state, work.pair_search);
  find_wall_candidates(model, state.balls, model.pose(begin), work.candidates);
  work.gone.assign(state.balls.size(), 0);
  clock.done(Phase::search);

  for (std::int64_t sub = 0; sub < study.solver.sub_steps; ++sub) {
    const double time = begin + static_cast<double>(sub) * h;
    const Pose pose = model.pose(time);

    // Gaps, normals and biases from the state at the beginning of the step; then free fall.
    assemble_rows(model, state, work.candidates, pose, work.assembly);
    for (Eigen::Vector3d& v : state.balls.velocity) v[2] -= gravity * h;
    load_velocities(model, state.balls, work.assembly);
    clock.done(Phase::assemble);

    // Impulses that satisfy contact and friction at the end of the step.
    apply_impulses(work.assembly.problem, work.assembly.impulse, work.assembly.velocity);
    solve(work.assembly.problem, static_cast<int>(study.solver.iterations), work.assembly.impulse,
          work.assembly.velocity);
    clock.done(Phase::solve);

    if (sub + 1 == study.solver.sub_steps) report = make_report(model, state, work);
    clock.done(Phase::report);

    // Advance with the new velocities; note exits and landings.
    store_result(pose, work.assembly, state);
    for (std::size_t i = 0; i < state.balls.size(); ++i) state.balls.position[i] += h * state.balls.velocity[i];
    record_exits_and_landings(model, model.pose(time + h), time + h, state, work.gone, landings);
    clock.done(Phase::move);
  }
  drop_gone(state, work.gone);
  ++state.num_steps;
  return report;
}

}  // namespace drumsweep

#include "core/step/stepper.h"

#include <algorithm>
#include <chrono>
#include <numbers>

#include "core/effects/air_drag.h"
#include "core/parallel/parallel_for.h"
#include "core/solver/projected_gauss_seidel.h"
#include "core/step/step_report.h"

namespace drumsweep {
namespace {

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

// iterations = "auto" looks at the residual after this many passes.
constexpr int passes_between_looks = 10;

constexpr double far_away = 1e4;  // [m]

int impact_iterations(const World& world) {
  constexpr int with_auto = 30;
  const auto asked = static_cast<int>(world.physics.solver.iterations);
  return asked > 0 ? asked : with_auto;
}

/// Places the walls that are there; one that was removed is far away.
void place_walls(const World& world, double time, std::vector<Pose>& poses) {
  poses.clear();
  for (const Wall& wall : world.walls) {
    poses.push_back(wall.motion.pose(time));
    if (time >= wall.removed_at) poses.back().origin += Eigen::Vector3d::Constant(far_away);
  }
}

/// Gravity and air drag.
void fall_freely(const World& world, const Workspace& work, Balls& balls) {
  const double h = world.time_step;
  const EffectsConfig& effects = world.physics.effects;
  const double drag = 0.5 * effects.air_density_kg_m3 * effects.drag_coefficient * std::numbers::pi;
  const Eigen::Vector3d fall = world.gravity_vector * h;
  parallel_ranges(work.threads, balls.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (work.inverse_mass[i] == 0) continue;
      balls.velocity[i] += fall;
      if (drag > 0)
        balls.velocity[i] = slowed_by_air(drag, balls.radius[i], work.inverse_mass[i], balls.velocity[i], h);
    }
  });
}

/// @return iterations done
int solve_rows(const SolverConfig& config, int threads, Assembly& a) {
  apply_impulses(a.problem, threads, a.velocity);
  if (config.iterations > 0) {
    solve(a.problem, static_cast<int>(config.iterations), threads, a.velocity);
    return static_cast<int>(config.iterations);
  }
  int done = 0;
  do {
    const int passes = std::min(passes_between_looks, static_cast<int>(config.max_iterations) - done);
    solve(a.problem, passes, threads, a.velocity);
    done += passes;
  } while (done < config.max_iterations &&
           natural_map_residual(a.problem, threads, a.velocity).mean > config.residual_target_m_s);
  return done;
}

}  // namespace

StepReport advance(const World& world, BallState& state, Workspace& work, const AfterMove& after_move) {
  const double h = world.time_step, begin = time_of(world, state.num_steps);
  const bool smooth = world.physics.step.method == "smooth";
  Balls& balls = state.balls;
  Assembly& contacts = work.assembly;
  StepReport report;
  PhaseClock clock(work);

  // Contact search, once for all sub-steps: pairs and triangles that may touch before the next one.
  place_walls(world, begin, work.poses);
  find_contacts(world, work.poses, work.threads, state, work.inverse_mass, contacts);
  if (smooth) list_smooth_contacts(world, contacts, state, work.smooth);
  clock.done(Phase::search);

  for (std::int64_t sub = 0; sub < world.sub_steps; ++sub) {
    const bool last = sub + 1 == world.sub_steps;
    const double time = begin + static_cast<double>(sub) * h;
    place_walls(world, time, work.poses);

    if (smooth) {
      // Forces of pressed contacts, explicitly.
      apply_smooth_forces(world, work.inverse_mass, work.poses, state, work.smooth);
      fall_freely(world, work, balls);
      move_freely(h, balls);
      clock.done(Phase::solve);
      if (last) report = make_smooth_report(world, work.smooth, work.overlaps);
    } else {
      // Gaps, normals and biases from the state at the beginning of the step; impacts; then free fall.
      load_velocities(balls, work.inverse_mass, work.threads, contacts);
      make_rows(world, balls, work.poses, work.threads, contacts);
      if (contacts.any_impact()) {
        resolve_impacts(world, impact_iterations(world), work.threads, contacts, work.impacts, balls);
        // What rebounds meets others than what approached: without rows for these it runs into them, and flies apart.
        load_velocities(balls, work.inverse_mass, work.threads, contacts);
        make_rows(world, balls, work.poses, work.threads, contacts);
      }
      fall_freely(world, work, balls);
      load_velocities(balls, work.inverse_mass, work.threads, contacts);
      clock.done(Phase::assemble);

      // Impulses that satisfy contact, friction and resistance to rolling at the end of the step.
      const int iterations = solve_rows(world.physics.solver, work.threads, contacts);
      clock.done(Phase::solve);
      if (last) report = make_report(world, balls, work, iterations);
      clock.done(Phase::report);

      // Advance with the new velocities.
      store_velocities(contacts, h, work.threads, balls);
      keep_wall_impulses(world, work.poses, work.threads, contacts);
      if (last) store_impulses(contacts, state);
    }
    if (after_move) after_move(time + h);
    clock.done(Phase::move);
  }
  ++state.num_steps;
  return report;
}

PhaseClock::PhaseClock(Workspace& work) : work_(work), last_(now()) {}

void PhaseClock::done(Phase phase) {
  const double time = now();
  work_.phase_s[static_cast<std::size_t>(phase)] += time - last_;
  last_ = time;
}

}  // namespace drumsweep

#include "core/step/stepper.h"

#include <algorithm>
#include <chrono>
#include <numbers>

#include "core/effects/air_drag.h"
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

void list_inverse_masses(const World& world, const Balls& balls, std::vector<double>& out) {
  out.resize(balls.size());
  for (std::size_t i = 0; i < balls.size(); ++i)
    out[i] = balls.exit[i] == static_cast<std::uint8_t>(Exit::fixed) ? 0 : world.inverse_mass(balls.radius[i]);
}

/// Places the walls that are there; one that was removed is far away.
void place_walls(const World& world, double time, std::vector<Pose>& poses) {
  poses.clear();
  for (const Wall& wall : world.walls) {
    poses.push_back(wall.motion.pose(time));
    if (time >= wall.removed_at) poses.back().origin += Eigen::Vector3d::Constant(far_away);
  }
}

/// Gravity, cohesion and air drag.
void fall_freely(const World& world, const Workspace& work, Balls& balls) {
  const double h = world.time_step;
  const EffectsConfig& effects = world.physics.effects;
  const double drag = 0.5 * effects.air_density_kg_m3 * effects.drag_coefficient * std::numbers::pi;
  for (std::size_t i = 0; i < balls.size(); ++i) {
    if (work.inverse_mass[i] == 0) continue;
    balls.velocity[i] += world.gravity_vector * h;
    if (!work.assembly.attracted.empty())
      balls.velocity[i] += work.assembly.attracted[i].cast<double>() * work.inverse_mass[i];
    if (drag > 0) balls.velocity[i] = slowed_by_air(drag, balls.radius[i], work.inverse_mass[i], balls.velocity[i], h);
  }
}

/// @return iterations done
int solve_rows(const SolverConfig& config, Assembly& a) {
  apply_impulses(a.problem, a.impulse, a.turn, a.velocity);
  if (config.iterations > 0) {
    solve(a.problem, static_cast<int>(config.iterations), a.impulse, a.turn, a.velocity);
    return static_cast<int>(config.iterations);
  }
  int done = 0;
  do {
    const int passes = std::min(passes_between_looks, static_cast<int>(config.max_iterations) - done);
    solve(a.problem, passes, a.impulse, a.turn, a.velocity);
    done += passes;
  } while (done < config.max_iterations &&
           natural_map_residual(a.problem, a.impulse, a.turn, a.velocity).mean > config.residual_target_m_s);
  return done;
}

}  // namespace

StepReport advance(const World& world, BallState& state, Workspace& work, const AfterMove& after_move) {
  const double h = world.time_step, begin = time_of(world, state.num_steps);
  const bool smooth = world.physics.step.method == "smooth";
  Balls& balls = state.balls;
  StepReport report;
  PhaseClock clock(work);

  // Contact search, once for all sub-steps: pairs and triangles that may touch before the next one.
  sort_and_find_pairs(world.search, state, work.pair_search);
  list_inverse_masses(world, balls, work.inverse_mass);
  place_walls(world, begin, work.poses);
  find_wall_candidates(world, balls, work.inverse_mass, work.poses, work.candidates);
  clock.done(Phase::search);

  for (std::int64_t sub = 0; sub < world.sub_steps; ++sub) {
    const bool last = sub + 1 == world.sub_steps;
    const double time = begin + static_cast<double>(sub) * h;
    place_walls(world, time, work.poses);

    if (smooth) {
      // Forces of pressed contacts, explicitly.
      apply_smooth_forces(world, work.inverse_mass, work.candidates, work.poses, state, work.smooth);
      fall_freely(world, work, balls);
      clock.done(Phase::solve);
      if (last) report = make_smooth_report(world, work.smooth, work.pressed);
    } else {
      // Gaps, normals and biases from the state at the beginning of the step; impacts; then free fall.
      assemble_rows(world, state, work.inverse_mass, work.candidates, work.poses, work.assembly);
      if (work.assembly.impacts) {
        resolve_impacts(world, impact_iterations(world), work.inverse_mass, work.assembly, state);
        // What rebounds meets others than what approached: without rows for these it runs into them, and flies apart.
        assemble_rows(world, state, work.inverse_mass, work.candidates, work.poses, work.assembly);
      }
      fall_freely(world, work, balls);
      load_velocities(balls, work.inverse_mass, work.assembly);
      clock.done(Phase::assemble);

      // Impulses that satisfy contact, friction and resistance to rolling at the end of the step.
      const int iterations = solve_rows(world.physics.solver, work.assembly);
      clock.done(Phase::solve);
      if (last) report = make_report(world, state, work, iterations);
      clock.done(Phase::report);
      store_velocities(work.assembly, balls);
      store_impulses(work.poses, work.assembly, state);
    }

    // Advance with the new velocities.
    for (std::size_t i = 0; i < balls.size(); ++i) balls.position[i] += h * balls.velocity[i];
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

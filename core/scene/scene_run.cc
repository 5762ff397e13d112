#include "core/scene/scene_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/effects/catalogue.h"
#include "core/geometry/random.h"
#include "core/scene/cpu_clock.h"

namespace drumsweep {
SceneRun::SceneRun(World w, const SceneObserver& observer, const Eigen::Vector3d& box_low,
                   const Eigen::Vector3d& box_high)
    : world(std::move(w)), observer_(observer), low_(box_low), high_(box_high) {}

bool SceneRun::step(const char* what, double planned_end_s) {
  if (stopped_) return false;
  work_.threads = threads;
  if (state.num_steps == 0) cpu_begin_ = cpu_seconds_of_run(threads);
  report_ = advance(world, state, work_, after_move);
  quality_.add(report_);
  lost_ += static_cast<std::int64_t>(remove([&](std::size_t i) {
    const Eigen::Vector3d& p = state.balls.position[i];
    const bool inside = (p.array() >= low_.array()).all() && (p.array() <= high_.array()).all();
    return !(inside && state.balls.velocity[i].allFinite() && state.balls.spin[i].allFinite());
  }));
  stopped_ = observer_ && !observer_({what, time(), planned_end_s, state.balls.size()});
  return !stopped_;
}

bool SceneRun::run_until(const char* what, double time_s, const std::function<bool()>& done) {
  const double half = 0.5 * world.physics.solver.outer_step_s;
  while (!stopped_ && time() < time_s - half) {
    if (!step(what, time_s)) break;
    if (done && done()) break;
  }
  return !stopped_;
}

void SceneRun::add(const Eigen::Vector3d& at, const Eigen::Vector3d& velocity) {
  state.balls.add(at, world.radius_of(next_id_), next_id_);
  state.balls.velocity.back() = velocity;
  ++next_id_;
  ++num_added_;
}

void SceneRun::add_fixed(const Eigen::Vector3d& at, double radius) {
  state.balls.add(at, radius, next_id_++);
  state.balls.exit.back() = static_cast<std::uint8_t>(Exit::fixed);
}

std::size_t SceneRun::remove(const std::function<bool(std::size_t)>& gone) {
  std::vector<char> marked(state.balls.size(), 0);
  std::size_t num = 0;
  for (std::size_t i = 0; i < marked.size(); ++i)
    if (gone(i)) {
      marked[i] = 1;
      ++num;
    }
  drop_gone(state, marked);
  return num;
}

double SceneRun::kinetic_energy() const {
  double sum = 0;
  const Balls& b = state.balls;
  for (std::size_t i = 0; i < b.size(); ++i)
    if (b.exit[i] != static_cast<std::uint8_t>(Exit::fixed))
      sum += 0.5 / world.inverse_mass(b.radius[i]) *
             (b.velocity[i].squaredNorm() + 0.4 * b.radius[i] * b.radius[i] * b.spin[i].squaredNorm());
  return sum;
}

double SceneRun::fastest() const {
  double most = 0;
  for (const Eigen::Vector3d& v : state.balls.velocity) most = std::max(most, v.norm());
  return most;
}

Eigen::Vector3d SceneRun::wall_force(std::size_t w) const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  // The smooth step keeps forces, the nonsmooth one impulses.
  const double per_time = world.physics.step.method == "smooth" ? 1 : 1 / world.time_step;
  if (w >= work_.poses.size()) return sum;
  for (const WallImpulse& p : state.walls)
    if (p.wall == w)
      sum += work_.poses[w].rotation *
             (static_cast<double>(p.normal) * Eigen::Vector3d(p.direction[0], p.direction[1], p.direction[2]) +
              Eigen::Vector3d(p.tangent[0], p.tangent[1], p.tangent[2]));
  return per_time * sum;
}

SceneResult SceneRun::finish() {
  SceneResult out;
  out.simulated_s = time();
  for (const Wall& wall : world.walls)
    if (time() < wall.removed_at) out.walls.push_back(placed(wall.mesh, wall.motion.pose(time())));
  out.state = std::move(state);
  out.quality = quality_.mean();
  out.num_balls = num_added_;
  out.lost = lost_;
  out.cpu_s = cpu_seconds_of_run(threads) - cpu_begin_;
  out.stopped = stopped_;
  return out;
}

std::vector<Eigen::Vector3d> lattice(const Eigen::Vector3d& low, const Eigen::Vector3d& high, double radius,
                                     std::int64_t seed, const std::function<bool(const Eigen::Vector3d&)>& keep) {
  std::vector<Eigen::Vector3d> out;
  const double cell = 2.04 * radius, slack = 0.02 * radius;
  const Eigen::Vector3d room = high - low;
  const auto count = [&](int k) { return static_cast<std::int64_t>(std::floor(room[k] / cell + 1e-9)); };
  const std::int64_t nx = count(0), ny = count(1), nz = count(2);
  // Rows are spread over the box, so that a periodic direction closes without a gap.
  const Eigen::Vector3d step(room[0] / static_cast<double>(std::max<std::int64_t>(1, nx)),
                             room[1] / static_cast<double>(std::max<std::int64_t>(1, ny)), cell);
  std::uint64_t index = 0;
  for (std::int64_t z = 0; z < nz; ++z)
    for (std::int64_t y = 0; y < ny; ++y)
      for (std::int64_t x = 0; x < nx; ++x) {
        const auto shake = uniform4(seed, Purpose::fill, index++);
        const Eigen::Vector3d at =
            low + Eigen::Vector3d((static_cast<double>(x) + 0.5) * step[0] + slack * (2 * shake[0] - 1),
                                  (static_cast<double>(y) + 0.5) * step[1] + slack * (2 * shake[1] - 1),
                                  (static_cast<double>(z) + 0.5) * step[2] + slack * (2 * shake[2] - 1));
        if (!keep || keep(at)) out.push_back(at);
      }
  return out;
}

void refuse_effects(const Physics& physics, const Where& where, const std::vector<std::string>& keys,
                    const std::string& scene) {
  Physics copy = physics;
  std::vector<Field> list;
  add_physics_fields(copy, list);
  for (const Effect& effect : effect_catalogue())
    for (const Field& f : list) {
      if (f.key != effect.key || std::find(keys.begin(), keys.end(), f.key) == keys.end()) continue;
      const double value = *std::get<double*>(f.value);
      if (value != effect.neutral && !(std::isnan(value) && std::isnan(effect.neutral)))
        throw InputError(fmt::format("{}{} = {}: a {} scene has nothing that this acts on; accepted is {}",
                                     where(f.key), f.key, value, scene, effect.neutral));
    }
}

}  // namespace drumsweep

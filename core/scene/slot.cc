#include "core/scene/slot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/geometry/primitives.h"
#include "core/scene/deposit.h"

namespace drumsweep {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double filled_packing = 0.58;  // expected; the height it settles to is an observable
constexpr std::size_t num_blocks = 8;    // of the recorded time, for standard errors

}  // namespace

void SlotScene::add_fields(FieldTable& table) {
  table.text("opening", opening, {"slot", "round"},
             "a slot across the whole depth, or a round orifice in a round silo");
  table.number("opening_m", opening_m, 1e-4, 10, "width of the slot, or diameter of the orifice");
  table.number("width_m", width_m, 1e-3, 100, "of the silo; round: its diameter");
  table.number("depth_m", depth_m, 1e-3, 100, "slot: of the slice, which is periodic along the slot");
  table.number("fill_height_m", fill_height_m, 1e-3, 100, "of the settled balls, at a packing of 0.58");
  table.flag("recycle", recycle, "what falls out comes back on top, so that the fill is steady");
  table.number("adapt_s", adapt_s, 0, 1e4, "after opening, before counting");
  table.number("record_s", record_s, 1e-3, 1e5, "counting");
  table.number("longest_settling_s", longest_settling_s, 0, 1e4, "waits so long for rest before opening");
}

void SlotScene::validate(const Physics& physics, const Where& where) const {
  refuse_effects(physics, where, {"effects.outlet_coating_m", "effects.drum_coating_m", "effects.texture_height_scale"},
                 "slot");
  const double d = physics.material.diameter_m;
  const auto need = [&](bool ok, const char* key, const std::string& text) {
    if (!ok) throw InputError(where(std::string("scene.") + key) + "scene." + key + text);
  };
  need(opening_m >= d, "opening_m",
       fmt::format(" = {}: nothing passes; accepted is a ball diameter, {} m, and more", opening_m, d));
  need(width_m >= opening_m + 4 * d, "width_m",
       fmt::format(" = {}: accepted is 4 ball diameters more than the opening, {} m, and more", width_m,
                   opening_m + 4 * d));
  need(opening == "round" || depth_m >= 3 * d, "depth_m",
       fmt::format(" = {}: accepted is 3 ball diameters, {} m, and more", depth_m, 3 * d));
  need(fill_height_m >= 4 * d, "fill_height_m",
       fmt::format(" = {}: accepted is 4 ball diameters, {} m, and more", fill_height_m, 4 * d));
}

SceneResult SlotScene::run(const Physics& physics, const SceneObserver& observer) const {
  const double d = physics.material.diameter_m, nan = std::numeric_limits<double>::quiet_NaN();
  const bool slot = opening == "slot";
  const double half = 0.5 * width_m, area = slot ? width_m * depth_m : pi * half * half;
  const auto wanted =
      static_cast<std::size_t>(std::lround(filled_packing * area * fill_height_m / (pi / 6 * d * d * d)));
  const double inside = half - 0.65 * d;
  const auto in_silo = [&](const Eigen::Vector3d& p) { return slot || std::hypot(p[0], p[1]) <= inside; };
  const Eigen::Vector3d fill_low(-inside, slot ? 0 : -inside, 0.6 * d), fill_high(inside, slot ? depth_m : inside, 0);
  const double high =
      std::max(loose_height(wanted, fill_low, fill_high, 0.5 * d, in_silo), fill_height_m + 14 * d) + 2 * d;
  World world(physics, std::sqrt(2 * gravity * opening_m) + 0.5);
  if (slot) world.set_period(depth_m);

  // Bottom with its opening, walls, and the gate that closes the opening.
  const double resolution = 0.1 * width_m;
  TriangleMesh bottom, gate, walls;
  if (slot) {
    const Eigen::Vector3d along(0, 3 * depth_m, 0);
    add_plate(bottom, {-half, -depth_m, 0}, {half - 0.5 * opening_m, 0, 0}, along);
    add_plate(bottom, {0.5 * opening_m, -depth_m, 0}, {half - 0.5 * opening_m, 0, 0}, along);
    add_plate(gate, {-0.5 * opening_m, -depth_m, 0}, {opening_m, 0, 0}, along);
    walls = box_mesh({-half, -depth_m, 0}, {half, 2 * depth_m, high}, {true, true, false, false, false, false});
  } else {
    const double facet = pi / 32 * half;  // 64 around, so that the orifice has 0.2 % less area than its circle
    add_ring(bottom, 0.5 * opening_m, half + d, 0, facet, true);
    add_ring(gate, 0, 0.5 * opening_m, 0, pi / 32 * 0.5 * opening_m, true);
    walls = tube_mesh(half, 0, high, pi / 16 * half);
  }
  // A ball below the bottom has left and may touch it from there.
  world.add_wall(std::move(bottom), resolution).one_sided = false;
  world.add_wall(std::move(walls), resolution);
  world.add_wall(std::move(gate), resolution);
  const std::size_t gate_number = world.walls.size() - 1;
  const double wide = half + 20 * d;
  SceneRun run(std::move(world), observer, {-wide, slot ? -2 * depth_m : -wide, -10 * d},
               {wide, slot ? 3 * depth_m : wide, high + 10 * d});
  run.threads = threads;
  std::size_t added = 0;
  for (const Eigen::Vector3d& at :
       loose_lattice(fill_low, {fill_high[0], fill_high[1], high}, 0.5 * d, physics.seed, in_silo))
    if (added < wanted) {
      run.add(at);
      ++added;
    }
  const Rest rest = come_to_rest(run, longest_settling_s);

  // Mean height of the free surface, and packing in a box; both without the balls that fall back onto it.
  const auto level = [&] {
    const Balls& balls = run.state.balls;
    const std::vector<int> contacts = contacts_of_balls(run.state);
    const double reach = slot ? half : half / std::numbers::sqrt2;
    const HeightMap map = surface_from_above(balls, -reach, reach, slot ? 0 : -reach, slot ? depth_m : reach, 0.5 * d,
                                             0, run.world.period, [&](std::size_t i) { return contacts[i] > 0; });
    double sum = 0;
    for (const double h : map.height) sum += h / static_cast<double>(map.height.size());
    return sum;
  };
  const auto packing = [&](double from, double to, double reach) {
    return packing_fraction(
               run.state.balls, {-reach, slot ? 0 : -reach, from}, {reach, slot ? depth_m : reach, to},
               run.world.period, [&](const Eigen::Vector3d& p) { return slot || std::hypot(p[0], p[1]) < reach; },
               [](const Eigen::Vector3d&) { return std::size_t{0}; }, 1)
        .mean;
  };
  const double height_at_rest = level();
  const double packing_at_rest = packing(std::min(2 * d, 0.3 * height_at_rest),
                                         std::max(height_at_rest - 2 * d, 0.5 * height_at_rest), half - 2 * d);

  // Open. What has fallen is counted, and comes back in its turn.
  run.world.walls[gate_number].removed_at = run.time();
  Source back;
  double debt = 0, fallen_kg = 0, source_z = height_at_rest + 2 * d;
  std::int64_t leaked = 0;
  const auto pass_on = [&] {
    const double lowest = -3 * d;
    run.remove([&](std::size_t i) {
      const Eigen::Vector3d& p = run.state.balls.position[i];
      if (p[2] > lowest) return false;
      // Only the opening leads here, and there is no time to go far sideways.
      const double away = slot ? std::abs(p[0]) : std::hypot(p[0], p[1]);
      leaked += away > 0.5 * opening_m + 4 * d ? 1 : 0;
      const double mass = 1 / run.world.inverse_mass(run.state.balls.radius[i]);
      fallen_kg += mass;
      debt += recycle ? mass : 0;
      return true;
    });
    if (!recycle) return;
    back.pour(
        run, debt,
        [&](double u, double v, double w) {
          const double r = inside * std::sqrt(u);
          const double z = source_z + 8 * d * w;
          return slot ? Eigen::Vector3d(inside * (2 * u - 1), depth_m * v, z)
                      : Eigen::Vector3d(r * std::cos(2 * pi * v), r * std::sin(2 * pi * v), z);
        },
        Eigen::Vector3d(0, 0, -std::sqrt(gravity * opening_m)));
  };
  const double opened = run.time();
  std::vector<double> heights;
  bool empty = false;
  const auto look = [&] {
    const double now = level();
    source_z = std::max(source_z, now + 1.5 * d);
    empty = now < opening_m;
    return now;
  };
  double next_look = opened;
  run.run_until("adapting", opened + adapt_s, [&] {
    pass_on();
    if (run.time() >= next_look) {
      look();
      next_look += 0.05;
    }
    return empty;
  });

  // Record: mass by outer steps, density above the opening now and then.
  const double begin = run.time();
  std::vector<double> per_step, above, flowing;
  double before = fallen_kg;
  next_look = begin;
  Series out_flow{"outflow", {"t [s]", "mass [kg]"}, {}};
  const double zero = fallen_kg;
  if (!empty)
    run.run_until("recording", begin + record_s, [&] {
      pass_on();
      per_step.push_back(fallen_kg - before);
      before = fallen_kg;
      if (run.time() >= next_look) {
        heights.push_back(look());
        const double box = std::min(0.5 * opening_m, half - d);
        above.push_back(packing(0.25 * opening_m, std::min(1.25 * opening_m, heights.back()), box));
        flowing.push_back(packing(std::min(2 * opening_m, 0.5 * heights.back()),
                                  std::max(heights.back() - 3 * d, 0.6 * heights.back()), half - 2 * d));
        out_flow.values.insert(out_flow.values.end(), {run.time() - begin, fallen_kg - zero});
        next_look += record_s / 40;
      }
      return empty;
    });
  const double dt = physics.solver.outer_step_s, depth = slot ? depth_m : 1;
  Estimate rate = block_estimate(per_step, num_blocks);
  rate.mean = per_step.empty() ? nan : (fallen_kg - zero) / static_cast<double>(per_step.size()) / dt / depth;
  rate.sigma /= dt * depth;
  const Estimate above_now = block_estimate(above, num_blocks), flowing_now = block_estimate(flowing, num_blocks),
                 height_now = block_estimate(heights, num_blocks);
  const double density = physics.material.density_kg_m3;
  std::vector<Observable> list = {
      observable("discharge_rate", rate.mean, rate.sigma, slot ? "kg s-1 m-1" : "kg s-1"),
      observable("bulk_density_above_opening", density * above_now.mean, density * above_now.sigma, "kg m-3"),
      observable("bulk_density_flowing", density * flowing_now.mean, density * flowing_now.sigma, "kg m-3"),
      observable("bulk_density_at_rest", density * packing_at_rest, nan, "kg m-3"),
      observable("packing_fraction", packing_at_rest, nan, "1"),
      observable("fill_height_at_rest", height_at_rest, nan, "m"),
      observable("fill_height", height_now.mean, height_now.sigma, "m"),
      observable("recorded_time", static_cast<double>(per_step.size()) * dt, nan, "s"),
      observable("ran_empty", empty ? 1 : 0, nan, "1"),
      observable("leaked", static_cast<double>(leaked), nan, "1"),
      observable("filled_at_rest", rest.reached ? 1 : 0, nan, "1"),
  };
  SceneResult out = run.finish();
  out.observables = std::move(list);
  out.series = {std::move(out_flow)};
  return out;
}

}  // namespace drumsweep

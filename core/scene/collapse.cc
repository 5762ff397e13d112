#include "core/scene/collapse.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/geometry/primitives.h"
#include "core/scene/deposit.h"

namespace drumsweep {
namespace {

constexpr double pi = std::numbers::pi;
constexpr std::size_t num_sectors = 8;
constexpr double filled_packing = 0.58;  // expected of the settled column; the height it reaches is an observable

/// Twice what has been published for the most mobile balls, from the wall.
double generous_floor(double length, double aspect) {
  return length * (1 + 2 * std::max(1.8 * std::min(aspect, 3.0), 2.3 * std::pow(aspect, 2.0 / 3)));
}

}  // namespace

void CollapseScene::add_fields(FieldTable& table) {
  table.text("geometry", geometry, {"channel", "axisymmetric"}, "channel along x, or column around the vertical axis");
  table.text("base", base, {"rough", "smooth"}, "rough: a layer of balls glued to the ground; smooth: a plate");
  table.text("sides", sides, {"periodic", "smooth", "frictional"},
             "channel: no side walls, plates without friction, or plates with that of walls");
  table.text("release", release, {"removed", "lifted"}, "the gate vanishes at an instant, or goes up");
  table.number("length_m", length_m, 1e-3, 100, "of the column: L0; its radius, or half of it when two-sided");
  table.number("height_m", height_m, 1e-3, 100, "of the column: H0, at a packing of 0.58");
  table.number("width_m", width_m, 1e-3, 100, "channel: its width");
  table.flag("two_sided", two_sided, "channel: runs out to both sides instead of standing at a wall");
  table.number("lift_speed_m_s", lift_speed_m_s, 1e-3, 1000, "lifted: speed of the gate");
  table.number("floor_length_m", floor_length_m, 1e-3, 1000,
               "from the wall, the middle or the axis; not given: twice what has been published for glass beads", true);
  table.number("longest_settling_s", longest_settling_s, 0, 1e4, "waits so long for rest, before and after");
}

void CollapseScene::validate(const Physics& physics, const Where& where) const {
  refuse_effects(physics, where, {"effects.outlet_coating_m", "effects.drum_coating_m", "effects.texture_height_scale"},
                 "collapse");
  const double d = physics.material.diameter_m;
  const auto need = [&](bool ok, const char* key, const std::string& text) {
    if (!ok) throw InputError(where(std::string("scene.") + key) + "scene." + key + text);
  };
  need(length_m >= 4 * d, "length_m",
       fmt::format(" = {}: accepted is 4 ball diameters, {} m, and more", length_m, 4 * d));
  need(height_m >= 2 * d, "height_m",
       fmt::format(" = {}: accepted is 2 ball diameters, {} m, and more", height_m, 2 * d));
  need(std::isnan(floor_length_m) || floor_length_m > length_m, "floor_length_m",
       fmt::format(" = {}: must be longer than the column, {} m", floor_length_m, length_m));
  if (geometry == "axisymmetric") {
    need(!two_sided, "two_sided", " = true: is for a channel; accepted is false");
    need(sides == "periodic", "sides", fmt::format(" = \"{}\": an axisymmetric column has none; leave it out", sides));
  } else {
    need(width_m >= 3 * d, "width_m",
         fmt::format(" = {}: accepted is 3 ball diameters, {} m, and more", width_m, 3 * d));
  }
}

SceneResult CollapseScene::run(const Physics& physics, const SceneObserver& observer) const {
  const double d = physics.material.diameter_m, nan = std::numeric_limits<double>::quiet_NaN();
  const bool channel = geometry == "channel", rough = base == "rough", periodic = channel && sides == "periodic";
  const double floor = std::isnan(floor_length_m) ? generous_floor(length_m, height_m / length_m) : floor_length_m;
  const double x_low = channel && !two_sided ? 0 : -floor, x_high = floor;
  const double area = channel ? (two_sided ? 2 : 1) * length_m * width_m : pi * length_m * length_m;
  const auto wanted = static_cast<std::size_t>(std::lround(filled_packing * area * height_m / (pi / 6 * d * d * d)));
  const double gap = 0.65 * d, inside = length_m - gap;
  const Eigen::Vector3d fill_low(channel && !two_sided ? gap : -inside,
                                 !channel              ? -inside
                                 : sides == "periodic" ? 0
                                                       : gap,
                                 0.6 * d);
  const Eigen::Vector3d fill_high(inside, channel ? width_m - fill_low[1] : inside, 0);
  const auto in_column = [&](const Eigen::Vector3d& p) { return channel || std::hypot(p[0], p[1]) <= inside; };
  const double high = loose_height(wanted, fill_low, fill_high, 0.5 * d, in_column) + 2 * d;  // of walls and gate
  World world(physics, std::sqrt(2 * gravity * height_m));
  if (periodic) world.set_period(width_m);

  // Ground, back wall, sides; walls go below the tops of a rough base and, where periodic, beyond both ends.
  const double y_low = periodic  ? -width_m
                       : channel ? 0
                                 : -floor,
               y_high = periodic  ? 2 * width_m
                        : channel ? width_m
                                  : floor;
  const double resolution = 0.2 * length_m;
  if (!rough) {
    TriangleMesh ground;
    add_plate(ground, {x_low - 10 * d, y_low, 0}, {x_high - x_low + 20 * d, 0, 0}, {0, y_high - y_low, 0});
    world.add_wall(std::move(ground), resolution);
  }
  const auto upright = [&](double x, bool front_to_low) {
    TriangleMesh mesh;
    const Eigen::Vector3d y(0, y_high - y_low, 0), z(0, 0, high + d);
    add_plate(mesh, {x, y_low, -d}, front_to_low ? z : y, front_to_low ? y : z);
    return mesh;
  };
  if (channel && !two_sided) world.add_wall(upright(0, false), resolution);
  if (channel && !periodic) {
    Surface surface = wall_surface(physics);
    if (sides == "smooth") {
      surface.friction = surface.rolling = surface.twisting = 0;
      surface.friction_speed.on = false;
    }
    TriangleMesh two =
        box_mesh({x_low - 10 * d, 0, -d}, {x_high + 10 * d, width_m, high}, {false, false, true, true, false, false});
    world.add_wall(std::move(two), resolution, {}, surface);
  }
  const std::size_t first_gate = world.walls.size();
  if (channel) {
    world.add_wall(upright(length_m, true), resolution);
    if (two_sided) world.add_wall(upright(-length_m, false), resolution);
  } else {
    world.add_wall(tube_mesh(length_m, -d, high, pi / 12 * length_m), resolution);
  }
  for (std::size_t w = first_gate; w < world.walls.size(); ++w) {
    world.walls[w].one_sided = false;  // balls beside a lifted gate touch it from outside
  }

  SceneRun run(std::move(world), observer, {x_low - 20 * d, periodic ? -2 * width_m : y_low - 20 * d, -20 * d},
               {x_high + 20 * d, periodic ? 3 * width_m : y_high + 20 * d, 2 * high});
  run.threads = threads;
  if (rough)
    glue_base(run, x_low, x_high, channel ? 0 : -floor, channel ? width_m : floor,
              [&](double x, double y) { return channel || std::hypot(x, y) <= floor; });

  // Loose fill, then rest behind the gate.
  std::size_t added = 0;
  for (const Eigen::Vector3d& at :
       loose_lattice(fill_low, {fill_high[0], fill_high[1], high}, 0.5 * d, physics.seed, in_column))
    if (added < wanted) {
      run.add(at);
      ++added;
    }
  const Rest before = come_to_rest(run, longest_settling_s);

  // Surface along x (from the axis), over the base seen in the same way.
  const double cell = d / 4;
  const auto surface = [&](double from, double to, bool base_only) {
    const Balls& balls = run.state.balls;
    return surface_from_above(balls, from, to, channel ? 0 : from, channel ? width_m : to, cell, rough ? -d : 0,
                              run.world.period, [&](std::size_t i) { return base_only ? !is_free(balls, i) : true; });
  };
  const auto mean_height = [&](const HeightMap& map, double from, double to) {
    double sum = 0, num = 0;
    for (int j = 0; j < map.ny; ++j)
      for (int i = 0; i < map.nx; ++i) {
        const double s = channel ? (two_sided ? std::abs(map.x(i)) : map.x(i)) : std::hypot(map.x(i), map.y(j));
        if (s < from || s >= to) continue;
        sum += map.at(i, j);
        num += 1;
      }
    return num > 0 ? sum / num : nan;
  };
  const double near_low = channel && !two_sided ? 0 : -length_m;
  const double ground_height = mean_height(surface(near_low, length_m, true), 0, length_m);
  const double column_height = mean_height(surface(near_low, length_m, false), 0, length_m) - ground_height;
  const double middle_low = channel && !two_sided ? d : -length_m + d;
  const Estimate packing = packing_fraction(
      run.state.balls, {middle_low, periodic || !channel ? (channel ? 0 : -length_m + d) : d, d},
      {length_m - d,
       periodic  ? width_m
       : channel ? width_m - d
                 : length_m - d,
       std::max(2 * d, column_height - 2 * d)},
      run.world.period, [&](const Eigen::Vector3d& p) { return channel || std::hypot(p[0], p[1]) < length_m - d; },
      [&](const Eigen::Vector3d& p) {
        return std::min<std::size_t>(3, static_cast<std::size_t>(std::max(0.0, 4 * p[2] / std::max(d, column_height))));
      },
      4);

  // Distance from the wall, the middle or the axis; strips in which the front is looked for.
  const auto distance = [&](const Eigen::Vector3d& p) {
    return channel ? (two_sided ? std::abs(p[0]) : p[0]) : std::hypot(p[0], p[1]);
  };
  const auto per_side = channel ? std::max<std::size_t>(1, static_cast<std::size_t>(width_m / (2 * d))) : num_sectors;
  const std::size_t num_strips = channel && two_sided ? 2 * per_side : per_side;
  const auto strip = [&](const Eigen::Vector3d& p) {
    const double part = channel ? p[1] / width_m : std::atan2(p[1], p[0]) / (2 * pi);
    const auto k =
        std::min(per_side - 1, static_cast<std::size_t>((part - std::floor(part)) * static_cast<double>(per_side)));
    return channel && two_sided && p[0] < 0 ? per_side + k : k;
  };
  const auto fronts = [&] {
    const Balls& balls = run.state.balls;
    const std::vector<char> joined_to_it = connected(
        balls, run.world.period, 0.25 * d, [&](std::size_t i) { return distance(balls.position[i]) < 0.5 * length_m; });
    std::vector<double> out(num_strips, 0);
    for (std::size_t i = 0; i < balls.size(); ++i)
      if (joined_to_it[i]) {
        double& f = out[strip(balls.position[i])];
        f = std::max(f, distance(balls.position[i]) + balls.radius[i]);
      }
    return out;
  };

  // The gate opens.
  const double opened = run.time();
  for (std::size_t w = first_gate; w < run.world.walls.size(); ++w) {
    Wall& gate = run.world.walls[w];
    gate.motion.travel_from = opened;
    if (release == "lifted") {
      gate.motion.travel = Eigen::Vector3d(0, 0, lift_speed_m_s);
      gate.removed_at = opened + (column_height + 5 * d) / lift_speed_m_s;
    } else {
      gate.removed_at = opened;
    }
  }
  std::int64_t left = 0;
  const auto clear_floor = [&] {
    left += static_cast<std::int64_t>(run.remove([&](std::size_t i) {
      const Eigen::Vector3d& p = run.state.balls.position[i];
      return is_free(run.state.balls, i) && distance(p) > floor - 0.5 * d;
    }));
  };
  Series motion{"front", {"t [s]", "front [m]", "kinetic energy [m g d per ball]"}, {}};
  double most_energy = 0, next_look = opened, arrest = nan;
  const double between = 0.05 * std::sqrt(height_m / gravity);
  const Rest after = come_to_rest(run, longest_settling_s, [&] {
    clear_floor();
    const double energy = kinetic_energy_per_ball(run);
    most_energy = std::max(most_energy, energy);
    // Arrested when the motion last fell below 1 % of its peak.
    if (energy > 0.01 * most_energy)
      arrest = nan;
    else if (std::isnan(arrest))
      arrest = run.time() - opened;
    if (run.time() < next_look) return;
    next_look += between;
    motion.values.insert(motion.values.end(), {run.time() - opened, estimate(fronts()).mean, energy});
  });

  // Deposit.
  const Balls& balls = run.state.balls;
  const Estimate front = estimate(fronts());
  std::vector<double> reach;
  for (std::size_t i = 0; i < balls.size(); ++i)
    if (is_free(balls, i)) reach.push_back(distance(balls.position[i]));
  std::sort(reach.begin(), reach.end());
  const double most =
      reach.empty() ? nan : reach[static_cast<std::size_t>(0.99 * static_cast<double>(reach.size() - 1))];
  const double far = std::min(floor, front.mean + 10 * d);
  const HeightMap map = surface(channel && !two_sided ? 0 : -far, far, false);
  const double final_height = mean_height(map, 0, 2 * d) - ground_height;
  Series shape{"deposit", {"x [m]", "height [m]"}, {}};
  for (double s = 0; s + d <= far; s += d)
    shape.values.insert(shape.values.end(), {s + 0.5 * d, mean_height(map, s, s + d) - ground_height});

  std::vector<Observable> list = {
      observable("aspect_ratio", column_height / length_m, nan, "1"),
      observable("run_out", (front.mean - length_m) / length_m, front.sigma / length_m, "1"),
      observable("run_out_99", (most - length_m) / length_m, nan, "1"),
      observable("final_length", front.mean, front.sigma, "m"),
      observable("initial_height", column_height, nan, "m"),
      observable("final_height", final_height, nan, "m"),
      observable("arrest_time", arrest, nan, "s"),
      observable("packing_fraction", packing.mean, packing.sigma, "1"),
      observable("left_floor", static_cast<double>(left), nan, "1"),
      observable("column_at_rest", before.reached ? 1 : 0, nan, "1"),
  };
  add_rest(after, list);
  SceneResult out = run.finish();
  out.observables = std::move(list);
  out.series = {std::move(motion), std::move(shape)};
  return out;
}

}  // namespace drumsweep

#include "core/scene/pile.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/geometry/primitives.h"
#include "core/scene/deposit.h"

namespace drumsweep {
namespace {

constexpr double pi = std::numbers::pi, degree = pi / 180;
constexpr std::size_t num_sectors = 8;

// A disc is full when its heap has grown by less than this part while a quarter of it was poured.
constexpr double full_growth = 0.02, full_part = 0.25;

std::size_t sector_of(double x, double y) {
  const double turn = std::atan2(y, x) / (2 * pi);
  return std::min(num_sectors - 1, static_cast<std::size_t>((turn - std::floor(turn)) * num_sectors));
}

/// Surface height over rings, of all sectors together and of each.
struct RadialProfile {
  std::vector<double> radius, height;
  std::vector<std::vector<double>> of_sector;  ///< (sectors x rings)
};

RadialProfile radial_profile(const HeightMap& map, double ring, double outer) {
  const auto num = static_cast<std::size_t>(std::floor(outer / ring));
  RadialProfile out;
  std::vector<std::vector<double>> sum(num_sectors, std::vector<double>(num, 0)), cells = sum;
  for (int j = 0; j < map.ny; ++j)
    for (int i = 0; i < map.nx; ++i) {
      const double x = map.x(i), y = map.y(j);
      const auto k = static_cast<std::size_t>(std::hypot(x, y) / ring);
      if (k >= num) continue;
      const std::size_t s = sector_of(x, y);
      sum[s][k] += map.at(i, j);
      cells[s][k] += 1;
    }
  out.of_sector = sum;
  for (std::size_t k = 0; k < num; ++k) {
    double all = 0, count = 0;
    for (std::size_t s = 0; s < num_sectors; ++s) {
      all += sum[s][k];
      count += cells[s][k];
      out.of_sector[s][k] = sum[s][k] / std::max(1.0, cells[s][k]);
    }
    out.radius.push_back((static_cast<double>(k) + 0.5) * ring);
    out.height.push_back(all / std::max(1.0, count));
  }
  return out;
}

double free_mass(const SceneRun& run) {
  double sum = 0;
  for (std::size_t i = 0; i < run.state.balls.size(); ++i)
    if (is_free(run.state.balls, i)) sum += 1 / run.world.inverse_mass(run.state.balls.radius[i]);
  return sum;
}

}  // namespace

void PileScene::add_fields(FieldTable& table) {
  table.text("base", base, {"rough", "smooth"}, "rough: a layer of balls glued to the ground; smooth: a plate");
  table.text("shape", shape, {"disc", "plane"}, "disc: what rolls over its edge is taken away");
  table.text("protocol", protocol, {"pour", "lifted_cylinder"}, "how the heap is made");
  table.number("base_radius_m", base_radius_m, 1e-3, 100, "of the disc; plane: what rolls out further is taken away");
  table.number("mass_kg", mass_kg, 1e-9, 1e6,
               "poured, or in the cylinder; poured on a disc it may be left out: until the heap grows no more", true);
  table.number("rate_kg_s", rate_kg_s, 1e-9, 1e5, "pour: mass flow of the source");
  table.text("source", source, {"rising", "fixed"}, "pour: the source stays over the apex, or over the ground");
  table.number("source_height_m", source_height_m, 1e-4, 100, "pour: of the source over the apex, or over the ground");
  table.number("source_radius_m", source_radius_m, 0, 100, "pour: of the disc from which balls fall");
  table.number("cylinder_radius_m", cylinder_radius_m, 1e-3, 100, "lifted_cylinder: inner radius");
  table.number("lift_speed_m_s", lift_speed_m_s, 1e-5, 100, "lifted_cylinder: speed at which it goes up");
  table.number("longest_settling_s", longest_settling_s, 0, 1e4, "the heap is measured at rest, or after this time");
}

void PileScene::validate(const Physics& physics, const Where& where) const {
  refuse_effects(physics, where, {"effects.outlet_coating_m", "effects.drum_coating_m", "effects.texture_height_scale"},
                 "pile");
  const double d = physics.material.diameter_m;
  const auto need = [&](bool ok, const char* key, const std::string& text) {
    if (!ok) throw InputError(where(std::string("scene.") + key) + "scene." + key + text);
  };
  need(base_radius_m >= 4 * d, "base_radius_m",
       fmt::format(" = {}: accepted is 4 ball diameters, {} m, and more", base_radius_m, 4 * d));
  if (protocol == "pour") {
    need(!std::isnan(mass_kg) || shape == "disc", "mass_kg",
         ": is needed on a plane; only on a disc is there an end of growth to wait for");
    need(source == "fixed" || source_height_m >= 1.5 * d, "source_height_m",
         fmt::format(" = {}: a rising source keeps at least 1.5 ball diameters, {} m, over the apex", source_height_m,
                     1.5 * d));
    need(source_radius_m <= 0.5 * base_radius_m, "source_radius_m",
         fmt::format(" = {}: accepted is up to half the base's radius, {} m", source_radius_m, 0.5 * base_radius_m));
  } else {
    need(!std::isnan(mass_kg), "mass_kg", ": is needed for a lifted cylinder");
    need(cylinder_radius_m >= 2 * d && cylinder_radius_m < base_radius_m, "cylinder_radius_m",
         fmt::format(" = {}: accepted is from 2 ball diameters, {} m, to the base's radius, {} m", cylinder_radius_m,
                     2 * d, base_radius_m));
  }
}

SceneResult PileScene::run(const Physics& physics, const SceneObserver& observer) const {
  const double d = physics.material.diameter_m, h_outer = physics.solver.outer_step_s;
  const bool pours = protocol == "pour", disc = shape == "disc", rough = base == "rough";
  const double steepest = 2.0 * base_radius_m;  // no heap of dry balls is higher
  World world(physics, std::sqrt(2 * gravity * (source_height_m + 4 * d)));

  // Ground: a plate as wide as the disc, or wider than anything that counts; a rough base needs none.
  const double ground = disc ? base_radius_m : base_radius_m + 3 * d;
  if (!rough) {
    TriangleMesh plate;
    if (disc)
      add_ring(plate, 0, base_radius_m, 0, 0.2 * base_radius_m, true);
    else
      add_plate(plate, {-ground, -ground, 0}, {2 * ground, 0, 0}, {0, 2 * ground, 0});
    world.add_wall(std::move(plate), 0.2 * base_radius_m);
  }

  // Cylinder: from below the tops of the base to above its fill.
  const double inner = cylinder_radius_m - 0.62 * d;
  const auto in_cylinder = [&](const Eigen::Vector3d& p) { return std::hypot(p[0], p[1]) <= inner; };
  const auto wanted =
      std::isnan(mass_kg) ? std::size_t{0} : static_cast<std::size_t>(std::lround(mass_kg / world.mean_mass));
  const double fill =
      pours ? 0 : loose_height(wanted, {-inner, -inner, 0}, {inner, inner, 0}, 0.5 * d, in_cylinder) + 2 * d;
  if (!pours) {
    Wall& tube =
        world.add_wall(tube_mesh(cylinder_radius_m, 0, fill, pi / 12 * cylinder_radius_m), 0.5 * cylinder_radius_m);
    tube.one_sided = false;  // the heap touches it from outside, too
  }
  const double top = std::max({steepest, fill, source_height_m}) + source_height_m + 10 * d;
  const double wide = ground + 20 * d;
  SceneRun run(std::move(world), observer, {-wide, -wide, -20 * d}, {wide, wide, top});
  run.threads = threads;

  const double glued = disc ? base_radius_m - 0.5 * d : ground;
  if (rough)
    glue_base(run, -glued, glued, -glued, glued, [&](double x, double y) { return x * x + y * y <= glued * glued; });
  const std::size_t num_glued = run.state.balls.size();

  // What has left the base.
  double left_kg = 0;
  const auto clear_edge = [&] {
    run.remove([&](std::size_t i) {
      const Eigen::Vector3d& p = run.state.balls.position[i];
      const bool gone =
          is_free(run.state.balls, i) && (disc ? p[2] < -0.5 * d : std::hypot(p[0], p[1]) > base_radius_m);
      if (gone) left_kg += 1 / run.world.inverse_mass(run.state.balls.radius[i]);
      return gone;
    });
  };
  // Highest ball under the source that rests on others; what still falls has no contact.
  const auto apex = [&] {
    double highest = 0;
    const std::vector<int> contacts = contacts_of_balls(run.state);
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      const Eigen::Vector3d& p = run.state.balls.position[i];
      if (contacts[i] > 0 && std::hypot(p[0], p[1]) < source_radius_m + 2 * d)
        highest = std::max(highest, p[2] + run.state.balls.radius[i]);
    }
    return highest;
  };

  double poured_s = 0;
  if (pours) {
    // Balls fall one by one; on a disc without a given mass until the heap grows no more.
    Source falls;
    double debt = 0, poured = 0, heap_then = 0, look = 0, source_z = source_height_m;
    const double longest =
        std::isnan(mass_kg) ? 20 * steepest * base_radius_m * base_radius_m * physics.material.density_kg_m3 / rate_kg_s
                            : 2 * mass_kg / rate_kg_s + 10;
    std::int64_t step = 0;
    const std::int64_t steps_between = std::max<std::int64_t>(1, std::llround(0.02 / h_outer));
    run.run_until("pouring", longest, [&] {
      clear_edge();
      if (source == "rising" && step++ % steps_between == 0) source_z = apex() + source_height_m;
      const double due = std::isnan(mass_kg) ? rate_kg_s * h_outer : std::min(rate_kg_s * h_outer, mass_kg - poured);
      debt += due;
      poured += due;
      falls.pour(
          run, debt,
          [&](double u, double v, double w) {
            const double r = source_radius_m * std::sqrt(u), angle = 2 * pi * v;
            return Eigen::Vector3d(r * std::cos(angle), r * std::sin(angle), source_z + 0.5 * d * w);
          },
          Eigen::Vector3d::Zero());
      debt = std::min(debt, 50 * run.world.mean_mass);  // a source narrower than its flow gives what it can
      if (!std::isnan(mass_kg)) return mass_kg - poured <= 0 && debt < run.world.mean_mass;
      const double heap = free_mass(run);
      if (poured - look < full_part * std::max(heap, 50 * run.world.mean_mass)) return false;
      const bool full = left_kg > 0 && heap - heap_then < full_growth * heap;
      heap_then = heap;
      look = poured;
      return full;
    });
    poured_s = run.time();
  } else {
    // Fill, let it settle, and lift until the lower edge is above everything.
    std::size_t added = 0;
    for (const Eigen::Vector3d& at :
         loose_lattice({-inner, -inner, 0}, {inner, inner, fill}, 0.5 * d, physics.seed, in_cylinder))
      if (added < wanted) {
        run.add(at);
        ++added;
      }
    come_to_rest(run, longest_settling_s, clear_edge);
    Motion& motion = run.world.walls.back().motion;
    motion.travel_from = run.time();
    motion.travel = Eigen::Vector3d(0, 0, lift_speed_m_s);
    run.run_until("lifting", run.time() + (fill + 2 * d) / lift_speed_m_s, [&] {
      clear_edge();
      double highest = 0;
      for (std::size_t i = 0; i < run.state.balls.size(); ++i)
        highest = std::max(highest, run.state.balls.position[i][2] + run.state.balls.radius[i]);
      return motion.pose(run.time()).origin[2] > highest + d;
    });
    run.world.walls.back().removed_at = run.time();
  }
  const Rest rest = come_to_rest(run, longest_settling_s, clear_edge);

  // Surface over the base; the base itself seen in the same way is height 0.
  const Balls& balls = run.state.balls;
  const auto all = [](std::size_t) { return true; };
  const auto is_base = [&](std::size_t i) { return !is_free(balls, i); };
  const double cell = d / 4, outer = disc ? base_radius_m : base_radius_m - d;
  const double floor = rough ? -d : 0;
  const HeightMap map = surface_from_above(balls, -outer, outer, -outer, outer, cell, floor, 0, all);
  const HeightMap bare = surface_from_above(balls, -outer, outer, -outer, outer, cell, floor, 0, is_base);
  const RadialProfile profile = radial_profile(map, 0.5 * d, outer),
                      ground_profile = radial_profile(bare, 0.5 * d, outer);
  double ground_height = 0;
  for (const double h : ground_profile.height) ground_height += h / static_cast<double>(ground_profile.height.size());

  const std::size_t num_rings = profile.radius.size();
  std::vector<double> height;
  for (const double h : profile.height) height.push_back(h - ground_height);
  // Apex: mean of the surface within one diameter of the axis.
  double apex_height = 0;
  for (std::size_t k = 0; k < 2 && k < num_rings; ++k) apex_height += height[k] * (k == 0 ? 0.25 : 0.75);
  std::vector<double> fit_r, fit_h;
  std::size_t from = 0, to = 0;
  for (std::size_t k = 0; k < num_rings; ++k) {
    if (height[k] > 0.8 * apex_height) from = k + 1;
    if (height[k] > 0.2 * apex_height) to = k + 1;
  }
  const auto cut = [&](const std::vector<double>& v) {
    return from < to ? std::vector<double>(v.begin() + static_cast<std::ptrdiff_t>(from),
                                           v.begin() + static_cast<std::ptrdiff_t>(to))
                     : std::vector<double>();
  };
  const Line line = fit_line(cut(profile.radius), cut(height));
  std::vector<double> angles;
  for (const std::vector<double>& sector : profile.of_sector)
    angles.push_back(-std::atan(fit_line(cut(profile.radius), cut(sector)).slope) / degree);

  // Volume under the surface, foot of the heap in each sector, and the cone of equal volume.
  double volume = 0;
  for (std::size_t k = 0; k < num_rings; ++k) volume += height[k] * pi * 0.25 * d * d * static_cast<double>(2 * k + 1);
  const std::vector<char> joined_to_heap = connected(
      balls, 0, 0.25 * d, [&](std::size_t i) { return std::hypot(balls.position[i][0], balls.position[i][1]) < d; });
  std::vector<double> foot(num_sectors, 0);
  for (std::size_t i = 0; i < balls.size(); ++i)
    if (joined_to_heap[i]) {
      const Eigen::Vector3d& p = balls.position[i];
      double& f = foot[sector_of(p[0], p[1])];
      f = std::max(f, std::hypot(p[0], p[1]) + balls.radius[i]);
    }
  const Estimate run_out = estimate(foot);
  const bool full_disc = disc && left_kg > 0;
  const double cone_radius = full_disc ? base_radius_m : run_out.mean;

  // Structure more than two diameters below the surface and over the base.
  const auto surface_at = [&](double r) {
    const auto k = static_cast<std::size_t>(r / (0.5 * d));
    return k < num_rings ? height[k] + ground_height : 0.0;
  };
  const auto deep = [&](const Eigen::Vector3d& p) {
    return p[2] > d && p[2] < surface_at(std::hypot(p[0], p[1])) - 2 * d;
  };
  const Estimate packing = packing_fraction(
      balls, {-outer, -outer, d}, {outer, outer, std::max(1.1 * d, apex_height)}, 0, deep,
      [](const Eigen::Vector3d& p) { return sector_of(p[0], p[1]); }, num_sectors);
  const Estimate coordination = coordination_number(run.state, [&](std::size_t i) { return deep(balls.position[i]); });
  const double on_base = free_mass(run);
  double spread = 0;
  for (std::size_t k = 0; k < 2; ++k)
    spread += 0.5 * (k < num_rings ? estimate([&] {
                                       std::vector<double> v;
                                       for (const auto& sector : profile.of_sector) v.push_back(sector[k]);
                                       return v;
                                     }())
                                         .sigma
                                   : 0.0);

  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<Observable> list = {
      observable("angle_of_repose", -std::atan(line.slope) / degree, estimate(angles).sigma, "deg"),
      observable("angle_of_repose_volume", std::atan(3 * volume / (pi * std::pow(cone_radius, 3))) / degree, nan,
                 "deg"),
      observable("height", apex_height, spread, "m"),
      observable("base_radius", cone_radius, full_disc ? nan : run_out.sigma, "m"),
      observable("packing_fraction", packing.mean, packing.sigma, "1"),
      observable("coordination_number", coordination.mean, coordination.sigma, "1"),
      observable("mass_on_base", on_base, nan, "kg"),
      observable("mass_left_base", left_kg, nan, "kg"),
      observable("glued_balls", static_cast<double>(num_glued), nan, "1"),
  };
  if (pours) list.push_back(observable("pouring_time", poured_s, nan, "s"));
  add_rest(rest, list);
  Series surface{"surface", {"r [m]", "height [m]", "sigma [m]"}, {}};
  for (std::size_t k = 0; k < num_rings; ++k) {
    std::vector<double> of_sectors;
    for (const std::vector<double>& sector : profile.of_sector) of_sectors.push_back(sector[k]);
    surface.values.insert(surface.values.end(), {profile.radius[k], height[k], estimate(of_sectors).sigma});
  }
  Series fitted{"fitted_line", {"r [m]", "height [m]"}, {}};
  if (line.points > 1)
    for (const std::size_t k : {from, to - 1})
      fitted.values.insert(fitted.values.end(), {profile.radius[k], line.offset + line.slope * profile.radius[k]});

  SceneResult out = run.finish();
  out.observables = std::move(list);
  out.series = {std::move(surface), std::move(fitted)};
  return out;
}

}  // namespace drumsweep

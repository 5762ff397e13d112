#include "core/scene/rotating_drum.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/effects/size_distribution.h"
#include "core/geometry/primitives.h"
#include "core/geometry/random.h"
#include "core/geometry/texture.h"
#include "core/scene/scene_run.h"
#include "core/scene/slice_field.h"

namespace drumsweep {
namespace {

constexpr std::size_t num_blocks = 8;
constexpr std::uint32_t feed_attempts = 30;
constexpr double sphere = 4 * std::numbers::pi / 3;

/// The walls of the drum: the tube, and its ends where it has them.
struct DrumWalls {
  TriangleMesh tube;
  std::vector<TriangleMesh> ends;
  double free_radius = 0;  ///< of the cylinder inside all bumps [m]
};

DrumWalls build_walls(const RotatingDrumScene& scene, const Physics& physics) {
  DrumWalls out;
  const double radius = 0.5 * scene.diameter_m, length = scene.length_m, circumference = 2 * std::numbers::pi * radius;
  const bool periodic = scene.ends == "periodic";
  Texture texture;
  texture.add(scene.texture, physics.effects.texture_height_scale, circumference, 0, length, physics.seed,
              Purpose::texture_drum, periodic);
  const double coating = physics.effects.drum_coating_m;
  out.free_radius = radius - coating;

  // Rows of vertices repeat with the period, and reach beyond both ends by more than a ball.
  const double rows = std::ceil(length / scene.mesh_resolution_m - 1e-9), row = length / rows;
  const double beyond = periodic ? row * std::ceil(4 * largest_radius(physics) / row) : 0;
  const auto bump = [&](double u, double z) {
    const double height = coating + texture.height(u, periodic ? z - length * std::floor(z / length) : z);
    out.free_radius = std::min(out.free_radius, radius - height);
    return height;
  };
  if (texture.num_bumps() > 0)
    out.tube = tube_mesh(radius, -beyond, length + beyond, row, bump);
  else
    out.tube = tube_mesh(radius - coating, -beyond, length + beyond, scene.mesh_resolution_m);

  // Flat ends, a little wider than the tube.
  const auto add_end = [&](double z, bool front_up) {
    TriangleMesh disc;
    add_ring(disc, 0, 1.02 * radius, z, std::max(scene.mesh_resolution_m, 0.2 * radius), front_up);
    out.ends.push_back(std::move(disc));
  };
  if (!periodic) add_end(0, true);
  if (scene.ends == "walls") add_end(length, false);
  return out;
}

/// Balls that wait at the upper end and come in by the clock.
struct Feeder {
  const RotatingDrumScene& scene;
  double debt_kg = 0, debt_before_kg = 0;
  std::vector<double> entered;  ///< (ids) time; NaN for the first filling [s]

  void feed(SceneRun& run) {
    const World& world = run.world;
    const double r = world.largest_radius;
    debt_kg += scene.feed_kg_s * world.physics.solver.outer_step_s;
    const auto id = [&] { return static_cast<std::uint32_t>(entered.size()); };
    const auto due = [&] { return 1 / world.inverse_mass(world.radius_of(id())); };
    for (; debt_kg >= due(); debt_kg -= due()) {
      const auto is_free = [&](const Eigen::Vector3d& at) {
        for (const Eigen::Vector3d& p : run.state.balls.position)
          if ((p - at).squaredNorm() < 4.1 * r * r) return false;
        return true;
      };
      bool placed = false;
      for (std::uint32_t attempt = 0; attempt < feed_attempts && !placed; ++attempt) {
        const auto draw = uniform4(world.physics.seed, Purpose::feed, id(), attempt);
        const Eigen::Vector3d at((draw[0] - 0.5) * scene.feed_zone_width_m,
                                 1.05 * r + draw[1] * (scene.feed_zone_length_m - 1.05 * r), 0);
        if (!is_free(at)) continue;
        run.add(at);
        placed = true;
      }
      if (!placed) return;
      entered.push_back(run.time());
    }
  }
};

/// What one time block shows.
struct Block {
  double angle, mass_centre_angle, surface, surface_velocity, zero, packing;
  std::vector<SliceField::Bin> bins;
  std::vector<SliceField::Point> points;
};

Block read_off(const SliceField& field, double radius, double diameter) {
  Block b{};
  const double nan = std::nan("");
  const SliceField::Line line = field.surface_line();
  const bool found = line.points >= 3;
  b.mass_centre_angle = field.mass_centre_angle();
  b.angle = found ? line.angle : nan;
  b.bins = field.profile(found ? line.angle : b.mass_centre_angle);
  b.points = field.surface();
  b.surface = SliceField::surface_position(b.bins);
  b.surface_velocity = SliceField::velocity_at(b.bins, b.surface);
  b.zero = SliceField::zero_position(b.bins);
  // Of the bed away from its surface and from the wall, where balls lie in layers.
  double sum = 0, count = 0;
  for (const SliceField::Bin& bin : b.bins)
    if (bin.y < b.surface - 3 * diameter && bin.y > -radius + 3 * diameter) {
      sum += bin.fraction;
      count += 1;
    }
  b.packing = count > 0 ? sum / count : nan;
  return b;
}

/// Over the blocks in which the number exists.
Estimate over(const std::vector<Block>& blocks, const std::function<double(const Block&)>& number) {
  std::vector<double> samples;
  for (const Block& b : blocks)
    if (const double v = number(b); std::isfinite(v)) samples.push_back(v);
  return samples.empty() ? Estimate{std::nan("")} : estimate(samples);
}

}  // namespace

void RotatingDrumScene::add_fields(FieldTable& table) {
  table.number("diameter_m", diameter_m, 0.01, 20, "inside, without texture and coating");
  table.number("length_m", length_m, 0.001, 100, "along the axis; of a periodic slice at least 3 balls");
  table.number("inclination_deg", inclination_deg, 0, 45, "of the axis, falling towards the outlet");
  table.number("angular_velocity_rad_s", angular_velocity_rad_s, 1e-3, 100, "below that at which balls centrifuge");
  table.text("ends", ends, {"periodic", "walls", "open_fed"},
             "periodic slice | flat ends turning with the drum | fed at the upper end, open at the lower one");
  table.number("fill", fill, 0, 0.5, "part of the cross-section that the bed takes at fill_packing (or num_balls)",
               true);
  table.number("fill_packing", fill_packing, 0.3, 0.74, "solid fraction of the bed that `fill` supposes");
  table.count("num_balls", num_balls, 0, 1e7, "put in at the beginning; 0: from `fill`");
  table.number("feed_kg_s", feed_kg_s, 0, 1e4, "open_fed: mass fed per second", true);
  table.number("feed_zone_length_m", feed_zone_length_m, 0.001, 100, "open_fed: balls come in this near the upper end");
  table.number("feed_zone_width_m", feed_zone_width_m, 0.001, 20, "open_fed: and this wide around the axis");
  table.number("mesh_resolution_m", mesh_resolution_m, 1e-4, 1, "edge length of the wall's triangles");
  table.number("texture_density_1_m2", texture.density_1_m2, 0, 1e6, "Gaussian bumps of the wall; 0: smooth");
  table.number("texture_height_min_m", texture.height_min_m, 0, 1, "of a bump");
  table.number("texture_height_max_m", texture.height_max_m, 0, 1, "of a bump");
  table.number("texture_width_min_m", texture.width_min_m, 1e-4, 1, "of a bump");
  table.number("texture_width_max_m", texture.width_max_m, 1e-4, 1, "of a bump");
  table.text("texture_width_is", texture.width_is, {"sigma", "two_sigma"}, "what the width of a Gaussian is");
  table.number("settle_turns", settle_turns, 0, 1e4, "before recording");
  table.number("record_turns", record_turns, 1e-3, 1e4, "averaged over, in eight blocks");
}

void RotatingDrumScene::validate(const Physics& physics, const Where& where) const {
  std::vector<std::string> idle = {"effects.outlet_coating_m"};
  if (texture.density_1_m2 == 0) idle.emplace_back("effects.texture_height_scale");
  refuse_effects(physics, where, idle, "drum");
  const auto refuse = [&](const char* key, const std::string& text) {
    throw InputError(fmt::format("{}scene.{}", where(std::string("scene.") + key), key) + text);
  };
  const double d = 2 * largest_radius(physics), radius = 0.5 * diameter_m;
  if (ends == "periodic" && length_m < 3 * d)
    refuse("length_m",
           fmt::format(" = {}: accepted is at least 3 balls of {} m, so that none meets itself", length_m, d));
  if (ends != "periodic" && length_m < 2 * d)
    refuse("length_m", fmt::format(" = {}: accepted is at least 2 balls of {} m", length_m, d));
  if (radius - physics.effects.drum_coating_m < 3 * d)
    refuse("diameter_m", fmt::format(" = {}: accepted is at least 6 balls of {} m between the walls", diameter_m, d));
  const double froude = angular_velocity_rad_s * angular_velocity_rad_s * radius / gravity;
  if (froude >= 1)
    refuse("angular_velocity_rad_s", fmt::format(" = {}: the balls centrifuge; accepted is less than {:.4g}",
                                                 angular_velocity_rad_s, std::sqrt(gravity / radius)));
  if (num_balls > 0 && !std::isnan(fill))
    refuse("num_balls", fmt::format(" = {}: accepted is either this or fill = {}, not both", num_balls, fill));
  const bool fed = ends == "open_fed";
  if (!fed && num_balls == 0 && !(fill > 0)) refuse("fill", " > 0 or scene.num_balls > 0 is needed");
  if (fed && !(feed_kg_s > 0)) refuse("feed_kg_s", " > 0 is needed with ends = \"open_fed\"");
  if (!fed && !std::isnan(feed_kg_s))
    refuse("feed_kg_s", fmt::format(" = {}: accepted only with ends = \"open_fed\"", feed_kg_s));
  if (fed && feed_zone_length_m < 2 * d)
    refuse("feed_zone_length_m", fmt::format(" = {}: accepted is at least 2 balls of {} m", feed_zone_length_m, d));
  if (fed && feed_zone_length_m > 0.5 * length_m)
    refuse("feed_zone_length_m", fmt::format(" = {}: accepted is at most half the drum's length", feed_zone_length_m));
  if (fed && feed_zone_width_m > diameter_m - 4 * d)
    refuse("feed_zone_width_m", fmt::format(" = {}: accepted is at most {}", feed_zone_width_m, diameter_m - 4 * d));
  if (texture.height_max_m < texture.height_min_m)
    refuse("texture_height_max_m",
           fmt::format(" = {}: accepted is at least texture_height_min_m", texture.height_max_m));
  if (texture.width_max_m < texture.width_min_m)
    refuse("texture_width_max_m", fmt::format(" = {}: accepted is at least texture_width_min_m", texture.width_max_m));
}

SceneResult RotatingDrumScene::run(const Physics& physics, const SceneObserver& observer) const {
  const double radius = 0.5 * diameter_m, d = physics.material.diameter_m, wall_speed = angular_velocity_rad_s * radius;
  const bool periodic = ends == "periodic", fed = ends == "open_fed";

  // World. Avalanches are a few times faster than the wall when that is slow.
  World world(physics, std::max(wall_speed, 0.25 * std::sqrt(gravity * diameter_m)));
  const double incline = inclination_deg * std::numbers::pi / 180;
  world.gravity_vector = gravity * Eigen::Vector3d(0, std::sin(incline), -std::cos(incline));
  if (periodic) world.set_period(length_m);
  DrumWalls walls = build_walls(*this, physics);
  Motion turning;
  turning.tilt.col(0) = Eigen::Vector3d(1, 0, 0);
  turning.tilt.col(1) = Eigen::Vector3d(0, 0, -1);
  turning.tilt.col(2) = Eigen::Vector3d(0, 1, 0);
  turning.angular_velocity = angular_velocity_rad_s;
  world.add_wall(std::move(walls.tube), mesh_resolution_m, turning);
  for (TriangleMesh& end : walls.ends)
    world.add_wall(std::move(end), std::max(mesh_resolution_m, 0.2 * radius), turning);

  // First filling: from the bottom up on a loose lattice with a fifth of its places left empty. (On a whole lattice the wall layer
  // keeps rows along the axis, as rollers do.)
  const double r = world.largest_radius, ball = world.mean_mass / physics.material.density_kg_m3, room = radius + 4 * r,
               beyond = 8 * r;
  SceneRun run(std::move(world), observer, {-room, -beyond, -room}, {room, length_m + beyond, room});
  run.threads = threads;
  const double volume = std::isnan(fill) ? 0 : fill * fill_packing * std::numbers::pi * radius * radius * length_m;
  const std::int64_t wanted = num_balls > 0 ? num_balls : std::llround(volume / ball);
  const double free = walls.free_radius - 1.02 * r, end_gap = periodic ? 0 : 0.05 * r;
  if (wanted > 0) {
    std::vector<Eigen::Vector3d> places =
        lattice({-radius, end_gap, -radius}, {radius, length_m - end_gap, radius}, r, physics.seed,
                [&](const Eigen::Vector3d& p) { return p[0] * p[0] + p[2] * p[2] < free * free; });
    if (static_cast<std::int64_t>(places.size()) < wanted)
      throw InputError(fmt::format("scene.{} = {}: {} balls do not fit loosely into the drum, {} do",
                                   num_balls > 0 ? "num_balls" : "fill",
                                   num_balls > 0 ? static_cast<double>(num_balls) : fill, wanted, places.size()));
    places.resize(std::min(places.size(), static_cast<std::size_t>(wanted + wanted / 4)));
    for (std::int64_t i = 0; i < wanted; ++i) {
      const auto draw = uniform4(physics.seed, Purpose::fill, static_cast<std::uint64_t>(i), 1)[0];
      const auto first = static_cast<std::size_t>(i);
      std::swap(places[first],
                places[first + static_cast<std::size_t>(draw * static_cast<double>(places.size() - first))]);
      run.add(places[first]);
    }
  }
  Feeder feeder{*this, 0, 0, std::vector<double>(static_cast<std::size_t>(wanted), std::nan(""))};

  // Where profiles are taken.
  const double from = periodic ? -beyond : 0.25 * length_m, to = periodic ? length_m + beyond : 0.75 * length_m;
  SliceField field(radius, d, periodic ? length_m : 0.5 * length_m);
  std::vector<double> kinetic, coordination, axial, inside, residence;
  std::vector<Block> blocks;
  std::int64_t left = 0;

  const double turn = 2 * std::numbers::pi / angular_velocity_rad_s, h = physics.solver.outer_step_s;
  const std::int64_t settle = std::llround(settle_turns * turn / h),
                     steps_a_block = std::max<std::int64_t>(
                         1, std::llround(record_turns * turn / h / static_cast<double>(num_blocks))),
                     last = settle + steps_a_block * static_cast<std::int64_t>(num_blocks);
  const double end = static_cast<double>(last) * h;
  while (run.state.num_steps < last) {
    const bool recording = run.state.num_steps >= settle;
    if (fed) feeder.feed(run);
    if (!run.step(recording ? "recording" : "settling", end)) break;

    // Over the open end.
    if (fed)
      left += static_cast<std::int64_t>(run.remove([&](std::size_t i) {
        if (run.state.balls.position[i][1] < length_m + 2 * r) return false;
        const double entered = feeder.entered[run.state.balls.id[i]];
        if (recording && std::isfinite(entered)) residence.push_back(run.time() - entered);
        return true;
      }));
    if (run.state.num_steps == settle) {
      left = 0;
      feeder.debt_before_kg = feeder.debt_kg;
    }
    if (!recording) continue;

    // One frame.
    const Balls& balls = run.state.balls;
    double v_y = 0, seen = 0;
    for (std::size_t i = 0; i < balls.size(); ++i) {
      const Eigen::Vector3d &p = balls.position[i], &v = balls.velocity[i];
      if (p[1] < from || p[1] > to) continue;
      field.add(p[0], p[2], v[0], v[2], sphere * balls.radius[i] * balls.radius[i] * balls.radius[i]);
      v_y += v[1];
      seen += 1;
    }
    field.end_frame();
    double touching = 0;
    for (const PairImpulse& pair : run.state.pairs) touching += pair.normal > 0 ? 1 : 0;
    const auto num = static_cast<double>(std::max<std::size_t>(1, balls.size()));
    coordination.push_back(2 * touching / num);
    kinetic.push_back(run.kinetic_energy());
    axial.push_back(seen > 0 ? v_y / seen : 0);
    inside.push_back(static_cast<double>(balls.size()));
    if ((run.state.num_steps - settle) % steps_a_block == 0) {
      blocks.push_back(read_off(field, radius, d));
      field.clear();
    }
  }

  const double recorded = static_cast<double>(kinetic.size()) * h;
  const double blocked = fed ? feeder.debt_kg - feeder.debt_before_kg : 0;
  SceneResult out = run.finish();

  // Observables.
  constexpr double degrees = 180 / std::numbers::pi;
  const auto add = [&](const char* name, const Estimate& e, const char* unit, double scale = 1) {
    out.observables.push_back(observable(name, e.mean * scale, e.sigma * scale, unit));
  };
  const auto of_blocks = [&](double Block::*member) {
    return over(blocks, [member](const Block& b) { return b.*member; });
  };
  add("charge_angle", of_blocks(&Block::angle), "deg", degrees);
  add("mass_centre_angle", of_blocks(&Block::mass_centre_angle), "deg", degrees);
  add("surface_position", of_blocks(&Block::surface), "m");
  add("surface_velocity", of_blocks(&Block::surface_velocity), "m/s");
  add("surface_velocity_ratio", of_blocks(&Block::surface_velocity), "1", 1 / wall_speed);
  add("zero_velocity_position", of_blocks(&Block::zero), "m");
  add("packing_fraction", of_blocks(&Block::packing), "1");
  add("axial_velocity", block_estimate(axial, num_blocks), "m/s");
  add("kinetic_energy", block_estimate(kinetic, num_blocks), "J");
  add("coordination_number", block_estimate(coordination, num_blocks), "1");
  add("holdup", block_estimate(inside, num_blocks), "balls");
  if (fed) {
    add("residence_time", residence.empty() ? Estimate{std::nan("")} : block_estimate(residence, num_blocks), "s");
    add("feed_rate", {feed_kg_s - (recorded > 0 ? blocked / recorded : 0), std::nan("")}, "kg/s");
    const double per_feed = ball * physics.material.density_kg_m3 / (feed_kg_s * recorded);
    const auto gone = static_cast<double>(left);
    add("outflow_over_feed", {gone * per_feed, std::sqrt(gone) * per_feed}, "1");
  }

  // Profile and surface.
  Series profile{"velocity_profile", {"y [m]", "u [m/s]", "sigma [m/s]", "solid fraction"}, {}};
  for (std::size_t b = 0; !blocks.empty() && b < blocks.front().bins.size(); ++b) {
    const Estimate u = over(blocks, [b](const Block& block) { return block.bins[b].u; });
    const Estimate fraction = over(blocks, [b](const Block& block) { return block.bins[b].fraction; });
    const double y = blocks.front().bins[b].y;
    if (!std::isfinite(u.mean) || fraction.mean < 0.05) continue;
    out.observables.push_back({"velocity_profile", y, u.mean, u.sigma, "m/s"});
    profile.values.insert(profile.values.end(), {y, u.mean, u.sigma, fraction.mean});
  }
  out.series.push_back(std::move(profile));
  Series surface{"free_surface", {"x [m]", "z [m]"}, {}};
  if (!blocks.empty())
    for (const SliceField::Point& p : blocks.back().points) surface.values.insert(surface.values.end(), {p.x, p.z});
  out.series.push_back(std::move(surface));
  return out;
}

}  // namespace drumsweep

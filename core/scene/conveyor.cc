#include "core/scene/conveyor.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "core/geometry/primitives.h"
#include "core/geometry/random.h"
#include "core/scene/scene_run.h"

namespace drumsweep {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr std::uint32_t max_attempts = 30;
constexpr double most_covered = 0.3;  // of the source by balls on their way out: random places are still found

double volume_of(double radius) { return 4 * std::numbers::pi / 3 * radius * radius * radius; }

/// Releases balls at random places of the source, as many as the rate says.
class Source {
 public:
  Source(const ConveyorScene& scene, std::int64_t seed) : scene_(scene), seed_(seed) {}

  std::vector<double> landings;  ///< (balls x 4): time, x, y, radius where a ball would touch the bare belt
  double released_kg = 0;

  void release(SceneRun& run, double duration) {
    owed_ += scene_.feed_rate_kg_s * duration;
    near_.clear();
    const double above = scene_.drop_height_m - 2 * run.world.largest_radius;
    for (const Eigen::Vector3d& p : run.state.balls.position)
      if (p[2] > above) near_.push_back(p);
    for (;;) {
      const auto id = static_cast<std::uint32_t>(run.num_added());
      const double radius = run.world.radius_of(id), mass = 1 / run.world.inverse_mass(radius);
      if (owed_ < mass) return;
      std::optional<Eigen::Vector3d> place;
      for (std::uint32_t attempt = 0; attempt < max_attempts && !place; ++attempt)
        place = find_place(id, attempt, radius, run.world.largest_radius);
      if (!place) return;  // later
      run.add(*place, {0, 0, -scene_.exit_speed_m_s});
      near_.push_back(*place);
      owed_ -= mass;
      released_kg += mass;
      const double u = scene_.exit_speed_m_s,
                   fall = (std::sqrt(u * u + 2 * gravity * ((*place)[2] - radius)) - u) / gravity;
      landings.insert(landings.end(), {run.time() + fall, (*place)[0], (*place)[1], radius});
    }
  }

 private:
  std::optional<Eigen::Vector3d> find_place(std::uint32_t id, std::uint32_t attempt, double radius,
                                            double largest) const {
    const auto u = uniform4(seed_, Purpose::feed, id, 2 * attempt),
               v = uniform4(seed_, Purpose::feed, id, 2 * attempt + 1);
    Eigen::Vector3d at((u[0] - 0.5) * scene_.source_length_m, 0, scene_.drop_height_m + radius);
    // Which of the two a ball belongs to is drawn once, or a full heap would push its balls into the band.
    if (uniform4(seed_, Purpose::feed, id)[1] < scene_.heap_share)
      at[1] = scene_.heap_at_m +
              scene_.heap_width_m * std::sqrt(-2 * std::log(1 - v[0])) * std::cos(2 * std::numbers::pi * v[1]);
    else
      at[1] = scene_.band_begin_m + u[2] * (scene_.band_end_m - scene_.band_begin_m);
    // Clear of the skirts, and not past an open edge.
    const double clear = scene_.edge == "skirt" ? radius : 0;
    if (at[1] < clear || at[1] > scene_.width_m - clear) return std::nullopt;
    for (const Eigen::Vector3d& p : near_)
      if ((p - at).squaredNorm() < 4.1 * largest * largest) return std::nullopt;
    return at;
  }

  const ConveyorScene& scene_;
  std::int64_t seed_;
  double owed_ = 0;
  std::vector<Eigen::Vector3d> near_;
};

/// Steepest of the slopes between neighbours [deg], with the error of that pair.
Estimate steepest(const std::vector<Estimate>& height, double cell) {
  Estimate out{0, nan};
  for (std::size_t j = 1; j < height.size(); ++j) {
    const double slope = std::abs(height[j].mean - height[j - 1].mean) / cell;
    const double angle = std::atan(slope) * 180 / std::numbers::pi;
    if (angle <= out.mean) continue;
    out.mean = angle;
    out.sigma = std::hypot(height[j].sigma, height[j - 1].sigma) / cell / (1 + slope * slope) * 180 / std::numbers::pi;
  }
  return out;
}

}  // namespace

void ConveyorScene::add_fields(FieldTable& table) {
  table.number("width_m", width_m, 0.005, 50, "of the belt, across");
  table.number("belt_speed_m_s", belt_speed_m_s, 1e-3, 20, "of the belt");
  table.number("length_m", length_m, 0.01, 100, "from the source to the belt's end");
  table.number("measure_from_m", measure_from_m, 0.001, 100, "the bed is measured from there to the end");
  table.text("edge", edge, {"skirt", "open"}, "skirt: standing plates along the edges; open: balls may fall over them");
  table.number("skirt_friction", skirt_friction, 0, 10, "Coulomb coefficient of the skirts");
  table.number("feed_rate_kg_s", feed_rate_kg_s, 1e-6, 1e5, "mass flow onto the belt");
  table.number("drop_height_m", drop_height_m, 0.001, 10, "of the source over the belt");
  table.number("exit_speed_m_s", exit_speed_m_s, 0.01, 20, "of the balls at the source, downwards");
  table.number("source_length_m", source_length_m, 0.001, 10, "of the source along the belt");
  table.number("band_begin_m", band_begin_m, 0, 50, "balls fall evenly from here, across the belt ...");
  table.number("band_end_m", band_end_m, 0, 50, "... to here");
  table.number("heap_share", heap_share, 0, 1, "part of the balls that falls on a narrow heap instead");
  table.number("heap_at_m", heap_at_m, 0, 50, "middle of the heap, across the belt");
  table.number("heap_width_m", heap_width_m, 1e-4, 10, "standard deviation of its places across the belt");
  table.number("measure_s", measure_s, 0.01, 10000, "time over which the bed is averaged, once it has reached the end");
  table.number("cell_m", cell_m, 1e-3, 10, "size of the profile's cells; adjusted to divide the width evenly");
  table.number("packing", packing, 0.1, 1, "of the bed, for heights from volumes");
}

void ConveyorScene::validate(const Physics& physics, const Where& where) const {
  refuse_effects(physics, where, {"effects.outlet_coating_m", "effects.drum_coating_m", "effects.texture_height_scale"},
                 "conveyor");
  const auto need = [&](bool ok, const char* key, double value, const std::string& accepted) {
    if (!ok)
      throw InputError(
          fmt::format("{}scene.{} = {}: accepted is {}", where(std::string("scene.") + key), key, value, accepted));
  };
  const World world(physics, 1);
  const double d = 2 * world.largest_radius;
  need(width_m >= 2 * d, "width_m", width_m, fmt::format("two diameters of the largest ball, {} m, and more", 2 * d));
  need(measure_from_m < length_m - 2 * d, "measure_from_m", measure_from_m,
       fmt::format("below length_m less two diameters, {}", length_m - 2 * d));
  need(measure_from_m > 0.5 * source_length_m, "measure_from_m", measure_from_m,
       fmt::format("beyond the source, {}", 0.5 * source_length_m));
  const double clear = edge == "skirt" ? d : 0;
  need(band_end_m <= width_m, "band_end_m", band_end_m, fmt::format("up to width_m = {}", width_m));
  need(heap_share == 1 || band_end_m - band_begin_m > clear, "band_end_m", band_end_m,
       fmt::format("beyond band_begin_m + {}", clear));
  need(heap_at_m <= width_m, "heap_at_m", heap_at_m, fmt::format("up to width_m = {}", width_m));
  // Balls on their way out must leave room for the next ones.
  const double per_second = feed_rate_kg_s / world.mean_mass, footprint = std::numbers::pi / 4 * d * d;
  const auto most = [&](double share, double across) {
    return most_covered * source_length_m * across * exit_speed_m_s / (d * footprint * share * per_second) *
           feed_rate_kg_s;
  };
  const double accepted = std::min(heap_share < 1 ? most(1 - heap_share, band_end_m - band_begin_m) : 1e300,
                                   heap_share > 0 ? most(heap_share, std::max(d, 2.5 * heap_width_m)) : 1e300);
  need(feed_rate_kg_s <= accepted, "feed_rate_kg_s", feed_rate_kg_s,
       fmt::format(
           "up to {:.4g}, which such a source can release; a longer source or a higher exit_speed_m_s releases more",
           accepted));
}

int ConveyorScene::num_cells() const { return std::max(1, static_cast<int>(std::lround(width_m / cell_m))); }

std::vector<Landing> ConveyorScene::landings(const SceneResult& result) {
  std::vector<Landing> out;
  for (const Series& s : result.series) {
    if (s.name != "landings") continue;
    for (std::size_t i = 0; i + 3 < s.values.size(); i += 4) {
      Landing landing;
      landing.time = s.values[i];
      landing.x = s.values[i + 1];
      landing.y = s.values[i + 2];
      landing.radius = static_cast<float>(s.values[i + 3]);
      landing.ball_id = static_cast<std::uint32_t>(i / 4);
      out.push_back(landing);
    }
  }
  return out;
}

SceneResult ConveyorScene::run(const Physics& physics, const SceneObserver& observer) const {
  const double impact = std::sqrt(exit_speed_m_s * exit_speed_m_s + 2 * gravity * drop_height_m);
  World world(physics, std::max(impact, belt_speed_m_s));
  const double d = 2 * world.largest_radius, before = 0.5 * source_length_m + 20 * d, after = 5 * d;
  const double sill = drop_height_m + 4 * d;

  TriangleMesh belt;
  add_plate(belt, {-before, 0, 0}, {before + length_m + after, 0, 0}, {0, width_m, 0});
  Motion motion;
  motion.belt = {belt_speed_m_s, 0, 0};
  const double resolution = std::max(width_m, length_m);
  world.add_wall(std::move(belt), resolution, motion);
  if (edge == "skirt") {
    TriangleMesh skirts;
    const Eigen::Vector3d along(before + length_m + after, 0, 0), up(0, 0, sill);
    add_plate(skirts, {-before, 0, 0}, up, along);
    add_plate(skirts, {-before, width_m, 0}, along, up);
    Surface surface = wall_surface(physics);
    surface.friction = skirt_friction;
    surface.friction_speed.on = false;
    surface.rolling = surface.twisting = 0;
    world.add_wall(std::move(skirts), resolution, {}, surface);
  }

  const double below = 0.1;
  SceneRun run(std::move(world), observer, {-before, -1, -1}, {length_m + 1, width_m + 1, sill + 1});
  run.threads = threads;
  Source source(*this, physics.seed);
  std::int64_t spilled = 0, spilled_before = 0, removed = 0, removed_before = 0;

  // Time-averaged profiles, one sample whenever the belt has moved on by a cell.
  const int cells = num_cells();
  const double cell = width_m / cells, end = length_m - d, section = end - measure_from_m,
               interval = cell / belt_speed_m_s;
  const int rows = std::max(1, static_cast<int>(std::floor(section / cell)));
  std::vector<std::vector<double>> volume(static_cast<std::size_t>(cells)), surface(volume);
  std::vector<double> mean_height, mean_surface, carried;
  const auto sample = [&] {
    std::vector<double> filled(static_cast<std::size_t>(cells), 0.0), top(static_cast<std::size_t>(cells * rows), 0.0);
    double speed = 0, num = 0, total = 0, tops = 0;
    const Balls& b = run.state.balls;
    for (std::size_t i = 0; i < b.size(); ++i) {
      const Eigen::Vector3d& p = b.position[i];
      if (p[0] < measure_from_m || p[0] >= end || p[2] < 0 || p[1] < 0 || p[1] > width_m) continue;
      const int j = std::clamp(static_cast<int>(p[1] / cell), 0, cells - 1);
      const int row = std::min(rows - 1, static_cast<int>((p[0] - measure_from_m) / section * rows));
      filled[static_cast<std::size_t>(j)] += volume_of(b.radius[i]) / (packing * cell * section);
      double& highest = top[static_cast<std::size_t>(row * cells + j)];
      highest = std::max(highest, p[2] + b.radius[i]);
      speed += b.velocity[i][0] / belt_speed_m_s;
      ++num;
    }
    for (std::size_t j = 0; j < filled.size(); ++j) {
      double height = 0;
      for (int row = 0; row < rows; ++row) height += top[static_cast<std::size_t>(row * cells) + j] / rows;
      volume[j].push_back(filled[j]);
      surface[j].push_back(height);
      total += filled[j] / cells;
      tops += height / cells;
    }
    mean_height.push_back(total);
    mean_surface.push_back(tops);
    if (num > 0) carried.push_back(speed / num);
  };

  const double filling = (length_m + before) / belt_speed_m_s + std::sqrt(2 * drop_height_m / gravity),
               stop = filling + measure_s, dt = physics.solver.outer_step_s;
  double next_sample = filling;
  const auto feed_and_clear = [&] {
    const auto is_spilled = [&](std::size_t i) {
      const Eigen::Vector3d& p = run.state.balls.position[i];
      return p[2] < -below && p[0] <= length_m;
    };
    spilled += static_cast<std::int64_t>(run.remove(is_spilled));
    removed +=
        static_cast<std::int64_t>(run.remove([&](std::size_t i) { return run.state.balls.position[i][0] > length_m; }));
    source.release(run, dt);
  };
  run.run_until("filling", filling, [&] {
    feed_and_clear();
    return false;
  });
  spilled_before = spilled;
  removed_before = removed;
  const double released_before = source.released_kg, measured_from = run.time();
  run.run_until("measuring", stop, [&] {
    feed_and_clear();
    if (run.time() >= next_sample) {
      sample();
      next_sample += interval;
    }
    return false;
  });

  const double rate = (source.released_kg - released_before) / std::max(dt, run.time() - measured_from);
  const double left = static_cast<double>(spilled - spilled_before + removed - removed_before);
  SceneResult out = run.finish();
  std::vector<Estimate> heights, tops;
  Series profile{"profile", {"y [m]", "height [m]", "its error [m]", "surface [m]", "its error [m]"}, {}};
  for (int j = 0; j < cells; ++j) {
    const double y = (j + 0.5) * cell;
    heights.push_back(block_estimate(volume[static_cast<std::size_t>(j)]));
    tops.push_back(block_estimate(surface[static_cast<std::size_t>(j)]));
    out.observables.push_back({"bed_height", y, heights.back().mean, heights.back().sigma, "m"});
    profile.values.insert(profile.values.end(),
                          {y, heights.back().mean, heights.back().sigma, tops.back().mean, tops.back().sigma});
  }
  for (int j = 0; j < cells; ++j) {
    const Estimate& e = tops[static_cast<std::size_t>(j)];
    out.observables.push_back({"surface_height", (j + 0.5) * cell, e.mean, e.sigma, "m"});
  }
  const auto add = [&](const char* name, const Estimate& e, const char* unit) {
    out.observables.push_back(observable(name, e.mean, e.sigma, unit));
  };
  const Estimate mean = block_estimate(mean_height), top = block_estimate(mean_surface);
  add("mean_height", mean, "m");
  add("mean_surface_height", top, "m");
  add("max_slope", steepest(heights, cell), "deg");
  add("max_surface_slope", steepest(tops, cell), "deg");
  add("bed_speed_over_belt_speed", block_estimate(carried), "1");
  out.observables.push_back(observable("released", rate, nan, "kg/s"));
  out.observables.push_back(
      observable("spilled_share", left > 0 ? static_cast<double>(spilled - spilled_before) / left : nan, nan, "1"));
  out.series.push_back({"landings", {"time [s]", "x [m]", "y [m]", "radius [m]"}, std::move(source.landings)});
  out.series.push_back(std::move(profile));
  return out;
}

}  // namespace drumsweep

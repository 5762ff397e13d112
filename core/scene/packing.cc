#include "core/scene/packing.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/geometry/primitives.h"
#include "core/geometry/random.h"
#include "core/scene/scene_run.h"

namespace drumsweep {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

struct Region {
  Eigen::Vector3d low, high;
  bool holds(const Eigen::Vector3d& p) const {
    return (p.array() >= low.array()).all() && (p.array() <= high.array()).all();
  }
  double volume() const { return (high - low).prod(); }
  bool empty() const { return ((high - low).array() <= 0).any(); }
};

/// Volume of a ball inside a region: all of it, or counted on a grid of points where the region's boundary cuts the ball.
double volume_inside(const Eigen::Vector3d& centre, double r, const Region& region) {
  if (((centre - region.low).array() <= -r).any() || ((region.high - centre).array() <= -r).any()) return 0;
  const double all = 4 * std::numbers::pi / 3 * r * r * r;
  if (((centre - region.low).array() >= r).all() && ((region.high - centre).array() >= r).all()) return all;
  constexpr int n = 16;
  int in_ball = 0, in_both = 0;
  for (int x = 0; x < n; ++x)
    for (int y = 0; y < n; ++y)
      for (int z = 0; z < n; ++z) {
        const Eigen::Vector3d q = r * (2 * Eigen::Vector3d(x + 0.5, y + 0.5, z + 0.5) / n - Eigen::Vector3d::Ones());
        if (q.squaredNorm() > r * r) continue;
        ++in_ball;
        in_both += region.holds(centre + q) ? 1 : 0;
      }
  return all * in_both / in_ball;
}

/// Contacts of each ball that carry load, balls and walls.
struct Network {
  std::vector<int> num;       ///< (balls)
  std::vector<char> rattles;  ///< (balls)
  std::vector<int> backbone;  ///< (balls) contacts with others that do not rattle
  double mean_force = 0;      ///< or impulse; of all pressed contacts
};

Network network_of(const BallState& state, double fraction) {
  const std::size_t n = state.balls.size();
  Network out{std::vector<int>(n, 0), std::vector<char>(n, 0), std::vector<int>(n, 0), 0};
  double sum = 0, count = 0;
  const auto add = [&](float normal) {
    if (normal > 1e-20f) {
      sum += static_cast<double>(normal);
      ++count;
    }
  };
  for (const PairImpulse& p : state.pairs) add(p.normal);
  for (const WallImpulse& p : state.walls) add(p.normal);
  if (count > 0) out.mean_force = sum / count;
  const auto carries = [&](float normal) {
    return normal > 1e-20f && static_cast<double>(normal) >= fraction * out.mean_force;
  };
  // Walls bear and balls bear on each other; what presses a ball down is another one above it.
  out.rattles.assign(n, 1);
  for (const PairImpulse& p : state.pairs)
    if (carries(p.normal)) {
      ++out.num[p.a];
      ++out.num[p.b];
      out.rattles[state.balls.position[p.a][2] > state.balls.position[p.b][2] ? p.b : p.a] = 0;
    }
  for (const WallImpulse& p : state.walls)
    if (carries(p.normal)) ++out.num[p.ball];
  for (std::size_t i = 0; i < n; ++i)
    if (out.num[i] > 3) out.rattles[i] = 0;
  for (const PairImpulse& p : state.pairs)
    if (carries(p.normal) && !out.rattles[p.a] && !out.rattles[p.b]) {
      ++out.backbone[p.a];
      ++out.backbone[p.b];
    }
  for (const WallImpulse& p : state.walls)
    if (carries(p.normal) && !out.rattles[p.ball]) ++out.backbone[p.ball];
  return out;
}

}  // namespace

void PackingScene::add_fields(FieldTable& table) {
  table.number("width_m", width_m, 1e-3, 100, "of the box, along x");
  table.number("depth_m", depth_m, 1e-3, 100, "of the box, along y");
  table.flag("periodic", periodic, "along y, instead of walls there");
  table.count("num_balls", num_balls, 1, 10000000, "in the box");
  table.number("shake_m_s", shake_m_s, 0, 10,
               "random velocities at the beginning, which undo the lattice they start on");
  table.number("rest_speed_m_s", rest_speed_m_s, 1e-9, 1, "root mean square speed of the balls that counts as rest");
  table.number("max_settle_s", max_settle_s, 1e-3, 1000, "waits for rest no longer than this");
  table.number("measure_s", measure_s, 1e-3, 1000, "forces, overlap and contacts are averaged over this time at rest");
  table.number("margin_diameters", margin_diameters, 0, 20, "the bulk keeps this far from walls, floor and surface");
  table.number("contact_force_fraction", contact_force_fraction, 0, 0.1,
               "contacts that carry less than this part of the mean normal force are not counted");
}

void PackingScene::validate(const Physics& physics, const Where& where) const {
  refuse_effects(physics, where, {"effects.outlet_coating_m", "effects.drum_coating_m", "effects.texture_height_scale"},
                 "packing");
  // A periodic box must be wide enough that a ball does not see another one twice.
  const double d = 2 * World(physics, 1).largest_radius, least_depth = (periodic ? 4 : 1.1) * d;
  const auto need = [&](const char* key, double value, double least) {
    if (value < least)
      throw InputError(fmt::format("{}scene.{} = {}: accepted for balls up to {} m is {} and more",
                                   where(std::string("scene.") + key), key, value, d, least));
  };
  need("width_m", width_m, 1.1 * d);
  need("depth_m", depth_m, least_depth);
}

SceneResult PackingScene::run(const Physics& physics, const SceneObserver& observer) const {
  World world(physics, std::max(0.5, 2 * shake_m_s));
  const double d = physics.material.diameter_m, largest = world.largest_radius;
  // Room for all on a loose lattice.
  const double cell = 2.04 * largest, per_layer = std::floor(width_m / cell) * std::floor(depth_m / cell);
  const double height = cell * (std::ceil(static_cast<double>(num_balls) / per_layer) + 1), top = height + 1;
  const double over = periodic ? 4 * largest : 0;  // a periodic box has its walls reach beyond both ends

  // Each wall by itself, for its force: floor, x low, x high, y low, y high.
  std::vector<std::string> names{"floor", "wall_x_low", "wall_x_high"};
  if (!periodic) names.insert(names.end(), {"wall_y_low", "wall_y_high"});
  const Eigen::Vector3d low(0, -over, 0), high(width_m, depth_m + over, top);
  for (std::size_t w = 0; w < names.size(); ++w) {
    const BoxSides side{w == 1, w == 2, w == 3, w == 4, w == 0, false};
    world.add_wall(box_mesh(low, high, side), std::max(width_m, depth_m));
  }
  if (periodic) world.set_period(depth_m);

  SceneRun run(std::move(world), observer, low - Eigen::Vector3d::Constant(10 * d),
               high + Eigen::Vector3d::Constant(10 * d));
  run.threads = threads;
  std::vector<Eigen::Vector3d> places = lattice({0, 0, 0}, {width_m, depth_m, height}, largest, physics.seed);
  places.resize(static_cast<std::size_t>(num_balls));
  std::uint64_t index = 1u << 31;  // beyond the lattice's own draws
  for (const Eigen::Vector3d& at : places) {
    const auto u = uniform4(physics.seed, Purpose::fill, index++);
    run.add(at, shake_m_s * Eigen::Vector3d(2 * u[0] - 1, 2 * u[1] - 1, 2 * u[2] - 1));
  }
  double weight = 0;
  for (const double r : run.state.balls.radius) weight += gravity / run.world.inverse_mass(r);

  // Rest is judged after the fall.
  const auto mean_square = [&] {
    double sum = 0;
    for (const Eigen::Vector3d& v : run.state.balls.velocity) sum += v.squaredNorm();
    return sum / static_cast<double>(std::max<std::size_t>(1, run.state.balls.size()));
  };
  const double falling = std::sqrt(2 * height / gravity);
  run.run_until("settling", max_settle_s,
                [&] { return run.time() > falling && mean_square() < rest_speed_m_s * rest_speed_m_s; });
  const double settled = run.time();

  // At rest: forces, overlaps and contacts.
  const std::size_t num_walls = names.size();
  std::vector<std::vector<double>> pressing(num_walls), carrying(num_walls);
  std::vector<double> vertical, overlap, twice_contacts, twice_backbone, coordination, backbone, rattling;
  constexpr std::array<std::array<double, 3>, 5> inward{{{0, 0, 1}, {1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}}};
  const double margin = margin_diameters * d;
  const auto region = [&] {
    // The free surface lies where 95 % of the balls are lower.
    std::vector<double> heights;
    for (const Eigen::Vector3d& p : run.state.balls.position) heights.push_back(p[2]);
    const auto place = heights.begin() + static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(heights.size() - 1));
    std::nth_element(heights.begin(), place, heights.end());
    return Region{{margin, periodic ? 0 : margin, margin},
                  {width_m - margin, depth_m - (periodic ? 0 : margin), *place - margin}};
  };
  run.run_until("measuring", settled + measure_s, [&] {
    if (run.state.balls.size() == 0) return true;
    double up = 0;
    for (std::size_t w = 0; w < num_walls; ++w) {
      const Eigen::Vector3d force = run.wall_force(w);
      pressing[w].push_back(force.dot(Eigen::Vector3d(inward[w][0], inward[w][1], inward[w][2])));
      carrying[w].push_back(force[2]);
      up += force[2];
    }
    vertical.push_back(up / weight);
    overlap.push_back(run.last_report().mean_overlap);

    const Network net = network_of(run.state, contact_force_fraction);
    const Region bulk = region();
    double halves = 0, backbone_halves = 0, backbone_balls = 0, in_bulk = 0, in_backbone = 0, all = 0, some = 0;
    for (std::size_t i = 0; i < net.num.size(); ++i) {
      if (!bulk.holds(run.state.balls.position[i])) continue;
      ++in_bulk;
      all += net.num[i];
      if (net.rattles[i]) continue;
      ++in_backbone;
      some += net.backbone[i];
    }
    // Of the whole pile, contacts with walls counted whole.
    for (const WallImpulse& p : run.state.walls)
      if (static_cast<double>(p.normal) >= contact_force_fraction * net.mean_force) {
        ++halves;
        backbone_halves += net.rattles[p.ball] ? 0 : 1;
      }
    for (std::size_t i = 0; i < net.num.size(); ++i) {
      halves += net.num[i];
      if (net.rattles[i]) continue;
      backbone_halves += net.backbone[i];
      ++backbone_balls;
    }
    twice_contacts.push_back(halves / static_cast<double>(net.num.size()));
    if (backbone_balls > 0) twice_backbone.push_back(backbone_halves / backbone_balls);
    if (in_bulk > 0) {
      coordination.push_back(all / in_bulk);
      rattling.push_back(1 - in_backbone / in_bulk);
    }
    if (in_backbone > 0) backbone.push_back(some / in_backbone);
    return false;
  });

  // Packing fraction of the bulk, balls cut by its boundary counted in part; its error from slabs.
  const Region bulk = run.state.balls.size() > 0 ? region() : Region{low, low};
  constexpr int num_slabs = 4;
  std::vector<double> fraction;
  if (!bulk.empty())
    for (int s = 0; s < num_slabs; ++s) {
      Region slab = bulk;
      const double rise = (bulk.high[2] - bulk.low[2]) / num_slabs;
      slab.low[2] = bulk.low[2] + rise * s;
      slab.high[2] = slab.low[2] + rise;
      double filled = 0;
      for (std::size_t i = 0; i < run.state.balls.size(); ++i)
        for (const double shift : {0.0, -depth_m, depth_m}) {
          if (shift != 0 && !periodic) continue;
          filled += volume_inside(run.state.balls.position[i] + Eigen::Vector3d(0, shift, 0), run.state.balls.radius[i],
                                  slab);
        }
      fraction.push_back(filled / slab.volume());
    }

  const double speed = std::sqrt(mean_square());
  SceneResult out = run.finish();
  const auto add = [&](const std::string& name, const std::vector<double>& series, const char* unit) {
    const Estimate e = series.empty() ? Estimate{nan, nan} : block_estimate(series);
    out.observables.push_back(observable(name, e.mean, e.sigma, unit));
  };
  const Estimate packed = fraction.empty() ? Estimate{nan, nan} : estimate(fraction);
  out.observables.push_back(observable("packing_fraction", packed.mean, packed.sigma, "1"));
  add("coordination", coordination, "1");
  add("coordination_without_rattlers", backbone, "1");
  add("rattlers", rattling, "1");
  add("twice_contacts_per_ball", twice_contacts, "1");
  add("twice_contacts_without_rattlers", twice_backbone, "1");
  add("mean_overlap", overlap, "diameters");
  out.observables.push_back(observable("weight", weight, nan, "N"));
  add("carried", vertical, "1");
  for (std::size_t w = 0; w < num_walls; ++w) {
    add(names[w] + "_normal_force", pressing[w], "N");
    if (w > 0) add(names[w] + "_upward_force", carrying[w], "N");
  }
  out.observables.push_back(observable("rms_speed", speed, nan, "m/s"));
  out.observables.push_back(observable("settled_after", settled, nan, "s"));
  return out;
}

}  // namespace drumsweep

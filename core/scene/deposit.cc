#include "core/scene/deposit.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <unordered_map>

#include "core/geometry/random.h"

namespace drumsweep {
namespace {

// A source gives up for this step after so many places in a row were taken.
constexpr int most_attempts = 40;

constexpr double hold_s = 0.1, creep_s = 0.2;

double mass_of(const SceneRun& run, std::size_t i) { return 1 / run.world.inverse_mass(run.state.balls.radius[i]); }

}  // namespace

void Source::pour(SceneRun& run, double& debt_kg, const Place& place, const Eigen::Vector3d& velocity) {
  const Balls& balls = run.state.balls;
  const std::int64_t seed = run.world.physics.seed;
  const double reach = 2.02 * run.world.largest_radius;
  int failed = 0;
  while (debt_kg >= run.world.mean_mass && failed < most_attempts) {
    const auto u = uniform4(seed, Purpose::feed, draws_++);
    const Eigen::Vector3d at = place(u[0], u[1], u[2]);
    const bool taken = std::any_of(balls.position.begin(), balls.position.end(), [&](const Eigen::Vector3d& p) {
      return std::abs(p[2] - at[2]) < reach && run.world.apart(p, at).squaredNorm() < reach * reach;
    });
    if (taken) {
      ++failed;
      continue;
    }
    run.add(at, velocity);
    debt_kg -= mass_of(run, balls.size() - 1);
    failed = 0;
  }
}

std::vector<Eigen::Vector3d> loose_lattice(const Eigen::Vector3d& low, const Eigen::Vector3d& high, double radius,
                                           std::int64_t seed, const std::function<bool(const Eigen::Vector3d&)>& keep) {
  constexpr double looser = 1.25 / 1.02, shake = 0.2;  // cells 2.5 radii wide leave 0.5; 0.02 go to lattice()
  std::vector<Eigen::Vector3d> out = lattice(low, high, looser * radius, seed);
  std::uint64_t index = 0;
  for (Eigen::Vector3d& at : out) {
    const auto u = uniform4(seed, Purpose::fill, index++, 1);
    at += shake * radius * Eigen::Vector3d(2 * u[0] - 1, 2 * u[1] - 1, 2 * u[2] - 1);
  }
  if (keep) std::erase_if(out, [&](const Eigen::Vector3d& at) { return !keep(at); });
  return out;
}

double loose_height(std::size_t num, const Eigen::Vector3d& low, const Eigen::Vector3d& high, double radius,
                    const std::function<bool(const Eigen::Vector3d&)>& keep) {
  // What the random moves put outside differs from layer to layer; ten layers tell the mean well enough.
  constexpr int layers = 10;
  Eigen::Vector3d top = high;
  top[2] = low[2] + layers * 2.5 * radius * (1 + 1e-9);
  const std::size_t held = std::max<std::size_t>(1, loose_lattice(low, top, radius, 1, keep).size());
  return (1.02 * static_cast<double>(num * layers) / static_cast<double>(held) + 2) * 2.5 * radius;
}

void glue_base(SceneRun& run, double x_low, double x_high, double y_low, double y_high,
               const std::function<bool(double x, double y)>& keep) {
  const Physics& physics = run.world.physics;
  const double d = physics.material.diameter_m;
  // Rows along x, spread so that they fill the width (and close a period).
  const int rows = std::max(1, static_cast<int>(std::ceil((y_high - y_low) / (0.5 * std::numbers::sqrt3 * d) - 1e-9))),
            columns = static_cast<int>(std::ceil((x_high - x_low) / d - 1e-9)) + 1;
  const double step = (y_high - y_low) / rows;
  std::uint64_t index = 0;
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      const auto u = uniform4(physics.seed, Purpose::fill, index++, 2);
      const double x = x_low + (i + 0.5 * (j % 2)) * d + 0.15 * d * (2 * u[0] - 1),
                   y = y_low + (j + 0.5) * step + 0.15 * d * (2 * u[1] - 1);
      if (keep(x, y)) run.add_fixed({x, y, -0.5 * d - 0.3 * d * u[2]}, 0.5 * d);
    }
}

bool is_free(const Balls& balls, std::size_t i) { return balls.exit[i] != static_cast<std::uint8_t>(Exit::fixed); }

std::vector<int> contacts_of_balls(const BallState& state) {
  std::vector<int> out(state.balls.size(), 0);
  for (const PairImpulse& p : state.pairs)
    if (p.normal > 0) {
      ++out[p.a];
      ++out[p.b];
    }
  for (const WallImpulse& w : state.walls)
    if (w.normal > 0) ++out[w.ball];
  return out;
}

double kinetic_energy_per_ball(const SceneRun& run) {
  const Balls& balls = run.state.balls;
  double free = 0, sum = 0;
  for (std::size_t i = 0; i < balls.size(); ++i) {
    if (!is_free(balls, i)) continue;
    free += 1;
    sum += 0.5 * mass_of(run, i) * balls.velocity[i].squaredNorm();
  }
  return free == 0 ? 0 : sum / (free * run.world.mean_mass * gravity * run.world.physics.material.diameter_m);
}

Rest come_to_rest(SceneRun& run, double longest_s, const std::function<void()>& after_step) {
  Rest out;
  const double begin = run.time(), end = begin + longest_s;
  double quiet_since = -1;
  run.run_until("settling", end, [&] {
    if (after_step) after_step();
    const bool quiet = kinetic_energy_per_ball(run) < at_rest;
    if (!quiet) quiet_since = -1;
    if (quiet && quiet_since < 0) quiet_since = run.time();
    out.reached = quiet && run.time() - quiet_since >= hold_s;
    return out.reached;
  });
  out.time = out.reached ? quiet_since : run.time();

  std::unordered_map<std::uint32_t, Eigen::Vector3d> before;
  for (std::size_t i = 0; i < run.state.balls.size(); ++i)
    if (is_free(run.state.balls, i)) before.emplace(run.state.balls.id[i], run.state.balls.position[i]);
  const double from = run.time();
  run.run_until("watching it rest", from + creep_s, [&] {
    if (after_step) after_step();
    return false;
  });
  double moved = 0, num = 0;
  for (std::size_t i = 0; i < run.state.balls.size(); ++i) {
    const auto old = before.find(run.state.balls.id[i]);
    if (old == before.end()) continue;
    moved += run.world.apart(run.state.balls.position[i], old->second).norm();
    num += 1;
  }
  out.creep = num > 0 ? moved / num / std::max(run.time() - from, 1e-12) : 0;
  out.kinetic_energy = kinetic_energy_per_ball(run);
  return out;
}

void add_rest(const Rest& rest, std::vector<Observable>& out) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  out.push_back(observable("residual_kinetic_energy", rest.kinetic_energy, nan, "m g d per ball"));
  out.push_back(observable("creep", rest.creep, nan, "m/s"));
  out.push_back(observable("at_rest", rest.reached ? 1 : 0, nan, "1"));
}

HeightMap surface_from_above(const Balls& balls, double x_low, double x_high, double y_low, double y_high, double cell,
                             double floor, double period, const std::function<bool(std::size_t)>& counts) {
  HeightMap map{x_low, y_low, cell, 0, 0, {}};
  map.nx = std::max(1, static_cast<int>(std::lround((x_high - x_low) / cell)));
  map.ny = std::max(1, static_cast<int>(std::lround((y_high - y_low) / cell)));
  map.height.assign(static_cast<std::size_t>(map.nx) * static_cast<std::size_t>(map.ny), floor);
  for (std::size_t b = 0; b < balls.size(); ++b) {
    if (!counts(b)) continue;
    const double r = balls.radius[b];
    for (int image = period > 0 ? -1 : 0; image <= (period > 0 ? 1 : 0); ++image) {
      const Eigen::Vector3d p = balls.position[b] + Eigen::Vector3d(0, image * period, 0);
      const auto first = [&](double v, double low) {
        return std::max(0, static_cast<int>(std::ceil((v - r - low) / cell - 0.5)));
      };
      const auto last = [&](double v, double low, int n) {
        return std::min(n - 1, static_cast<int>(std::floor((v + r - low) / cell - 0.5)));
      };
      for (int j = first(p[1], y_low); j <= last(p[1], y_low, map.ny); ++j)
        for (int i = first(p[0], x_low); i <= last(p[0], x_low, map.nx); ++i) {
          const double dx = map.x(i) - p[0], dy = map.y(j) - p[1], left = r * r - dx * dx - dy * dy;
          if (left < 0) continue;
          double& h =
              map.height[static_cast<std::size_t>(j) * static_cast<std::size_t>(map.nx) + static_cast<std::size_t>(i)];
          h = std::max(h, p[2] + std::sqrt(left));
        }
    }
  }
  return map;
}

Estimate packing_fraction(const Balls& balls, const Eigen::Vector3d& low, const Eigen::Vector3d& high, double period,
                          const std::function<bool(const Eigen::Vector3d&)>& within,
                          const std::function<std::size_t(const Eigen::Vector3d&)>& part, std::size_t num_parts) {
  double mean_radius = 0;
  for (const double r : balls.radius) mean_radius += r / static_cast<double>(balls.size());
  const Eigen::Vector3d room = high - low;
  if (balls.size() == 0 || !(room.minCoeff() > 0)) return {};
  const double cell = mean_radius / 3;
  const Eigen::Array3i n = (room / cell).array().floor().cast<int>().max(1);
  const auto index = [&](int i, int j, int k) {
    return (static_cast<std::size_t>(k) * static_cast<std::size_t>(n[1]) + static_cast<std::size_t>(j)) *
               static_cast<std::size_t>(n[0]) +
           static_cast<std::size_t>(i);
  };
  const Eigen::Vector3d step = room.array() / n.cast<double>();
  std::vector<char> full(
      static_cast<std::size_t>(n[0]) * static_cast<std::size_t>(n[1]) * static_cast<std::size_t>(n[2]), 0);
  for (std::size_t b = 0; b < balls.size(); ++b)
    for (int image = period > 0 ? -1 : 0; image <= (period > 0 ? 1 : 0); ++image) {
      const Eigen::Vector3d p = balls.position[b] + Eigen::Vector3d(0, image * period, 0) - low;
      const double r = balls.radius[b];
      Eigen::Array3i from, to;
      for (int k = 0; k < 3; ++k) {
        from[k] = std::max(0, static_cast<int>(std::ceil((p[k] - r) / step[k] - 0.5)));
        to[k] = std::min(n[k] - 1, static_cast<int>(std::floor((p[k] + r) / step[k] - 0.5)));
      }
      for (int k = from[2]; k <= to[2]; ++k)
        for (int j = from[1]; j <= to[1]; ++j)
          for (int i = from[0]; i <= to[0]; ++i) {
            const Eigen::Vector3d q((i + 0.5) * step[0], (j + 0.5) * step[1], (k + 0.5) * step[2]);
            if ((q - p).squaredNorm() <= r * r) full[index(i, j, k)] = 1;
          }
    }
  std::vector<double> in(num_parts, 0), all(num_parts, 0);
  for (int k = 0; k < n[2]; ++k)
    for (int j = 0; j < n[1]; ++j)
      for (int i = 0; i < n[0]; ++i) {
        const Eigen::Vector3d q = low + Eigen::Vector3d((i + 0.5) * step[0], (j + 0.5) * step[1], (k + 0.5) * step[2]);
        if (!within(q)) continue;
        const std::size_t which = part(q);
        all[which] += 1;
        in[which] += full[index(i, j, k)];
      }
  std::vector<double> parts;
  double sum_in = 0, sum_all = 0;
  for (std::size_t k = 0; k < num_parts; ++k) {
    sum_in += in[k];
    sum_all += all[k];
    if (all[k] > 0) parts.push_back(in[k] / all[k]);
  }
  Estimate out = estimate(parts);
  out.mean = sum_all > 0 ? sum_in / sum_all : std::numeric_limits<double>::quiet_NaN();
  return out;
}

Estimate coordination_number(const BallState& state, const std::function<bool(std::size_t)>& counts) {
  const std::vector<int> contacts = contacts_of_balls(state);
  std::vector<double> chosen;
  for (std::size_t i = 0; i < contacts.size(); ++i)
    if (is_free(state.balls, i) && counts(i)) chosen.push_back(contacts[i]);
  Estimate out = estimate(chosen);
  if (chosen.empty()) out.mean = std::numeric_limits<double>::quiet_NaN();
  return out;
}

std::vector<char> connected(const Balls& balls, double period, double gap,
                            const std::function<bool(std::size_t)>& seed) {
  double largest = 0;
  for (const double r : balls.radius) largest = std::max(largest, r);
  const double cell = 2 * largest + gap;
  // Balls sorted by x; neighbours are within a cell along it.
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < balls.size(); ++i)
    if (is_free(balls, i)) order.push_back(i);
  const auto x_of = [&](std::size_t i) { return balls.position[i][0]; };
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return x_of(a) != x_of(b) ? x_of(a) < x_of(b) : balls.id[a] < balls.id[b];
  });
  std::vector<char> out(balls.size(), 0);
  std::vector<std::size_t> waiting;
  for (std::size_t k = 0; k < order.size(); ++k)
    if (seed(order[k])) {
      out[order[k]] = 1;
      waiting.push_back(k);
    }
  const auto visit = [&](std::size_t from, std::size_t k) {
    const std::size_t i = order[from], j = order[k];
    if (out[j]) return;
    Eigen::Vector3d way = balls.position[i] - balls.position[j];
    if (period > 0) way[1] -= period * std::round(way[1] / period);
    const double reach = balls.radius[i] + balls.radius[j] + gap;
    if (way.squaredNorm() > reach * reach) return;
    out[j] = 1;
    waiting.push_back(k);
  };
  while (!waiting.empty()) {
    const std::size_t from = waiting.back();
    waiting.pop_back();
    const double x = x_of(order[from]);
    for (std::size_t k = from + 1; k < order.size() && x_of(order[k]) - x <= cell; ++k) visit(from, k);
    for (std::size_t k = from; k-- > 0 && x - x_of(order[k]) <= cell;) visit(from, k);
  }
  return out;
}

Line fit_line(const std::vector<double>& x, const std::vector<double>& y) {
  const auto n = static_cast<double>(x.size());
  const double mx = std::accumulate(x.begin(), x.end(), 0.0) / n, my = std::accumulate(y.begin(), y.end(), 0.0) / n;
  double xx = 0, xy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    xx += (x[i] - mx) * (x[i] - mx);
    xy += (x[i] - mx) * (y[i] - my);
  }
  const double slope = xx > 0 ? xy / xx : std::numeric_limits<double>::quiet_NaN();
  return {my - slope * mx, slope, x.size()};
}

}  // namespace drumsweep

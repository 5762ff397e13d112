#include "core/scene/incline.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/geometry/primitives.h"
#include "core/scene/scene_run.h"

namespace drumsweep {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// Slope of values over times by least squares, and its standard error from the scatter around the line.
Estimate slope_of(const std::vector<double>& time, const std::vector<double>& value) {
  const auto n = static_cast<double>(time.size());
  if (time.size() < 3) return {nan, nan};
  double t_mean = 0, v_mean = 0, tt = 0, tv = 0, rest = 0;
  for (std::size_t i = 0; i < time.size(); ++i) {
    t_mean += time[i] / n;
    v_mean += value[i] / n;
  }
  for (std::size_t i = 0; i < time.size(); ++i) {
    tt += (time[i] - t_mean) * (time[i] - t_mean);
    tv += (time[i] - t_mean) * (value[i] - v_mean);
  }
  const double slope = tv / tt;
  for (std::size_t i = 0; i < time.size(); ++i) {
    const double off = value[i] - v_mean - slope * (time[i] - t_mean);
    rest += off * off;
  }
  return {slope, std::sqrt(rest / (n - 2) / tt)};
}

/// World with the plane; its extent is what can be travelled.
World world_with_plane(const Physics& physics, double angle, double speed, double reach) {
  World world(physics, speed);
  world.gravity_vector = gravity * Eigen::Vector3d(std::sin(angle), 0, -std::cos(angle));
  TriangleMesh plane;
  add_plate(plane, {-reach, -reach, 0}, {2 * reach, 0, 0}, {0, 2 * reach, 0});
  world.add_wall(std::move(plane), 0.1 * reach);
  return world;
}

}  // namespace

void InclineScene::add_fields(FieldTable& table) {
  table.text("stack", stack, {"none", "pyramid", "triangle"},
             "none: a single ball; pyramid: a tetrahedral pile; triangle: a pile one ball thick across the slope");
  table.count("layers", layers, 1, 20, "of the stack, which are also the balls along a side of the lowest");
  table.number("angle_deg", angle_deg, 0, 180, "of the plane; beyond 90 it is a ceiling");
  table.number("speed_m_s", speed_m_s, -100, 100, "of a single ball at the beginning, downhill");
  table.number("spin_rad_s", spin_rad_s, -1e5, 1e5, "of a single ball at the beginning, as when it rolls downhill");
  table.number("twist_rad_s", twist_rad_s, -1e5, 1e5, "of a single ball at the beginning, about the plane's normal");
  table.number("height_m", height_m, 0, 100, "of a single ball at the beginning, over the place where it would rest");
  table.number("duration_s", duration_s, 1e-4, 1000, "simulated time");
  table.number("fit_from_s", fit_from_s, 0, 1000, "accelerations and overlap are taken from then to the end");
  table.number("rest_speed_m_s", rest_speed_m_s, 1e-9, 1, "slower than this at the end is at rest");
  table.number("stand_diameters", stand_diameters, 1e-6, 10, "a stack stands where no ball has moved farther");
}

void InclineScene::validate(const Physics& physics, const Where& where) const {
  refuse_effects(
      physics, where,
      {"effects.size_spread", "effects.outlet_coating_m", "effects.drum_coating_m", "effects.texture_height_scale"},
      "incline");
  const auto refuse = [&](const char* key, const std::string& text) {
    throw InputError(fmt::format("{}scene.{}{}", where(std::string("scene.") + key), key, text));
  };
  if (stack == "none" && fit_from_s >= duration_s)
    refuse("fit_from_s", fmt::format(" = {}: accepted is below duration_s = {}", fit_from_s, duration_s));
  if (stack != "none") {
    for (const auto& [key, value] : {std::pair{"speed_m_s", speed_m_s}, std::pair{"spin_rad_s", spin_rad_s},
                                     std::pair{"twist_rad_s", twist_rad_s}, std::pair{"height_m", height_m}})
      if (value != 0) refuse(key, fmt::format(" = {}: a stack starts at rest on the plane; accepted is 0", value));
    if (angle_deg >= 90) refuse("angle_deg", fmt::format(" = {}: accepted for a stack is below 90", angle_deg));
  }
}

SceneResult InclineScene::run(const Physics& physics, const SceneObserver& observer) const {
  return stack == "none" ? run_ball(physics, observer) : run_stack(physics, observer);
}

SceneResult InclineScene::run_ball(const Physics& physics, const SceneObserver& observer) const {
  const double angle = angle_deg * std::numbers::pi / 180, radius = 0.5 * physics.material.diameter_m;
  const double fastest = std::max(0.1, std::abs(speed_m_s) + gravity * duration_s * std::sin(angle));
  const double reach = 2 * (fastest * duration_s + height_m + 20 * radius);
  World world = world_with_plane(physics, angle, fastest, reach);
  const Surface& surface = world.walls.front().surface;
  const double load = std::max(0.0, world.mean_mass * gravity * std::cos(angle) + surface.cohesion.force),
               sunk = std::pow(load / surface.stiffness(radius), 2.0 / 3);

  // A falling ball may leave far below a ceiling: the box follows it.
  const double fall = reach + gravity * duration_s * duration_s;
  SceneRun run(std::move(world), observer, Eigen::Vector3d::Constant(-fall), Eigen::Vector3d::Constant(fall));
  run.threads = threads;
  run.add({0, 0, radius - sunk + height_m}, {speed_m_s, 0, 0});
  run.state.balls.spin.back() = Eigen::Vector3d(0, spin_rad_s, twist_rad_s);

  std::vector<double> time, speed, spin, twist, overlap;
  Series track{"track", {"time [s]", "x [m]", "speed [m/s]", "spin [rad/s]", "twist [rad/s]", "overlap [m]"}, {}};
  run.run_until("moving", duration_s, [&] {
    if (run.state.balls.size() == 0) return true;
    const Eigen::Vector3d &at = run.state.balls.position.front(), &v = run.state.balls.velocity.front(),
                          &w = run.state.balls.spin.front();
    track.values.insert(track.values.end(), {run.time(), at[0], v[0], w[1], w[2], radius - at[2]});
    if (run.time() >= fit_from_s) {
      time.push_back(run.time());
      speed.push_back(v[0]);
      spin.push_back(w[1]);
      twist.push_back(w[2]);
      overlap.push_back(radius - at[2]);
    }
    return false;
  });

  const Estimate acceleration = slope_of(time, speed), spinning = slope_of(time, spin),
                 twisting = slope_of(time, twist), depth = block_estimate(overlap);
  const bool there = run.state.balls.size() == 1;
  const Eigen::Vector3d at = there ? run.state.balls.position.front() : Eigen::Vector3d::Constant(nan),
                        v = there ? run.state.balls.velocity.front() : at,
                        w = there ? run.state.balls.spin.front() : at;
  SceneResult out = run.finish();
  out.observables = {observable("acceleration", acceleration.mean, acceleration.sigma, "m/s2"),
                     observable("spin_acceleration", spinning.mean, spinning.sigma, "rad/s2"),
                     observable("twist_acceleration", twisting.mean, twisting.sigma, "rad/s2"),
                     observable("speed", v[0], nan, "m/s"),
                     observable("spin", w[1], nan, "rad/s"),
                     observable("twist", w[2], nan, "rad/s"),
                     observable("rolling", v[0] != 0 ? w[1] * radius / v[0] : nan, nan, "1"),
                     observable("distance", at[0], nan, "m"),
                     observable("rests", v.norm() < rest_speed_m_s ? 1 : 0, nan, "1"),
                     observable("overlap", depth.mean, depth.sigma, "m")};
  out.series.push_back(std::move(track));
  return out;
}

SceneResult InclineScene::run_stack(const Physics& physics, const SceneObserver& observer) const {
  const double angle = angle_deg * std::numbers::pi / 180, d = physics.material.diameter_m;
  const auto n = static_cast<int>(layers);
  // A falling ball is at most as fast as from the top of the pile.
  const double fastest = std::sqrt(2 * gravity * d * n) + gravity * duration_s * std::sin(angle);
  const double reach = 2 * (fastest * duration_s + 4 * d * n);
  SceneRun run(world_with_plane(physics, angle, fastest, reach), observer, Eigen::Vector3d::Constant(-reach),
               Eigen::Vector3d::Constant(reach));
  run.threads = threads;

  // Touching balls: rows at x, layers shifted to lie in the hollows.
  const bool thick = stack == "pyramid";
  const double row = d * std::sqrt(3.0) / 2, rise = thick ? d * std::sqrt(2.0 / 3) : row;
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < (thick ? n - k : 1); ++j)
      for (int i = 0; i < n - k - (thick ? j : 0); ++i)
        run.add({d * (i + 0.5 * j + 0.5 * k), thick ? row * (j + k / 3.0) : 0.0, 0.5 * d + rise * k});

  std::vector<Eigen::Vector3d> start(run.state.balls.size());
  for (std::size_t i = 0; i < start.size(); ++i) start[run.state.balls.id[i]] = run.state.balls.position[i];
  double farthest = 0;
  Series moved{"displacement", {"time [s]", "largest displacement [m]"}, {}};
  run.run_until("standing", duration_s, [&] {
    double now = 0;
    for (std::size_t i = 0; i < run.state.balls.size(); ++i)
      now = std::max(now, (run.state.balls.position[i] - start[run.state.balls.id[i]]).norm());
    farthest = std::max(farthest, now);
    moved.values.insert(moved.values.end(), {run.time(), now});
    return false;
  });

  const double speed = run.fastest();
  const auto contacts = static_cast<double>(run.last_report().num_contacts);
  SceneResult out = run.finish();
  out.observables = {
      observable("stands", farthest <= stand_diameters * d && out.lost == 0 ? 1 : 0, nan, "1"),
      observable("largest_displacement", farthest / d, nan, "diameters"), observable("fastest", speed, nan, "m/s"),
      observable("rests", speed < rest_speed_m_s ? 1 : 0, nan, "1"), observable("contacts", contacts, nan, "1")};
  out.series.push_back(std::move(moved));
  return out;
}

}  // namespace drumsweep

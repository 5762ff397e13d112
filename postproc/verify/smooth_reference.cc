#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <optional>

#include "core/io/durable_file.h"
#include "core/scene/drum.h"
#include "core/scene/rotating_drum.h"
#include "core/scene/scene_value.h"
#include "postproc/child_process.h"
#include "postproc/verify/groups.h"

namespace drumsweep {
namespace {

/// One way to compute the same physics.
struct Setting {
  double time_step_s;       ///< of the nonsmooth step; 0: the smooth step
  std::int64_t iterations;  ///< of the nonsmooth step
};

void set(Physics& physics, const Setting& setting) {
  if (setting.time_step_s == 0) {
    physics.step.method = "smooth";
    physics.solver.outer_step_s = 0.002;
    // The dashpot c = 20 ms decays faster than a contact lasts: t_c/25 does not resolve it (charge angle 40.5 deg, at t_c/50 42.1,
    // at t_c/100 42.8, at t_c/200 43.2, all +- 0.4).
    physics.step.steps_per_contact = 100;
    return;
  }
  physics.solver.outer_step_s = setting.time_step_s;
  physics.solver.sub_steps = 1;
  physics.solver.iterations = setting.iterations;
}

struct Outcome {
  Setting setting{};
  Estimate speed, angle, over_end;
  double cpu_per_s_per_1000 = 0;  ///< CPU s per simulated s and 1000 balls, of the slice
  std::int64_t lost = 0;
};

/// Slice of a drum with the lab drum's balls (k = 25 kN/m^1.5, or E = 0.7 MPa, no restitution) and Froude number.
RotatingDrumScene slice(bool full) {
  RotatingDrumScene scene;
  scene.diameter_m = 0.2;
  scene.length_m = full ? 0.063 : 0.043;
  scene.angular_velocity_rad_s = 4.85;
  scene.fill = 0.3;
  scene.mesh_resolution_m = 0.005;
  scene.texture = {4000, 0.002, 0.004, 0.003, 0.005, "sigma"};
  scene.settle_turns = 0.5;
  scene.record_turns = full ? 12 : 5;
  return scene;
}

/// A drum with an outlet of three slots.
Study with_outlet(bool full) {
  Study study;
  study.drum.diameter_m = 0.24;
  study.drum.length_m = 0.20;
  study.drum.angular_velocity_rad_s = 4.4;
  study.drum.texture.height_min_m = 0.001;
  study.drum.texture.height_max_m = 0.003;
  study.outlet.length_m = 0.12;
  study.outlet.opening_angle_deg = 4.0;
  study.outlet.base_width_m = 0.018;
  study.belt.width_m = 0.25;
  study.belt.outlet_begin_m = 0.06;
  study.belt.speed_m_s = 0.2;
  study.feed.rate_kg_s = 0.3;
  study.feed.zone_begin_m = 0.01;
  study.feed.zone_length_m = 0.06;
  study.feed.zone_width_m = 0.10;
  study.warmup.window_turns = 1;
  study.warmup.tolerance = 0.10;
  study.warmup.max_turns = 12;
  study.record.adapt_turns = 1;
  study.record.turns = full ? 24 : 6;
  return study;
}

/// Share of the balls that leave over the outlet's end, with its error from thirds of a turn.
Estimate share_over_end(const Recording& r, double seconds_per_turn) {
  const auto num = static_cast<std::size_t>(std::lround(3 * r.turns));
  std::vector<double> all(num, 0), end(num, 0);
  for (const Landing& l : r.landings) {
    const double block = 3 * (l.time - r.begin_s) / seconds_per_turn;
    if (block < 0 || block >= static_cast<double>(num)) continue;
    all[static_cast<std::size_t>(block)] += 1;
    end[static_cast<std::size_t>(block)] += l.exit == static_cast<std::uint8_t>(Exit::end) ? 1 : 0;
  }
  // Ratio of two sums: residuals of the ratio over the mean count.
  double sum_all = 0, sum_end = 0, squares = 0;
  for (std::size_t b = 0; b < num; ++b) sum_all += all[b], sum_end += end[b];
  if (sum_all == 0) return {std::nan("")};
  const double share = sum_end / sum_all, n = static_cast<double>(num);
  for (std::size_t b = 0; b < num; ++b) squares += std::pow(end[b] - share * all[b], 2);
  return {share, std::sqrt(squares * n / (n - 1)) / sum_all};
}

std::optional<Outcome> compute(const Setting& setting, const DrumState& warm, const VerifyOptions& options) {
  const auto goes_on = [&] { return !options.goes_on || options.goes_on(); };
  Outcome out;
  out.setting = setting;
  Physics physics;
  set(physics, setting);
  const SceneResult r = slice(options.full).run(physics, [&](const SceneProgress&) { return goes_on(); });
  if (r.stopped) return {};
  out.speed = scene_value(r, "surface_velocity");
  out.angle = scene_value(r, "charge_angle");
  out.cpu_per_s_per_1000 = r.cpu_s / r.simulated_s / static_cast<double>(r.num_balls) * 1000;
  Study study = with_outlet(options.full);
  set(study, setting);
  DrumState start = warm;
  // Impulses of the nonsmooth step are no forces; each method finds its own. Time is counted in outer steps.
  start.pairs.clear();
  start.walls.clear();
  start.num_steps = std::llround(static_cast<double>(warm.num_steps) * with_outlet(options.full).solver.outer_step_s /
                                 study.solver.outer_step_s);
  const Recording recording = run_design(study, start, {}, [&](const Progress&) { return goes_on(); });
  if (recording.stopped) return {};
  out.over_end = share_over_end(recording, 2 * std::numbers::pi / study.drum.angular_velocity_rad_s);
  out.lost = r.lost + recording.lost;
  return out;
}

struct Quantity {
  const char* name;
  const char* file;
  Estimate Outcome::*value;
};
constexpr Quantity quantities[] = {{"surface velocity", "surface_velocity", &Outcome::speed},
                                   {"charge angle", "charge_angle", &Outcome::angle},
                                   {"share over the outlet's end", "outflow_split", &Outcome::over_end}};

double deviation(const Outcome& a, const Outcome& smooth, const Quantity& q) {
  return (a.*q.value).mean / (smooth.*q.value).mean - 1;
}

/// Maps of the deviation from the smooth step over time step and iterations, and a table of error against cost.
void draw(const std::string& folder, const Outcome& smooth, const std::vector<Outcome>& list,
          const std::vector<double>& steps, const std::vector<std::int64_t>& passes) {
  const std::filesystem::path place = std::filesystem::absolute(folder);
  std::string csv =
      "method,time_step_ms,iterations,surface_velocity_m_s,sigma,charge_angle_deg,sigma,share_over_end,sigma,"
      "cpu_s_per_s_per_1000_balls,lost\n";
  const auto line = [&](const Outcome& o) {
    const bool is_smooth = o.setting.time_step_s == 0;
    csv += fmt::format("{},{},{},{:.5g},{:.2g},{:.5g},{:.2g},{:.5g},{:.2g},{:.4g},{}\n",
                       is_smooth ? "smooth" : "nonsmooth",
                       is_smooth ? "" : fmt::format("{:g}", 1e3 * o.setting.time_step_s),
                       is_smooth ? "" : fmt::format("{}", o.setting.iterations), o.speed.mean, o.speed.sigma,
                       o.angle.mean, o.angle.sigma, o.over_end.mean, o.over_end.sigma, o.cpu_per_s_per_1000, o.lost);
  };
  line(smooth);
  for (const Outcome& o : list) line(o);
  write_durably(place / "smooth_reference.csv", csv);

  const ScratchFolder scratch;
  std::string script =
      "set terminal pngcairo size 1500,480 font 'sans,11'\nset output 'figure.png'\nset multiplot layout 1,3\n"
      "set palette defined (-1 '#31688e', 0 '#f7f7f7', 1 '#b00020')\nset cbrange [-30:30]\nunset key\n"
      "set xlabel 'iterations'\nset ylabel 'time step (ms)'\nset cblabel 'deviation from the smooth step (%)'\n";
  std::string x_ticks, y_ticks;
  for (std::size_t i = 0; i < passes.size(); ++i) x_ticks += fmt::format("{}'{}' {}", i ? "," : "", passes[i], i);
  for (std::size_t i = 0; i < steps.size(); ++i) y_ticks += fmt::format("{}'{:g}' {}", i ? "," : "", 1e3 * steps[i], i);
  script +=
      fmt::format("set xtics ({}) scale 0\nset ytics ({}) scale 0\nset xrange [-0.5:{}]\nset yrange [-0.5:{}]\n",
                  x_ticks, y_ticks, static_cast<double>(passes.size()) - 0.5, static_cast<double>(steps.size()) - 0.5);
  for (const Quantity& q : quantities) {
    std::string data;
    for (std::size_t i = 0; i < list.size(); ++i) {
      const double sigma = (list[i].*q.value).sigma / (smooth.*q.value).mean;
      data += fmt::format("{} {} {:.4g} \"{:+.1f}\\n+- {:.1f}\"\n", i % passes.size(), i / passes.size(),
                          100 * deviation(list[i], smooth, q), 100 * deviation(list[i], smooth, q), 100 * sigma);
    }
    write_durably(scratch.path / (std::string(q.file) + ".dat"), data);
    script += fmt::format("set title \"{} (smooth: {:.4g} ± {:.2g})\"\n", q.name, (smooth.*q.value).mean,
                          (smooth.*q.value).sigma);
    script += fmt::format("plot '{0}.dat' using 1:2:3 with image, '{0}.dat' using 1:2:4 with labels\n", q.file);
  }
  write_durably(scratch.path / "figure.gp", script + "unset multiplot\n");
  run_program(scratch.path, {"gnuplot", "-d", "figure.gp"}, "install gnuplot");
  write_durably(place / "smooth_reference.png", read_whole_file(scratch.path / "figure.png"));
}

}  // namespace

std::vector<VerifyCase> verify_smooth_reference(const VerifyOptions& options) {
  // The same load for all: a drum warmed up by the nonsmooth step.
  WarmState warm;
  if (!warm_up(with_outlet(options.full), warm, [&](const Progress&) { return !options.goes_on || options.goes_on(); },
               {}))
    return {};

  const std::vector<double> steps =
      options.full ? std::vector<double>{0.001, 0.002, 0.005, 0.010} : std::vector<double>{0.001, 0.010};
  const std::vector<std::int64_t> passes =
      options.full ? std::vector<std::int64_t>{10, 25, 50, 100, 400} : std::vector<std::int64_t>{10, 50};
  const std::optional<Outcome> smooth = compute({0, 0}, warm.state, options);
  if (!smooth) return {};
  std::vector<Outcome> list;
  for (const double h : steps)
    for (const std::int64_t iterations : passes) {
      const std::optional<Outcome> one = compute({h, iterations}, warm.state, options);
      if (!one) return {};
      list.push_back(*one);
    }
  draw(options.folder, *smooth, list, steps, passes);

  // The finest is the first time step with the most passes.
  std::vector<VerifyCase> out;
  constexpr double widest = 0.05;
  const Outcome& finest = list[passes.size() - 1];
  for (const Quantity& q : quantities) {
    const Estimate &a = finest.*q.value, &b = (*smooth).*q.value;
    const double relative = std::hypot(a.sigma, b.sigma) / std::abs(b.mean), band = std::min(3 * relative, widest);
    out.push_back(
        {fmt::format("{}: nonsmooth ({:g} ms x {}) over smooth", q.name, 1e3 * finest.setting.time_step_s,
                     finest.setting.iterations),
         "explicit Hertz-Mindlin at t_c/100", "1 within 3 sigma, at most 5 %", 1 - band, 1 + band, a.mean / b.mean,
         fmt::format("{:.4g} +- {:.2g} and {:.4g} +- {:.2g}; coarsest: {:+.1f} %; CPU s per s and 1000 balls: "
                     "{:.2g} and {:.2g} smooth, {:.2g} coarsest",
                     a.mean, a.sigma, b.mean, b.sigma, 100 * deviation(list[list.size() - passes.size()], *smooth, q),
                     finest.cpu_per_s_per_1000, smooth->cpu_per_s_per_1000,
                     list[list.size() - passes.size()].cpu_per_s_per_1000)});
  }
  return out;
}

}  // namespace drumsweep

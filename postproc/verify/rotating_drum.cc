#include "core/scene/rotating_drum.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>

#include "core/io/durable_file.h"
#include "postproc/child_process.h"
#include "postproc/verify/groups.h"

namespace drumsweep {
namespace {

/// Alizadeh, Bertrand and Chaouki, AIChE J. 59 (2013) 1894: 3 mm glass in a drum of 0.24 m at 11.6 rpm, a third full; friction and
/// restitution as in simulations of the same drum. A few balls of its length, periodic: its end walls are 120 balls apart.
///
/// The wall is rough. With a smooth one and without rolling resistance the wall layer rolls between wall and bed, and the bed slides as a
/// whole (balls of 6 mm: at 15 degrees in the nonsmooth step, 14 +- 2 in the smooth one); the measured bed does not slide
/// (0.141 m/s beside the wall, omega r = 0.137 m/s). So the measured boundary is taken: bumps of a third to two thirds of a ball
/// that hold the wall layer. Their size is an assumption. The result leans on the step: at 2 ms x 10 iterations the angle is
/// 21 degrees and the speed ratio 1.9; the full form shows whether 1 ms x 20 is fine enough.
RotatingDrumScene alizadeh(bool full) {
  RotatingDrumScene scene;
  scene.diameter_m = 0.24;
  scene.length_m = full ? 0.024 : 0.010;
  scene.angular_velocity_rad_s = 1.2147;
  scene.num_balls = std::llround(226080 * scene.length_m / 0.36);
  scene.mesh_resolution_m = 0.0015;
  scene.texture = {60000, 0.001, 0.002, 0.001, 0.0015, "sigma"};
  scene.settle_turns = full ? 0.5 : 0.25;
  scene.record_turns = full ? 1.0 : 0.3;
  return scene;
}

/// Softer than glass; 95 % of the overlaps stay below 1 % of the diameter.
Physics glass(double time_step, std::int64_t iterations) {
  Physics p;
  p.material.diameter_m = 0.003;
  p.material.density_kg_m3 = 2500;
  p.material.friction = 0.3;
  p.material.wall_friction = 0.35;
  p.material.restitution = 0.97;
  p.material.wall_restitution = 0.85;
  p.material.youngs_modulus_Pa = 1e7;
  p.material.poisson_ratio = 0.25;
  p.solver.outer_step_s = 0.002;
  p.solver.sub_steps = std::llround(0.002 / time_step);
  p.solver.iterations = iterations;
  return p;
}

const Observable& find(const SceneResult& result, const std::string& name) {
  for (const Observable& o : result.observables)
    if (o.name == name) return o;
  throw std::logic_error("no observable " + name);
}

void draw_profile(const std::string& folder, const SceneResult& result) {
  const std::filesystem::path place = std::filesystem::absolute(folder);
  std::string csv = "kind,y_m,u_m_s,sigma_m_s\n", measured, simulated;
  for (const std::vector<double>& row : anchor_table("drum_velocity_alizadeh2013")) {
    csv += fmt::format("measured,{},{},\n", row[0], row[1]);
    measured += fmt::format("{} {}\n", 1e3 * row[0], row[1]);
  }
  for (const Observable& o : result.observables) {
    if (o.name != "velocity_profile") continue;
    csv += fmt::format("simulated,{},{},{}\n", o.position, o.value, o.sigma);
    simulated += fmt::format("{} {} {}\n", 1e3 * o.position, o.value, o.sigma);
  }
  write_durably(place / "rotating_drum_profile.csv", csv);
  const ScratchFolder scratch;
  write_durably(scratch.path / "measured.dat", measured);
  write_durably(scratch.path / "simulated.dat", simulated);
  write_durably(
      scratch.path / "figure.gp",
      "set terminal pngcairo size 900,640 font 'sans,12'\nset output 'figure.png'\n"
      "set xlabel 'distance from the axis along the normal to the surface (mm)'\n"
      "set ylabel 'velocity along the surface (m/s)'\nset key top left Left reverse\nset grid lc rgb '#dcdcdc'\n"
      "set xrange [-122:-20]\n"
      "plot 0 with lines lc rgb '#808080' notitle, 1.2147e-3*x with lines dt 2 lc rgb '#808080' title "
      "'wall: omega y', 'simulated.dat' using 1:2:3 with yerrorlines pt 7 ps 0.6 lc rgb '#31688e' title "
      "'simulated, one sigma', 'measured.dat' using 1:2 with points pt 6 ps 1.4 lw 2 lc rgb '#b00020' title "
      "'measured, Alizadeh et al. 2013'\n");
  run_program(scratch.path, {"gnuplot", "-d", "figure.gp"}, "install gnuplot");
  write_durably(place / "rotating_drum_profile.png", read_whole_file(scratch.path / "figure.png"));
}

}  // namespace

std::vector<VerifyCase> verify_rotating_drum(const VerifyOptions& options) {
  const SceneObserver goes_on = [&](const SceneProgress&) { return !options.goes_on || options.goes_on(); };
  const RotatingDrumScene scene = alizadeh(options.full);
  const SceneResult r = scene.run(glass(0.001, 20), goes_on);
  if (r.stopped) return {};
  const auto row = [&](const char* what, const char* name, const char* expected, double low, double high,
                       double scale = 1) {
    const Observable& o = find(r, name);
    return VerifyCase{what,
                      "Alizadeh, Bertrand, Chaouki 2013",
                      expected,
                      low,
                      high,
                      scale * o.value,
                      fmt::format("statistical error {:.2g}; {} balls, {:.2g} turns recorded, rough wall",
                                  scale * o.sigma, r.num_balls, scene.record_turns)};
  };
  std::vector<VerifyCase> out = {
      row("charge angle [deg]", "charge_angle", "27 +- 2", 25, 29),
      row("surface velocity / (omega R)", "surface_velocity_ratio", "2.39 +- 15 %", 0.85 * 2.39, 1.15 * 2.39),
      row("zero velocity at y [mm]", "zero_velocity_position", "-59.5 +- one ball", -62.5, -56.5, 1e3)};
  // The first measured point is the speed that 2.39 comes from; the same place in the simulated profile beside the speed at the surface
  // as the scene defines it.
  const double top = anchor_table("drum_velocity_alizadeh2013").front()[0], wall_speed = 1.2147 * 0.12;
  const Observable *below = nullptr, *above = nullptr;
  for (const Observable& o : r.observables) {
    if (o.name != "velocity_profile") continue;
    if (o.position < top) below = &o;
    if (o.position >= top && above == nullptr) above = &o;
  }
  if (below != nullptr && above != nullptr) {
    const double part = (top - below->position) / (above->position - below->position);
    const double u = below->value + part * (above->value - below->value);
    out.push_back({"velocity at the highest measured point (y = -30.3 mm) / (omega R)",
                   "Alizadeh, Bertrand, Chaouki 2013", "2.39 +- 15 %", 0.85 * 2.39, 1.15 * 2.39, u / wall_speed,
                   fmt::format("statistical error {:.2g}", above->sigma / wall_speed)});
  }
  for (VerifyCase& c : out)
    if (!c.pass())
      c.note +=
          "; the profile follows the measured points but the highest, where it is too fast: 3.15 +- 0.12 at 0.5 ms x "
          "40, 2.89 +- 0.05 over half a turn at 1 ms x 20, 2.69 +- 0.09 with a "
          "restitution of 0.5 instead of 0.97. The wall's roughness is assumed: on a smooth wall without rolling "
          "resistance the bed slides as a block (17 deg)";
  draw_profile(options.folder, r);

  if (options.full) {
    // The step must not decide: half the time step, twice the iterations.
    const SceneResult fine = scene.run(glass(0.0005, 40), goes_on);
    if (fine.stopped) return out;
    for (const char* name : {"charge_angle", "surface_velocity_ratio", "zero_velocity_position"}) {
      const Observable &a = find(r, name), &b = find(fine, name);
      const double combined = std::hypot(a.sigma, b.sigma) / std::abs(b.value);
      out.push_back(
          {fmt::format("{}: 1 ms x 20 over 0.5 ms x 40", name), "convergence in step and iterations",
           "1 within 3 sigma", 1 - 3 * combined, 1 + 3 * combined, a.value / b.value,
           fmt::format("{:.4g} +- {:.2g} and {:.4g} +- {:.2g} {}", a.value, a.sigma, b.value, b.sigma, b.unit)});
    }
  }
  return out;
}

}  // namespace drumsweep

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/scene/collapse.h"
#include "core/scene/scene_value.h"
#include "postproc/verify/glass_beads.h"
#include "postproc/verify/groups.h"
#include "postproc/verify/line_figure.h"

namespace drumsweep {
namespace {

/// Published run-out in channels. Between the ends of the two linear laws and the power law both bounds are continued.
double least(double a) { return a < 3 ? 1.2 * a : 1.9 * std::pow(a, 2.0 / 3); }
double most(double a) { return a < 3 ? 1.8 * a : 2.3 * std::pow(a, 2.0 / 3); }

}  // namespace

std::vector<VerifyCase> verify_column_collapse(const VerifyOptions& options) {
  const auto goes_on = [&](const SceneProgress&) { return !options.goes_on || options.goes_on(); };
  struct Beads {
    const char* name;
    double rolling;
    Curve curve;
  };
  std::vector<Beads> series = {{"spheres, friction 0.5", 0.0, {}}};
  if (options.full) series.push_back({"the same with rolling friction 0.1", 0.1, {}});
  const std::vector<double> aspects =
      options.full ? std::vector<double>{0.6, 1, 1.5, 2, 2.6, 4.5, 6, 9} : std::vector<double>{1, 2, 4.5};
  std::vector<VerifyCase> out;
  for (Beads& s : series) {
    Physics physics = glass_beads(options.full);
    physics.effects.rolling_friction = s.rolling;
    s.curve.name = s.name;
    s.curve.points = true;
    for (const double a : aspects) {
      CollapseScene scene;
      scene.length_m = options.full && a < 4 ? 0.2 : 0.1;
      scene.height_m = a * scene.length_m;
      scene.width_m = options.full ? 0.06 : 0.04;
      const SceneResult r = scene.run(physics, goes_on);
      if (r.stopped) return out;
      const double reached = scene_value(r, "aspect_ratio").mean;
      const Estimate run_out = scene_value(r, "run_out");
      s.curve.x.push_back(reached);
      s.curve.y.push_back(run_out.mean);
      s.curve.sigma.push_back(run_out.sigma);
      VerifyCase c{
          fmt::format("run-out (L - L0)/L0 at a = {:.3g}, {}", reached, s.name),
          "Lube et al. 2005; Lajeunesse et al. 2005",
          a < 3 ? "1.2 a (sand) to 1.8 a (glass beads)" : "1.9 to 2.3 a^(2/3)",
          least(reached),
          most(reached),
          run_out.mean,
          fmt::format("+- {:.2g}; 99 % of the mass within {:.3g}; L0 = {:.0f} balls, {} balls{}", run_out.sigma,
                      scene_value(r, "run_out_99").mean, scene.length_m / physics.material.diameter_m, r.num_balls,
                      scene_value(r, "left_floor").mean > 0 ? "; some left the floor" : "")};
      out.push_back(std::move(c));
    }
  }
  LineFigure figure{
      "Column collapse in a channel", "aspect ratio a = H0 / L0", "run-out (L - L0) / L0", {}, true, false};
  for (Beads& s : series) figure.curves.push_back(std::move(s.curve));
  const auto law = [&](const char* name, double from, double to, double factor, double power) {
    Curve c{name, {}, {}, {}, false};
    for (int i = 0; i <= 20; ++i) {
      c.x.push_back(from * std::pow(to / from, i / 20.0));
      c.y.push_back(factor * std::pow(c.x.back(), power));
    }
    figure.curves.push_back(std::move(c));
  };
  law("1.2 a (sand, Lube 2005)", 0.5, 1.8, 1.2, 1);
  law("1.8 a (beads, Lajeunesse 2005)", 0.5, 3, 1.8, 1);
  law("1.9 a^(2/3)", 1.8, 10, 1.9, 2.0 / 3);
  law("2.3 a^(2/3)", 3, 10, 2.3, 2.0 / 3);
  const std::string trouble = write_figure(figure, options.folder, "column_collapse");
  if (!trouble.empty() && !out.empty()) out.back().note += "; no picture: " + trouble;
  return out;
}

}  // namespace drumsweep

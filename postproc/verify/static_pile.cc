#include <fmt/format.h>

#include <cmath>

#include "core/scene/packing.h"
#include "core/scene/scene_value.h"
#include "postproc/verify/groups.h"

namespace drumsweep {
namespace {

/// What floor and walls bear of the weight, for rough balls of S1.
void carried(const std::string& method, const VerifyOptions& options, std::vector<VerifyCase>& out) {
  Physics p;
  p.step.method = method;
  PackingScene scene;
  scene.width_m = scene.depth_m = 0.06;
  scene.num_balls = options.full ? 2000 : 250;
  scene.rest_speed_m_s = 1e-3;
  scene.max_settle_s = 2;
  scene.measure_s = 0.5;
  const SceneResult r = scene.run(p, [&](const SceneProgress&) { return !options.goes_on || options.goes_on(); });
  if (r.stopped) return;
  out.push_back(within(
      fmt::format("pile in a box: upward force of floor and walls/weight{}", method == "smooth" ? ", smooth step" : ""),
      "balance of forces, mean over 0.5 s", 1, 0.005, observed(r, "carried")));
}

/// Frictionless balls. N rigid ones at rest have 3 N equations of force and so 3 N contacts: 6 ends of contacts a ball. What the
/// scene counts differs from that by theory, not by choice:
///   soft balls touch more: + 7.7 sqrt(3 x 0.64 x overlap/d) (O'Hern et al. 2003), 0.03 at the overlap of 1e-5 d that the
///   stiffness 1.6e9 N/m^1.5 gives a pile of six layers, 0.008 at 100 times that (--full);
///   forces below 1e-3 of the mean are not counted, about 0.1 % of the contacts (the distribution is flat at small forces): - 0.006.
/// Accepted is 1 % about 6.
void isostatic(const VerifyOptions& options, std::vector<VerifyCase>& out) {
  Physics p;
  p.material.friction = 0;
  p.material.stiffness_N_m15 = options.full ? 1.6e11 : 1.6e9;
  p.solver.outer_step_s = 1e-3;
  p.solver.sub_steps = 1;
  p.solver.iterations = options.full ? 1000 : 300;
  PackingScene scene;
  scene.width_m = scene.depth_m = options.full ? 0.08 : 0.06;
  scene.num_balls = options.full ? 700 : 200;
  scene.rest_speed_m_s = 1e-6;
  scene.max_settle_s = options.full ? 4 : 1.5;
  scene.measure_s = 0.05;
  const SceneResult r = scene.run(p, [&](const SceneProgress&) { return !options.goes_on || options.goes_on(); });
  if (r.stopped) return;
  for (const auto& [name, what] : {std::pair{"twice_contacts_per_ball", "all balls"},
                                   std::pair{"twice_contacts_without_rattlers", "without rattlers"}}) {
    VerifyCase row = within(fmt::format("frictionless packing: 2 x contacts/balls, {}", what),
                            "isostatic: 3 N contacts for N balls", 6, 0.01, observed(r, name));
    row.note = fmt::format("mean overlap {:.2g} d, which adds {:.2g}", observed(r, "mean_overlap"),
                           7.7 * std::sqrt(3 * 0.64 * observed(r, "mean_overlap")));
    out.push_back(row);
  }
  // Nothing but the floor bears weight, and nothing but the opposite wall holds a wall.
  out.push_back(within("frictionless packing: force on the floor/weight", "balance of forces", 1, 0.005,
                       observed(r, "floor_normal_force") / observed(r, "weight")));
  for (const std::string axis : {"x", "y"})
    out.push_back(within(
        fmt::format("frictionless packing: forces on the two walls across {}, ratio", axis), "balance of forces", 1,
        0.005, observed(r, "wall_" + axis + "_low_normal_force") / observed(r, "wall_" + axis + "_high_normal_force")));
}

}  // namespace

std::vector<VerifyCase> verify_static_pile(const VerifyOptions& options) {
  std::vector<VerifyCase> out;
  carried("nonsmooth", options, out);
  carried("smooth", options, out);
  isostatic(options, out);
  return out;
}

}  // namespace drumsweep

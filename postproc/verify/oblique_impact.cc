#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "core/scene/drop.h"
#include "core/scene/scene_value.h"
#include "postproc/verify/groups.h"

namespace drumsweep {
namespace {

/// Kharaz, Gorham and Salman (2001): 5 mm aluminium oxide on glass at 3.9 m/s.
Physics kharaz() {
  Physics p;
  p.material.diameter_m = 0.005;
  p.material.density_kg_m3 = 3850;
  p.material.friction = 0.092;
  p.material.restitution = 0.98;
  p.material.youngs_modulus_Pa = 3.8e11;
  p.material.poisson_ratio = 0.23;
  p.solver.outer_step_s = 1e-4;
  p.solver.sub_steps = 1;
  p.solver.iterations = 20;
  return p;
}

}  // namespace

std::vector<VerifyCase> verify_oblique_impact(const VerifyOptions&) {
  std::vector<VerifyCase> out;
  const Physics physics = kharaz();
  const double e = physics.material.restitution, mu = physics.material.friction;
  for (const std::vector<double>& row : anchor_table("oblique_impact_kharaz2001")) {
    DropScene scene;
    scene.speed_m_s = 3.9;
    scene.angle_deg = row[0];
    scene.height_m = 0.005;
    const SceneResult r = scene.run(physics, {});
    const double angle = row[0] * std::numbers::pi / 180, v_n = 3.9 * std::cos(angle), v_t = 3.9 * std::sin(angle);
    const bool slides = std::tan(angle) >= 3.5 * mu * (1 + e);
    const std::string at = fmt::format("{:g} deg", row[0]);
    out.push_back(within("normal restitution at " + at, "Newton", e, 1e-3, observed(r, "normal_restitution")));
    out.push_back(within("tangential restitution at " + at, slides ? "v_t - mu (1 + e) v_n" : "rolling, 5/7",
                         slides ? 1 - mu * (1 + e) * v_n / v_t : 5.0 / 7, 1e-3, observed(r, "tangential_restitution")));
    out.push_back(within("spin [rad/s] at " + at, slides ? "5/2 mu (1 + e) v_n / R" : "rolling, 5/7 v_t / R",
                         slides ? 2.5 * mu * (1 + e) * v_n / 0.0025 : 5.0 / 7 * v_t / 0.0025, 1e-3,
                         observed(r, "spin")));
    if (row[0] >= 35)
      out.push_back(within("tangential restitution, measured, at " + at, "Kharaz et al. 2001", row[1], 0.01,
                           observed(r, "tangential_restitution")));
  }

  // The smooth step. Its dashpot (Antypov and Elliott 2011) gives e exactly; the explicit step of t_c/25 adds about 0.01 to it, in
  // proportion to the step (h-limited).
  for (const double restitution : {0.98, 0.5, 0.18})
    for (const double steps : {25.0, 400.0}) {
      Physics smooth = physics;
      smooth.step.method = "smooth";
      smooth.step.contact_speed_m_s = 3.9;
      smooth.step.steps_per_contact = steps;
      smooth.material.restitution = restitution;
      DropScene scene;
      scene.speed_m_s = 3.9;
      scene.height_m = 0.001;
      VerifyCase row = within(fmt::format("normal restitution {:g}, smooth step at t_c/{:g}", restitution, steps),
                              "Newton", restitution, 0.01, observed(scene.run(smooth, {}), "normal_restitution"));
      if (steps < 100) {
        row.low = restitution - 0.02;
        row.high = restitution + 0.02;
      }
      out.push_back(row);
    }
  return out;
}

}  // namespace drumsweep

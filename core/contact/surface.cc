#include "core/contact/surface.h"

#include <cmath>

#include "core/effects/size_distribution.h"

namespace drumsweep {
namespace {

// Of the overlap of a ball at rest: a contact that carries 3 % of a ball's weight is still Hertz'.
constexpr double first_overlap_part = 0.1;
constexpr double standard_gravity = 9.81;

double or_else(double value, double otherwise) { return std::isnan(value) ? otherwise : value; }

/// (1 - nu^2) / E: what one body adds to 1/E*.
double compliance(double youngs_modulus, double poisson_ratio) {
  return std::isnan(youngs_modulus) ? 0 : (1 - poisson_ratio * poisson_ratio) / youngs_modulus;
}

Surface surface(const Physics& physics, bool wall) {
  const MaterialConfig& m = physics.material;
  const EffectsConfig& e = physics.effects;
  const auto choose = [&](double of_balls, double of_wall) { return wall ? or_else(of_wall, of_balls) : of_balls; };
  Surface s;
  const double radius = 0.5 * m.diameter_m;
  s.reference = wall ? radius : 0.5 * radius;
  s.sizes_differ = e.size_spread > 0;

  double stiffness = m.stiffness_N_m15;
  if (!std::isnan(m.youngs_modulus_Pa)) {
    const double ball = compliance(m.youngs_modulus_Pa, m.poisson_ratio);
    const double other = wall ? compliance(m.wall_youngs_modulus_Pa, m.wall_poisson_ratio) : ball;
    stiffness = 4.0 / 3 / (ball + other) * std::sqrt(s.reference);
  }
  s.law = {stiffness, m.damping_s, physics.solver.impact_speed_m_s, physics.solver.stabilization_steps, 0};
  s.law.first_overlap = first_overlap_part * std::pow(mean_ball_mass(physics) * standard_gravity / stiffness, 2.0 / 3);

  s.friction = choose(m.friction, m.wall_friction);
  if (!std::isnan(e.dynamic_friction)) {
    // The wall's friction falls in the same proportion.
    const double part = m.friction > 0 ? e.dynamic_friction / m.friction : 1;
    s.friction_speed = {true, part * s.friction, e.friction_speed_m_s};
  }
  s.restitution = choose(m.restitution, m.wall_restitution);
  s.rolling = choose(e.rolling_friction, e.wall_rolling_friction);
  s.twisting = choose(e.twisting_friction, e.wall_twisting_friction);
  s.cohesion = {choose(e.cohesion_force_N, e.wall_cohesion_force_N), e.cohesion_range_m};
  return s;
}

}  // namespace

double Surface::stiffness(double reduced_radius) const {
  return sizes_differ ? law.stiffness * std::sqrt(reduced_radius / reference) : law.stiffness;
}

Cohesion Surface::cohesion_at(double reduced_radius) const {
  return {sizes_differ ? cohesion.force * reduced_radius / reference : cohesion.force, cohesion.range};
}

Surface ball_surface(const Physics& physics) { return surface(physics, false); }
Surface wall_surface(const Physics& physics) { return surface(physics, true); }

}  // namespace drumsweep

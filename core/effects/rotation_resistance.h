/// Rolling and twisting resistance: a torque between two touching balls, or a ball and a wall, against their relative angular
/// velocity w = omega_a - omega_b (S0). Across the normal n it is at most mu_r R lambda_n (rolling), along n at most mu_t R lambda_n
/// (twisting); below these limits nothing turns. It does not depend on speed: a ball rests on an incline iff tan(theta) <= mu_r and
/// else rolls with (5/7) g (sin - mu_r cos).
///
/// Written with q = torque impulse / R [N s] and the speed R w [m/s], so that it has the shape of a friction row: R is the ball's
/// radius at a wall and 2 Ra Rb / (Ra + Rb) between balls. With S = radius * omega a unit q changes S_a by (5/2) c_a / m_a, c_a = R / Ra.
#pragma once

#include <cstdint>

#include "core/solver/contact_problem.h"

namespace drumsweep {

/// Row beside that of a contact.
/// @param radius_b  0 for a wall
/// @param wall_turn  R times the wall's angular velocity [m/s]
inline RotationRow rotation_row(double radius_a, double radius_b, double inverse_mass_a, double inverse_mass_b,
                                double rolling, double twisting, Float4 wall_turn) {
  const double arm = radius_b > 0 ? 2 * radius_a * radius_b / (radius_a + radius_b) : radius_a;
  const double a = arm / radius_a, b = radius_b > 0 ? arm / radius_b : 0;
  const double diagonal = 2.5 * (a * a * inverse_mass_a + b * b * inverse_mass_b);
  return {wall_turn,
          static_cast<float>(a),
          static_cast<float>(b),
          static_cast<float>(1 / diagonal),
          static_cast<float>(rolling),
          static_cast<float>(twisting),
          {}};
}

}  // namespace drumsweep

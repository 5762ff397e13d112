/// Air drag on a ball, F = -1/2 rho_air C_d pi R^2 |v| v, over one time step. The speed follows v' = -b v^2 exactly,
/// v(h) = v / (1 + b |v| h), so any step is stable. Terminal speed: sqrt(8 R rho g / (3 rho_air C_d)).
#pragma once

#include <Eigen/Core>

namespace drumsweep {

/// @param strength  1/2 rho_air C_d pi [kg/m^3]
inline Eigen::Vector3d slowed_by_air(double strength, double radius, double inverse_mass,
                                     const Eigen::Vector3d& velocity, double h) {
  return velocity / (1 + strength * radius * radius * inverse_mass * velocity.norm() * h);
}

}  // namespace drumsweep

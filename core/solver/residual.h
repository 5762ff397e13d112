/// How well impulses and velocities solve the contact problem, computed outside every solver, in double.
#pragma once

#include <span>

#include "core/solver/contact_problem.h"

namespace drumsweep {

struct Residual {
  double max = 0;   ///< of the natural map over all rows [m/s]
  double mean = 0;  ///< [m/s]
};

/// Natural map of a row: lambda - projection(lambda - r F(lambda)), over r, with r the inverse of the row's diagonal:
/// zero exactly at a solution, and in m/s. Normal, tangential and rotation part are added as squares.
Residual natural_map_residual(const ContactProblem& problem, std::span<const Impulse> impulse,
                              std::span<const TurnImpulse> turn, std::span<const BodyVelocity> velocity);

}  // namespace drumsweep

/// How well impulses and velocities solve the contact problem, computed outside every solver.
#pragma once

#include <cstddef>
#include <span>

#include "core/solver/contact_problem.h"

namespace drumsweep {

struct Residual {
  double max = 0;            ///< of the natural map over all rows [m/s]
  double mean = 0;           ///< [m/s]
  std::size_t num_rows = 0;  ///< rows there are
};

/// Natural map of a row: lambda - projection(lambda - r F(lambda)), over r, with r the inverse of the row's diagonal:
/// zero exactly at a solution, and in m/s. Normal, tangential and rotation part are added as squares.
Residual natural_map_residual(const ContactProblem& problem, int threads, std::span<const BodyVelocity> velocity);

}  // namespace drumsweep

/// Projected Gauss-Seidel for the contact problem of Wang (2013), Eq. (1); the unknown is an impulse, so Sigma is in
/// 1/kg.
///
/// For spheres the 3x3 block of a contact is diagonal, normal w = 1/m_a + 1/m_b and tangential (1 + 5/2 c^2) w, so a visit is
/// explicit and needs no tangent frame: normal part clipped at 0, tangential part clipped to the disc of radius
/// friction * lambda_n; then, where there is one, the rotation row, clipped likewise. Rows are visited in their order; the result is a function of the problem alone. Rejected:
/// cone-complementarity relaxation (Anitescu-Tasora), which pushes a sliding contact open by h mu |u_t|.
#pragma once

#include <span>

#include "core/solver/contact_problem.h"

namespace drumsweep {

/// Adds the impulses that the solve starts from to the velocities.
/// @param impulse  (rows) warm start
/// @param turn  (rotation rows) warm start
void apply_impulses(const ContactProblem& problem, std::span<const Impulse> impulse, std::span<const TurnImpulse> turn,
                    std::span<BodyVelocity> velocity);

/// @param impulse   (rows) in: already applied start, out: solution
/// @param turn      (rotation rows) likewise; empty without rolling and twisting resistance
/// @param velocity  (bodies) in: free velocities plus the start's effect, out: after the impulses
/// Cost: O(iterations * rows), no allocation. Judged by tests/oracle/dense_contact_solver.h.
void solve(const ContactProblem& problem, int iterations, std::span<Impulse> impulse, std::span<TurnImpulse> turn,
           std::span<BodyVelocity> velocity);

}  // namespace drumsweep

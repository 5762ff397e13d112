/// Projected Gauss-Seidel for the contact problem of Wang (2013), Eq. (1); the unknown is an impulse, so Sigma is in
/// 1/kg.
///
/// For spheres the 3x3 block of a contact is diagonal, normal w = 1/m_a + 1/m_b and tangential (1 + 5/2 c^2) w, so a visit is
/// explicit and needs no tangent frame: normal part clipped at 0, tangential part clipped to the disc of radius
/// friction * lambda_n; then, where there is one, the rotation row, clipped likewise. Packs are visited in their order, phase by
/// phase; the result is a function of the problem alone, for any number of threads and any vector width. Rejected:
/// cone-complementarity relaxation (Anitescu-Tasora), which pushes a sliding contact open by h mu |u_t|.
#pragma once

#include <span>

#include "core/solver/contact_problem.h"

namespace drumsweep {

/// Adds the impulses that the solve starts from to the velocities.
/// @param velocity  (bodies)
void apply_impulses(const ContactProblem& problem, int threads, std::span<BodyVelocity> velocity);

/// @param problem   its impulses and turns: in the start, already applied, out the solution
/// @param velocity  (bodies) in: free velocities plus the start's effect, out: after the impulses
/// Cost: O(iterations * contacts), no allocation. Judged by tests/oracle/dense_contact_solver.h.
void solve(ContactProblem& problem, int iterations, int threads, std::span<BodyVelocity> velocity);

}  // namespace drumsweep

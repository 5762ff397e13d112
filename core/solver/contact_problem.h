/// The contact problem of one time step as plain data: what the solver reads, what it changes.
///
/// Bodies are spheres, or pieces of wall with inverse mass 0. With S = radius * angular velocity a sphere's contact
/// needs no radius: u = v_a - v_b + c n x (S_a + S_b), an impulse p on a changes v_a by p/m_a and S_a by -(5/2)/m_a c n x p.
/// c is the distance of the centres over the sum of the radii: with lever arms c R_a and c R_b that meet in one point angular
/// momentum is conserved however deep the overlap or wide the gap. At a wall c = 1: a soft ball rolls on its nominal radius.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace drumsweep {

/// Four floats in one register; three of space and one passenger.
using Float4 = float __attribute__((vector_size(16)));

struct BodyVelocity {
  Float4 linear;   ///< v [m/s], and in the fourth lane the inverse mass [1/kg]
  Float4 surface;  ///< S = R omega [m/s], fourth lane 0
};

/// One contact, 48 bytes. Row: n.u + regularization * lambda_n = bias, lambda_n >= 0; u_t = 0 within |lambda_t| <=
/// friction lambda_n.
struct ContactRow {
  Float4 normal;          ///< n from b to a; fourth lane: bias [m/s]
  float regularization;   ///< Sigma [1/kg]
  float inverse_normal;   ///< 1 / (1/m_a + 1/m_b + Sigma) [kg]
  float inverse_tangent;  ///< 1 / ((1 + 5/2 c^2) (1/m_a + 1/m_b)) [kg]
  float friction;
  std::uint32_t a, b;     ///< bodies
  float arm;              ///< c
  std::uint32_t surface;  ///< kind of the contact, see World::surface(); the solver does not look at it
};

/// Rolling and twisting resistance of the contact with the same index; effects/rotation_resistance.h. With
/// w = a S_a - b S_b - wall_turn and q on body a: q = 0 or w = 0, |q across n| <= rolling lambda_n, |q along n| <= twisting lambda_n.
struct RotationRow {
  Float4 wall_turn;  ///< [m/s], fourth lane 0
  float a, b;        ///< arm over radius of each body
  float inverse;     ///< 1 / (5/2 (a^2/m_a + b^2/m_b)) [kg]
  float rolling, twisting;
  float spare[3];
};

struct ContactProblem {
  std::vector<ContactRow> rows;
  std::vector<RotationRow> rotation;  ///< (rows), or empty: no resistance
};

/// Impulse on body a (minus that on b): tangential part in three lanes, normal part in the fourth [N s].
using Impulse = Float4;
/// Torque impulse on body a over the contact's arm, fourth lane 0 [N s].
using TurnImpulse = Float4;

}  // namespace drumsweep

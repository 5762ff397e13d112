/// The contact problem of one time step as plain data: what the solver reads, what it changes.
///
/// Bodies are spheres, or walls. With S = radius * angular velocity a sphere's contact needs no radius:
/// u = v_a - v_b + c n x (S_a + S_b), an impulse p on a changes v_a by p/m_a and S_a by -(5/2)/m_a c n x p.
/// c is the distance of the centres over the sum of the radii: with lever arms c R_a and c R_b that meet in one point angular
/// momentum is conserved however deep the overlap or wide the gap. At a wall c = 1: a soft ball rolls on its nominal radius.
///
/// Contacts come in packs of sixteen in which no ball is twice, so that a pack is solved at once; packs come in blocks. Blocks are
/// visited in phases: those of one phase share no ball and may run on as many threads as there are. The order of visits, and with it
/// every bit of the result, is that of the data alone.
#pragma once

#include <cstdint>
#include <vector>

#include "core/simd/targets.h"

namespace drumsweep {

struct BodyVelocity {
  float linear[3];     ///< v [m/s]
  float inverse_mass;  ///< [1/kg]
  float surface[3];    ///< S = R omega [m/s]
  float radius;        ///< [m]
};

/// A sixteen-fold of vectors, by component.
struct alignas(64) Pack3 {
  float of[3][pack_width];
};

/// A sixteen-fold of numbers.
struct alignas(64) Pack1 {
  float of[pack_width];
};

/// Sixteen contacts, 640 bytes. Row: n.u + regularization * lambda_n = bias, lambda_n >= 0; u_t = 0 within |lambda_t| <=
/// friction lambda_n. A lane without a row has bias `no_row`: its impulse is 0.
struct alignas(64) ContactPack {
  std::uint32_t a[pack_width], b[pack_width];  ///< bodies; b of a wall contact is not read
  float normal[3][pack_width];                 ///< n, from b to a
  float arm[pack_width];                       ///< c
  float bias[pack_width];                      ///< [m/s]
  float regularization[pack_width];            ///< Sigma [1/kg]
  float friction[pack_width];
  float overlap[pack_width];  ///< > 0 pressed, < 0 open [m]; the solver does not look at it
};
inline constexpr float no_row = -1e30f;

/// Impulse on body a (minus that on b) [N s].
struct alignas(64) ImpulsePack {
  float tangent[3][pack_width];
  float normal[pack_width];
};

/// Rolling and twisting resistance, effects/rotation_resistance-inl.h: limits over the normal impulse.
struct RotationLimits {
  float rolling = 0, twisting = 0;
};

/// Packs of one kind: between balls, or between balls and walls.
struct ContactPacks {
  std::vector<ContactPack> rows;
  std::vector<ImpulsePack> impulse;
  std::vector<Pack3> wall_velocity;    ///< of the wall at the contact; empty between balls [m/s]
  std::vector<Pack3> turn;             ///< torque impulse on a over the arm [N s]; empty without resistance to rotation
  std::vector<Pack3> wall_turn;        ///< arm times the wall's angular velocity [m/s]; likewise, empty between balls
  std::vector<RotationLimits> limits;  ///< (packs); likewise
  std::vector<std::uint32_t> wall;     ///< (packs) index of the wall, ascending; empty between balls
  std::vector<Pack1> pull;             ///< impulse against the normal from outside, of moisture [N s]; empty without
  std::vector<std::uint32_t> active;   ///< packs that have a row or a pull, ascending
};

/// Contacts that one thread visits in one go: first those between balls, then those with walls.
struct ContactBlock {
  ContactPacks pairs, walls;
};

struct ContactProblem {
  std::vector<ContactBlock> blocks;                ///< memory of more than there are may be kept
  std::vector<std::vector<std::uint32_t>> phases;  ///< blocks that share no ball, phase after phase
  std::size_t num_slabs =
      0;  ///< where the first blocks are slabs in a row, each with contacts to itself and the next: how many; the
          ///< even ones are then the first phase, the odd ones the second, and one block follows as the third
  bool rotation_resisted = false;
};

}  // namespace drumsweep

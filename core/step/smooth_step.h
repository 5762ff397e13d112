/// The smooth reference: explicit forces of Hertz and Mindlin at a time step well below the contact time. Nothing of it is shared
/// with the nonsmooth solver but contact geometry, laws of the surfaces and cohesion, so the two judge each other.
///
/// Normal: k g^1.5, plus damping: with restitution e > 0 the dashpot of Tsuji et al. (1992) in the form of Antypov and Elliott
/// (2011), -2 sqrt(5/6) beta sqrt(S m*) dg/dt with S = 1.5 k sqrt(g), beta = ln e / sqrt(ln^2 e + pi^2), which rebounds with e at any
/// speed; with e = 0 the dashpot k c sqrt(g) dg/dt, and no pull. Dashpots are integrated exactly over the step, so they are
/// stable for any strength.
/// Tangential: a spring of stiffness S 2 (1 - nu) / (2 - nu) (Mindlin, no slip) with history, turned with the normal, dashpot
/// likewise, clipped at mu N. Rolling and twisting: a spring of the same stiffness on R times the relative rotation, clipped at
/// mu_r N and mu_t N (Luding 2008). The histories are kept in the state as forces.
#pragma once

#include <span>

#include "core/contact/wall_contact.h"
#include "core/state/drum_state.h"
#include "core/step/assemble.h"

namespace drumsweep {

struct StepReport;
struct Overlaps;

struct SmoothScratch {
  WallCandidates candidates;            ///< of all slabs
  std::vector<Eigen::Vector3d> force;   ///< (balls) [N]
  std::vector<Eigen::Vector3d> torque;  ///< (balls) [N m]
  std::vector<WallImpulse> walls;
  std::vector<Turn> wall_turns;
  std::vector<WallContact> contacts;
  std::vector<float> overlaps;  ///< of all pressed contacts [m]
};

/// Takes over what the contact search found: candidate pairs with their forces into the state, triangles near balls.
void list_smooth_contacts(const World& world, const Assembly& found, BallState& state, SmoothScratch& scratch);

/// Adds the effect of all contact forces in one time step to velocities and spins, and updates the histories.
void apply_smooth_forces(const World& world, std::span<const double> inverse_mass, std::span<const Pose> poses,
                         BallState& state, SmoothScratch& scratch);

void move_freely(double time_step, Balls& balls);

StepReport make_smooth_report(const World& world, const SmoothScratch& scratch, std::vector<Overlaps>& overlaps);

}  // namespace drumsweep

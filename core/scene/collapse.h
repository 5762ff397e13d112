/// Collapse of a column of balls on the ground when its gate opens: how far and how high the deposit is.
///
/// A column of length (or radius) L0 and height H0 settles behind its gate, which is then taken away at an instant or lifted. Channel:
/// the column stands at a wall and runs out to one side, or between two gates and runs out to both (L0 is then half its length).
/// Published for channels, with a = H0/L0: (L - L0)/L0 = 1.2 a for a < 1.8 (sand, Lube et al. 2005), 1.8 a for a < 3 (glass beads,
/// Lajeunesse et al. 2005), beyond that 1.9 to 2.3 a^(2/3); axisymmetric: 1.24 a for a < 1.7, then 1.6 a^(1/2) (Lube et al. 2004).
///
/// The front is the farthest ball that is joined to the deposit by a chain of gaps below a quarter of a diameter: where the deposit
/// ends for the eye, as in the measurements, which leave out the single grains that rolled on from it. It is taken in strips two
/// diameters wide (eight sectors around the axis), which gives its mean and standard error. The distance that holds 99 % of the mass
/// is given too; it does not depend on a gap but lies further in by what the thin foot holds.
#pragma once

#include "core/scene/scene.h"

namespace drumsweep {

struct CollapseScene : Scene {
  std::string geometry = "channel";
  std::string base = "rough";
  std::string sides = "periodic";
  std::string release = "removed";
  double length_m = 0.075;  ///< L0
  double height_m = 0.15;   ///< H0 to fill for; what it settles to is an observable
  double width_m = 0.02;    ///< of the channel
  bool two_sided = false;
  double lift_speed_m_s = 2;
  double floor_length_m = not_given;  ///< from the wall, the middle or the axis
  double longest_settling_s = 3;

  void add_fields(FieldTable& table) override;
  void validate(const Physics& physics, const Where& where) const override;
  SceneResult run(const Physics& physics, const SceneObserver& observer) const override;
};

}  // namespace drumsweep

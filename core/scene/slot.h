/// A silo empties through a slot (along y, periodic: a slice of a long one) or a round orifice in its flat bottom.
///
/// Balls settle on the closed bottom, the opening is set free, and what falls out is counted. With `recycle` every ball that fell out
/// comes back on top, so that the fill is steady and the rate can be averaged for as long as one likes; else the silo runs empty
/// and the measurement ends when less than an opening's width stands above the bottom.
/// Beverloo's law: W = C rho_b sqrt(g) (D - k d)^(3/2) per depth of a slot, C rho_b sqrt(g) (D - k d)^(5/2) for a round orifice
/// (Beverloo, Leniger and van de Velde 1961: C = 0.58, k = 1.4 for orifices; Myers and Sellers 1978: C = 1.03 for slots).
#pragma once

#include "core/scene/scene.h"

namespace drumsweep {

struct SlotScene : Scene {
  std::string opening = "slot";
  double opening_m = 0.04;  ///< width of the slot, or diameter of the orifice
  double width_m = 0.15;    ///< of the silo along x, or its diameter
  double depth_m = 0.02;    ///< slot: of the slice, one period
  double fill_height_m = 0.15;
  bool recycle = true;
  double adapt_s = 0.3;  ///< after opening, before counting
  double record_s = 1.0;
  double longest_settling_s = 2;

  void add_fields(FieldTable& table) override;
  void validate(const Physics& physics, const Where& where) const override;
  SceneResult run(const Physics& physics, const SceneObserver& observer) const override;
};

}  // namespace drumsweep

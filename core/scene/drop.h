/// One ball meets a plate at a given speed and angle, without gravity: normal and tangential restitution, spin, rebound angle.
/// Rigid contact: e_n out = e in; gross sliding for tan(angle) > 7/2 mu (1 + e), with v_x' = v_x - mu (1 + e) v_n and spin
/// (5/2) mu (1 + e) v_n / R; below that angle it leaves rolling with v_x' = 5/7 v_x. Real contacts store tangential
/// energy there and differ (Kharaz, Gorham and Salman 2001).
#pragma once

#include "core/scene/scene.h"

namespace drumsweep {

struct DropScene : Scene {
  double speed_m_s = 1.0;   ///< at impact
  double angle_deg = 0.0;   ///< from the plate's normal
  double height_m = 0.01;   ///< of the ball's lower side over the plate at the beginning
  double spin_rad_s = 0.0;  ///< before, backspin positive

  void add_fields(FieldTable& table) override;
  void validate(const Physics& physics, const Where& where) const override;
  SceneResult run(const Physics& physics, const SceneObserver& observer) const override;
};

}  // namespace drumsweep

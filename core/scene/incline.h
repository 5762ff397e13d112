/// A ball, or a small stack of balls, on a plane. The plane stays level (z = 0) and gravity is tilted by the angle towards +x,
/// which is downhill; at 180 degrees a ball hangs under the plane.
///
/// Single ball on a rigid plane (normal load N = m g cos(angle) + cohesion, friction mu, rolling resistance mu_r, twisting mu_t):
///   at rest it overlaps by (N/k)^(2/3), and without cohesion it stays at rest iff tan(angle) <= mu_r and <= mu;
///   otherwise it rolls with 5/7 g (sin - mu_r cos), as long as the friction this takes is within mu N;
///   launched at u0 without spin on the level it slides with -mu g, then rolls at 5/7 u0 (mu_r = 0), then slows by 5/7 mu_r g;
///   spin without friction decays by 5 mu_r g / (2 R) about a tangent and by 5 mu_t g / (2 R) about the normal.
/// Pyramid of four balls: the sides of a base ball's contact with the top are at the angle b to the vertical, tan b = 1/sqrt(2).
///   Without rolling resistance the frictions at top and plane are equal, f = N_top tan(b/2), so it stands iff mu >= tan(b/2) =
///   sqrt(3) - sqrt(2), and the plane's friction is >= tan(b/2)/4. Between frictionless balls rolling resistance alone holds
///   it iff mu_r >= tan b / (4 + 1/cos b), torques at top and plane both at their limits.
#pragma once

#include "core/scene/scene.h"

namespace drumsweep {

struct InclineScene : Scene {
  std::string stack = "none";  ///< or "pyramid" (tetrahedron), "triangle" (one ball thick, across the slope)
  std::int64_t layers = 2;     ///< of the stack; balls along the lowest one's side
  double angle_deg = 10.0;     ///< of the plane
  double speed_m_s = 0.0;      ///< at the beginning, downhill
  double spin_rad_s = 0.0;     ///< at the beginning, positive as when rolling downhill
  double twist_rad_s = 0.0;    ///< at the beginning, about the plane's normal
  double height_m = 0.0;       ///< over the place where the ball would rest
  double duration_s = 1.0;
  double fit_from_s = 0.2;       ///< accelerations and overlap are taken from then on
  double rest_speed_m_s = 1e-4;  ///< slower at the end is at rest
  double stand_diameters = 0.1;  ///< a stack stands where no ball has moved farther

  void add_fields(FieldTable& table) override;
  void validate(const Physics& physics, const Where& where) const override;
  SceneResult run(const Physics& physics, const SceneObserver& observer) const override;

 private:
  SceneResult run_ball(const Physics& physics, const SceneObserver& observer) const;
  SceneResult run_stack(const Physics& physics, const SceneObserver& observer) const;
};

}  // namespace drumsweep

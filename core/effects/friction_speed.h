/// Friction that falls with sliding speed (Stribeck's law without the viscous branch):
/// mu(v) = mu_d + (mu_s - mu_d) exp(-v / v_c). The speed is that at the beginning of a time step.
#pragma once

#include <cmath>

namespace drumsweep {

struct FrictionSpeed {
  bool on = false;
  double dynamic = 0;  ///< mu_d
  double speed = 1;    ///< v_c [m/s]
};

inline double friction_at(const FrictionSpeed& law, double static_friction, double sliding_speed) {
  if (!law.on) return static_friction;
  return law.dynamic + (static_friction - law.dynamic) * std::exp(-sliding_speed / law.speed);
}

}  // namespace drumsweep

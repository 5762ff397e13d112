/// Cohesion by moisture: a pull between two surfaces, constant while they press (as in DMT adhesion) and falling linearly to nothing
/// at the range, as a liquid bridge does when it thins and breaks (Lian, Thornton and Adams 1993). It is an external force: Hertz'
/// repulsion and Coulomb's friction act on top of it, so a wet contact rubs more than a dry one under the same load. Pulled by less
/// than the pull-off force a ball hangs; by more it comes off.
#pragma once

#include <algorithm>

namespace drumsweep {

struct Cohesion {
  double force = 0;  ///< pull-off force for two balls of the mean diameter, or one and a wall; scales with R* [N]
  double range = 0;  ///< gap at which it has fallen to 0 [m]
};

/// @param gap  < 0 pressed [m]
/// @return attraction >= 0 [N]
inline double attraction(const Cohesion& cohesion, double gap) {
  if (gap <= 0) return cohesion.force;
  return gap < cohesion.range ? cohesion.force * (1 - gap / cohesion.range) : 0;
}

}  // namespace drumsweep

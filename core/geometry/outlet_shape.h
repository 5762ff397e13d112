/// Slots of the outlet on the unrolled wall: s along the axis from the outlet's beginning, u = radius * angle around
/// it. S1, section 2; width w(s) = base_width + 2 s tan(opening_angle / 2), bisector inclined by bisector_angle.
#pragma once

#include "core/config/study.h"

namespace drumsweep {

struct OutletShape {
  double radius = 0;  ///< [m]
  double length = 0;  ///< [m]
  int num_slots = 0;
  double base_width = 0;  ///< [m]
  double widening = 0;    ///< dw/ds
  double lean = 0;        ///< du/ds of the bisectors

  double circumference() const;
  double width(double s) const { return base_width + widening * s; }
  /// u of the bisector of slot k at s; slot 0 begins at u = 0.
  double centre(int k, double s) const { return circumference() * k / num_slots + lean * s; }
  /// The slot whose bisector is nearest to (s, u), and how far u lies beyond that slot's edge (negative: inside the
  /// slot) [m].
  struct Nearest {
    int slot;
    double beyond;
  };
  Nearest nearest_slot(double s, double u) const;
};

/// @param coating  thickness of what sticks to the edges of the slots; each is narrower by twice that [m]
OutletShape outlet_shape(const DrumConfig& drum, const OutletConfig& outlet, double coating);

}  // namespace drumsweep

#include "core/geometry/outlet_shape.h"

#include <cmath>
#include <numbers>

#include "core/config/schema.h"

namespace drumsweep {

double OutletShape::circumference() const { return 2 * std::numbers::pi * radius; }

OutletShape::Nearest OutletShape::nearest_slot(double s, double u) const {
  const double pitch = circumference() / num_slots;
  const double from_first = u - centre(0, s);
  const double k = std::round(from_first / pitch);
  const int slot = static_cast<int>(k - num_slots * std::floor(k / num_slots));
  return {slot, std::abs(from_first - k * pitch) - 0.5 * width(s)};
}

OutletShape outlet_shape(const DrumConfig& drum, const OutletConfig& outlet, double coating) {
  OutletShape shape;
  shape.radius = 0.5 * drum.diameter_m;
  shape.length = outlet.length_m;
  shape.num_slots = static_cast<int>(outlet.num_slots);
  shape.base_width = outlet.base_width_m - 2 * coating;
  const double lean = std::tan(outlet.bisector_angle_deg * std::numbers::pi / 180);
  shape.lean = outlet.bisector_sense == "with_rotation" ? lean : -lean;
  // Along the bisector the same slot is 1 / cos longer, so it widens by that much more per axial distance.
  const double stretch = outlet.distance_along == "bisector" ? std::sqrt(1 + lean * lean) : 1.0;
  shape.widening = 2 * std::tan(opening_angle_rad(outlet) / 2) * stretch;
  return shape;
}

}  // namespace drumsweep

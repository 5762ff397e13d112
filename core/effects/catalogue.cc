#include "core/effects/catalogue.h"

#include "core/config/study.h"

namespace drumsweep {

std::span<const Effect> effect_catalogue() {
  static constexpr Effect list[] = {
      {"rolling_resistance", "effects.rolling_friction", "1", 0, 0.3, "torque against rolling, up to mu_r R N"},
      {"twisting_resistance", "effects.twisting_friction", "1", 0, 0.3, "torque against spin about the normal"},
      {"cohesion", "effects.cohesion_force_N", "N", 0, 0.1, "pull-off force with a range (moisture)"},
      {"size_distribution", "effects.size_spread", "1", 0, 0.2, "diameters differ; standard deviation over mean"},
      {"outlet_coating", "effects.outlet_coating_m", "m", 0, 0.006, "fines on the outlet narrow its slots"},
      {"drum_coating", "effects.drum_coating_m", "m", 0, 0.02, "fines on the drum's wall narrow it"},
      {"friction_falls_with_speed", "effects.dynamic_friction", "1", not_given, 0.3, "friction of fast sliding"},
      {"air_drag", "effects.air_density_kg_m3", "kg m-3", 0, 1.2, "drag on balls in flight"},
      {"texture_height", "effects.texture_height_scale", "1", 1, 2, "scale of the wall's bumps"},
      {"restitution", "material.restitution", "1", 0, 0.8, "fast collisions rebound"},
      {"wall_friction", "material.wall_friction", "1", not_given, 0.3, "friction of the wall, where not that of balls"},
  };
  return list;
}

}  // namespace drumsweep

/// A drum small enough for tests: a few hundred balls, seconds of a core.
#pragma once

#include "core/config/study.h"

namespace drumsweep {

inline Study small_drum() {
  Study study;
  study.name = "small drum";
  study.drum.diameter_m = 0.24;
  study.drum.length_m = 0.20;
  study.drum.angular_velocity_rad_s = 4.4;
  study.drum.texture.height_min_m = 0.001;
  study.drum.texture.height_max_m = 0.003;
  study.outlet.length_m = 0.12;
  study.outlet.opening_angle_deg = 4.0;
  study.outlet.base_width_m = 0.03;
  study.belt.width_m = 0.25;
  study.belt.outlet_begin_m = 0.06;
  study.belt.speed_m_s = 0.2;
  study.feed.rate_kg_s = 0.3;
  study.feed.zone_begin_m = 0.01;
  study.feed.zone_length_m = 0.06;
  study.feed.zone_width_m = 0.10;
  study.warmup.window_turns = 1;
  study.warmup.tolerance = 0.10;
  study.warmup.max_turns = 12;
  study.record.adapt_turns = 1;
  study.record.turns = 1;
  return study;
}

}  // namespace drumsweep

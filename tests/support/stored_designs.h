/// Output folders of sweeps that nobody has simulated: real files with made-up landings, for tests of what is stored.
#pragma once

#include <cmath>
#include <cstdint>

#include "sweep/plan/designs.h"
#include "sweep/store/store.h"

namespace drumsweep {

/// Landings spread over belt and recorded time, a little unlike for each `number`; every fourth leaves over the end.
/// @param spread  share of the belt's width on which they land; a small one makes a high heap that topples for long
inline Recording made_up_recording(const Study& study, std::uint32_t number, std::uint32_t num_landings,
                                   double spread = 0.6) {
  Recording r;
  r.begin_s = 3;
  r.turns = study.record.turns;
  const double duration = r.turns * 2 * M_PI / study.drum.angular_velocity_rad_s;
  for (std::uint32_t i = 0; i < num_landings; ++i) {
    const double u = std::fmod(0.618 * i + 0.001 * number, 1.0), y = study.belt.width_m * (0.2 + spread * u * u);
    const auto exit = static_cast<std::uint8_t>(i % 4 == 0 ? 255u : i % 4);
    r.landings.push_back({3 + duration * (i + 0.5) / num_landings, 0, y, 0, 0, -1, 0.005f, i, exit});
  }
  r.hash = number;
  return r;
}

/// A warm drum without a ball that counts as finished and steady.
inline WarmState made_up_warm_drum() {
  WarmState warm;
  warm.windows.push_back({2, 100, 100, 0});
  warm.finished = warm.steady = true;
  return warm;
}

/// A study with a grid of rows x columns designs of the outlet.
inline Study grid_study(std::int64_t rows, std::int64_t columns) {
  Study study;
  study.name = "made up";
  study.outlet.opening_angle_deg = 1;
  study.stages = {
      {"grid",
       "grid",
       {{"outlet.opening_angle_deg", 0.1, 0.6, rows, {}}, {"outlet.base_width_m", 0.04, 0.06, columns, {}}}}};
  return study;
}

}  // namespace drumsweep

/// Landings and tables made up for the tests of postproc.
#pragma once

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "core/config/study.h"
#include "core/state/landing.h"

namespace drumsweep {

/// Rate of lab2013, 4.4 kg/s of 1.309 g [balls/s].
inline double lab_balls_per_s() {
  const MaterialConfig material;
  const double radius = 0.5 * material.diameter_m;
  return 4.4 / (material.density_kg_m3 * 4.0 / 3.0 * std::numbers::pi * radius * radius * radius);
}

inline double turns_to_seconds(double turns) { return turns * 2.0 * std::numbers::pi / 2.5; }

inline Landing landing_at(double time, double x, double y, std::uint32_t id = 0) {
  Landing landing;
  landing.time = time;
  landing.x = x;
  landing.y = y;
  landing.radius = 0.005F;
  landing.ball_id = id;
  return landing;
}

/// Poisson landings at the lab rate over two turns; y is drawn by the caller's rule.
inline std::vector<Landing> poisson_landings(std::mt19937_64& random,
                                             const std::function<double(std::mt19937_64&)>& draw_y) {
  std::exponential_distribution<double> wait(lab_balls_per_s());
  std::uniform_real_distribution<double> place(-0.1, 0.1);
  std::vector<Landing> landings;
  for (double time = wait(random); time < turns_to_seconds(2.0); time += wait(random)) {
    const double x = place(random);
    landings.push_back(landing_at(time, x, draw_y(random), static_cast<std::uint32_t>(landings.size())));
  }
  return landings;
}

inline std::string file_content(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

}  // namespace drumsweep

#include "core/effects/size_distribution.h"

#include <cmath>
#include <numbers>

#include "core/geometry/random.h"

namespace drumsweep {
namespace {

/// Diameter over its mean where the underlying normal variable is z.
double relative_size(const EffectsConfig& effects, double z) {
  if (effects.size_distribution == "normal") return 1 + effects.size_spread * z;
  // Mean 1 and standard deviation size_spread of the uncut distribution.
  const double variance = std::log(1 + effects.size_spread * effects.size_spread);
  return std::exp(std::sqrt(variance) * z - 0.5 * variance);
}

}  // namespace

double radius_of_ball(const Physics& physics, std::uint32_t id) {
  const EffectsConfig& effects = physics.effects;
  const double mean = 0.5 * physics.material.diameter_m;
  if (effects.size_spread == 0) return mean;
  for (std::uint32_t attempt = 0;; ++attempt) {
    const auto u = uniform4(physics.seed, Purpose::ball_size, id, attempt);
    const double z = std::sqrt(-2 * std::log(1 - u[0])) * std::cos(2 * std::numbers::pi * u[1]);
    if (std::abs(z) <= effects.size_cut) return mean * relative_size(effects, z);
  }
}

double smallest_radius(const Physics& physics) {
  const EffectsConfig& effects = physics.effects;
  return 0.5 * physics.material.diameter_m * (effects.size_spread == 0 ? 1 : relative_size(effects, -effects.size_cut));
}

double largest_radius(const Physics& physics) {
  const EffectsConfig& effects = physics.effects;
  return 0.5 * physics.material.diameter_m * (effects.size_spread == 0 ? 1 : relative_size(effects, effects.size_cut));
}

double mean_ball_mass(const Physics& physics) {
  const double d = physics.material.diameter_m, sphere = physics.material.density_kg_m3 * std::numbers::pi / 6;
  const EffectsConfig& effects = physics.effects;
  if (effects.size_spread == 0) return sphere * std::pow(d, 3);
  // Simpson's rule over the cut normal density.
  constexpr int intervals = 400;
  double sum = 0, norm = 0;
  for (int i = 0; i <= intervals; ++i) {
    const double z = effects.size_cut * (2.0 * i / intervals - 1);
    const double weight = (i == 0 || i == intervals ? 1 : (i % 2 == 1 ? 4 : 2)) * std::exp(-0.5 * z * z);
    norm += weight;
    sum += weight * std::pow(relative_size(effects, z), 3);
  }
  return sphere * std::pow(d, 3) * sum / norm;
}

}  // namespace drumsweep

/// Random numbers of a diagnosis: functions of (seed, purpose, index) alone, so that nothing depends on threads or order.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <numbers>

#include "core/geometry/random.h"

namespace drumsweep {

/// `count` independent standard normal numbers: Box and Muller's transform of Philox blocks.
inline Eigen::VectorXd normal_draws(std::int64_t seed, Purpose purpose, std::uint64_t index, Eigen::Index count) {
  Eigen::VectorXd out(count);
  for (Eigen::Index i = 0; i < count; i += 4) {
    const auto u = uniform4(seed, purpose, index, static_cast<std::uint32_t>(i / 4));
    for (Eigen::Index k = 0; k < 4 && i + k < count; ++k) {
      const double radius = std::sqrt(-2 * std::log(1 - u[k < 2 ? 0 : 2])),
                   angle = 2 * std::numbers::pi * u[k < 2 ? 1 : 3];
      out[i + k] = radius * (k % 2 == 0 ? std::cos(angle) : std::sin(angle));
    }
  }
  return out;
}

/// `count` numbers uniform in [0, 1).
inline Eigen::VectorXd uniform_draws(std::int64_t seed, Purpose purpose, std::uint64_t index, Eigen::Index count) {
  Eigen::VectorXd out(count);
  for (Eigen::Index i = 0; i < count; i += 4) {
    const auto u = uniform4(seed, purpose, index, static_cast<std::uint32_t>(i / 4));
    for (Eigen::Index k = 0; k < 4 && i + k < count; ++k) out[i + k] = u[static_cast<std::size_t>(k)];
  }
  return out;
}

}  // namespace drumsweep

/// Surfaces that are known, measured with errors like the drum's: a smooth one shared by a replicate and one of each run.
#pragma once

#include <cmath>
#include <functional>
#include <map>
#include <vector>

#include "core/geometry/random.h"
#include "sweep/fit/box.h"
#include "sweep/fit/samples.h"

namespace drumsweep {

inline Box two_variables() {
  return {{"outlet.opening_angle_deg", 0, 9, 0.1}, {"outlet.base_width_m", 0.02, 0.065, 0.0005}};
}

/// Standard normal, keyed.
inline double normal(std::int64_t seed, std::uint64_t index, std::uint32_t draw = 0) {
  const auto u = uniform4(seed, Purpose::fill, index, draw);
  return std::sqrt(-2 * std::log(1 - u[0])) * std::cos(2 * M_PI * u[1]);
}

/// A valley across the box, as wide and as flat as the drum's: its axis turned by 30 to 60 deg, its lowest point drawn.
struct Valley {
  double at[2], cosine, sine, across, along;

  explicit Valley(std::int64_t seed) {
    const auto u = uniform4(seed, Purpose::fill, 1000000);
    at[0] = 0.2 + 0.6 * u[0];
    at[1] = 0.2 + 0.6 * u[1];
    const double angle = M_PI / 6 * (1 + u[2]);
    cosine = std::cos(angle);
    sine = std::sin(angle);
    across = 0.010;
    along = 0.002 + 0.002 * u[3];
  }
  /// [m], of unit coordinates
  double operator()(const Point& unit) const {
    const double p = cosine * (unit[0] - at[0]) + sine * (unit[1] - at[1]);
    const double q = -sine * (unit[0] - at[0]) + cosine * (unit[1] - at[1]);
    return 0.011 + across * p * p / (1 + std::abs(p)) + along * (q * q + 0.3 * q * q * q);
  }
};

struct Laboratory {
  Box box = two_variables();
  std::function<double(const Point& unit)> truth;
  double sigma_m = 0.0006;  ///< of one run
  double shared = 0.9;      ///< share of the variance common to a replicate
  std::int64_t seed = 1;

  /// A row; its stated sigma is a jackknife's, which scatters by a third.
  Measurement measure(const Point& at, double replicate = 0) const {
    const Point unit = to_unit(box, at);
    std::uint64_t key = 0;
    for (const double u : unit) key = key * 1000003 + static_cast<std::uint64_t>(std::llround(u * 100000));
    key = key * 64 + static_cast<std::uint64_t>(replicate);
    const double scale = sigma_m * (0.6 + 0.8 * unit.back());
    double chi2 = 0;
    for (std::uint32_t i = 0; i < 5; ++i) chi2 += std::pow(normal(seed, key, 10 + i), 2);
    const double error = std::sqrt(shared) * smooth_error(unit, replicate) + std::sqrt(1 - shared) * normal(seed, key);
    return {at, replicate, truth(unit) + scale * error, scale * std::sqrt(chi2 / 5)};
  }
  /// Random waves of lengths near the box's own (random Fourier features), unit variance.
  double smooth_error(const Point& unit, double replicate) const {
    constexpr int num_waves = 60;
    double sum = 0;
    for (int w = 0; w < num_waves; ++w) {
      const std::uint64_t key = 5000000 + 1000 * static_cast<std::uint64_t>(replicate) + static_cast<std::uint64_t>(w);
      double phase = 2 * M_PI * uniform4(seed, Purpose::fill, key, 99)[0];
      for (std::size_t k = 0; k < unit.size(); ++k)
        phase += normal(seed, key, static_cast<std::uint32_t>(k)) / 0.6 * unit[k];
      sum += std::cos(phase);
    }
    return sum * std::sqrt(2.0 / num_waves);
  }
  std::vector<Measurement> measure(const std::vector<Point>& points, int num_replicates = 1) const {
    std::vector<Measurement> rows;
    for (int r = 0; r < num_replicates; ++r)
      for (const Point& at : points) rows.push_back(measure(at, r));
    return rows;
  }
};

}  // namespace drumsweep

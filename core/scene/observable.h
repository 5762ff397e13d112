/// A number that can be compared with a measurement.
#pragma once

#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace drumsweep {

struct Observable {
  std::string name;
  double position;  ///< place, angle or time that it belongs to, in the scene's own terms; NaN for a number without one
  double value;
  double sigma;  ///< standard error, NaN where it is not estimated
  std::string unit;
  std::string position_unit = "m";
};

/// Observable without a place.
inline Observable observable(std::string name, double value, double sigma, std::string unit) {
  return {std::move(name), std::numeric_limits<double>::quiet_NaN(), value, sigma, std::move(unit)};
}

/// "name,position,position_unit,value,sigma,unit", one line each.
std::string observables_csv(const std::vector<Observable>& list);

/// Mean and standard error of independent samples (NaN below two).
struct Estimate {
  double mean = 0, sigma = std::numeric_limits<double>::quiet_NaN();
};
Estimate estimate(const std::vector<double>& samples);

/// Mean and standard error of a correlated series in time, from the means of `num_blocks` blocks of equal length.
Estimate block_estimate(const std::vector<double>& series, std::size_t num_blocks = 8);

}  // namespace drumsweep

/// A local minimum of a cheap smooth function in a box, without derivatives: BOBYQA (Powell 2009) of NLopt. For fits and
/// fitted surfaces; simulations are searched by replay (nlopt_replay.h).
#pragma once

#include <functional>
#include <vector>

namespace drumsweep {

struct BoundedMinimum {
  std::vector<double> at;
  double value = 0;
};

/// The same bits for the same arguments: no clock, no random numbers.
/// @param step      first step a variable, > 0
/// @param tolerance stops when steps are smaller than this times `step`
/// A value that is not finite counts as 1e100. @return the best point seen, inside [low, high]
/// @pre at least two variables (BOBYQA's own limit), low < high
BoundedMinimum bounded_minimum(const std::function<double(const std::vector<double>&)>& objective,
                               std::vector<double> start, const std::vector<double>& low,
                               const std::vector<double>& high, const std::vector<double>& step, double tolerance,
                               int max_evaluations);

}  // namespace drumsweep

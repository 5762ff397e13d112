/// One local search by NLopt as a pure function of what is known. NLopt wants values at once and a simulation takes
/// hours, so each call runs NLopt from its start with the values known by now, up to the first point without one: that
/// point is what to simulate next. Nothing of NLopt's inside need be stored: a resumed search walks the same way as an
/// uninterrupted one, whatever the order in which values came. Several starts are several calls, one rank each.
///
/// NLopt walks through the unit cube; what it is told at x is the value at the lattice point nearest to x, so a step
/// below the resolution costs nothing. Stops by steps and counts, never by a clock.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "sweep/fit/box.h"

namespace drumsweep {

struct ReplayOptions {
  std::string method = "bobyqa";  ///< or cobyla, sbplx, nelder_mead
  int max_evaluations = 40;       ///< distinct lattice points; their simulations are what costs
  double tolerance_steps = 1;     ///< converged when NLopt's steps are below this many lattice steps in every variable
  double first_step = 0.2;        ///< of the box, in every variable
};

/// What is known of a lattice point. A hole is a design without a value: no such drum, failed, not trusted.
struct Known {
  enum class State { unknown, value, hole } state = State::unknown;
  double f_m = 0;
};

enum class ReplayEnd {
  asks,       ///< not ended: `asks` is to be simulated
  converged,  ///< steps below the tolerance
  exhausted,  ///< max_evaluations points are known
  hole,       ///< a point without a value came up; NLopt cannot go round it
  stuck       ///< NLopt gave up (rounding, failure): `why` has its word
};

struct Replay {
  ReplayEnd end = ReplayEnd::asks;
  std::optional<Point> asks;  ///< lattice point
  std::optional<Point> best;  ///< lattice point with the lowest value of this search; none before the first value
  double best_f_m = 0;
  std::vector<Point> path;  ///< distinct points with values, in the order of the search
  std::string why;          ///< for people: "converged after 14 points: ..."
};

const std::vector<std::string>& replay_methods();

/// @throws InputError for an unknown method (names the accepted ones), max_evaluations < 1, tolerance <= 0, first_step
/// outside (0, 0.5], a start outside the box.
/// A value that is not finite is treated as a hole; NLopt never sees one.
Replay replay(const Box& box, const ReplayOptions& options, const Point& start,
              const std::function<Known(const Point&)>& lookup);

}  // namespace drumsweep

#include "sweep/refine/nlopt_replay.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlopt.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <memory>
#include <utility>

#include "core/config/schema.h"

namespace drumsweep {
namespace {

nlopt_algorithm algorithm_of(const std::string& method) {
  const std::map<std::string, nlopt_algorithm> algorithms = {{"bobyqa", NLOPT_LN_BOBYQA},
                                                             {"cobyla", NLOPT_LN_COBYLA},
                                                             {"sbplx", NLOPT_LN_SBPLX},
                                                             {"nelder_mead", NLOPT_LN_NELDERMEAD}};
  const auto found = algorithms.find(method);
  if (found == algorithms.end())
    throw InputError(fmt::format("method = \"{}\"; accepted: {}", method, fmt::join(replay_methods(), ", ")));
  return found->second;
}

void check(const Box& box, const ReplayOptions& options, const Point& start) {
  check_box(box);
  algorithm_of(options.method);
  if (options.max_evaluations < 1)
    throw InputError(fmt::format("max_evaluations = {}; accepted: 1 or more", options.max_evaluations));
  if (!(options.tolerance_steps > 0))
    throw InputError(fmt::format("tolerance_steps = {}; accepted: > 0", options.tolerance_steps));
  if (!(options.first_step > 0 && options.first_step <= 0.5))
    throw InputError(fmt::format("first_step = {}; accepted: above 0, up to 0.5 of the box", options.first_step));
  for (std::size_t i = 0; i < box.size(); ++i)
    if (!(start.at(i) >= box[i].low && start[i] <= box[i].high))
      throw InputError(fmt::format("start {} = {}; accepted: {} to {}", box[i].key, start[i], box[i].low, box[i].high));
}

struct Run {
  const Box& box;
  const ReplayOptions& options;
  const std::function<Known(const Point&)>& lookup;
  nlopt_opt opt = nullptr;
  std::map<Point, double> values;
  Replay out;
  std::string hole;
};

/// Ends NLopt's run before it gets the value that this call returns.
double stop(Run& run, ReplayEnd end) {
  run.out.end = end;
  nlopt_force_stop(run.opt);
  return 0;
}

double evaluate(unsigned n, const double* x, double*, void* data) {
  Run& run = *static_cast<Run*>(data);
  if (run.out.end != ReplayEnd::converged) return 0;  // stopped; NLopt may ask once more before it looks
  const Point at = quantised(run.box, from_unit(run.box, Point(x, x + n)));
  if (const auto seen = run.values.find(at); seen != run.values.end()) return seen->second;
  if (run.values.size() == static_cast<std::size_t>(run.options.max_evaluations))
    return stop(run, ReplayEnd::exhausted);
  const Known known = run.lookup(at);
  if (known.state == Known::State::unknown) {
    run.out.asks = at;
    return stop(run, ReplayEnd::asks);
  }
  if (known.state == Known::State::hole || !std::isfinite(known.f_m)) {
    run.hole = fmt::format("{}", fmt::join(at, ", "));
    return stop(run, ReplayEnd::hole);
  }
  run.values.emplace(at, known.f_m);
  run.out.path.push_back(at);
  if (!run.out.best || known.f_m < run.out.best_f_m) {
    run.out.best = at;
    run.out.best_f_m = known.f_m;
  }
  return known.f_m;
}

std::string reason(const Run& run) {
  const std::size_t num = run.values.size();
  switch (run.out.end) {
    case ReplayEnd::asks:
      return fmt::format("{} points known, the next is asked for", num);
    case ReplayEnd::converged:
      return fmt::format("converged after {} points: steps below {} of the resolution", num,
                         run.options.tolerance_steps);
    case ReplayEnd::exhausted:
      return fmt::format("max_evaluations = {} points are used up", run.options.max_evaluations);
    case ReplayEnd::hole:
      return fmt::format("ended after {} points at a design without a value: {}", num, run.hole);
    case ReplayEnd::stuck:
      break;
  }
  return fmt::format("NLopt gave up after {} points", num);
}

}  // namespace

const std::vector<std::string>& replay_methods() {
  static const std::vector<std::string> methods = {"bobyqa", "cobyla", "sbplx", "nelder_mead"};
  return methods;
}

Replay replay(const Box& box, const ReplayOptions& options, const Point& start,
              const std::function<Known(const Point&)>& lookup) {
  check(box, options, start);
  const std::size_t n = box.size();
  // BOBYQA refuses a single variable; SBPLX is a simplex search there.
  const bool too_few = options.method == "bobyqa" && n < 2;
  const nlopt_algorithm algorithm = too_few ? NLOPT_LN_SBPLX : algorithm_of(options.method);
  nlopt_srand(1);  // none of the four draws random numbers; a fifth would start from the same ones
  const std::unique_ptr<nlopt_opt_s, decltype(&nlopt_destroy)> opt(nlopt_create(algorithm, static_cast<unsigned>(n)),
                                                                   &nlopt_destroy);
  Run run{box, options, lookup, opt.get(), {}, {}, {}};
  run.out.end = ReplayEnd::converged;

  std::vector<double> tolerance;
  for (const DesignAxis& axis : box)
    tolerance.push_back(options.tolerance_steps * axis.resolution / (axis.high - axis.low));
  nlopt_set_lower_bounds1(opt.get(), 0);
  nlopt_set_upper_bounds1(opt.get(), 1);
  nlopt_set_initial_step1(opt.get(), options.first_step);
  nlopt_set_xtol_abs(opt.get(), tolerance.data());
  // Points that are known again cost nothing, but on a flat lattice they must not go on for ever.
  nlopt_set_maxeval(opt.get(), 100 * options.max_evaluations);
  nlopt_set_min_objective(opt.get(), evaluate, &run);

  Point x = to_unit(box, quantised(box, start));
  for (double& value : x) value = std::clamp(value, 0.0, 1.0);
  double value = 0;
  const nlopt_result result = nlopt_optimize(opt.get(), x.data(), &value);
  const bool gave_up = run.out.end == ReplayEnd::converged &&
                       (result == NLOPT_MAXEVAL_REACHED || (result < 0 && result != NLOPT_ROUNDOFF_LIMITED));
  if (gave_up) run.out.end = ReplayEnd::stuck;
  run.out.why = reason(run);
  if (too_few) run.out.why += "; sbplx, as bobyqa needs two variables";
  if (gave_up) run.out.why += fmt::format(" ({})", nlopt_result_to_string(result));
  return std::move(run.out);
}

}  // namespace drumsweep

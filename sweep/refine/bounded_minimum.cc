#include "sweep/refine/bounded_minimum.h"

#include <nlopt.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>

namespace drumsweep {
namespace {

struct Search {
  const std::function<double(const std::vector<double>&)>& objective;
  const std::vector<double>&low, &high;
  BoundedMinimum best;
};

double evaluate(unsigned n, const double* x, double*, void* data) {
  Search& search = *static_cast<Search*>(data);
  std::vector<double> at(x, x + n);
  for (std::size_t i = 0; i < n; ++i) at[i] = std::clamp(at[i], search.low[i], search.high[i]);
  double value = search.objective(at);
  if (!std::isfinite(value)) value = 1e100;
  if (search.best.at.empty() || value < search.best.value) search.best = {std::move(at), value};
  return value;
}

}  // namespace

BoundedMinimum bounded_minimum(const std::function<double(const std::vector<double>&)>& objective,
                               std::vector<double> start, const std::vector<double>& low,
                               const std::vector<double>& high, const std::vector<double>& step, double tolerance,
                               int max_evaluations) {
  Search search{objective, low, high, {}};
  std::vector<double> smallest;
  for (std::size_t i = 0; i < start.size(); ++i) {
    start[i] = std::clamp(start[i], low[i], high[i]);
    smallest.push_back(tolerance * step[i]);
  }
  const std::unique_ptr<nlopt_opt_s, decltype(&nlopt_destroy)> opt(
      nlopt_create(NLOPT_LN_BOBYQA, static_cast<unsigned>(start.size())), &nlopt_destroy);
  nlopt_set_lower_bounds(opt.get(), low.data());
  nlopt_set_upper_bounds(opt.get(), high.data());
  nlopt_set_initial_step(opt.get(), step.data());
  nlopt_set_xtol_abs(opt.get(), smallest.data());
  nlopt_set_maxeval(opt.get(), max_evaluations);
  nlopt_set_min_objective(opt.get(), evaluate, &search);
  double value = 0;
  nlopt_optimize(opt.get(), start.data(), &value);  // the result is the best point seen, whatever ended the search
  return search.best;
}

}  // namespace drumsweep

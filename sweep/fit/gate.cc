#include "sweep/fit/gate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace drumsweep {
namespace {

double square(double x) { return x * x; }

GateFigures figures_of(const FittedSurface& surface) {
  const std::vector<Measurement>& rows = surface.rows();
  const Pooled pooled = pool(surface.box(), rows);
  const auto n = static_cast<double>(rows.size());
  GateFigures out;
  out.num_rows = static_cast<int>(rows.size());
  out.num_points = static_cast<int>(pooled.samples.size());
  out.points_per_variable = out.num_points / static_cast<double>(surface.box().size());

  // Left-out errors against noise, prediction and spread.
  const std::vector<LeftOut> left_out = surface.leave_one_out();
  double mean = 0, errors = 0, scatter = 0, own = 0, run = 0, shared = 0;
  for (const Measurement& row : rows) mean += row.f_m / n;
  double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    errors += square(left_out[i].error_m) / n;
    out.loo_chi2 += square(left_out[i].error_m / left_out[i].sd_m) / n;
    scatter += square(rows[i].f_m - mean) / n;
    own += square(pooled.own_sigma_m[i]) / n;
    run += square(surface.run_sd_m(rows[i].at)) / n;
    shared += square(surface.shared_sd_m(rows[i].at)) / n;
    const double f = surface.mean_m(rows[i].at);
    lowest = std::min(lowest, f);
    highest = std::max(highest, f);
  }
  out.loo_rms_m = std::sqrt(errors);
  out.loo_over_sigma = std::sqrt(errors / own);
  out.q2 = scatter > 0 ? 1 - errors / scatter : 0;
  out.amplitude_over_run = (highest - lowest) / std::sqrt(run);
  out.amplitude_over_error = (highest - lowest) / std::sqrt(run + shared);

  out.quadratic_chi2 = std::numeric_limits<double>::quiet_NaN();
  if (const auto quadratic = quadratic_fit(surface.box(), pooled.samples); quadratic && quadratic->dof > 0) {
    out.quadratic_dof = quadratic->dof;
    out.quadratic_chi2 = quadratic->chi2_per_dof;
    out.quadratic_p = quadratic->p_value;
  }
  return out;
}

void judge(Gate& out, const GateLimits& limits) {
  const GateFigures& f = out.figures;
  const bool rough = f.loo_over_sigma > limits.loo_over_sigma && f.q2 < limits.q2_whatever_noise;
  if (rough) {
    out.verdict = GateVerdict::rough;
    out.reason = fmt::format(
        "neighbours differ by more than noise explains: left-out rows are missed by {:.1f} of their sigma (limit {})",
        f.loo_over_sigma, limits.loo_over_sigma);
  } else if (f.q2 < limits.q2) {
    out.verdict = GateVerdict::unresolved;
    out.reason = fmt::format("noise hides the surface: left-out rows are explained to {:.0f} % only (limit {:.0f} %)",
                             100 * std::max(0.0, f.q2), 100 * limits.q2);
  } else if (f.loo_chi2 > limits.loo_chi2) {
    out.verdict = GateVerdict::rough;
    out.reason = fmt::format("left-out rows are missed by more than the fit predicts: chi^2 {:.2f} a row (limit {})",
                             f.loo_chi2, limits.loo_chi2);
  } else if (f.amplitude_over_error < limits.amplitude_over_error) {
    out.verdict = GateVerdict::unresolved;
    out.reason =
        fmt::format("the surface's range is {:.1f} errors of a run (limit {}): it may be one replicate's error",
                    f.amplitude_over_error, limits.amplitude_over_error);
  } else if (f.amplitude_over_run < limits.amplitude_over_run) {
    out.verdict = GateVerdict::noisy;
    out.reason =
        fmt::format("the surface shows, but its range is only {:.1f} of a run's noise (limit {}): optimise the fit",
                    f.amplitude_over_run, limits.amplitude_over_run);
  } else {
    out.verdict = GateVerdict::smooth;
    out.reason = fmt::format("left-out rows are explained to {:.1f} %, range over a run's noise {:.0f}", 100 * f.q2,
                             f.amplitude_over_run);
  }
}

}  // namespace

int points_for_a_fit(const Box& box, const GateLimits& limits) {
  return static_cast<int>(std::ceil(limits.points_per_variable * static_cast<double>(box.size())));
}

Gate too_few_points(const Box& box, int num_rows, int num_points, const GateLimits& limits) {
  Gate out;
  out.figures.num_rows = num_rows;
  out.figures.num_points = num_points;
  out.figures.points_per_variable = num_points / static_cast<double>(box.size());
  out.verdict = GateVerdict::few_points;
  out.reason = fmt::format("{} points are too few for {} variables: {} are needed", num_points, box.size(),
                           points_for_a_fit(box, limits));
  return out;
}

Gate gate(const FittedSurface& surface, const GateLimits& limits) {
  Gate out;
  out.figures = figures_of(surface);
  if (out.figures.num_points < points_for_a_fit(surface.box(), limits))
    return too_few_points(surface.box(), out.figures.num_rows, out.figures.num_points, limits);
  judge(out, limits);
  return out;
}

}  // namespace drumsweep

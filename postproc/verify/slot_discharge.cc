#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/scene/deposit.h"
#include "core/scene/scene_value.h"
#include "core/scene/slot.h"
#include "postproc/verify/glass_beads.h"
#include "postproc/verify/groups.h"
#include "postproc/verify/line_figure.h"

namespace drumsweep {
namespace {

constexpr double diameter = 0.01, k_beverloo = 1.4;

/// As wide and as full as measurements ask for: 2.5 D, and 1.2 times that (Nedderman 1992; Mankoc et al. 2007).
SlotScene silo(double opening, bool full) {
  SlotScene s;
  s.opening_m = opening;
  s.width_m = 2.5 * opening;
  s.depth_m = (full ? 5 : 3) * diameter;
  s.fill_height_m = 1.2 * s.width_m;
  s.longest_settling_s = 2;
  // A time in which the fill sinks by a good part of an opening, and many balls pass.
  const double fall = std::sqrt(opening / gravity);
  s.adapt_s = 3 * fall;
  s.record_s = std::max((full ? 12 : 5) * fall, full ? 3.0 : (opening < 0.2 ? 1.5 : 1.0));
  return s;
}

}  // namespace

std::vector<VerifyCase> verify_slot_discharge(const VerifyOptions& options) {
  const auto goes_on = [&](const SceneProgress&) { return !options.goes_on || options.goes_on(); };
  const Physics physics = glass_beads(options.full);
  const std::vector<double> openings = options.full ? std::vector<double>{0.06, 0.08, 0.10, 0.14, 0.20, 0.28}
                                                    : std::vector<double>{0.06, 0.08, 0.10, 0.12};
  std::vector<VerifyCase> out;

  // Rate over opening, scaled by the bulk density at rest as in Beverloo's fits.
  Curve measured{"drumsweep", {}, {}, {}, true};
  std::vector<double> log_rate, two_thirds, all_openings;
  double factor = 0, leaked = 0, empty = 0, middle_rate = 0, middle_sigma = 0;
  const double middle = 0.08;  // where two fill heights are compared
  for (const double opening : openings) {
    const SlotScene scene = silo(opening, options.full);
    const SceneResult r = scene.run(physics, goes_on);
    if (r.stopped) return out;
    const Estimate rate = scene_value(r, "discharge_rate");
    const double scale = scene_value(r, "bulk_density_at_rest").mean * std::sqrt(gravity);
    measured.x.push_back(1e3 * opening);
    measured.y.push_back(rate.mean);
    measured.sigma.push_back(rate.sigma);
    log_rate.push_back(std::log(rate.mean / scale));
    two_thirds.push_back(std::pow(rate.mean / scale, 2.0 / 3));
    all_openings.push_back(opening);
    factor += rate.mean / scale / std::pow(opening - k_beverloo * diameter, 1.5) / static_cast<double>(openings.size());
    leaked += scene_value(r, "leaked").mean + static_cast<double>(r.lost);
    empty += scene_value(r, "ran_empty").mean;
    if (opening == middle) {
      middle_rate = rate.mean;
      middle_sigma = rate.sigma;
    }
  }
  // The exponent with Beverloo's k; then k with Beverloo's exponent.
  std::vector<double> log_free;
  for (const double opening : all_openings) log_free.push_back(std::log(opening - k_beverloo * diameter));
  const Line power = fit_line(log_free, log_rate), linear = fit_line(all_openings, two_thirds);
  const double k = -linear.offset / linear.slope / diameter, c_fitted = std::pow(linear.slope, 1.5);

  log_free.clear();
  for (const double opening : all_openings) log_free.push_back(std::log(opening - k * diameter));
  const double own_exponent = fit_line(log_free, log_rate).slope;

  // How far the exponent 3/2 with a free k is from the measured rates, in their standard errors.
  double misfit = 0;
  for (std::size_t i = 0; i < all_openings.size(); ++i) {
    const double sigma = 2.0 / 3 * two_thirds[i] * measured.sigma[i] / measured.y[i];
    misfit += std::pow((two_thirds[i] - linear.offset - linear.slope * all_openings[i]) / sigma, 2);
  }

  // The same opening under twice the fill.
  SlotScene taller = silo(middle, options.full);
  taller.fill_height_m *= 2;
  const SceneResult tall = taller.run(physics, goes_on);
  if (tall.stopped) return out;
  const Estimate tall_rate = scene_value(tall, "discharge_rate");

  out.push_back({"exponent n of W ~ (D - 1.4 d)^n", "Beverloo et al. 1961, per depth of a slot", "1.5", 1.4, 1.6,
                 power.slope,
                 fmt::format("{} openings of {:g} to {:g} d; with k as below it is {:.3g}. Openings beyond "
                             "10 d, steps of 0.5 to 2 ms, 15 to 60 iterations and the fill give the same; why k is 2 "
                             "and more here is open",
                             openings.size(), openings.front() / diameter, openings.back() / diameter, own_exponent)});
  out.push_back({"C at k = 1.4, exponent 1.5", "Beverloo et al. 1961; Myers and Sellers 1978",
                 "0.58 (orifices) to 1.03 (slots)", 0.58, 1.03, factor, "with the bulk density at rest"});
  out.push_back({"k where W^(2/3) over D meets zero", "Beverloo et al. 1961; Nedderman 1992",
                 "1.4; 1 to 3 are published", 1, 3, k,
                 fmt::format("with C = {:.3g}; chi^2 of exponent 3/2 with this k: {:.2g} for {} degrees of freedom",
                             c_fitted, misfit, all_openings.size() - 2)});
  out.push_back({"rate under twice the fill over that under the fill", "Hagen 1852; Beverloo et al. 1961", "1", 0.95,
                 1.05, tall_rate.mean / middle_rate,
                 fmt::format("+- {:.2g}; D = {:g} d, fill {:.3g} and {:.3g} m",
                             std::hypot(tall_rate.sigma / tall_rate.mean, middle_sigma / middle_rate),
                             middle / diameter, silo(middle, options.full).fill_height_m, taller.fill_height_m)});
  out.push_back(
      {"balls that went through walls or bottom, silos run empty", "conservation", "0", 0, 0, leaked + empty, ""});

  LineFigure figure{
      "Discharge through a slot", "opening D [mm]", "discharge per depth [kg/(s m)]", {measured}, true, false};
  const double scale = std::exp(power.offset);
  Curve fitted{fmt::format("fit, (D - 1.4 d)^{:.2f}", power.slope), {}, {}, {}, false};
  Curve low{"Beverloo with C = 0.58", {}, {}, {}, false}, high{"Beverloo with C = 1.03", {}, {}, {}, false};
  const double density = std::exp(std::log(measured.y.front()) - log_rate.front());
  for (int i = 0; i <= 30; ++i) {
    const double d = openings.front() * 0.9 * std::pow(openings.back() * 1.1 / (openings.front() * 0.9), i / 30.0);
    const double free = d - k_beverloo * diameter;
    for (Curve* c : {&fitted, &low, &high}) c->x.push_back(1e3 * d);
    fitted.y.push_back(density * scale * std::pow(free, power.slope));
    low.y.push_back(density * 0.58 * std::pow(free, 1.5));
    high.y.push_back(density * 1.03 * std::pow(free, 1.5));
  }
  figure.curves.insert(figure.curves.end(), {fitted, low, high});
  const std::string trouble = write_figure(figure, options.folder, "slot_discharge");
  if (!trouble.empty()) out.back().note += "no picture: " + trouble;
  return out;
}

}  // namespace drumsweep

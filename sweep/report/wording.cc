#include "sweep/report/wording.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "postproc/contour.h"

namespace drumsweep {

Quantity quantity_of(const std::string& column) {
  const std::string label = axis_label(column);
  const std::size_t open = label.rfind(" (");
  if (open == std::string::npos || label.back() != ')') return {label, ""};
  const std::string unit = label.substr(open + 2, label.size() - open - 3);
  return {label.substr(0, open), unit == "deg" ? "°" : unit};
}

std::string plain(double value, int digits) {
  if (!std::isfinite(value)) return "–";
  const std::string text = fmt::format("{:.{}g}", value, digits);
  return text[0] == '-' ? "−" + text.substr(1) : text;
}

std::string with_unit(double value, const std::string& unit, int digits) {
  return plain(value, digits) + (unit.empty() ? "" : unit == "°" ? unit : "\u00a0" + unit);
}

std::string millimetres(double value_m, double sigma_m) {
  const double value = 1000 * value_m, sigma = 1000 * sigma_m;
  if (!std::isfinite(value)) return "–";
  if (!(sigma > 0)) return plain(value, 4) + "\u00a0mm";
  const int decimals = std::clamp(1 - static_cast<int>(std::floor(std::log10(sigma))), 0, 6);
  return fmt::format("{:.{}f} ± {:.{}f}\u00a0mm", value, decimals, sigma, decimals);
}

std::string place_text(const std::vector<std::pair<std::string, double>>& at) {
  std::string text;
  for (std::size_t i = 0; i < at.size(); ++i) {
    const Quantity q = quantity_of(at[i].first);
    text += fmt::format("{}{} {}",
                        i == 0               ? ""
                        : i + 1 == at.size() ? " and "
                                             : ", ",
                        q.name, with_unit(at[i].second, q.unit));
  }
  return text;
}

std::string core_time(double seconds) {
  if (!(seconds >= 120)) return fmt::format("{:.3g} core-seconds", seconds);
  if (seconds < 7200) return fmt::format("{:.3g} core-minutes", seconds / 60);
  return fmt::format("{:.3g} core-hours", seconds / 3600);
}

std::string counted(std::size_t count, const std::string& what) {
  return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

double quantile(std::vector<double> values, double q) {
  std::erase_if(values, [](double v) { return !std::isfinite(v); });
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::sort(values.begin(), values.end());
  const double at =
      std::clamp(q * static_cast<double>(values.size()) - 0.5, 0.0, static_cast<double>(values.size() - 1));
  return values[static_cast<std::size_t>(std::lround(at))];
}

}  // namespace drumsweep

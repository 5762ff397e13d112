/// Numbers and names as a reader wants them.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace drumsweep {

/// "opening_angle_deg" -> {"opening angle", "°"}.
struct Quantity {
  std::string name, unit;
};
Quantity quantity_of(const std::string& column);

/// So many significant digits, without zeros at the end, with a real minus sign; "–" where there is none.
std::string plain(double value, int digits = 4);
/// "0.048 m", "3°".
std::string with_unit(double value, const std::string& unit, int digits = 4);
/// Lengths of metres in millimetres with their error: "6.20 ± 0.41 mm". Digits follow the error.
std::string millimetres(double value_m, double sigma_m);
/// "opening angle 0.2°, base width 0.048 m".
std::string place_text(const std::vector<std::pair<std::string, double>>& at);
/// "3.2 core-hours", "45 s".
std::string core_time(double seconds);
/// "1 design", "3 designs".
std::string counted(std::size_t count, const std::string& what);
/// q-quantile of the finite values, nearest rank; NaN without any.
double quantile(std::vector<double> values, double q);

}  // namespace drumsweep

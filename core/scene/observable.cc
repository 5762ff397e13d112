#include "core/scene/observable.h"

#include <fmt/format.h>

namespace drumsweep {

std::string observables_csv(const std::vector<Observable>& list) {
  const auto number = [](double v) { return std::isnan(v) ? std::string() : fmt::format("{}", v); };
  std::string out = "name,position,position_unit,value,sigma,unit\n";
  for (const Observable& o : list)
    out += fmt::format("{},{},{},{},{},{}\n", o.name, number(o.position), std::isnan(o.position) ? "" : o.position_unit,
                       number(o.value), number(o.sigma), o.unit);
  return out;
}

Estimate estimate(const std::vector<double>& samples) {
  Estimate out;
  const auto num = static_cast<double>(samples.size());
  for (const double s : samples) out.mean += s / num;
  if (samples.size() < 2) return out;
  double squares = 0;
  for (const double s : samples) squares += (s - out.mean) * (s - out.mean);
  out.sigma = std::sqrt(squares / (num - 1) / num);
  return out;
}

Estimate block_estimate(const std::vector<double>& series, std::size_t num_blocks) {
  std::vector<double> blocks;
  const std::size_t length = series.size() / num_blocks;
  if (length == 0) return estimate(series);
  // What does not fill a block is left out at the beginning.
  const std::size_t first = series.size() - length * num_blocks;
  for (std::size_t b = 0; b < num_blocks; ++b) {
    double sum = 0;
    for (std::size_t i = 0; i < length; ++i) sum += series[first + b * length + i];
    blocks.push_back(sum / static_cast<double>(length));
  }
  return estimate(blocks);
}

}  // namespace drumsweep

#include "sweep/fit/box.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/config/schema.h"
#include "core/geometry/random.h"
#include "sweep/plan/designs.h"

namespace drumsweep {
namespace {

/// Whole steps that fit between the ends; one that ends within rounding of `high` counts.
double whole_steps(const DesignAxis& axis) { return std::floor((axis.high - axis.low) / axis.resolution + 1e-9); }

double quantised(const DesignAxis& axis, double value) {
  const double k = std::clamp(std::round((value - axis.low) / axis.resolution), 0.0, whole_steps(axis));
  const double on_step = rounded(axis.low + k * axis.resolution);
  // The end itself is allowed although no whole number of steps may lead there.
  const bool end_is_nearer = std::abs(axis.high - value) < std::abs(on_step - value);
  return std::clamp(end_is_nearer ? rounded(axis.high) : on_step, axis.low, axis.high);
}

}  // namespace

void check_box(const Box& box) {
  if (box.empty()) throw InputError("a search needs at least one design variable");
  for (const DesignAxis& axis : box) {
    const bool finite = std::isfinite(axis.low) && std::isfinite(axis.high) && std::isfinite(axis.resolution);
    if (!finite || !(axis.low < axis.high) || !(axis.resolution > 0))
      throw InputError(fmt::format("{}: from {} to {} in steps of {}; accepted: from < to, step > 0", axis.key,
                                   axis.low, axis.high, axis.resolution));
  }
}

Point quantised(const Box& box, const Point& point) {
  Point out;
  for (std::size_t i = 0; i < box.size(); ++i) out.push_back(quantised(box[i], point[i]));
  return out;
}

std::vector<double> lattice_values(const DesignAxis& axis) {
  std::vector<double> out;
  for (double k = 0; k <= whole_steps(axis); ++k) out.push_back(quantised(axis, axis.low + k * axis.resolution));
  if (const double end = std::min(rounded(axis.high), axis.high); end > out.back()) out.push_back(end);
  return out;
}

std::size_t lattice_size(const Box& box, std::size_t limit) {
  double size = 1;
  for (const DesignAxis& axis : box) {
    const double last = rounded(axis.low + whole_steps(axis) * axis.resolution);
    size *= whole_steps(axis) + (rounded(axis.high) > last ? 2 : 1);
  }
  return size < static_cast<double>(limit) ? static_cast<std::size_t>(size) : limit;
}

std::vector<Point> whole_lattice(const Box& box) {
  std::vector<Point> points(1);
  for (const DesignAxis& axis : box) {
    std::vector<Point> longer;
    for (const Point& point : points)
      for (const double value : lattice_values(axis)) {
        longer.push_back(point);
        longer.back().push_back(value);
      }
    points = std::move(longer);
  }
  return points;
}

Point to_unit(const Box& box, const Point& point) {
  Point unit;
  for (std::size_t i = 0; i < box.size(); ++i) unit.push_back((point[i] - box[i].low) / (box[i].high - box[i].low));
  return unit;
}

Point from_unit(const Box& box, const Point& unit) {
  Point point;
  for (std::size_t i = 0; i < box.size(); ++i)
    point.push_back(std::clamp(box[i].low + unit[i] * (box[i].high - box[i].low), box[i].low, box[i].high));
  return point;
}

Point low_discrepancy(std::size_t num_axes, std::int64_t seed, std::uint64_t i) {
  // The root of g^(d+1) = g + 1 by its contraction; d = 1 gives the golden ratio.
  double g = 2;
  for (int k = 0; k < 60; ++k) g = std::pow(1 + g, 1 / (static_cast<double>(num_axes) + 1));
  Point unit;
  for (std::size_t axis = 0; axis < num_axes; ++axis) {
    const double shift = uniform4(seed, Purpose::space_filling, axis)[0];
    const double at = shift + static_cast<double>(i) * std::pow(g, -static_cast<double>(axis + 1));
    unit.push_back(at - std::floor(at));
  }
  return unit;
}

std::vector<Point> space_filling(const Box& box, std::size_t count, std::int64_t seed) {
  check_box(box);
  if (lattice_size(box, count + 1) <= count) return whole_lattice(box);
  std::vector<Point> points;
  std::set<Point> seen;
  // On a lattice hardly larger than the set the sequence meets known points again and again; the rest is taken in order.
  const std::uint64_t patience = 100 * count + 1000;
  for (std::uint64_t i = 0; i < patience && points.size() < count; ++i) {
    const Point point = quantised(box, from_unit(box, low_discrepancy(box.size(), seed, i)));
    if (seen.insert(point).second) points.push_back(point);
  }
  if (points.size() == count) return points;
  for (const Point& point : whole_lattice(box))
    if (points.size() < count && seen.insert(point).second) points.push_back(point);
  return points;
}

}  // namespace drumsweep

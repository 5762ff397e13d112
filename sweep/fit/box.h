/// The box of design variables that a search may use, and points on its lattice.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace drumsweep {

/// One design variable in the unit of its key; low < high, resolution > 0.
struct DesignAxis {
  std::string key;
  double low = 0, high = 1;
  double resolution = 0.01;  ///< values are low + k * resolution, and high itself
};

using Box = std::vector<DesignAxis>;
using Point = std::vector<double>;  ///< (num_axes) [units of the axes]

/// @throws InputError naming the axis when low, high and resolution are not finite with low < high, resolution > 0;
/// or when there is no axis.
void check_box(const Box& box);

/// The nearest lattice point inside [low, high], as rounded() (see sweep/plan/designs.h); never outside, not by a bit.
/// @pre finite coordinates.
Point quantised(const Box& box, const Point& point);

/// All values of one axis, ascending. @pre fewer than 1e6
std::vector<double> lattice_values(const DesignAxis& axis);

/// Number of lattice points, at most `limit`.
std::size_t lattice_size(const Box& box, std::size_t limit);

/// Every lattice point, first axis slowest. @pre few enough to hold
std::vector<Point> whole_lattice(const Box& box);

/// To and from [0, 1] a variable.
Point to_unit(const Box& box, const Point& point);
Point from_unit(const Box& box, const Point& unit);

/// i-th point of a low-discrepancy sequence in the unit cube: the additive recurrence of the generalised golden ratio
/// (Roberts 2018, "The unreasonable effectiveness of quasirandom sequences"), rotated at random by the seed. Unlike
/// Sobol it needs no direction numbers and has no preferred counts.
Point low_discrepancy(std::size_t num_axes, std::int64_t seed, std::uint64_t i);

/// `count` distinct lattice points spread evenly; all of them where the lattice has no more. A longer set begins with
/// the shorter one.
std::vector<Point> space_filling(const Box& box, std::size_t count, std::int64_t seed);

}  // namespace drumsweep

/// Interpolation and level lines of samples on a rectangular grid, the geometry behind contour_figure.h. Bilinear
/// between neighbouring samples and nothing else: no smoothing that would invent structure, no colour where nothing was
/// sampled.
#pragma once

#include <span>
#include <vector>

namespace drumsweep {

struct PlanePoint {
  double x = 0.0, y = 0.0;
};

/// A finite value at a place.
struct PlaneSample {
  PlanePoint at;
  double value = 0.0;
};

/// Samples sorted into a grid; lines of the grid may be unevenly spaced, and nodes may be missing (NaN).
struct GridSurface {
  std::vector<double> x, y;   ///< ascending
  std::vector<double> value;  ///< (num_y x num_x), x fastest

  /// Bilinear in cells with four samples, linear in the corner of cells with three, NaN elsewhere.
  double at(double at_x, double at_y) const;
  /// Mean area of a cell; the measure of how fine a stage is.
  double cell_area() const;
  /// Whether any cell can be interpolated.
  bool has_area() const;
};

/// Sorted distinct values; values closer than 1e-9 of the range are the same.
std::vector<double> distinct_values(std::vector<double> values);
/// Position in distinct_values() of the one nearest to value.
std::size_t nearest_index(std::span<const double> sorted, double value);

/// The first sample wins where two share a node.
GridSurface grid_surface(std::span<const PlaneSample> samples);

/// Surfaces laid over each other on size x size evenly spaced nodes of their common bounding box.
struct Raster {
  int size = 0;
  PlanePoint low, high;
  std::vector<double> value;  ///< (size x size), x fastest; NaN where no surface is
  std::vector<int> owner;     ///< the surface the value is from, -1 for none

  double x(double column) const { return low.x + (high.x - low.x) * column / (size - 1); }
  double y(double row) const { return low.y + (high.y - low.y) * row / (size - 1); }
};

/// @param surfaces  later ones cover earlier ones; those without area are ignored
/// @pre at least one has area
Raster rasterize(std::span<const GridSurface> surfaces, int size);

/// Where the raster crosses the level, by marching squares, as connected lines; closed ones repeat their first point.
/// Lines end where one surface meets the next, as the value jumps there.
std::vector<std::vector<PlanePoint>> level_lines(const Raster& raster, double level);

}  // namespace drumsweep

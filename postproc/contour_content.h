/// All that a contour figure shows, as numbers: what contour_figure.h draws and tests can judge. f in mm.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "postproc/contour.h"
#include "postproc/contour_lines.h"
#include "postproc/plane_geometry.h"

namespace drumsweep {

/// One design that has a value.
struct ContourDesign {
  PlanePoint at;  ///< y is 0 on a curve
  double f_mm = 0.0, sigma_mm = 0.0;
  bool trusted = true;
};

struct ContourStage {
  std::string name;
  std::vector<ContourDesign> designs;
  GridSurface surface;  ///< NaN where a design failed
};

struct ContourContent {
  std::vector<ContourStage> stages;   ///< coarse first, those without a map last
  std::vector<PlanePoint> failed;     ///< in the slice, without a value
  std::vector<PlanePoint> elsewhere;  ///< projections of designs that lie outside the slice
  std::optional<ContourDesign> best;  ///< the lowest trusted one
  double low_mm = 0.0, high_mm = 0.0;
  PlanePoint low, high;  ///< bounding box of designs and hull
  Polygon hull;          ///< of all designs, cut by the slice: nothing is coloured outside

  /// Maps. Colours: the fit where there is one to trust, else between neighbours of a grid. None in the cell of a failed
  /// design, which is all that lies nearer to it than to any other.
  Raster raster;  ///< size 0: nothing to colour
  bool fit_is_drawn = false, interpolation_is_drawn = false;
  std::vector<std::vector<PlanePoint>> hatching;  ///< over what failed designs leave blank

  /// Curves.
  struct CurvePoint {
    double x, f_mm, sigma_mm;
  };
  std::vector<std::vector<CurvePoint>> fit_curve;        ///< pieces
  std::vector<std::pair<double, double>> failed_ranges;  ///< of x

  Polygon region;  ///< holds the optimum with 95 %, projected; two corners: a line
};

/// @throws InputError when no design has a value.
ContourContent contour_content(const ResultTable& table, const ContourOptions& options, const ContourAxes& axes);

/// f of the figure in m; NaN for a design without a value.
double figure_value(const ResultRow& row, const ContourOptions& options);

}  // namespace drumsweep

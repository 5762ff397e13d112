/// Figures of the proof: lines and points over one axis, as PNG, with their numbers beside them as CSV.
#pragma once

#include <string>
#include <vector>

namespace drumsweep {

struct Curve {
  std::string name;  ///< its line in the key
  std::vector<double> x, y;
  std::vector<double> sigma;  ///< error bars of points, or empty
  bool points = false;        ///< else a line
};

struct LineFigure {
  std::string title, x_label, y_label;
  std::vector<Curve> curves;
  bool log_log = false;
  bool equal_scales = false;  ///< a metre is as long on both axes
};

/// Writes NAME.csv ("curve,x,y,sigma") and draws NAME.png into a folder with gnuplot.
/// @return empty, or why there is no picture (gnuplot is missing): the numbers are written all the same
std::string write_figure(const LineFigure& figure, const std::string& folder, const std::string& name);

}  // namespace drumsweep

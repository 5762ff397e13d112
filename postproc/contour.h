/// Contour plots of a campaign (S1, Figs. 6 and 7): tables and a figure of f over two design variables.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

#include "postproc/result_table.h"

namespace drumsweep {

struct ContourOptions {
  std::string title;       ///< the study's name
  std::string x_variable;  ///< empty: the first two variables that vary
  std::string y_variable;
  std::string stage;          ///< empty: all stages
  std::string value = "f_m";  ///< or "f_footprint_m"; what the figure and the matrix show
  double tolerance_m = 0.01;  ///< drawn as a bold line: S1's tolerance
  bool matrix = false;        ///< write_contour() to .csv: a matrix instead of the long table
};

/// Positions of the two variables in the table. y is there unless the table has a single variable; it may be constant.
struct ContourAxes {
  std::size_t x = 0;
  std::optional<std::size_t> y;
  bool plane = false;  ///< x and y both vary: a map. Otherwise f is drawn over x.
};

/// @throws InputError naming the variables when none exists, a given one is not there, or more than two vary.
ContourAxes contour_axes(const ResultTable& table, const ContourOptions& options);

/// Long table: stage, x, y, f_m, sigma_f_m, f_footprint_m, state; stages, then x, then y ascending. The columns of the
/// variables have their names. y is left out when the table has a single variable.
std::string contour_csv(const ResultTable& table, const ContourOptions& options);

/// Matrix of one stage that is a full grid (options.stage, or the only one): first row x, first column y; designs
/// without a value are empty cells. @throws InputError when a combination was not part of the stage.
std::string contour_matrix_csv(const ResultTable& table, const ContourOptions& options);

/// "opening_angle_deg" -> "opening angle (deg)", "outlet.base_width_m" -> "base width (m)".
std::string axis_label(const std::string& variable_name);

/// A design that several stages share stands in the table once, under the first of them. This gives each grid stage its
/// shared nodes back, as rows of its own, so that its matrix and its map have no holes.
ResultTable with_shared_designs(const ResultTable& table, const ContourOptions& options);

/// Writes what the ending of the path asks for: .csv, .gp (with .dat beside it), .png, .svg. A file appears whole or
/// not at all. @throws InputError for another ending or a table that cannot be drawn, std::runtime_error when gnuplot
/// fails.
void write_contour(const ResultTable& table, const ContourOptions& options, const std::filesystem::path& path);

}  // namespace drumsweep

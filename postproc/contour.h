/// Contour plots of a campaign (S1, Figs. 8 and 9): tables and a figure of f over two design variables.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "postproc/gnuplot.h"
#include "postproc/result_table.h"

namespace drumsweep {

/// What a fit says about f, from whoever has one ; lengths of f in m.
struct ContourFit {
  /// False: it is not to be trusted. Then nothing of it is drawn, and `verdict` is on the figure.
  bool usable = false;
  std::string verdict;  ///< one sentence
  /// Designs it was fitted to, and all that have a value: of large sweeps only some, spread evenly, are fitted.
  std::size_t num_fitted = 0, num_designs = 0;

  /// Mesh in the plane; y is one value where f is drawn over x alone.
  std::vector<double> x, y;
  std::vector<double> value_m;  ///< (num_y x num_x), x fastest; NaN where it knows nothing
  std::vector<double> sigma_m;  ///< its standard error, over x alone; empty for a plane

  /// The lowest point of the fit over all variables.
  struct Optimum {
    std::vector<std::string> variables;  ///< names as in the table
    std::vector<double> at, low, high;   ///< (num_variables) with the range that holds it with 95 %
    double f_m = 0, sigma_m = 0;
    std::vector<std::vector<double>> draws;  ///< where it may be instead: draws of its place, (num_variables) each
  };
  std::optional<Optimum> optimum;
};

struct ContourOptions {
  std::string title;       ///< the study's name
  std::string x_variable;  ///< empty: the first two variables that vary
  std::string y_variable;
  std::vector<std::pair<std::string, double>> slice{};  ///< other variables and the values at which to look
  std::string stage;                                    ///< empty: all stages
  std::string value = "f_m";                            ///< or "f_footprint_m"; what the figure and the matrix show
  double tolerance_m = 0.01;                            ///< drawn as a bold line: S1's tolerance
  bool matrix = false;                                  ///< write_contour() to .csv: a matrix instead of the long table
  std::optional<ContourFit> fit{};                      ///< none: designs and what lies between neighbours of a grid
};

/// Positions of the two variables in the table. y is there unless the table has a single variable; it may be constant.
struct ContourAxes {
  std::size_t x = 0;
  std::optional<std::size_t> y;
  bool plane = false;         ///< x and y both vary: a map. Otherwise f is drawn over x.
  std::vector<double> fixed;  ///< (num_variables) where the others are held; NaN for x and y, or if the table has none
};

/// @throws InputError naming the variables with their values when none exists, a given one is not there, a slice lies
/// outside, or more than two vary that no slice holds.
ContourAxes contour_axes(const ResultTable& table, const ContourOptions& options);

/// Whether a row lies in the slice and the stage that are asked for.
bool is_chosen(const ResultRow& row, const ContourOptions& options, const ContourAxes& axes);

/// Long table: stage, x, y, f_m, sigma_f_m, f_footprint_m, state; stages, then x, then y ascending. The columns of the
/// variables have their names. y is left out when the table has a single variable.
std::string contour_csv(const ResultTable& table, const ContourOptions& options);

/// Matrix of one stage that is a full grid (options.stage, or the only one): first row x, first column y; designs
/// without a value are empty cells. @throws InputError when a combination was not part of the stage.
std::string contour_matrix_csv(const ResultTable& table, const ContourOptions& options);

/// "opening_angle_deg" -> "opening angle (deg)", "outlet.base_width_m" -> "base width (m)".
std::string axis_label(const std::string& variable_name);
/// "opening_angle_deg", 0.2 -> "opening angle 0.2 deg".
std::string value_text(const std::string& variable_name, double value);

/// A design that several stages share stands in the table once, under the first of them. This gives each grid stage its
/// shared nodes back, as rows of its own, so that its matrix and its map have no holes.
ResultTable with_shared_designs(const ResultTable& table, const ContourOptions& options);

/// Writes what the ending of the path asks for: .csv, .gp (with .dat beside it), .png, .svg. A file appears whole or
/// not at all. @throws InputError for another ending or a table that cannot be drawn, std::runtime_error when gnuplot
/// fails.
void write_contour(const ResultTable& table, const ContourOptions& options, const std::filesystem::path& path);

/// The figure as an element of an HTML page, for light and dark. @throws as write_contour()
std::string contour_for_page(const ResultTable& table, const ContourOptions& options, const PageFigure& page);

}  // namespace drumsweep

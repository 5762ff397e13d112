/// The figure of contour.h as a gnuplot script and its data.
#pragma once

#include <string>

#include "postproc/contour.h"
#include "postproc/result_table.h"

namespace drumsweep {

struct FigureSource {
  std::string script;  ///< reads the data and writes the picture, both from the folder it runs in
  std::string data;    ///< named blocks: map, samples, lines, ...; f in mm
};

/// Map of f between the designs of each stage (coarse stages first, finer over them), level lines with labels, a bold
/// line at the tolerance, the designs, the best one, and crosses where a design has no value. Nothing is coloured
/// outside the designs. With one varying variable: f with its error over that variable.
/// The picture is PNG or SVG by its ending. Deterministic.
/// @throws InputError when no design has a value.
FigureSource contour_figure(const ResultTable& table, const ContourOptions& options, const std::string& data_name,
                            const std::string& picture_name);

/// What the figure shows of a design [m]: NaN unless it is done or untrusted.
double figure_value(const ResultRow& row, const ContourOptions& options);

}  // namespace drumsweep

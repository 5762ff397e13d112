/// The figure of contour.h as a gnuplot script and its data.
#pragma once

#include <string>

#include "postproc/contour.h"
#include "postproc/gnuplot.h"
#include "postproc/result_table.h"

namespace drumsweep {

/// On paper, or transparent for a page.
enum class ContourGround { paper, page };

/// Map of f: the fit where there is one to trust, else what lies between neighbouring designs of each grid (coarse
/// stages first, finer over them). Level lines with labels, a bold line at the tolerance, the designs (filled with the
/// colour of what they measured), the best one, the optimum of the fit with its 95 % region; hatched where designs
/// failed, blank outside the designs. With one varying variable: f with its error over that variable, and the fit with
/// its 95 % band.
/// The picture is PNG or SVG by its ending. The data is one file of named blocks, f in mm. Deterministic.
/// @throws InputError when no design has a value.
FigureFiles contour_figure(const ResultTable& table, const ContourOptions& options, const std::string& data_name,
                           const std::string& picture_name, ContourGround ground = ContourGround::paper);

}  // namespace drumsweep

/// What all figures drawn by gnuplot share. A figure is a script and its data; the script reads the data and writes the
/// picture in the folder it runs in. Ink is black; a figure that goes into a page takes the page's colour for it.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace drumsweep {

/// How a figure goes into an HTML page (SVG only).
struct PageFigure {
  std::string id_prefix;  ///< before every id of the SVG, so that figures of one page do not mix
  std::string label;      ///< what a screen reader says
};

struct FigureFiles {
  std::string script;
  std::map<std::string, std::string> data;  ///< file name -> text
};

/// Runs the script beside its data in a folder of its own. @param picture  the file that the script writes
/// @return the picture. @throws std::runtime_error when gnuplot is missing, fails, or draws nothing
std::string draw(const FigureFiles& figure, const std::string& picture);

/// gnuplot's SVG as an element for a page: without XML declaration and fixed size (it scales with its box), no
/// background, black becomes the page's currentColor, generic font, ids with the prefix.
std::string for_page(const std::string& svg, const PageFigure& page);

/// "set terminal ... \n set output ..." for a picture whose ending is .svg or .png.
std::string terminal(const std::string& picture_name, int width, int height);
/// Font size that looks alike in both: SVG counts pixels, PNG points.
int font_size(const std::string& picture_name, int points);

/// Text in single quotes, on one line.
std::string single_quoted(const std::string& text);
/// No longer than `most` bytes and "…"; cut between characters of UTF-8.
std::string shortened(const std::string& text, std::size_t most);
/// Its words in lines of at most `most` bytes.
std::vector<std::string> wrapped(const std::string& text, std::size_t most);
/// The smallest of 1, 2, 2.5, 5 times a power of ten that is not below. @pre least > 0
double nice_step(double least);
/// Decimals that multiples of a nice step need.
int decimals_of(double step);
/// "11.6 ± 0.2": as many decimals as the error allows.
std::string with_error(double value, double sigma);
/// Range of an axis with room for symbols at its ends.
std::pair<double, double> padded(double low, double high);
/// "set palette": viridis mixed with 45 % white: even steps of brightness, so it reads in grey, and black lines are
/// legible on all of it.
extern const char* const pale_viridis;

}  // namespace drumsweep

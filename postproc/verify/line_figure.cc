#include "postproc/verify/line_figure.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>

#include "core/io/durable_file.h"
#include "postproc/child_process.h"

namespace drumsweep {
namespace {

constexpr std::array<const char*, 6> colours = {"#31688e", "#d1495b", "#35b779", "#440154", "#b8a000", "#606060"};
constexpr std::array<int, 6> symbols = {7, 5, 9, 13, 11, 6};

std::string quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("''") : std::string(1, c);
  return out + "'";
}

}  // namespace

std::string write_figure(const LineFigure& figure, const std::string& folder, const std::string& name) {
  std::string csv = "curve,x,y,sigma\n", data, plot;
  for (std::size_t c = 0; c < figure.curves.size(); ++c) {
    const Curve& curve = figure.curves[c];
    for (std::size_t i = 0; i < curve.x.size(); ++i) {
      const double sigma = i < curve.sigma.size() ? curve.sigma[i] : std::nan("");
      csv += fmt::format("\"{}\",{},{},{}\n", curve.name, curve.x[i], curve.y[i],
                         std::isnan(sigma) ? "" : fmt::format("{}", sigma));
      data += fmt::format("{} {} {}\n", curve.x[i], curve.y[i], std::isnan(sigma) ? 0.0 : sigma);
    }
    data += "\n\n";
    plot += plot.empty() ? "plot " : ", \\\n     ";
    const char* colour = colours[c % colours.size()];
    plot += fmt::format("'figure.dat' index {} ", c);
    plot += curve.points ? fmt::format("using 1:2:3 with yerrorbars pt {} ps 1.2 lw 1.6 lc rgb '{}'",
                                       symbols[c % symbols.size()], colour)
                         : fmt::format("using 1:2 with lines lw 2 dt {} lc rgb '{}'", 1 + c % 4, colour);
    plot += " title " + quoted(curve.name);
  }
  write_durably(std::filesystem::path(folder) / (name + ".csv"), csv);

  std::string script =
      "set encoding utf8\n"
      "set terminal pngcairo size 900,640 font 'DejaVu Sans,11' noenhanced background 'white'\n"
      "set output 'figure.png'\n"
      "set tics out nomirror\nset border 3 lw 1.2\nset grid lt 1 lc rgb '#dcdcdc' lw 0.8\n"
      "set key outside bottom center horizontal Left reverse maxcols 2 samplen 2\n";
  script += fmt::format("set title {}\nset xlabel {}\nset ylabel {}\n", quoted(figure.title), quoted(figure.x_label),
                        quoted(figure.y_label));
  if (figure.log_log) {
    // Axes end where the data end, not at powers of ten; tics at 1, 2 and 5.
    const auto range = [&](const char* axis, std::vector<double> Curve::*values) {
      double low = std::numeric_limits<double>::infinity(), high = 0;
      for (const Curve& curve : figure.curves)
        for (const double v : curve.*values)
          if (v > 0) {
            low = std::min(low, v);
            high = std::max(high, v);
          }
      std::string tics;
      for (int power = -6; power <= 6; ++power)
        for (const int digit : {1, 2, 5})
          tics += fmt::format("{}{:g}", tics.empty() ? "" : ",", digit * std::pow(10.0, power));
      return fmt::format("set {0}range [{1:g}:{2:g}]\nset {0}tics ({3})\n", axis, 0.9 * low, 1.1 * high, tics);
    };
    script += "set logscale xy\n" + range("x", &Curve::x) + range("y", &Curve::y);
  }
  if (figure.equal_scales) script += "set size ratio -1\n";
  try {
    const ScratchFolder scratch;
    write_durably(scratch.path / "figure.dat", data);
    write_durably(scratch.path / "figure.gp", script + plot + "\n");
    run_program(scratch.path, {"gnuplot", "-d", "figure.gp"}, "install gnuplot; the numbers are in the CSV file");
    write_durably(std::filesystem::path(folder) / (name + ".png"), read_whole_file(scratch.path / "figure.png"));
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return {};
}

}  // namespace drumsweep

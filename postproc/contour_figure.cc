#include "postproc/contour_figure.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "core/config/schema.h"
#include "postproc/contour_content.h"
#include "postproc/contour_lines.h"
#include "postproc/level_labels.h"

namespace drumsweep {
namespace {

// Layout [pixels]. Fixed, so that labels can be placed here and not by luck.
constexpr double width = 1000, plot_height = 546, below = 176, title_height = 54, line_height = 23;
constexpr double left = 0.095, right_of_map = 0.845, right_of_curve = 0.96;
constexpr std::size_t line_length = 112;  ///< characters of a line between title and plot
/// More designs than this are small dots; fewer are filled with the colour of what they measured.
constexpr std::size_t most_filled = 130;
/// Black that stays black where the ground is coloured; plain black is the page's ink.
constexpr const char* on_map = "#101010";

/// Levels for lines and colour scale, strictly inside (low, high).
struct Levels {
  std::vector<double> values;
  bool logarithmic = false;
};

Levels choose_levels(double low, double high, double tolerance) {
  Levels levels;
  if (!(high - low > 1e-9 * std::abs(high))) return levels;
  double step = 0.0;
  // A range of 1 to 8 and more hides its valley on a linear scale.
  levels.logarithmic = low > 0.0 && high > 8.0 * low;
  if (levels.logarithmic) {
    std::vector<double> mantissas = {1, 1.5, 2, 3, 5, 7};
    if (high > 30.0 * low) mantissas = {1, 2, 5};
    if (high > 1e4 * low) mantissas = {1};
    for (double decade = std::pow(10.0, std::floor(std::log10(low))); decade < high; decade *= 10.0)
      for (double mantissa : mantissas)
        if (mantissa * decade > low && mantissa * decade < high) levels.values.push_back(mantissa * decade);
  } else {
    step = nice_step((high - low) / 8.0);
    for (double k = std::floor(low / step); k * step < high; k += 1.0)
      if (k * step > low) levels.values.push_back(k * step);
  }
  // The tolerance has its own bold line; a thin one right beside it would only blur it.
  std::erase_if(levels.values, [&](double level) {
    return std::abs(level - tolerance) < (levels.logarithmic ? 0.12 * tolerance : 0.3 * step);
  });
  return levels;
}

/// Named block of the data file; blocks are two empty lines apart.
void begin_block(std::string& data, const std::string& name) {
  if (!data.empty()) data += "\n\n";
  data += "# " + name + "\n";
}

void add_lines(std::string& data, const std::vector<std::vector<PlanePoint>>& lines) {
  for (std::size_t k = 0; k < lines.size(); ++k) {
    if (k > 0) data += '\n';
    for (const PlanePoint& point : lines[k]) data += fmt::format("{:.7g} {:.7g}\n", point.x, point.y);
  }
}

/// Symbols of the stages: gnuplot's point types, filled and open.
struct Symbol {
  int filled, open;
};
constexpr std::array<Symbol, 5> stage_symbols = {{{7, 6}, {5, 4}, {9, 8}, {11, 10}, {15, 14}}};

/// The parts that map and curve share.
class Script {
 public:
  Script(const ContourOptions& options, const std::string& data_name, const std::string& picture_name,
         const std::vector<std::string>& notes, double right, ContourGround ground)
      : data_name_(single_quoted(data_name)) {
    std::vector<std::string> lines;
    for (const std::string& note : notes)
      for (std::string& line : wrapped(note, line_length)) lines.push_back(std::move(line));
    const double head = title_height + line_height * static_cast<double>(lines.size()) + 12;
    const double height = std::round(head + plot_height + below);
    bottom = below / height;
    top = 1 - head / height;
    const double centre = 0.5 * (left + right);
    std::string first = terminal(picture_name, static_cast<int>(width), static_cast<int>(height));
    if (ground == ContourGround::page) first.replace(first.find(" background 'white'"), 19, "");
    text = fmt::format(
        "# f over the design variables, f in mm\n# Run gnuplot in this folder; reads {}, writes {}.\n{}"
        "set label 1 {} at screen {:.4f},{:.4f} center font ',{}'\n"
        "set lmargin at screen {}\nset rmargin at screen {}\nset bmargin at screen {:.5f}\nset tmargin at screen "
        "{:.5f}\n"
        "set tics out nomirror\n"
        "set border 3 lw 1.2\n"
        "set key at screen {:.4f},{:.4f} top center horizontal Left reverse maxrows 3 samplen 2 width 2\n",
        data_name_, single_quoted(picture_name), first, single_quoted(shortened(options.title, 90)), centre,
        1 - 0.55 * title_height / height, font_size(picture_name, 13), left, right, bottom, top, centre,
        (below - 76) / height);
    for (std::size_t k = 0; k < lines.size(); ++k)
      text += fmt::format("set label {} {} at screen {:.4f},{:.4f} center\n", k + 2, single_quoted(lines[k]), centre,
                          1 - (title_height + line_height * (static_cast<double>(k) + 0.25)) / height);
  }

  /// Range, evenly spaced tics with the same number of decimals, and label of axis "x" or "y".
  void axis(const std::string& name, std::pair<double, double> range, const std::string& label) {
    const double step = nice_step((range.second - range.first) / 9.0);
    const int decimals = decimals_of(step);
    text += fmt::format("set {0}range [{1:.9g}:{2:.9g}]\nset {0}tics {3:.9g}\nset format {0} '%.{4}f'\n", name,
                        range.first, range.second, step, decimals);
    text += fmt::format("set {}label {}\n", name, single_quoted(label));
  }

  /// One thing to draw: a block of the data file, how, and its line in the key (empty for none).
  void draw(const std::string& block, const std::string& how, const std::string& key = "") {
    plot_ += plot_.empty() ? "plot " : ", \\\n     ";
    plot_ += fmt::format("{} index '{}' {} {}", data_name_, block, how,
                         key.empty() ? "notitle" : "title " + single_quoted(key));
  }
  /// The same for an expression.
  void draw_expression(const std::string& expression, const std::string& how, const std::string& key) {
    plot_ += plot_.empty() ? "plot " : ", \\\n     ";
    plot_ += fmt::format("{} {} title {}", expression, how, single_quoted(key));
  }
  /// Only a line of the key.
  void key(const std::string& how, const std::string& words) {
    plot_ += plot_.empty() ? "plot " : ", \\\n     ";
    plot_ += fmt::format("keyentry {} title {}", how, single_quoted(words));
  }
  std::string finished() const { return text + plot_ + "\n"; }

  std::string text;
  double bottom = 0, top = 1;  ///< of the plot, shares of the canvas

 private:
  std::string data_name_;
  std::string plot_;
};

std::string value_label(const ContourOptions& options) {
  return options.value == "f_footprint_m" ? "unevenness f under the outlet (mm)" : "unevenness f (mm)";
}

const ContourFit* usable_fit(const ContourOptions& options) {
  return options.fit && options.fit->usable ? &*options.fit : nullptr;
}

std::vector<std::string> optimum_texts(const ContourFit::Optimum& optimum) {
  std::string where, range;
  for (std::size_t k = 0; k < optimum.variables.size(); ++k) {
    const std::string& name = optimum.variables[k];
    // "base width (m)" -> "base width 0.035 to 0.041 m"
    const std::string label = axis_label(name);
    const std::size_t unit = label.rfind(" (");
    where += fmt::format("{}{}", k == 0 ? "" : ", ", value_text(name, optimum.at[k]));
    range += fmt::format("{}{} {:.3g} to {:.3g}", k == 0 ? "" : ", ", label.substr(0, unit), optimum.low[k],
                         optimum.high[k]);
    if (unit != std::string::npos) range += " " + label.substr(unit + 2, label.size() - unit - 3);
  }
  return {
      fmt::format("optimum of the fit: f = {} mm at {}", with_error(1e3 * optimum.f_m, 1e3 * optimum.sigma_m), where),
      fmt::format("with 95 % each: {}", range)};
}

/// What stands between title and plot.
std::vector<std::string> notes_of(const ResultTable& table, const ContourOptions& options, const ContourAxes& axes,
                                  const ContourContent& content) {
  std::vector<std::string> notes;
  const ContourFit* fit = usable_fit(options);
  if (fit != nullptr && fit->optimum) notes = optimum_texts(*fit->optimum);
  if (const auto& best = content.best) {
    std::string where = value_text(table.variable_names[axes.x], best->at.x);
    if (axes.plane) where += ", " + value_text(table.variable_names[*axes.y], best->at.y);
    notes.push_back(fmt::format("best design: f = {} mm at {}", with_error(best->f_mm, best->sigma_mm), where));
  }
  if (!content.elsewhere.empty()) {
    std::string held;
    for (std::size_t v = 0; v < axes.fixed.size(); ++v)
      if (std::isfinite(axes.fixed[v]))
        held += (held.empty() ? "" : ", ") + value_text(table.variable_names[v], axes.fixed[v]);
    std::size_t here = content.failed.size();
    for (const ContourStage& stage : content.stages) here += stage.designs.size();
    const bool projected = fit != nullptr && fit->optimum && axes.plane;
    notes.push_back(fmt::format("slice at {}: {} of {} designs lie in it{}", held, here,
                                here + content.elsewhere.size(),
                                projected ? "; the optimum and its region are projected" : ""));
  }
  if (options.fit && fit == nullptr) {
    notes.push_back(fmt::format("no fit is drawn, as none is to be trusted: {}", options.fit->verdict));
  } else if (fit != nullptr && content.fit_is_drawn && fit->num_fitted < fit->num_designs) {
    notes.push_back(fmt::format("the fit is of {} of {} designs: those with the lowest f and others spread evenly",
                                fit->num_fitted, fit->num_designs));
  }
  if (content.interpolation_is_drawn)
    notes.push_back(content.fit_is_drawn ? "outside the ranges of the fit: linear between neighbouring designs"
                                         : "map: linear between neighbouring designs");
  const double tolerance_mm = 1e3 * options.tolerance_m;
  if (content.low_mm > tolerance_mm)
    notes.push_back(fmt::format("f is above the tolerance of {:.4g} mm everywhere", tolerance_mm));
  return notes;
}

/// Marks on top of map or curve that need a word of their own.
void draw_designs_that_matter(Script& script, std::string& data, const ContourContent& content, bool plane,
                              double y_of_failed) {
  std::string untrusted, failed;
  const auto y = [&](const ContourDesign& design) { return plane ? design.at.y : design.f_mm; };
  for (const ContourStage& stage : content.stages)
    for (const ContourDesign& design : stage.designs)
      if (!design.trusted) untrusted += fmt::format("{:.9g} {:.9g}\n", design.at.x, y(design));
  for (const PlanePoint& point : content.failed)
    failed += fmt::format("{:.9g} {:.9g}\n", point.x, plane ? point.y : y_of_failed);
  if (!untrusted.empty()) {
    begin_block(data, "untrusted");
    data += untrusted;
    script.draw("untrusted", fmt::format("using 1:2 with points pt 7 ps 2.3 lc rgb 'white'"));
    script.draw("untrusted", fmt::format("using 1:2 with points pt 6 ps 2.3 lw 1.5 lc rgb '{}'", on_map));
    script.key("with points pt 6 ps 1.8 lw 1.5 lc rgb 'black'", "untrusted (?)");
    script.draw("untrusted", fmt::format("using 1:2:('?') with labels center font ',11' tc rgb '{}'", on_map));
  }
  if (!failed.empty()) {
    begin_block(data, "failed");
    data += failed;
    const bool many = content.failed.size() > 40;
    script.draw("failed",
                fmt::format("using 1:2 with points pt 2 {} lc rgb 'black'", many ? "ps 0.5 lw 1.2" : "ps 1.2 lw 2.2"),
                fmt::format("no result, hatched ({})", content.failed.size()));
  }
  if (content.best) {
    begin_block(data, "best");
    data += fmt::format("{:.9g} {:.9g}\n", content.best->at.x, y(*content.best));
    script.draw("best", "using 1:2 with points pt 13 ps 2.4 lc rgb 'white'");
    script.draw("best", fmt::format("using 1:2 with points pt 12 ps 2.4 lw 2 lc rgb '{}'", on_map));
    script.key("with points pt 12 ps 1.7 lw 2 lc rgb 'black'", "best design");
  }
}

/// Level lines, bold one first as it has the first choice of places for its labels.
void draw_levels(Script& script, std::string& data, const ContourContent& content, const Levels& levels,
                 const PixelFrame& frame, double tolerance_mm, bool tolerance_crossed, int label_size) {
  std::vector<PlanePoint> symbols;
  for (const ContourStage& stage : content.stages)
    for (const ContourDesign& design : stage.designs) symbols.push_back(frame.pixels(design.at));
  for (const PlanePoint& failed : content.failed) symbols.push_back(frame.pixels(failed));
  // The edge of the region, in steps closer than a label is long.
  for (std::size_t k = 0; k < content.region.size(); ++k) {
    const PlanePoint from = frame.pixels(content.region[k]);
    const PlanePoint to = frame.pixels(content.region[(k + 1) % content.region.size()]);
    const double steps = std::ceil(std::hypot(to.x - from.x, to.y - from.y) / 12.0);
    for (double step = 0; step < steps; ++step)
      symbols.push_back({from.x + step / steps * (to.x - from.x), from.y + step / steps * (to.y - from.y)});
  }
  LabelPlacer placer(frame, symbols);
  const auto labelled_lines = [&](double level) {
    std::vector<std::vector<PlanePoint>> pieces;
    for (const auto& line : level_lines(content.raster, level))
      for (auto& piece : placer.place(line, fmt::format("{:.4g}", level))) pieces.push_back(std::move(piece));
    return pieces;
  };
  const std::vector<std::vector<PlanePoint>> bold =
      tolerance_crossed ? labelled_lines(tolerance_mm) : std::vector<std::vector<PlanePoint>>{};
  std::vector<std::vector<PlanePoint>> thin;
  for (double level : levels.values)
    for (auto& piece : labelled_lines(level)) thin.push_back(std::move(piece));
  if (!thin.empty()) {
    begin_block(data, "lines");
    add_lines(data, thin);
    script.draw("lines", "using 1:2 with lines lw 1.1 lc rgb '#202020'");
  }
  if (!bold.empty()) {
    begin_block(data, "tolerance");
    add_lines(data, bold);
    script.draw("tolerance", fmt::format("using 1:2 with lines lw 3.5 lc rgb '{}'", on_map));
    script.key("with lines lw 3.5 lc rgb 'black'", fmt::format("f = {:.4g} mm (tolerance)", tolerance_mm));
  }
  if (!placer.labels.empty()) {
    begin_block(data, "labels");
    for (const LevelLabel& label : placer.labels)
      data += fmt::format("{:.7g} {:.7g} \"{}\" {:.1f}\n", label.at.x, label.at.y, label.text, label.angle_deg);
    script.draw("labels", fmt::format("using 1:2:3:4 with labels rotate variable center font ',{}' tc rgb '{}'",
                                      label_size, on_map));
  }
}

/// Colours of the map and their scale.
void set_colours(Script& script, const ContourOptions& options, const ContourContent& content, const Levels& levels,
                 double tolerance_mm, bool tolerance_crossed) {
  script.text += pale_viridis;
  double low = content.low_mm, high = content.high_mm;
  if (levels.values.empty() && !(high - low > 1e-9 * std::abs(high))) {
    const double room = high != 0.0 ? 0.1 * std::abs(high) : 1.0;
    low -= room;
    high += room;
  }
  script.text += fmt::format("set cbrange [{:.5g}:{:.5g}]\nset cblabel {} offset 0.8,0\n", low, high,
                             single_quoted(value_label(options)));
  if (levels.logarithmic) script.text += "set logscale cb\n";
  std::vector<double> ticks = levels.values;
  if (tolerance_crossed) ticks.push_back(tolerance_mm);
  std::sort(ticks.begin(), ticks.end());
  if (!ticks.empty()) {
    std::string list;
    for (double tick : ticks) list += fmt::format("{}'{:.4g}' {:.6g}", list.empty() ? "" : ", ", tick, tick);
    script.text += "set cbtics (" + list + ")\n";
  }
  script.text += fmt::format("set colorbox user origin {:.4f},{:.5f} size 0.022,{:.5f}\n", right_of_map + 0.02,
                             script.bottom, script.top - script.bottom);
}

void draw_raster(Script& script, std::string& data, const Raster& raster) {
  begin_block(data, "map");
  const std::size_t size = static_cast<std::size_t>(raster.size);
  for (std::size_t j = 0; j < size; ++j) {
    for (std::size_t i = 0; i < size; ++i) {
      const double value = raster.value[j * size + i];
      if (i > 0) data += ' ';
      data += std::isfinite(value) ? fmt::format("{:.4g}", value) : "NaN";
    }
    data += '\n';
  }
  script.draw("map", fmt::format("matrix using ({:.9g}+$1*{:.9g}):({:.9g}+$2*{:.9g}):3 with image", raster.low.x,
                                 (raster.high.x - raster.low.x) / (raster.size - 1), raster.low.y,
                                 (raster.high.y - raster.low.y) / (raster.size - 1)));
}

/// Where a finer stage lies over a coarser one.
void draw_frames(Script& script, std::string& data, const ContourContent& content) {
  std::vector<std::vector<PlanePoint>> frames;
  for (const ContourStage& stage : content.stages) {
    const GridSurface& surface = stage.surface;
    if (&stage == &content.stages.front() || !surface.has_area()) continue;
    const double x0 = surface.x.front(), x1 = surface.x.back(), y0 = surface.y.front(), y1 = surface.y.back();
    frames.push_back({{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}, {x0, y0}});
  }
  if (frames.empty()) return;
  begin_block(data, "frames");
  add_lines(data, frames);
  script.draw("frames", "using 1:2 with lines lw 1 dt (6,4) lc rgb '#404040'");
}

/// The edge of what was sampled; it also hides the steps of the raster.
void draw_hull(Script& script, std::string& data, const ContourContent& content) {
  if (content.hull.size() < 3) return;
  std::vector<PlanePoint> closed = content.hull;
  closed.push_back(closed.front());
  begin_block(data, "hull");
  add_lines(data, {closed});
  script.draw("hull", "using 1:2 with lines lw 1.8 lc rgb '#8a8a8a'");
}

void draw_stages(Script& script, std::string& data, const ContourContent& content, ContourGround ground) {
  if (!content.elsewhere.empty()) {
    begin_block(data, "elsewhere");
    for (const PlanePoint& point : content.elsewhere) data += fmt::format("{:.9g} {:.9g}\n", point.x, point.y);
    script.draw("elsewhere", "using 1:2 with points pt 6 ps 0.7 lw 1 lc rgb '#808080'",
                fmt::format("outside the slice ({})", content.elsewhere.size()));
  }
  std::size_t total = 0;
  for (const ContourStage& stage : content.stages) total += stage.designs.size();
  for (std::size_t s = 0; s < content.stages.size(); ++s) {
    const ContourStage& stage = content.stages[s];
    const Symbol symbol = stage_symbols[s % stage_symbols.size()];
    const std::string block = fmt::format("stage {}", s + 1);
    begin_block(data, block);
    for (const ContourDesign& design : stage.designs)
      data += fmt::format("{0:.9g} {1:.9g} {2:.6g} \"{0:.6g}, {1:.6g}: f = {2:.4g} mm\"\n", design.at.x, design.at.y,
                          design.f_mm);
    const std::string key = fmt::format("{} ({})", shortened(stage.name, 24), stage.designs.size());
    // A map drawn through the designs themselves has their colours already.
    const bool filled = total <= most_filled || content.raster.size == 0;
    if (filled) {
      script.draw(block, fmt::format("using 1:2:3 with points pt {} ps 1.35 lc palette", symbol.filled));
      script.draw(block, fmt::format("using 1:2 with points pt {} ps 1.35 lw 1.3 lc rgb '{}'", symbol.open, on_map));
      script.key(fmt::format("with points pt {} ps 1.2 lw 1.3 lc rgb 'black'", symbol.open), key);
      // Said when pointed at; of many designs that would be most of a page's bytes.
      if (ground == ContourGround::page)
        script.draw(block, "using 1:2:4 with labels hypertext point pt 7 ps 1.35 lc rgb '#ff000000'");
    } else {
      script.draw(block, fmt::format("using 1:2 with points pt {} ps 0.4 lc rgb '{}'", symbol.filled, on_map));
      script.key(fmt::format("with points pt {} ps 0.5 lc rgb 'black'", symbol.filled), key);
    }
  }
}

/// Where the optimum lies with 95 %; under the designs.
void draw_region(Script& script, std::string& data, const ContourContent& content) {
  if (content.region.size() < 2) return;
  std::vector<PlanePoint> closed = content.region;
  closed.push_back(closed.front());
  begin_block(data, "region");
  add_lines(data, {closed});
  script.draw("region", "using 1:2 with lines lw 4.5 lc rgb 'white'");
  script.draw("region", fmt::format("using 1:2 with lines lw 2 dt (12,6) lc rgb '{}'", on_map));
}

void draw_optimum(Script& script, std::string& data, const ContourContent& content, const ContourFit::Optimum& optimum,
                  const ResultTable& table, const ContourAxes& axes) {
  const auto coordinate = [&](std::size_t variable) {
    const auto& names = optimum.variables;
    const auto found = std::find(names.begin(), names.end(), table.variable_names[variable]);
    return found == names.end() ? std::nan("") : optimum.at[static_cast<std::size_t>(found - names.begin())];
  };
  const double x = coordinate(axes.x), y = coordinate(*axes.y);
  if (!std::isfinite(x) || !std::isfinite(y)) return;
  begin_block(data, "optimum");
  data += fmt::format("{:.9g} {:.9g}\n", x, y);
  script.draw("optimum", "using 1:2 with points pt 3 ps 2.2 lw 5.5 lc rgb 'white'");
  script.draw("optimum", fmt::format("using 1:2 with points pt 3 ps 2 lw 2.4 lc rgb '{}'", on_map));
  script.key("with points pt 3 ps 1.6 lw 2 lc rgb 'black'", "optimum of the fit");
  if (content.region.size() > 1) script.key("with lines lw 2 dt (12,6) lc rgb 'black'", "its 95 % region, jointly");
}

FigureFiles map_figure(const ResultTable& table, const ContourOptions& options, const ContourAxes& axes,
                       const ContourContent& content, const std::string& data_name, const std::string& picture_name,
                       ContourGround ground) {
  const PixelFrame frame{padded(content.low.x, content.high.x), padded(content.low.y, content.high.y),
                         (right_of_map - left) * width, plot_height};
  const double tolerance_mm = 1e3 * options.tolerance_m;
  const Levels levels = choose_levels(content.low_mm, content.high_mm, tolerance_mm);
  const bool tolerance_crossed = content.low_mm < tolerance_mm && tolerance_mm < content.high_mm;
  Script script(options, data_name, picture_name, notes_of(table, options, axes, content), right_of_map, ground);
  std::string data;
  script.axis("x", frame.x_range, axis_label(table.variable_names[axes.x]));
  script.axis("y", frame.y_range, axis_label(table.variable_names[*axes.y]));
  set_colours(script, options, content, levels, tolerance_mm, tolerance_crossed);
  if (content.raster.size > 0) draw_raster(script, data, content.raster);
  if (!content.hatching.empty()) {
    begin_block(data, "hatching");
    add_lines(data, content.hatching);
    script.draw("hatching", "using 1:2 with lines lw 0.8 lc rgb '#707070'");
  }
  if (content.raster.size > 0) {
    if (!content.fit_is_drawn) draw_frames(script, data, content);
    if (content.fit_is_drawn) draw_hull(script, data, content);
    draw_levels(script, data, content, levels, frame, tolerance_mm, tolerance_crossed, font_size(picture_name, 9));
  }
  draw_region(script, data, content);
  draw_stages(script, data, content, ground);
  if (const ContourFit* fit = usable_fit(options); fit != nullptr && fit->optimum)
    draw_optimum(script, data, content, *fit->optimum, table, axes);
  draw_designs_that_matter(script, data, content, true, 0.0);
  return {script.finished(), {{data_name, data}}};
}

/// The fit with its band and the optimum with its range, over one variable.
void draw_fit_curve(Script& script, std::string& data, const ContourContent& content, const ContourFit& fit,
                    const std::string& variable) {
  if (content.fit_curve.empty()) return;
  begin_block(data, "fit");
  for (std::size_t k = 0; k < content.fit_curve.size(); ++k) {
    if (k > 0) data += '\n';
    for (const auto& p : content.fit_curve[k])
      data += fmt::format("{:.9g} {:.6g} {:.6g} {:.6g}\n", p.x, p.f_mm, std::max(0.0, p.f_mm - 1.96 * p.sigma_mm),
                          p.f_mm + 1.96 * p.sigma_mm);
  }
  script.draw("fit", "using 1:3:4 with filledcurves fs solid 0.35 noborder lc rgb '#8bb2c1'", "its 95 % band");
  script.draw("fit", "using 1:2 with lines lw 2.2 lc rgb '#31688e'", "fit");
  // Of a slice it would lie on another curve.
  if (!fit.optimum || content.region.empty() || !content.elsewhere.empty()) return;
  const auto& names = fit.optimum->variables;
  const auto found = std::find(names.begin(), names.end(), variable);
  if (found == names.end()) return;
  const double at = fit.optimum->at[static_cast<std::size_t>(found - names.begin())];
  double low = at, high = at;
  for (const PlanePoint& p : content.region) {
    low = std::min(low, p.x);
    high = std::max(high, p.x);
  }
  begin_block(data, "optimum");
  data += fmt::format("{:.9g} {:.6g} {:.9g} {:.9g}\n", at, 1e3 * fit.optimum->f_m, low, high);
  script.draw("optimum", "using 1:2:3:4 with xerrorbars pt 3 ps 2 lw 2.4 lc rgb 'black'", "optimum, 95 % range");
}

FigureFiles curve_figure(const ResultTable& table, const ContourOptions& options, const ContourAxes& axes,
                         const ContourContent& content, const std::string& data_name, const std::string& picture_name,
                         ContourGround ground) {
  const double tolerance_mm = 1e3 * options.tolerance_m;
  Script script(options, data_name, picture_name, notes_of(table, options, axes, content), right_of_curve, ground);
  std::string data;

  // Axes: f from 0, with room for the error bars.
  double high = 0.0;
  for (const ContourStage& stage : content.stages)
    for (const ContourDesign& design : stage.designs) high = std::max(high, design.f_mm + design.sigma_mm);
  for (const auto& piece : content.fit_curve)
    for (const auto& p : piece) high = std::max(high, p.f_mm + p.sigma_mm);
  high = high > 0.0 ? 1.08 * high : 1.0;
  const bool tolerance_near = tolerance_mm < 1.5 * high;
  if (tolerance_near) high = std::max(high, 1.15 * tolerance_mm);
  const auto x_range = padded(content.low.x, content.high.x);
  script.axis("x", x_range, axis_label(table.variable_names[axes.x]));
  script.axis("y", {0.0, high}, value_label(options));
  script.text += "set grid ytics lt 1 lc rgb '#d0d0d0' lw 0.7\n";

  // Hatched where designs failed; in shares of the plot, so that the lines are at 45 degrees.
  std::vector<Polygon> blank;
  const double span = x_range.second - x_range.first, aspect = (right_of_curve - left) * width / plot_height;
  for (auto [from, to] : content.failed_ranges) {
    // A design alone at its place is as wide as a mark.
    from = std::max(x_range.first, std::min(from, 0.5 * (from + to) - 0.01 * span));
    to = std::min(x_range.second, std::max(to, 0.5 * (from + to) + 0.01 * span));
    const double u0 = aspect * (from - x_range.first) / span, u1 = aspect * (to - x_range.first) / span;
    blank.push_back({{u0, 0}, {u1, 0}, {u1, 1}, {u0, 1}});
  }
  std::vector<std::vector<PlanePoint>> lines;
  for (const auto& [a, b] : hatching(blank, 0.02))
    lines.push_back(
        {{x_range.first + span * a.x / aspect, high * a.y}, {x_range.first + span * b.x / aspect, high * b.y}});
  if (!lines.empty()) {
    begin_block(data, "hatching");
    add_lines(data, lines);
    script.draw("hatching", "using 1:2 with lines lw 0.8 lc rgb '#707070'");
  }

  const ContourFit* fit = usable_fit(options);
  if (fit != nullptr) draw_fit_curve(script, data, content, *fit, table.variable_names[axes.x]);
  if (tolerance_near)
    script.draw_expression(fmt::format("{:.6g}", tolerance_mm), "with lines lw 3.5 lc rgb 'black'",
                           fmt::format("f = {:.4g} mm (tolerance)", tolerance_mm));
  static constexpr std::array<const char*, 4> colours = {"#31688e", "#1f9e6a", "#7a3b8f", "#a08500"};
  for (std::size_t s = 0; s < content.stages.size(); ++s) {
    std::vector<ContourDesign> designs = content.stages[s].designs;
    std::stable_sort(designs.begin(), designs.end(),
                     [](const ContourDesign& a, const ContourDesign& b) { return a.at.x < b.at.x; });
    const std::string block = fmt::format("stage {}", s + 1);
    begin_block(data, block);
    for (const ContourDesign& design : designs)
      data += fmt::format("{:.9g} {:.6g} {:.6g}\n", design.at.x, design.f_mm, design.sigma_mm);
    const char* colour = colours[s % colours.size()];
    if (content.fit_curve.empty())
      script.draw(block, fmt::format("using 1:2 with lines lw 1.4 dt (8,4) lc rgb '{}'", colour));
    script.draw(block,
                fmt::format("using 1:2:3 with yerrorbars pt {} ps 1.1 lw 1.6 lc rgb '{}'",
                            stage_symbols[s % stage_symbols.size()].filled, colour),
                fmt::format("{} ({}), ± 1 sigma", shortened(content.stages[s].name, 24), designs.size()));
  }
  draw_designs_that_matter(script, data, content, false, 0.03 * high);
  return {script.finished(), {{data_name, data}}};
}

}  // namespace

FigureFiles contour_figure(const ResultTable& table, const ContourOptions& options, const std::string& data_name,
                           const std::string& picture_name, ContourGround ground) {
  if (options.value != "f_m" && options.value != "f_footprint_m")
    throw InputError(fmt::format("contour: value '{}', accepted: f_m, f_footprint_m", options.value));
  const ContourAxes axes = contour_axes(table, options);
  const ContourContent content = contour_content(table, options, axes);
  return axes.plane ? map_figure(table, options, axes, content, data_name, picture_name, ground)
                    : curve_figure(table, options, axes, content, data_name, picture_name, ground);
}

}  // namespace drumsweep

#include "postproc/contour_figure.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "core/config/schema.h"
#include "postproc/contour_lines.h"

namespace drumsweep {
namespace {

// Layout [pixels, fractions of the canvas]. Fixed, so that labels can be placed here and not by luck.
constexpr double canvas_width = 1000, canvas_height = 780;
constexpr double left = 0.095, right = 0.845, bottom = 0.19, top = 0.89;
constexpr int raster_size = 301;

/// One design that has a value, f in mm.
struct Design {
  PlanePoint at;
  double f_mm = 0.0, sigma_mm = 0.0;
  bool trusted = true;
};

struct Stage {
  std::string name;
  std::vector<Design> designs;
  GridSurface surface;
};

/// All that is drawn.
struct Content {
  std::vector<Stage> stages;       ///< coarse first, those without a map last
  std::vector<PlanePoint> failed;  ///< y is meaningless on a curve
  std::optional<Design> best;
  double low_mm = 0.0, high_mm = 0.0;
  PlanePoint low, high;  ///< bounding box of all designs
};

Content gather(const ResultTable& table, const ContourOptions& options, const ContourAxes& axes) {
  Content content;
  const double infinite = std::numeric_limits<double>::infinity();
  content.low = {infinite, infinite};
  content.high = {-infinite, -infinite};
  content.low_mm = infinite;
  content.high_mm = -infinite;
  for (const ResultRow& row : table.rows) {
    if (!options.stage.empty() && row.stage != options.stage) continue;
    const PlanePoint at{row.variables[axes.x], axes.plane ? row.variables[*axes.y] : 0.0};
    if (!std::isfinite(at.x) || !std::isfinite(at.y)) continue;
    content.low = {std::min(content.low.x, at.x), std::min(content.low.y, at.y)};
    content.high = {std::max(content.high.x, at.x), std::max(content.high.y, at.y)};
    const double f_mm = 1e3 * figure_value(row, options);
    if (!std::isfinite(f_mm)) {
      content.failed.push_back(at);
      continue;
    }
    const double sigma_mm = 1e3 * (options.value == "f_footprint_m" ? row.sigma_f_footprint_m : row.sigma_f_m);
    const Design design{at, f_mm, std::isfinite(sigma_mm) ? sigma_mm : 0.0, row.state == "done"};
    content.low_mm = std::min(content.low_mm, f_mm);
    content.high_mm = std::max(content.high_mm, f_mm);
    if (design.trusted && (!content.best || f_mm < content.best->f_mm)) content.best = design;

    auto stage = std::find_if(content.stages.begin(), content.stages.end(),
                              [&](const Stage& known) { return known.name == row.stage; });
    if (stage == content.stages.end()) stage = content.stages.insert(stage, Stage{row.stage, {}, {}});
    stage->designs.push_back(design);
  }
  if (content.stages.empty()) throw InputError("contour: no design has a value yet, there is nothing to draw");

  // Coarse stages first; scattered designs (a refinement) have no map and go on top of everything.
  for (Stage& stage : content.stages) {
    std::vector<PlaneSample> samples;
    for (const Design& design : stage.designs) samples.push_back({design.at, design.f_mm});
    stage.surface = grid_surface(samples);
  }
  std::stable_sort(content.stages.begin(), content.stages.end(), [](const Stage& a, const Stage& b) {
    const auto key = [](const Stage& stage) {
      const bool map = stage.surface.has_area();
      return std::make_pair(map ? 0 : 1, map ? -stage.surface.cell_area() : 0.0);
    };
    return key(a) < key(b);
  });
  return content;
}

/// Levels for lines and colour scale, strictly inside (low, high).
struct Levels {
  std::vector<double> values;
  bool logarithmic = false;
};

/// The smallest of 1, 2, 2.5, 5 times a power of ten that is not below.
double nice_step(double least) {
  const double decade = std::pow(10.0, std::floor(std::log10(least)));
  for (double mantissa : {1.0, 2.0, 2.5, 5.0})
    if (mantissa * decade >= least) return mantissa * decade;
  return 10.0 * decade;
}

/// Decimals that multiples of a nice step need.
int decimals_of(double step) {
  for (int decimals = 0; decimals < 12; ++decimals) {
    const double scaled = step * std::pow(10.0, decimals);
    if (std::abs(scaled - std::round(scaled)) < 1e-6 * scaled) return decimals;
  }
  return 12;
}

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

/// Text in gnuplot's single quotes, on one line.
std::string quoted(std::string text) {
  std::string result = "'";
  for (char c : text) {
    if (c == '\'') result += '\'';
    result += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
  }
  return result + '\'';
}

/// No longer than fits in the key; cut between characters of UTF-8.
std::string shortened(const std::string& text, std::size_t most) {
  if (text.size() <= most) return text;
  std::size_t end = most;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80) --end;
  return text.substr(0, end) + "…";
}

/// Range of an axis with room for the symbols at its ends.
std::pair<double, double> padded(double low, double high) {
  const double span = high - low;
  const double pad = span > 0.0 ? 0.045 * span : (low != 0.0 ? 0.1 * std::abs(low) : 1.0);
  return {low - pad, high + pad};
}

/// From the plane to pixels, for placing labels.
struct PixelFrame {
  std::pair<double, double> x_range, y_range;

  PlanePoint pixels(PlanePoint at) const {
    return {(at.x - x_range.first) / (x_range.second - x_range.first) * (right - left) * canvas_width,
            (at.y - y_range.first) / (y_range.second - y_range.first) * (top - bottom) * canvas_height};
  }
};

double distance(PlanePoint a, PlanePoint b) { return std::hypot(a.x - b.x, a.y - b.y); }

struct Label {
  PlanePoint at, at_pixels;
  std::string text;
  double angle_deg = 0.0;
};

/// Finds places for labels on level lines: far from other labels, designs and the frame, where the line is straight.
class LabelPlacer {
 public:
  LabelPlacer(const PixelFrame& frame, std::vector<PlanePoint> keep_clear_pixels)
      : frame_(frame), keep_clear_(std::move(keep_clear_pixels)) {}

  /// Labels the line if there is room and returns it cut where the labels stand.
  std::vector<std::vector<PlanePoint>> place(const std::vector<PlanePoint>& line, const std::string& text) {
    // Arc length in pixels; specks are not drawn.
    std::vector<PlanePoint> pixels;
    std::vector<double> arc = {0.0};
    for (const PlanePoint& point : line) pixels.push_back(frame_.pixels(point));
    for (std::size_t i = 1; i < pixels.size(); ++i) arc.push_back(arc.back() + distance(pixels[i - 1], pixels[i]));

    if (arc.back() < 8.0) return {};

    // A label on lines long enough to spare it, another every 500 pixels.
    const double half_width = 4.5 + 3.6 * static_cast<double>(text.size());
    std::vector<double> centres;
    const int wanted = arc.back() < 5.0 * half_width ? 0 : 1 + static_cast<int>(arc.back() / 500.0);
    for (int k = 0; k < wanted; ++k) {
      std::size_t best = 0;
      double best_score = 0.0;
      for (std::size_t i = 0; i < pixels.size(); ++i) {
        const double score = score_at(pixels, arc, i, half_width);
        if (score > best_score) {
          best = i;
          best_score = score;
        }
      }
      if (best == 0) break;
      const auto [before, after] = chord(pixels, arc, best, half_width);
      double angle = std::atan2(after.y - before.y, after.x - before.x) * 180.0 / std::numbers::pi;
      if (angle > 90.0) angle -= 180.0;
      if (angle <= -90.0) angle += 180.0;
      labels.push_back({line[best], pixels[best], text, angle});
      centres.push_back(arc[best]);
    }

    // Leave a gap for each label.
    std::vector<std::vector<PlanePoint>> pieces(1);
    for (std::size_t i = 0; i < line.size(); ++i) {
      const bool hidden = std::any_of(centres.begin(), centres.end(),
                                      [&](double centre) { return std::abs(arc[i] - centre) < half_width; });
      if (!hidden) pieces.back().push_back(line[i]);
      if (hidden && !pieces.back().empty()) pieces.emplace_back();
    }
    std::erase_if(pieces, [](const auto& piece) { return piece.size() < 2; });
    return pieces;
  }

  std::vector<Label> labels;

 private:
  /// Ends of the stretch of line that a label at i covers.
  static std::pair<PlanePoint, PlanePoint> chord(const std::vector<PlanePoint>& pixels, const std::vector<double>& arc,
                                                 std::size_t i, double half_width) {
    std::size_t before = i, after = i;
    while (before > 0 && arc[i] - arc[before] < half_width) --before;
    while (after + 1 < arc.size() && arc[after] - arc[i] < half_width) ++after;
    return {pixels[before], pixels[after]};
  }

  /// 0 where a label cannot stand, else higher for better places.
  double score_at(const std::vector<PlanePoint>& pixels, const std::vector<double>& arc, std::size_t i,
                  double half_width) const {
    if (arc[i] < 2.3 * half_width || arc.back() - arc[i] < 2.3 * half_width) return 0.0;
    const auto [before, after] = chord(pixels, arc, i, half_width);
    const double straightness = distance(before, after) / (2.0 * half_width);
    if (straightness < 0.85) return 0.0;
    double to_label = 160.0, to_symbol = 26.0;
    for (const Label& label : labels) to_label = std::min(to_label, distance(label.at_pixels, pixels[i]));
    if (to_label < 2.5 * half_width) return 0.0;
    for (const PlanePoint& symbol : keep_clear_)
      for (const PlanePoint& part : {before, pixels[i], after}) to_symbol = std::min(to_symbol, distance(symbol, part));
    // Text that lies flat is read most easily.
    const double flat = std::abs(after.x - before.x) / (distance(before, after) + 1e-12);
    return 0.1 + 2.0 * to_symbol / 26.0 + to_label / 160.0 + 2.0 * std::min(1.0, straightness) + 0.7 * flat;
  }

  PixelFrame frame_;
  std::vector<PlanePoint> keep_clear_;
};

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

/// Symbols of the stages, gnuplot's point types; dots, then open circles, squares, triangles.
constexpr std::array<int, 4> stage_symbols = {7, 6, 4, 10};

/// The parts that map and curve share.
class Script {
 public:
  Script(const ContourOptions& options, const std::string& data_name, const std::string& picture_name,
         double right_edge)
      : data_name_(quoted(data_name)), centre_(0.5 * (left + right_edge)) {
    const bool svg = picture_name.ends_with(".svg");
    text = fmt::format(
        "# {}\n"
        "# Run gnuplot in this folder; reads {}, writes {}.\n"
        "set encoding utf8\n"
        "set terminal {} size {},{} font '{}' noenhanced background 'white'\n"
        "set output {}\n"
        "set title {} font ',{}' offset 0,1.1\n"
        "set lmargin at screen {}\nset rmargin at screen {}\nset bmargin at screen {}\nset tmargin at screen {}\n"
        "set tics out nomirror\n"
        "set border 3 lw 1.2\n"
        "set key at screen {},0.085 top center horizontal Left reverse maxrows 2 samplen 1.8 width 2\n",
        "f over the design variables, f in mm", data_name_, quoted(picture_name), svg ? "svg" : "pngcairo",
        canvas_width, canvas_height, svg ? "DejaVu Sans,13" : "DejaVu Sans,11", quoted(picture_name),
        quoted(shortened(options.title, 90)), svg ? 16 : 13, left, right_edge, bottom, top, centre_);
  }

  /// Range, evenly spaced tics with the same number of decimals, and label of axis "x" or "y".
  void axis(const std::string& name, std::pair<double, double> range, const std::string& label) {
    const double step = nice_step((range.second - range.first) / 9.0);
    const int decimals = decimals_of(step);
    text += fmt::format("set {0}range [{1:.9g}:{2:.9g}]\nset {0}tics {3:.9g}\nset format {0} '%.{4}f'\n", name,
                        range.first, range.second, step, decimals);
    text += fmt::format("set {}label {}\n", name, quoted(label));
  }
  /// A line of text between title and plot.
  void subtitle(const std::string& line) {
    text += fmt::format("set label 1 {} at screen {},{} center\n", quoted(line), centre_, top + 0.03);
  }

  /// One thing to draw: a block of the data file, how, and its line in the key (empty for none).
  void draw(const std::string& block, const std::string& how, const std::string& key = "") {
    plot_ += plot_.empty() ? "plot " : ", \\\n     ";
    plot_ +=
        fmt::format("{} index '{}' {} {}", data_name_, block, how, key.empty() ? "notitle" : "title " + quoted(key));
  }
  /// The same for an expression.
  void draw_expression(const std::string& expression, const std::string& how, const std::string& key) {
    plot_ += plot_.empty() ? "plot " : ", \\\n     ";
    plot_ += fmt::format("{} {} title {}", expression, how, quoted(key));
  }
  std::string finished() const { return text + plot_ + "\n"; }

  std::string text;

 private:
  std::string data_name_;
  double centre_;
  std::string plot_;
};

std::string value_label(const ContourOptions& options) {
  return options.value == "f_footprint_m" ? "unevenness f under the outlet (mm)" : "unevenness f (mm)";
}

std::string best_text(const Design& best, const std::vector<std::string>& axis_labels) {
  // "opening angle (deg)" 0.2 -> "opening angle 0.2 deg"
  std::string where;
  for (std::size_t a = 0; a < axis_labels.size(); ++a) {
    const std::string& label = axis_labels[a];
    const std::size_t unit = label.rfind(" (");
    where += fmt::format("{}{} {:.4g}", a == 0 ? "" : ", ", label.substr(0, unit), a == 0 ? best.at.x : best.at.y);
    if (unit != std::string::npos) where += " " + label.substr(unit + 2, label.size() - unit - 3);
  }
  // As many decimals as the error allows: one digit of it, two when the first is a 1.
  if (!(best.sigma_mm > 0.0)) return fmt::format("best: f = {:.3g} mm at {}", best.f_mm, where);
  const int decimals = std::clamp(-static_cast<int>(std::floor(std::log10(0.5 * best.sigma_mm))), 0, 6);
  return fmt::format("best: f = {:.{}f} ± {:.{}f} mm at {}", best.f_mm, decimals, best.sigma_mm, decimals, where);
}

FigureSource map_figure(const ResultTable& table, const ContourOptions& options, const ContourAxes& axes,
                        const Content& content, const std::string& data_name, const std::string& picture_name) {
  const PixelFrame frame{padded(content.low.x, content.high.x), padded(content.low.y, content.high.y)};
  const std::string x_label = axis_label(table.variable_names[axes.x]);
  const std::string y_label = axis_label(table.variable_names[*axes.y]);
  const double tolerance_mm = 1e3 * options.tolerance_m;
  const Levels levels = choose_levels(content.low_mm, content.high_mm, tolerance_mm);
  const bool tolerance_crossed = content.low_mm < tolerance_mm && tolerance_mm < content.high_mm;
  std::vector<GridSurface> surfaces;
  for (const Stage& stage : content.stages) surfaces.push_back(stage.surface);
  const bool has_map = std::any_of(surfaces.begin(), surfaces.end(), [](const auto& s) { return s.has_area(); });

  Script script(options, data_name, picture_name, right);
  std::string data;

  // Axes and colours. The palette is viridis mixed with 45 % white: even steps of brightness, black lines legible on
  // all.
  script.axis("x", frame.x_range, x_label);
  script.axis("y", frame.y_range, y_label);
  script.text +=
      "set palette defined (0 '#987399', 1 '#9985b8', 2 '#94a0bf', 3 '#8bb2c1', 4 '#85c2bf', 5 '#89d2b9', "
      "6 '#a6e1a8', 7 '#d2ec8d', 8 '#fef187')\n";
  double low = content.low_mm, high = content.high_mm;
  if (levels.values.empty() && !(high - low > 1e-9 * std::abs(high))) {
    const double room = high != 0.0 ? 0.1 * std::abs(high) : 1.0;
    low -= room;
    high += room;
  }
  script.text += fmt::format("set cbrange [{:.5g}:{:.5g}]\nset cblabel {} offset 0.8,0\n", low, high,
                             quoted(value_label(options)));
  if (levels.logarithmic) script.text += "set logscale cb\n";
  std::vector<double> ticks = levels.values;
  if (tolerance_crossed) ticks.push_back(tolerance_mm);
  std::sort(ticks.begin(), ticks.end());
  if (!ticks.empty()) {
    std::string list;
    for (double tick : ticks) list += fmt::format("{}'{:.4g}' {:.6g}", list.empty() ? "" : ", ", tick, tick);
    script.text += "set cbtics (" + list + ")\n";
  }
  script.text +=
      fmt::format("set colorbox user origin {:.4f},{:.4f} size 0.022,{:.4f}\n", right + 0.02, bottom, top - bottom);

  if (has_map) {
    // Filled map.
    const Raster raster = rasterize(surfaces, raster_size);
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

    // Where a finer stage lies over a coarser one.
    std::vector<std::vector<PlanePoint>> frames;
    for (const GridSurface& surface : surfaces) {
      if (&surface == &surfaces.front() || !surface.has_area()) continue;
      const double x0 = surface.x.front(), x1 = surface.x.back(), y0 = surface.y.front(), y1 = surface.y.back();
      frames.push_back({{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}, {x0, y0}});
    }
    if (!frames.empty()) {
      begin_block(data, "frames");
      add_lines(data, frames);
      script.draw("frames", "using 1:2 with lines lw 1 dt (6,4) lc rgb '#404040'");
    }

    // Level lines with gaps for their labels; the bold one has the first choice of places.
    std::vector<PlanePoint> symbols;
    for (const Stage& stage : content.stages)
      for (const Design& design : stage.designs) symbols.push_back(frame.pixels(design.at));
    for (const PlanePoint& failed : content.failed) symbols.push_back(frame.pixels(failed));
    LabelPlacer placer(frame, symbols);
    const auto labelled_lines = [&](double level) {
      std::vector<std::vector<PlanePoint>> pieces;
      for (const auto& line : level_lines(raster, level))
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
      script.draw("tolerance", "using 1:2 with lines lw 3.5 lc rgb 'black'",
                  fmt::format("f = {:.4g} mm (tolerance)", tolerance_mm));
    }
    if (!placer.labels.empty()) {
      begin_block(data, "labels");
      for (const Label& label : placer.labels)
        data += fmt::format("{:.7g} {:.7g} \"{}\" {:.1f}\n", label.at.x, label.at.y, label.text, label.angle_deg);
      script.draw("labels", fmt::format("using 1:2:3:4 with labels rotate variable center font ',{}'",
                                        picture_name.ends_with(".svg") ? 12 : 9));
    }
  }

  // Designs: small marks on a map; scattered ones carry their colour.
  std::vector<Design> untrusted;
  for (std::size_t s = 0; s < content.stages.size(); ++s) {
    const Stage& stage = content.stages[s];
    for (const Design& design : stage.designs)
      if (!design.trusted) untrusted.push_back(design);
    const std::string block = fmt::format("stage {}", s + 1);
    begin_block(data, block);
    for (const Design& design : stage.designs)
      data += fmt::format("{:.9g} {:.9g} {:.6g}\n", design.at.x, design.at.y, design.f_mm);
    const std::string key = fmt::format("{} ({})", shortened(stage.name, 24), stage.designs.size());
    if (stage.surface.has_area()) {
      script.draw(block,
                  fmt::format("using 1:2 with points pt {} ps {} lw 1.2 lc rgb 'black'",
                              stage_symbols[s % stage_symbols.size()],
                              (stage.designs.size() > 60 ? 0.45 : 0.7) + (s > 0 ? 0.2 : 0.0)),
                  key);
    } else {
      script.draw(block, "using 1:2:3 with points pt 7 ps 1.5 lc palette");
      script.draw(block, "using 1:2 with points pt 6 ps 1.5 lw 1.2 lc rgb 'black'", key);
    }
  }
  if (!untrusted.empty()) {
    begin_block(data, "untrusted");
    for (const Design& design : untrusted) data += fmt::format("{:.9g} {:.9g}\n", design.at.x, design.at.y);
    script.draw("untrusted", "using 1:2 with points pt 8 ps 1.8 lw 1.6 lc rgb 'black'", "untrusted");
  }
  if (!content.failed.empty()) {
    begin_block(data, "failed");
    for (const PlanePoint& point : content.failed) data += fmt::format("{:.9g} {:.9g}\n", point.x, point.y);
    script.draw("failed", "using 1:2 with points pt 2 ps 1.4 lw 2.2 lc rgb '#b00020'", "no result");
  }
  if (content.best) {
    begin_block(data, "best");
    data += fmt::format("{:.9g} {:.9g}\n", content.best->at.x, content.best->at.y);
    script.draw("best", "using 1:2 with points pt 13 ps 2.6 lc rgb 'white'");
    script.draw("best", "using 1:2 with points pt 12 ps 2.6 lw 2.2 lc rgb 'black'", "best");
    script.subtitle(best_text(*content.best, {x_label, y_label}));
  }
  return {script.finished(), data};
}

FigureSource curve_figure(const ResultTable& table, const ContourOptions& options, const ContourAxes& axes,
                          const Content& content, const std::string& data_name, const std::string& picture_name) {
  const std::string x_label = axis_label(table.variable_names[axes.x]);
  const double tolerance_mm = 1e3 * options.tolerance_m;
  Script script(options, data_name, picture_name, 0.96);
  std::string data;

  // Axes: f from 0, with room for the error bars.
  double high = 0.0;
  for (const Stage& stage : content.stages)
    for (const Design& design : stage.designs) high = std::max(high, design.f_mm + design.sigma_mm);
  high = high > 0.0 ? 1.08 * high : 1.0;
  const bool tolerance_near = tolerance_mm < 1.5 * high;
  if (tolerance_near) high = std::max(high, 1.15 * tolerance_mm);
  script.axis("x", padded(content.low.x, content.high.x), x_label);
  script.axis("y", {0.0, high}, value_label(options));
  script.text += "set grid ytics lt 1 lc rgb '#dcdcdc' lw 0.8\n";

  if (tolerance_near)
    script.draw_expression(fmt::format("{:.6g}", tolerance_mm), "with lines lw 3 lc rgb '#606060'",
                           fmt::format("f = {:.4g} mm (tolerance)", tolerance_mm));
  static constexpr std::array<const char*, 4> colours = {"#31688e", "#35b779", "#440154", "#b8a000"};
  for (std::size_t s = 0; s < content.stages.size(); ++s) {
    std::vector<Design> designs = content.stages[s].designs;
    std::stable_sort(designs.begin(), designs.end(), [](const Design& a, const Design& b) { return a.at.x < b.at.x; });
    const std::string block = fmt::format("stage {}", s + 1);
    begin_block(data, block);
    for (const Design& design : designs)
      data += fmt::format("{:.9g} {:.6g} {:.6g}\n", design.at.x, design.f_mm, design.sigma_mm);
    const char* colour = colours[s % colours.size()];
    script.draw(block, fmt::format("using 1:2 with lines lw 1.4 lc rgb '{}'", colour));
    script.draw(block,
                fmt::format("using 1:2:3 with yerrorbars pt {} ps 1 lw 1.6 lc rgb '{}'",
                            stage_symbols[s % stage_symbols.size()], colour),
                fmt::format("{} ({}), ± 1 sigma", shortened(content.stages[s].name, 24), designs.size()));
  }

  // What needs a word of its own.
  std::string untrusted, failed;
  for (const Stage& stage : content.stages)
    for (const Design& design : stage.designs)
      if (!design.trusted) untrusted += fmt::format("{:.9g} {:.6g}\n", design.at.x, design.f_mm);
  for (const PlanePoint& point : content.failed) failed += fmt::format("{:.9g} {:.6g}\n", point.x, 0.025 * high);
  if (!untrusted.empty()) {
    begin_block(data, "untrusted");
    data += untrusted;
    script.draw("untrusted", "using 1:2 with points pt 8 ps 2.2 lw 1.8 lc rgb 'black'", "untrusted");
  }
  if (!failed.empty()) {
    begin_block(data, "failed");
    data += failed;
    script.draw("failed", "using 1:2 with points pt 2 ps 1.4 lw 2.2 lc rgb '#b00020'", "no result");
  }
  if (content.best) {
    begin_block(data, "best");
    data += fmt::format("{:.9g} {:.6g}\n", content.best->at.x, content.best->f_mm);
    script.draw("best", "using 1:2 with points pt 12 ps 2.6 lw 2.2 lc rgb 'black'", "best");
    script.subtitle(best_text(*content.best, {x_label}));
  }
  return {script.finished(), data};
}

}  // namespace

double figure_value(const ResultRow& row, const ContourOptions& options) {
  if (row.state != "done" && row.state != "untrusted") return ResultRow::none;
  return options.value == "f_footprint_m" ? row.f_footprint_m : row.f_m;
}

FigureSource contour_figure(const ResultTable& table, const ContourOptions& options, const std::string& data_name,
                            const std::string& picture_name) {
  if (options.value != "f_m" && options.value != "f_footprint_m")
    throw InputError(fmt::format("contour: value '{}', accepted: f_m, f_footprint_m", options.value));
  const ContourAxes axes = contour_axes(table, options);
  const Content content = gather(table, options, axes);
  return axes.plane ? map_figure(table, options, axes, content, data_name, picture_name)
                    : curve_figure(table, options, axes, content, data_name, picture_name);
}

}  // namespace drumsweep

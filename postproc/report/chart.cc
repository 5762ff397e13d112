#include "postproc/report/chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "postproc/report/html.h"

namespace drumsweep {
namespace {

std::string tip_of(const std::string& tip) { return tip.empty() ? "" : fmt::format("<title>{}</title>", escaped(tip)); }

std::string shape_at(const std::string& shape, double x, double y, double r) {
  if (shape == "square")
    return fmt::format("M{:.1f} {:.1f}h{:.1f}v{:.1f}h{:.1f}z", x - 0.9 * r, y - 0.9 * r, 1.8 * r, 1.8 * r, -1.8 * r);
  if (shape == "diamond")
    return fmt::format("M{:.1f} {:.1f}l{:.1f} {:.1f}l{:.1f} {:.1f}l{:.1f} {:.1f}z", x, y - 1.3 * r, 1.3 * r, 1.3 * r,
                       -1.3 * r, 1.3 * r, -1.3 * r, -1.3 * r);
  if (shape == "cross")
    return fmt::format("M{:.1f} {:.1f}l{:.1f} {:.1f}m0 {:.1f}l{:.1f} {:.1f}", x - r, y - r, 2 * r, 2 * r, -2 * r,
                       -2 * r, 2 * r);
  if (shape == "dot") return fmt::format("M{:.1f} {:.1f}h0", x, y);
  return fmt::format("M{:.1f} {:.1f}a{:.1f} {:.1f} 0 1 0 {:.1f} 0a{:.1f} {:.1f} 0 1 0 {:.1f} 0z", x - r, y, r, r, 2 * r,
                     r, r, -2 * r);
}

bool finite(const ChartPoint& p) { return std::isfinite(p.x) && std::isfinite(p.y); }

/// Room for the longest name, in letters as wide as on narrow screens.
double width_of_names(const std::vector<std::string>& names) {
  std::ptrdiff_t longest = 0;
  for (const std::string& name : names)
    longest = std::max(longest, std::count_if(name.begin(), name.end(),
                                              [](char c) { return (static_cast<unsigned char>(c) & 0xc0u) != 0x80u; }));
  return 9.6 * static_cast<double>(longest) + 12;
}

}  // namespace

std::vector<double> round_ticks(double low, double high, int count) {
  const double raw = (high - low) / std::max(1, count);
  const double power = std::pow(10, std::floor(std::log10(raw)));
  double step = 10 * power;
  for (const double nice : {5.0, 2.5, 2.0, 1.0})
    if (nice * power >= raw * 0.999) step = nice * power;
  std::vector<double> ticks;
  for (double i = std::ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; ++i) ticks.push_back(i * step);
  return ticks;
}

std::string number_text(double value, int digits) {
  if (!std::isfinite(value)) return "–";
  const double size = std::abs(value);
  std::string text;
  if (size != 0 && (size < 1e-4 || size >= 1e6)) {
    text = fmt::format("{:.{}e}", value, std::max(0, digits - 1));
  } else {
    const int before = size >= 1 ? static_cast<int>(std::floor(std::log10(size))) + 1 : 1;
    const int zeros = size > 0 && size < 1 ? static_cast<int>(std::floor(-std::log10(size))) : 0;
    text = fmt::format("{:.{}f}", value, std::max(0, digits - before + (size < 1 ? zeros + 1 : 0)));
  }
  if (text[0] == '-') text = "−" + text.substr(1);
  return text;
}

ChartAxis axis_over(const std::string& label, const std::vector<double>& values, bool with_zero) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  if (!(low <= high)) return {label, 0, 1};
  const bool from_zero = with_zero && low >= 0;
  if (from_zero) low = 0;
  const double margin = high > low ? 0.05 * (high - low) : (high != 0 ? 0.1 * std::abs(high) : 1);
  return {label, from_zero ? 0 : low - margin, high + margin};
}

std::string legend_html(const std::vector<LegendEntry>& entries) {
  std::string list;
  for (const auto& [text, css, shape] : entries) {
    const std::string mark =
        shape == "line" ? fmt::format("<path class=\"ln {}\" d=\"M1 6H19\"/>", css)
        : shape == "bar"
            ? fmt::format("<rect class=\"br {}\" x=\"1\" y=\"1\" width=\"18\" height=\"10\"/>", css)
            : fmt::format("<g class=\"pt {} {}\"><path d=\"{}\"/></g>", css, shape, shape_at(shape, 10, 6, 4));
    list += fmt::format("<span><svg viewBox=\"0 0 20 12\" aria-hidden=\"true\">{}</svg>{}</span>", mark, escaped(text));
  }
  return list.empty() ? "" : fmt::format("<p class=\"legend\">{}</p>\n", list);
}

Chart::Chart(std::string title, ChartAxis x, ChartAxis y, double width, double height)
    : title_(std::move(title)), x_(std::move(x)), y_(std::move(y)), width_(width), height_(height) {
  left_ = std::max(left_, width_of_names(y_.names));
}

double Chart::px(double x) const { return left_ + (x - x_.low) / (x_.high - x_.low) * (width_ - left_ - right_); }
double Chart::py(double y) const {
  return height_ - bottom_ - (y - y_.low) / (y_.high - y_.low) * (height_ - top_ - bottom_);
}

void Chart::points(const std::vector<ChartPoint>& points, const std::string& css, const std::string& shape,
                   double radius) {
  std::string errors, marks;
  for (const ChartPoint& p : points) {
    if (!finite(p)) continue;
    if (p.error > 0)
      errors += fmt::format("M{:.1f} {:.1f}V{:.1f}", px(p.x), py(std::max(y_.low, p.y - p.error)),
                            py(std::min(y_.high, p.y + p.error)));
    marks += fmt::format("<path d=\"{}\">{}</path>", shape_at(shape, px(p.x), py(p.y), radius), tip_of(p.tip));
  }
  if (!errors.empty()) body_ += fmt::format("<path class=\"err {}\" d=\"{}\"/>\n", css, errors);
  body_ += fmt::format("<g class=\"pt {} {}\">{}</g>\n", css, shape, marks);
}

void Chart::line(const std::vector<ChartPoint>& points, const std::string& css, bool step) {
  std::string path;
  bool down = false;
  for (const ChartPoint& p : points) {
    if (!finite(p)) {
      down = false;
      continue;
    }
    if (down && step) path += fmt::format("H{:.1f}", px(p.x));
    path += fmt::format("{}{:.1f} {:.1f}", down ? "L" : "M", px(p.x), py(p.y));
    down = true;
  }
  body_ += fmt::format("<path class=\"ln {}\" d=\"{}\"/>\n", css, path);
}

void Chart::band(const std::vector<ChartPoint>& low, const std::vector<ChartPoint>& high, const std::string& css) {
  std::string path;
  for (const ChartPoint& p : low)
    if (finite(p)) path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? "M" : "L", px(p.x), py(std::max(y_.low, p.y)));
  for (auto p = high.rbegin(); p != high.rend(); ++p)
    if (finite(*p)) path += fmt::format("L{:.1f} {:.1f}", px(p->x), py(std::min(y_.high, p->y)));
  if (!path.empty()) behind_ += fmt::format("<path class=\"bd {}\" d=\"{}z\"/>\n", css, path);
}

void Chart::rule(double at, const std::string& text, const std::string& css, RuleText where) {
  if (at < y_.low || at > y_.high) return;
  const bool right = where == RuleText::right_above, below = where == RuleText::left_below;
  body_ += fmt::format("<path class=\"ln {}\" d=\"M{:.1f} {:.1f}H{:.1f}\"/>", css, left_, py(at), width_ - right_);
  if (text.empty()) return;
  body_ += fmt::format("<text class=\"on {}\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>\n", css,
                       right ? width_ - right_ - 4 : left_ + 6, py(at) + (below ? 16 : -5), right ? "end" : "start",
                       escaped(text));
}

void Chart::upright(double at, const std::string& text, const std::string& css) {
  if (at < x_.low || at > x_.high) return;
  body_ += fmt::format("<path class=\"ln {}\" d=\"M{:.1f} {:.1f}V{:.1f}\"/>", css, px(at), top_, height_ - bottom_);
  // The text is on the side where there is room.
  const bool right = px(at) < 0.7 * width_;
  body_ += fmt::format("<text class=\"on {}\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>\n", css,
                       px(at) + (right ? 5 : -5), top_ - 3, right ? "start" : "end", escaped(text));
}

void Chart::bar(double x_begin, double x_end, double y_begin, double y_end, const std::string& css,
                const std::string& tip) {
  const double low = std::max(x_begin, x_.low), high = std::min(x_end, x_.high);
  if (!(high >= low)) return;
  body_ +=
      fmt::format("<rect class=\"br {}\" x=\"{:.2f}\" y=\"{:.1f}\" width=\"{:.2f}\" height=\"{:.1f}\">{}</rect>\n", css,
                  px(low), py(y_end), std::max(0.6, px(high) - px(low)), py(y_begin) - py(y_end), tip_of(tip));
}

void Chart::whisker(double x_begin, double x_end, double y, const std::string& css) {
  const double low = std::max(x_begin, x_.low), high = std::min(x_end, x_.high);
  if (!(high >= low)) return;
  std::string path = fmt::format("M{:.1f} {:.1f}H{:.1f}", px(low), py(y), px(high));
  // An end that is cut off has no cap.
  for (const double end : {x_begin, x_end})
    if (end >= x_.low && end <= x_.high) path += fmt::format("M{:.1f} {:.1f}v6", px(end), py(y) - 3);
  body_ += fmt::format("<path class=\"err {}\" d=\"{}\"/>\n", css, path);
}

void Chart::note(double x, double y, const std::string& text, NoteSide side) {
  const bool right = side == NoteSide::right;
  body_ += fmt::format("<text class=\"on\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>\n",
                       px(x) + (right ? 6 : -6), py(y) + 4.5, right ? "start" : "end", escaped(text));
}

void Chart::stripe(double x_begin, double x_end, const std::string& text, bool dark) {
  const double low = px(std::max(x_begin, x_.low)), high = px(std::min(x_end, x_.high));
  if (!(high > low)) return;
  behind_ += fmt::format("<rect class=\"st{}\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\"/>",
                         dark ? " dark" : "", low, top_, high - low, height_ - top_ - bottom_);
  // A name that does not fit is left to what the points say.
  if (7.5 * static_cast<double>(text.size()) < high - low)
    behind_ += fmt::format("<text class=\"on\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>\n",
                           0.5 * (low + high), top_ + 14, escaped(text));
}

void Chart::legend(const std::string& text, const std::string& css, const std::string& shape) {
  legend_.push_back({text, css, shape});
}

std::string Chart::frame() const {
  std::string grid, texts;
  const double bottom = height_ - bottom_, right = width_ - right_;
  auto x_ticks = round_ticks(x_.low, x_.high, width_ > 600 ? 8 : 5);
  if (x_.whole) std::erase_if(x_ticks, [](double tick) { return std::abs(tick - std::round(tick)) > 1e-9; });
  const auto y_ticks = round_ticks(y_.low, y_.high, 4);
  const auto label = [](double value, const std::vector<double>& ticks) {
    const double step = ticks.size() > 1 ? ticks[1] - ticks[0] : std::abs(value);
    const int decimals = step > 0 ? std::max(0, static_cast<int>(std::ceil(-std::log10(step) - 1e-9))) : 0;
    // A step of 2.5 needs one more.
    const double scaled = step * std::pow(10, decimals);
    const bool more = std::abs(scaled - std::round(scaled)) > 1e-6;
    std::string text = fmt::format("{:.{}f}", std::abs(value) < 1e-12 ? 0.0 : value, decimals + (more ? 1 : 0));
    return text[0] == '-' ? "−" + text.substr(1) : text;
  };
  for (const double tick : x_ticks)
    if (x_.names.empty()) {
      grid += fmt::format("M{:.1f} {:.1f}v5", px(tick), bottom);
      texts += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>", px(tick), bottom + 19,
                           label(tick, x_ticks));
    }
  std::string lines;
  if (y_.names.empty()) {
    for (const double tick : y_ticks) {
      lines += fmt::format("M{:.1f} {:.1f}H{:.1f}", left_, py(tick), right);
      texts += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\">{}</text>", left_ - 7, py(tick) + 4.5,
                           label(tick, y_ticks));
    }
  } else {
    for (std::size_t i = 0; i < y_.names.size(); ++i)
      texts += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\">{}</text>", left_ - 7,
                           py(static_cast<double>(i)) + 4.5, escaped(y_.names[i]));
  }
  texts += fmt::format("<text class=\"lb\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>",
                       0.5 * (left_ + right), height_ - 8, escaped(x_.label));
  texts += fmt::format("<text class=\"lb\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"start\">{}</text>", 4.0, top_ - 12,
                       escaped(y_.label));
  return fmt::format("<path class=\"gr\" d=\"{}\"/><path class=\"ax\" d=\"M{:.1f} {:.1f}H{:.1f}{}\"/>{}", lines, left_,
                     bottom, right, grid, texts);
}

std::string Chart::svg() const {
  return fmt::format(
      "{}<div class=\"box\"><svg class=\"chart{}\" style=\"max-width:{:.0f}px\" viewBox=\"0 0 {:.0f} {:.0f}\" "
      "role=\"img\" aria-label=\"{}\">\n{}{}\n{}</svg></div>",
      legend_html(legend_), width_ > 600 ? " big" : "", 1.1 * width_, width_, height_, escaped(title_), behind_,
      frame(), body_);
}

}  // namespace drumsweep

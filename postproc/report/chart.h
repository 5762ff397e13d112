/// Charts for pages as inline SVG: colours and sizes of text come from the page's style (style.css), so one drawing
/// serves light and dark, screen and paper. What is drawn says its values when pointed at (<title>).
#pragma once

#include <string>
#include <vector>

namespace drumsweep {

struct ChartAxis {
  std::string label;                 ///< with unit
  double low = 0, high = 1;          ///< low < high
  std::vector<std::string> names{};  ///< in place of numbers: one a unit from 0, for lists; of y: room is made for them
  bool whole = false;                ///< ticks at whole numbers only
};

/// Lowest and highest finite value with a margin on both sides; [0, 1] without any, never empty.
/// @param with_zero  the axis begins at 0 where all values are positive
ChartAxis axis_over(const std::string& label, const std::vector<double>& values, bool with_zero = false);

struct ChartPoint {
  double x = 0, y = 0;
  double error = 0;  ///< of y, one standard error; 0 or NaN: none is drawn
  std::string tip;   ///< plain text
};

/// Names a series: a mark ("line", "bar" or a shape of Chart::points) and a text.
struct LegendEntry {
  std::string text, css, shape;
};
/// A legend of its own, for several charts.
std::string legend_html(const std::vector<LegendEntry>& entries);

/// Draws in the order of the calls. Classes are those of style.css: "a" to "d" for series, "best", "bad", "limit".
class Chart {
 public:
  /// @param title  what a reader who cannot see it should know
  Chart(std::string title, ChartAxis x, ChartAxis y, double width = 480, double height = 270);

  /// @param shape  circle, square, diamond, cross; dot: a small circle of few bytes, for thousands
  void points(const std::vector<ChartPoint>& points, const std::string& css, const std::string& shape = "circle",
              double radius = 3.2);
  /// Lines break at points that are not finite. @param step  horizontal up to the next point
  void line(const std::vector<ChartPoint>& points, const std::string& css, bool step = false);
  /// Between two lines over the same x.
  void band(const std::vector<ChartPoint>& low, const std::vector<ChartPoint>& high, const std::string& css);
  enum class RuleText { right_above, left_above, left_below };
  /// Across the whole chart at a value of y, with a text, if any, where it covers least.
  void rule(double at, const std::string& text, const std::string& css, RuleText where = RuleText::right_above);
  /// The same at a value of x, with its text at the top.
  void upright(double at, const std::string& text, const std::string& css);
  /// From x to x, between y and y.
  void bar(double x_begin, double x_end, double y_begin, double y_end, const std::string& css, const std::string& tip);
  /// An error bar that lies at a height y, for lists.
  void whisker(double x_begin, double x_end, double y, const std::string& css);
  /// A short text beside a place in the chart.
  enum class NoteSide { left, right };
  void note(double x, double y, const std::string& text, NoteSide side = NoteSide::right);
  /// Shades x between two values, with a text at its top.
  void stripe(double x_begin, double x_end, const std::string& text, bool dark);
  /// Names a series above the chart.
  void legend(const std::string& text, const std::string& css, const std::string& shape);

  std::string svg() const;

 private:
  double px(double x) const;
  double py(double y) const;
  std::string frame() const;

  std::string title_, behind_, body_;
  ChartAxis x_, y_;
  double width_, height_, left_ = 62, right_ = 14, top_ = 30, bottom_ = 52;
  std::vector<LegendEntry> legend_;
};

/// Round numbers from low to high, about `count` of them.
std::vector<double> round_ticks(double low, double high, int count);

/// With so many significant digits, a real minus sign, and no exponent between 1e-4 and 1e6; "–" where there is none.
std::string number_text(double value, int digits = 3);

}  // namespace drumsweep

/// Places for the labels of level lines: far from other labels, designs and the frame, where the line is straight.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "postproc/contour_lines.h"

namespace drumsweep {

/// From the plane to pixels.
struct PixelFrame {
  std::pair<double, double> x_range, y_range;
  double width = 0, height = 0;  ///< of the plot [pixels]

  PlanePoint pixels(PlanePoint at) const {
    return {(at.x - x_range.first) / (x_range.second - x_range.first) * width,
            (at.y - y_range.first) / (y_range.second - y_range.first) * height};
  }
};

struct LevelLabel {
  PlanePoint at, at_pixels;
  std::string text;
  double angle_deg = 0.0;
};

class LabelPlacer {
 public:
  LabelPlacer(const PixelFrame& frame, std::vector<PlanePoint> keep_clear_pixels)
      : frame_(frame), keep_clear_(std::move(keep_clear_pixels)) {}

  /// Labels the line if there is room and returns it cut where the labels stand.
  std::vector<std::vector<PlanePoint>> place(const std::vector<PlanePoint>& line, const std::string& text);

  std::vector<LevelLabel> labels;

 private:
  double score_at(const std::vector<PlanePoint>& pixels, const std::vector<double>& arc, std::size_t i,
                  double half_width) const;

  PixelFrame frame_;
  std::vector<PlanePoint> keep_clear_;
};

}  // namespace drumsweep

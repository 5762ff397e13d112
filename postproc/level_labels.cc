#include "postproc/level_labels.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace drumsweep {
namespace {

double distance(PlanePoint a, PlanePoint b) { return std::hypot(a.x - b.x, a.y - b.y); }

/// Ends of the stretch of line that a label at i covers.
std::pair<PlanePoint, PlanePoint> chord(const std::vector<PlanePoint>& pixels, const std::vector<double>& arc,
                                        std::size_t i, double half_width) {
  std::size_t before = i, after = i;
  while (before > 0 && arc[i] - arc[before] < half_width) --before;
  while (after + 1 < arc.size() && arc[after] - arc[i] < half_width) ++after;
  return {pixels[before], pixels[after]};
}

}  // namespace

std::vector<std::vector<PlanePoint>> LabelPlacer::place(const std::vector<PlanePoint>& line, const std::string& text) {
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

/// 0 where a label cannot stand, else higher for better places.
double LabelPlacer::score_at(const std::vector<PlanePoint>& pixels, const std::vector<double>& arc, std::size_t i,
                             double half_width) const {
  if (arc[i] < 2.3 * half_width || arc.back() - arc[i] < 2.3 * half_width) return 0.0;
  const auto [before, after] = chord(pixels, arc, i, half_width);
  const double straightness = distance(before, after) / (2.0 * half_width);
  if (straightness < 0.85) return 0.0;
  double to_label = 160.0, to_symbol = 26.0;
  for (const LevelLabel& label : labels) to_label = std::min(to_label, distance(label.at_pixels, pixels[i]));
  if (to_label < 2.5 * half_width) return 0.0;
  for (const PlanePoint& symbol : keep_clear_)
    for (const PlanePoint& part : {before, pixels[i], after}) to_symbol = std::min(to_symbol, distance(symbol, part));
  // Text that lies flat is read most easily.
  const double flat = std::abs(after.x - before.x) / (distance(before, after) + 1e-12);
  return 0.1 + 2.0 * to_symbol / 26.0 + to_label / 160.0 + 2.0 * std::min(1.0, straightness) + 0.7 * flat;
}

}  // namespace drumsweep

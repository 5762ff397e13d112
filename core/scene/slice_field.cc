#include "core/scene/slice_field.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace drumsweep {
namespace {

constexpr int cells_a_diameter = 4;
constexpr double surface_fraction = 0.3;  // half of what a bed has
constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();

}  // namespace

SliceField::SliceField(double radius, double diameter, double length)
    : radius_(radius),
      diameter_(diameter),
      length_(length),
      cell_(diameter / cells_a_diameter),
      num_(static_cast<std::size_t>(std::ceil(2 * radius / cell_)) + 2 * cells_a_diameter) {
  clear();
}

void SliceField::clear() {
  for (std::vector<double>* field : {&volume_, &flux_x_, &flux_z_}) field->assign(num_ * num_, 0.0);
  frames_ = 0;
}

void SliceField::add(double x, double z, double vx, double vz, double volume) {
  const double middle = 0.5 * static_cast<double>(num_), i = std::floor(x / cell_ + middle),
               k = std::floor(z / cell_ + middle), n = static_cast<double>(num_);
  if (!(i >= 0 && i < n && k >= 0 && k < n)) return;
  const std::size_t at = static_cast<std::size_t>(k) * num_ + static_cast<std::size_t>(i);
  volume_[at] += volume;
  flux_x_[at] += volume * vx;
  flux_z_[at] += volume * vz;
}

std::vector<SliceField::Bin> SliceField::profile(double angle) const {
  const double c = std::cos(angle), s = std::sin(angle), middle = 0.5 * static_cast<double>(num_) - 0.5;
  const double width = 0.5 * diameter_, strip = 2 * diameter_;
  const auto num_bins = static_cast<std::size_t>(std::ceil(2 * radius_ / width));
  std::vector<double> volume(num_bins, 0.0), flux(num_bins, 0.0);
  for (std::size_t k = 0; k < num_; ++k)
    for (std::size_t i = 0; i < num_; ++i) {
      const std::size_t at = k * num_ + i;
      if (volume_[at] == 0) continue;
      const double x = (static_cast<double>(i) - middle) * cell_, z = (static_cast<double>(k) - middle) * cell_;
      // Tangent (c, -s) down-slope, normal (s, c).
      if (std::abs(x * c - z * s) > strip) continue;
      const double bin = std::floor((x * s + z * c + radius_) / width);
      if (bin < 0 || bin >= static_cast<double>(num_bins)) continue;
      const auto b = static_cast<std::size_t>(bin);
      volume[b] += volume_[at];
      flux[b] += flux_x_[at] * c - flux_z_[at] * s;
    }
  std::vector<Bin> out;
  const double room = width * 2 * strip * length_ * static_cast<double>(std::max<std::size_t>(1, frames_));
  for (std::size_t b = 0; b < num_bins; ++b)
    out.push_back({-radius_ + (static_cast<double>(b) + 0.5) * width, volume[b] / room,
                   volume[b] > 0 ? flux[b] / volume[b] : nan_value});
  return out;
}

double SliceField::mass_centre_angle() const {
  const double middle = 0.5 * static_cast<double>(num_) - 0.5;
  double x = 0, z = 0;
  for (std::size_t k = 0; k < num_; ++k)
    for (std::size_t i = 0; i < num_; ++i) {
      x += volume_[k * num_ + i] * (static_cast<double>(i) - middle);
      z += volume_[k * num_ + i] * (static_cast<double>(k) - middle);
    }
  return std::atan2(-x, -z);
}

std::vector<SliceField::Point> SliceField::surface() const {
  std::vector<Point> out;
  constexpr std::size_t w = cells_a_diameter;
  const double middle = 0.5 * static_cast<double>(num_);
  const double room = diameter_ * diameter_ * length_ * static_cast<double>(std::max<std::size_t>(1, frames_));
  for (std::size_t left = 0; left + w <= num_; left += w) {
    // Volume of this column's rows, then of windows one diameter high, from the top down.
    std::vector<double> row(num_, 0.0);
    for (std::size_t k = 0; k < num_; ++k)
      for (std::size_t i = left; i < left + w; ++i) row[k] += volume_[k * num_ + i];
    double above = 0;
    for (std::size_t low = num_ - w + 1; low-- > 0;) {
      double fraction = 0;
      for (std::size_t k = low; k < low + w; ++k) fraction += row[k] / room;
      if (fraction >= surface_fraction) {
        const double up = above < fraction ? (fraction - surface_fraction) / (fraction - above) : 0;
        out.push_back({(static_cast<double>(left) + 0.5 * w - middle) * cell_,
                       (static_cast<double>(low) + 0.5 * w + up - middle) * cell_});
        break;
      }
      above = fraction;
    }
  }
  return out;
}

SliceField::Line SliceField::surface_line() const {
  Line line;
  line.angle = mass_centre_angle();
  line.distance = surface_position(profile(line.angle));
  const std::vector<Point> points = surface();
  // The central half of the chord depends on the line: a few rounds settle it.
  for (int round = 0; round < 4 && std::isfinite(line.distance); ++round) {
    const double foot = line.distance * std::sin(line.angle),
                 chord = std::sqrt(std::max(0.0, radius_ * radius_ - line.distance * line.distance)),
                 reach = 0.5 * chord * std::cos(line.angle);
    double n = 0, sx = 0, sz = 0, sxx = 0, sxz = 0;
    for (const Point& p : points) {
      const double x = p.x - foot;
      if (std::abs(x) > reach) continue;
      n += 1, sx += x, sz += p.z, sxx += x * x, sxz += x * p.z;
    }
    const double spread = n * sxx - sx * sx;
    line.points = static_cast<std::size_t>(n);
    if (n < 3 || !(spread > 0)) break;
    const double slope = (n * sxz - sx * sz) / spread, height = (sz - slope * sx) / n - slope * foot;  // at x = 0
    line.angle = std::atan(-slope);
    line.distance = height * std::cos(line.angle);
  }
  return line;
}

double SliceField::surface_position(const std::vector<Bin>& bins) {
  double above = 0;
  for (std::size_t b = bins.size(); b-- > 1;) {
    const double fraction = 0.5 * (bins[b].fraction + bins[b - 1].fraction);
    if (fraction >= surface_fraction) {
      const double y = 0.5 * (bins[b].y + bins[b - 1].y), step = bins[1].y - bins[0].y;
      return y + (above < fraction ? (fraction - surface_fraction) / (fraction - above) : 0) * step;
    }
    above = fraction;
  }
  return nan_value;
}

double SliceField::velocity_at(const std::vector<Bin>& bins, double y) {
  const Bin* below = nullptr;
  for (const Bin& b : bins) {
    if (!std::isfinite(b.u)) continue;
    if (b.y >= y) {
      if (below == nullptr) return b.u;
      return below->u + (b.u - below->u) * (y - below->y) / (b.y - below->y);
    }
    below = &b;
  }
  return below == nullptr ? nan_value : below->u;
}

double SliceField::zero_position(const std::vector<Bin>& bins) {
  const double top = surface_position(bins);
  const Bin* above = nullptr;
  for (std::size_t b = bins.size(); b-- > 0;) {
    const Bin& bin = bins[b];
    if (!std::isfinite(bin.u) || bin.y > top) continue;
    if (above != nullptr && above->u > 0 && bin.u <= 0) return bin.y + (above->y - bin.y) * bin.u / (bin.u - above->u);
    above = &bin;
  }
  return nan_value;
}

}  // namespace drumsweep

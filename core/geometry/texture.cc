#include "core/geometry/texture.h"

#include <algorithm>
#include <cmath>

namespace drumsweep {

namespace {
constexpr double cut_off = 5.0;  // standard deviations; the step there is 4e-6 of a bump's height
}

void Texture::add(const TextureConfig& config, double scale, double circumference, double begin, double end,
                  std::int64_t seed, Purpose purpose, bool periodic) {
  circumference_ = circumference;
  const auto count = static_cast<std::uint64_t>(std::llround(config.density_1_m2 * circumference * (end - begin)));
  const double sigma_per_width = config.width_is == "sigma" ? 1.0 : 0.5;
  for (std::uint64_t i = 0; i < count; ++i) {
    const auto r = uniform4(seed, purpose, i);
    const double width = config.width_min_m + r[3] * (config.width_max_m - config.width_min_m);
    bumps_.push_back({r[0] * circumference, begin + r[1] * (end - begin),
                      scale * (config.height_min_m + r[2] * (config.height_max_m - config.height_min_m)),
                      sigma_per_width * width});
    if (!periodic) continue;
    // A short period has images from many periods away.
    const Bump bump = bumps_.back();
    const double length = end - begin, beyond = 2 * cut_off * bump.sigma;
    const double num_images = std::ceil(beyond / length) + 1;
    for (double k = -num_images; k <= num_images; ++k) {
      Bump image = bump;
      image.s += k * length;
      if (k != 0 && image.s > begin - beyond && image.s < end + beyond) bumps_.push_back(image);
    }
  }
  bin();
}

void Texture::bin() {
  if (bumps_.empty()) return;
  double last = begin_ = bumps_.front().s;
  reach_ = 0;
  for (const Bump& b : bumps_) {
    reach_ = std::max(reach_, cut_off * b.sigma);
    begin_ = std::min(begin_, b.s);
    last = std::max(last, b.s);
  }
  num_u_ = std::max<std::size_t>(1, static_cast<std::size_t>(circumference_ / reach_));
  num_s_ = static_cast<std::size_t>((last - begin_) / reach_) + 1;
  cells_.assign(num_u_ * num_s_, {});
  for (std::size_t i = 0; i < bumps_.size(); ++i) {
    const auto cu =
        std::min(num_u_ - 1, static_cast<std::size_t>(bumps_[i].u / circumference_ * static_cast<double>(num_u_)));
    const auto cs = std::min(num_s_ - 1, static_cast<std::size_t>((bumps_[i].s - begin_) / reach_));
    cells_[cs * num_u_ + cu].push_back(static_cast<std::uint32_t>(i));
  }
}

void Texture::add_coating(double begin, double thickness) { coatings_.push_back({begin, thickness}); }

double Texture::coating(double s) const {
  double thickness = 0;
  for (const Coating& c : coatings_)
    if (s >= c.begin) thickness = c.thickness;
  return thickness;
}

double Texture::height(double u, double s) const {
  if (bumps_.empty()) return coating(s);
  u -= circumference_ * std::floor(u / circumference_);
  const auto cu =
      static_cast<long>(std::min(static_cast<double>(num_u_ - 1), u / circumference_ * static_cast<double>(num_u_)));
  const auto cs = static_cast<long>(std::floor((s - begin_) / reach_));
  const long width = static_cast<long>(num_u_), length = static_cast<long>(num_s_);
  double sum = coating(s);
  for (long is = std::max(0L, cs - 1); is <= std::min(length - 1, cs + 1); ++is) {
    // Around the drum the cells wrap; with fewer than three each is visited once.
    for (long k = 0; k < std::min(3L, width); ++k) {
      const long iu = width < 3 ? k : (cu + k - 1 + width) % width;
      for (const std::uint32_t i : cells_[static_cast<std::size_t>(is * width + iu)]) {
        const Bump& b = bumps_[i];
        double du = u - b.u;
        du -= circumference_ * std::round(du / circumference_);
        const double q = (du * du + (s - b.s) * (s - b.s)) / (b.sigma * b.sigma);
        if (q < cut_off * cut_off) sum += b.height * std::exp(-0.5 * q);
      }
    }
  }
  return sum;
}

}  // namespace drumsweep

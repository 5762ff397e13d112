/// Random Gaussian bumps on the inside of a cylinder of circumference C, on its unrolled wall (u periodic, s along the
/// axis). The drum's and the outlet's bumps have streams of their own: all designs of a study share the same texture.
#pragma once

#include <cstdint>
#include <vector>

#include "core/config/study.h"
#include "core/geometry/random.h"

namespace drumsweep {

class Texture {
 public:
  /// Bumps for s in [begin, end), round(density * area) of them.
  /// @param scale  of the heights
  /// @param periodic  the bumps go on as they are beyond both ends
  void add(const TextureConfig& config, double scale, double circumference, double begin, double end, std::int64_t seed,
           Purpose purpose, bool periodic = false);
  /// A layer of this thickness on the wall from `begin` on.
  void add_coating(double begin, double thickness);
  /// Height of the wall over the smooth cylinder, towards the axis [m].
  double height(double u, double s) const;
  std::size_t num_bumps() const { return bumps_.size(); }

 private:
  struct Bump {
    double u, s, height, sigma;
  };
  void bin();
  struct Coating {
    double begin, thickness;
  };
  double coating(double s) const;
  std::vector<Bump> bumps_;
  std::vector<Coating> coatings_;  ///< by ascending begin
  double circumference_ = 0, reach_ = 0, begin_ = 0;
  std::size_t num_u_ = 1, num_s_ = 1;
  std::vector<std::vector<std::uint32_t>>
      cells_;  ///< (num_s x num_u) bumps whose centre is there; cells at least reach_ wide
};

}  // namespace drumsweep

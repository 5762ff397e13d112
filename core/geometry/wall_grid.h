/// Uniform grid over a mesh: for a point, the triangles within `reach` of its cell, in one look-up.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>

#include "core/geometry/triangle_mesh.h"

namespace drumsweep {

class WallGrid {
 public:
  /// Triangles of one cell, ascending.
  struct Triangles {
    std::span<const std::int32_t> index;
    const float*
        spheres;  ///< bounding spheres: x, y, z and radius, (index.size()) each, readable up to sixteen past the end [m]
  };

  /// Every triangle is listed in every cell that has a point nearer than `reach` to it.
  WallGrid(const TriangleMesh& mesh, double cell_size, double reach);

  double reach() const { return reach_; }
  double cell_size() const { return cell_; }

  /// Lists of the cells that the box with corners low and high touches: calls visit(triangles) for each whose triangles are within
  /// reach of the box.
  template <class Visit>
  void near(const Eigen::Array3f& low, const Eigen::Array3f& high, Visit&& visit) const {
    // In quarters of cells.
    std::array<int, 3> from{}, to{};
    for (int k = 0; k < 3; ++k) {
      const auto i = static_cast<std::size_t>(k);
      const float a = (low[k] - origin_f_[i]) * per_quarter_, b = (high[k] - origin_f_[i]) * per_quarter_;
      if (!(b >= 0 && a < static_cast<float>(4 * size_[i]))) return;
      from[i] = static_cast<int>(std::max(0.0f, a));
      to[i] = static_cast<int>(std::min(static_cast<float>(4 * size_[i] - 1), b));
    }
    for (int z = from[2] / 4; z <= to[2] / 4; ++z)
      for (int y = from[1] / 4; y <= to[1] / 4; ++y)
        for (int x = from[0] / 4; x <= to[0] / 4; ++x) {
          const std::span<const std::int32_t> list = cell(x, y, z);
          if (list.empty()) continue;
          const auto quarters = [](int first, int last, int at) {
            return std::array<int, 2>{std::max(first - 4 * at, 0), std::min(last - 4 * at, 3)};
          };
          const std::uint64_t box =
              bits_of(quarters(from[0], to[0], x), quarters(from[1], to[1], y), quarters(from[2], to[2], z));
          const std::uint64_t mask =
              static_cast<std::uint32_t>(list[0]) | std::uint64_t{static_cast<std::uint32_t>(list[1])} << 32;
          if ((mask & box) != 0)
            visit(
                Triangles{list.subspan(2), spheres_.data() + 4 * static_cast<std::size_t>(list.data() - list_.data())});
        }
  }

  std::size_t bytes() const { return (begin_.size() + list_.size() + spheres_.size()) * sizeof(std::int32_t); }

 private:
  /// Bits 16 z + 4 y + x of the parts of a cell in these ranges.
  static std::uint64_t bits_of(std::array<int, 2> x, std::array<int, 2> y, std::array<int, 2> z) {
    const auto run = [](std::array<int, 2> r, int width) {
      const int begin = r[0] * width, end = (r[1] + 1) * width;
      return (end == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << end) - 1) & ~((std::uint64_t{1} << begin) - 1);
    };
    return (run(x, 1) * 0x1111111111111111u) & (run(y, 4) * 0x0001000100010001u) & run(z, 16);
  }

  std::span<const std::int32_t> cell(int x, int y, int z) const {
    const auto c = (static_cast<std::size_t>(z) * static_cast<std::size_t>(size_[1]) + static_cast<std::size_t>(y)) *
                       static_cast<std::size_t>(size_[0]) +
                   static_cast<std::size_t>(x);
    return {list_.data() + begin_[c], list_.data() + begin_[c + 1]};
  }
  void mark_parts(const TriangleMesh& mesh);
  void list_spheres(const TriangleMesh& mesh);

  double cell_, reach_;
  Eigen::Vector3d origin_;
  float per_quarter_;
  std::array<float, 3> origin_f_;
  std::array<int, 3> size_;
  std::vector<std::uint32_t> begin_;  ///< (cells + 1) first entry of each cell in list_
  std::vector<std::int32_t>
      list_;  ///< of a cell that is not empty: mask of its 64 parts that are within reach of a triangle, in two
              ///< numbers; triangles, ascending
  std::vector<float> spheres_;  ///< at four times a cell's place in list_
};

}  // namespace drumsweep

/// Uniform grid over a mesh: for a point, the triangles within `reach` of its cell, in one look-up.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>

#include "core/geometry/triangle_mesh.h"

namespace drumsweep {

class WallGrid {
 public:
  /// Every triangle is listed in every cell that has a point nearer than `reach` to it.
  WallGrid(const TriangleMesh& mesh, double cell_size, double reach);

  double reach() const { return reach_; }
  double cell_size() const { return cell_; }

  /// Triangles near the cell that holds p; empty where no wall is within reach.
  std::span<const std::int32_t> near(const Eigen::Vector3d& p) const {
    const Eigen::Vector3d q = (p - origin_) / cell_;
    if (!(q.minCoeff() >= 0) || q[0] >= size_[0] || q[1] >= size_[1] || q[2] >= size_[2]) return {};
    return cell(static_cast<int>(q[0]), static_cast<int>(q[1]), static_cast<int>(q[2]));
  }

  /// Cell coordinates of a point, for telling whether two points share a cell.
  Eigen::Vector3i cell_of(const Eigen::Vector3d& p) const {
    return ((p - origin_) / cell_).array().floor().cast<int>();
  }

  /// Calls visit(triangle) for all triangles within reach of the box with corners low and high, some of them more than
  /// once.
  template <class Visit>
  void near(const Eigen::Vector3d& low, const Eigen::Vector3d& high, Visit&& visit) const {
    std::array<int, 3> from{}, to{};
    for (int k = 0; k < 3; ++k) {
      const auto i = static_cast<std::size_t>(k);
      const double a = (low[k] - origin_[k]) / cell_, b = (high[k] - origin_[k]) / cell_;
      if (!(b >= 0 && a < size_[i])) return;
      from[i] = static_cast<int>(std::max(0.0, a));
      to[i] = static_cast<int>(std::min(size_[i] - 1.0, b));
    }
    for (int z = from[2]; z <= to[2]; ++z)
      for (int y = from[1]; y <= to[1]; ++y)
        for (int x = from[0]; x <= to[0]; ++x)
          for (const std::int32_t t : cell(x, y, z)) visit(t);
  }

  std::size_t bytes() const { return (begin_.size() + list_.size()) * sizeof(std::int32_t); }

 private:
  std::span<const std::int32_t> cell(int x, int y, int z) const {
    const auto c = (static_cast<std::size_t>(z) * static_cast<std::size_t>(size_[1]) + static_cast<std::size_t>(y)) *
                       static_cast<std::size_t>(size_[0]) +
                   static_cast<std::size_t>(x);
    return {list_.data() + begin_[c], list_.data() + begin_[c + 1]};
  }
  double cell_, reach_;
  Eigen::Vector3d origin_;
  std::array<int, 3> size_;
  std::vector<std::uint32_t> begin_;  ///< (cells + 1) first entry of each cell in list_
  std::vector<std::int32_t> list_;    ///< triangles, ascending within a cell
};

}  // namespace drumsweep

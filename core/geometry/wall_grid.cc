#include "core/geometry/wall_grid.h"

#include <algorithm>

namespace drumsweep {

WallGrid::WallGrid(const TriangleMesh& mesh, double cell_size, double reach) : cell_(cell_size), reach_(reach) {
  Eigen::Vector3d low = Eigen::Vector3d::Zero(), high = low;
  for (const Eigen::Vector3d& v : mesh.vertices) {
    low = &v == mesh.vertices.data() ? v : low.cwiseMin(v).eval();
    high = &v == mesh.vertices.data() ? v : high.cwiseMax(v).eval();
  }
  origin_ = low.array() - reach;
  for (int k = 0; k < 3; ++k)
    size_[static_cast<std::size_t>(k)] = static_cast<int>((high[k] - low[k] + 2 * reach) / cell_) + 1;

  // Twice over the triangles: count, then fill, so that the list has no slack.
  const double cell_radius = 0.5 * std::sqrt(3.0) * cell_;
  const auto visit = [&](auto&& action) {
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const auto& [i, j, k] = mesh.triangles[t];
      const Eigen::Vector3d &a = mesh.vertices[static_cast<std::size_t>(i)],
                            &b = mesh.vertices[static_cast<std::size_t>(j)],
                            &c = mesh.vertices[static_cast<std::size_t>(k)];
      const Eigen::Vector3d from = (a.cwiseMin(b).cwiseMin(c).array() - reach) - origin_.array();
      const Eigen::Vector3d to = (a.cwiseMax(b).cwiseMax(c).array() + reach) - origin_.array();
      for (int z = std::max(0, static_cast<int>(from[2] / cell_));
           z <= std::min(size_[2] - 1, static_cast<int>(to[2] / cell_)); ++z)
        for (int y = std::max(0, static_cast<int>(from[1] / cell_));
             y <= std::min(size_[1] - 1, static_cast<int>(to[1] / cell_)); ++y)
          for (int x = std::max(0, static_cast<int>(from[0] / cell_));
               x <= std::min(size_[0] - 1, static_cast<int>(to[0] / cell_)); ++x) {
            const Eigen::Vector3d centre = origin_ + cell_ * Eigen::Vector3d(x + 0.5, y + 0.5, z + 0.5);
            if ((closest_point(centre, a, b, c).point - centre).norm() > reach + cell_radius) continue;
            action((static_cast<std::size_t>(z) * static_cast<std::size_t>(size_[1]) + static_cast<std::size_t>(y)) *
                           static_cast<std::size_t>(size_[0]) +
                       static_cast<std::size_t>(x),
                   static_cast<std::int32_t>(t));
          }
    }
  };
  begin_.assign(
      static_cast<std::size_t>(size_[0]) * static_cast<std::size_t>(size_[1]) * static_cast<std::size_t>(size_[2]) + 1,
      0);
  visit([&](std::size_t c, std::int32_t) { ++begin_[c + 1]; });
  for (std::size_t c = 1; c < begin_.size(); ++c) begin_[c] += begin_[c - 1];
  list_.resize(begin_.back());
  std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
  visit([&](std::size_t c, std::int32_t t) { list_[next[c]++] = t; });
}

}  // namespace drumsweep

#include "core/geometry/wall_grid.h"

#include <algorithm>

#include "core/simd/targets.h"

namespace drumsweep {

WallGrid::WallGrid(const TriangleMesh& mesh, double cell_size, double reach) : cell_(cell_size), reach_(reach) {
  Eigen::Vector3d low = Eigen::Vector3d::Zero(), high = low;
  for (const Eigen::Vector3d& v : mesh.vertices) {
    low = &v == mesh.vertices.data() ? v : low.cwiseMin(v).eval();
    high = &v == mesh.vertices.data() ? v : high.cwiseMax(v).eval();
  }
  origin_ = low.array() - reach;
  per_quarter_ = static_cast<float>(4 / cell_);
  for (int k = 0; k < 3; ++k) origin_f_[static_cast<std::size_t>(k)] = static_cast<float>(origin_[k]);
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
  for (std::size_t c = 1; c < begin_.size(); ++c) {
    if (begin_[c] > 0) begin_[c] += 2;  // the mask
    begin_[c] += begin_[c - 1];
  }
  list_.resize(begin_.back(), 0);
  std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
  visit([&](std::size_t c, std::int32_t t) {
    if (next[c] == begin_[c]) next[c] += 2;
    list_[next[c]++] = t;
  });
  mark_parts(mesh);
  list_spheres(mesh);
}

void WallGrid::list_spheres(const TriangleMesh& mesh) {
  std::vector<std::array<float, 4>> spheres;
  spheres.reserve(mesh.triangles.size());
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3d &a = mesh.vertices[static_cast<std::size_t>(t[0])],
                          &b = mesh.vertices[static_cast<std::size_t>(t[1])],
                          &c = mesh.vertices[static_cast<std::size_t>(t[2])];
    const Eigen::Vector3d centre = (a.cwiseMin(b).cwiseMin(c) + a.cwiseMax(b).cwiseMax(c)) / 2;
    const double radius =
        std::sqrt(std::max({(a - centre).squaredNorm(), (b - centre).squaredNorm(), (c - centre).squaredNorm()}));
    spheres.push_back({static_cast<float>(centre[0]), static_cast<float>(centre[1]), static_cast<float>(centre[2]),
                       static_cast<float>(radius * 1.001 + 1e-6)});
  }
  spheres_.assign(4 * list_.size() + pack_width, 0);
  for (std::size_t c = 0; c + 1 < begin_.size(); ++c) {
    if (begin_[c] == begin_[c + 1]) continue;
    const std::size_t num = begin_[c + 1] - begin_[c] - 2;
    for (std::size_t l = 0; l < num; ++l)
      for (std::size_t k = 0; k < 4; ++k)
        spheres_[4 * begin_[c] + k * num + l] = spheres[static_cast<std::size_t>(list_[begin_[c] + 2 + l])][k];
  }
}

void WallGrid::mark_parts(const TriangleMesh& mesh) {
  std::size_t c = 0;
  for (int z = 0; z < size_[2]; ++z)
    for (int y = 0; y < size_[1]; ++y)
      for (int x = 0; x < size_[0]; ++x, ++c) {
        if (begin_[c] == begin_[c + 1]) continue;
        const Eigen::Array3d corner = origin_.array() + cell_ * Eigen::Array3d(x, y, z);
        std::uint64_t mask = 0;
        for (std::uint32_t l = begin_[c] + 2; l < begin_[c + 1]; ++l) {
          const auto& [i, j, k] = mesh.triangles[static_cast<std::size_t>(list_[l])];
          const Eigen::Array3d a = mesh.vertices[static_cast<std::size_t>(i)],
                               b = mesh.vertices[static_cast<std::size_t>(j)],
                               d = mesh.vertices[static_cast<std::size_t>(k)];
          // By the triangle's bounding box; the micrometre is for rounding.
          const Eigen::Array3d low = (a.min(b).min(d) - reach_ - 1e-6 - corner) * (4 / cell_),
                               high = (a.max(b).max(d) + reach_ + 1e-6 - corner) * (4 / cell_);
          if (low.maxCoeff() >= 4 || high.minCoeff() < 0) continue;
          const auto part = [](double q) { return std::clamp(static_cast<int>(std::floor(q)), 0, 3); };
          mask |= bits_of({part(low[0]), part(high[0])}, {part(low[1]), part(high[1])}, {part(low[2]), part(high[2])});
        }
        list_[begin_[c]] = static_cast<std::int32_t>(static_cast<std::uint32_t>(mask));
        list_[begin_[c] + 1] = static_cast<std::int32_t>(static_cast<std::uint32_t>(mask >> 32));
      }
}

}  // namespace drumsweep

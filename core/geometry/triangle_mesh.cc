#include "core/geometry/triangle_mesh.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <stdexcept>

namespace drumsweep {

void TriangleMesh::connect() {
  // One entry per directed edge, sorted by its undirected pair of vertices: the two sides of an edge become neighbours.
  struct Edge {
    std::int32_t low, high, triangle, side;
    bool forward;
  };
  std::vector<Edge> edges;
  edges.reserve(3 * triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (int i = 0; i < 3; ++i) {
      const std::int32_t a = triangles[t][static_cast<std::size_t>(i)],
                         b = triangles[t][static_cast<std::size_t>((i + 1) % 3)];
      edges.push_back({std::min(a, b), std::max(a, b), static_cast<std::int32_t>(t), i, a < b});
    }
  std::sort(edges.begin(), edges.end(), [](const Edge& l, const Edge& r) {
    return std::tie(l.low, l.high, l.triangle) < std::tie(r.low, r.high, r.triangle);
  });
  border.assign(triangles.size(), 0b111);
  for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
    const Edge &e = edges[i], &f = edges[i + 1];
    if (e.low != f.low || e.high != f.high) continue;
    const bool third = i + 2 < edges.size() && edges[i + 2].low == e.low && edges[i + 2].high == e.high;
    if (third || e.forward == f.forward)
      throw std::logic_error(
          fmt::format("mesh edge {}-{}: {}", e.low, e.high, third ? "three triangles" : "triangles wound differently"));
    for (const Edge& shared : {e, f})
      border[static_cast<std::size_t>(shared.triangle)] &= static_cast<std::uint8_t>(~(1 << shared.side));
    ++i;
  }

  // Vertices at the ends of border edges, then told to every triangle that has them.
  std::vector<char> at_border(vertices.size(), 0);
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (std::size_t e = 0; e < 3; ++e)
      if ((border[t] >> e & 1) != 0)
        for (const std::size_t end : {e, (e + 1) % 3}) at_border[static_cast<std::size_t>(triangles[t][end])] = 1;
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      if (at_border[static_cast<std::size_t>(triangles[t][k])] != 0)
        border[t] = static_cast<std::uint8_t>(border[t] | (8 << k));
  vertices.shrink_to_fit();
  triangles.shrink_to_fit();
}

ClosestPoint closest_point(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                           const Eigen::Vector3d& c) {
  const Eigen::Vector3d ab = b - a, ac = c - a, ap = p - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return {a, Feature::vertex0};
  const Eigen::Vector3d bp = p - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return {b, Feature::vertex1};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return {a + ab * (d1 / (d1 - d3)), Feature::edge0};
  const Eigen::Vector3d cp = p - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return {c, Feature::vertex2};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return {a + ac * (d2 / (d2 - d6)), Feature::edge2};
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0)
    return {b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6))), Feature::edge1};
  const double scale = 1 / (va + vb + vc);
  return {a + ab * (vb * scale) + ac * (vc * scale), Feature::face};
}

}  // namespace drumsweep

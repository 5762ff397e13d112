/// Triangles with shared vertices and their neighbours across edges.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace drumsweep {

struct TriangleMesh {
  std::vector<Eigen::Vector3d> vertices;               ///< [m]
  std::vector<std::array<std::int32_t, 3>> triangles;  ///< counter-clockwise seen from the side that balls touch
  std::vector<std::uint8_t> border;                    ///< (triangles) bit e: no neighbour across edge (v_e, v_e+1);
                                                       ///< bit 3 + k: vertex k ends a border edge of some triangle

  /// Fills `border` and gives back spare memory.
  /// @throws std::logic_error where three triangles share an edge or two disagree about its direction
  void connect();
};

/// Where a closest point lies on a triangle.
enum class Feature : std::uint8_t { face = 0, edge0, edge1, edge2, vertex0, vertex1, vertex2 };

struct ClosestPoint {
  Eigen::Vector3d point;
  Feature feature;
};

/// Closest point to p on triangle (a, b, c); Ericson, Real-Time Collision Detection (2005), section 5.1.5.
ClosestPoint closest_point(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                           const Eigen::Vector3d& c);

}  // namespace drumsweep

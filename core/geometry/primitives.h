/// Walls of the scenes: plates, boxes, tubes and rings as triangle meshes. Front sides (those that balls touch) are said with each.
#pragma once

#include <functional>

#include "core/geometry/triangle_mesh.h"

namespace drumsweep {

/// Parallelogram; its front is the side from which `corner`, corner + first, corner + second turn counter-clockwise.
void add_plate(TriangleMesh& mesh, const Eigen::Vector3d& corner, const Eigen::Vector3d& first,
               const Eigen::Vector3d& second);

/// Which sides of a box are there.
struct BoxSides {
  bool x_low = true, x_high = true, y_low = true, y_high = true, bottom = true, top = false;
};
/// Box with its front inside.
TriangleMesh box_mesh(const Eigen::Vector3d& low, const Eigen::Vector3d& high, const BoxSides& sides = {});

/// Tube around z from z_low to z_high with front inside, its vertices on the radius minus bump(u, z), u = radius * angle.
/// @param resolution  edge length of its triangles [m]; without bumps they are as long as the tube
TriangleMesh tube_mesh(double radius, double z_low, double z_high, double resolution,
                       const std::function<double(double u, double z)>& bump = {});

/// Flat ring (or disc, with inner radius 0) around z at height z; front up, or down.
void add_ring(TriangleMesh& mesh, double inner_radius, double outer_radius, double z, double resolution, bool front_up);

/// One mesh of two; their edges are not joined.
TriangleMesh joined(const TriangleMesh& a, const TriangleMesh& b);

}  // namespace drumsweep

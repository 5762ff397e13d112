#include "core/geometry/primitives.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace drumsweep {
namespace {

std::int32_t add_vertex(TriangleMesh& mesh, const Eigen::Vector3d& v) {
  mesh.vertices.push_back(v);
  return static_cast<std::int32_t>(mesh.vertices.size()) - 1;
}

int pieces(double length, double resolution, int least) {
  return std::max(least, static_cast<int>(std::ceil(length / resolution - 1e-9)));
}

}  // namespace

void add_plate(TriangleMesh& mesh, const Eigen::Vector3d& corner, const Eigen::Vector3d& first,
               const Eigen::Vector3d& second) {
  const std::int32_t a = add_vertex(mesh, corner), b = add_vertex(mesh, corner + first),
                     c = add_vertex(mesh, corner + first + second), d = add_vertex(mesh, corner + second);
  mesh.triangles.push_back({a, b, c});
  mesh.triangles.push_back({a, c, d});
  mesh.connect();
}

TriangleMesh box_mesh(const Eigen::Vector3d& low, const Eigen::Vector3d& high, const BoxSides& sides) {
  TriangleMesh mesh;
  const Eigen::Vector3d size = high - low, x(size[0], 0, 0), y(0, size[1], 0), z(0, 0, size[2]);
  if (sides.bottom) add_plate(mesh, low, x, y);
  if (sides.top) add_plate(mesh, low + z, y, x);
  if (sides.x_low) add_plate(mesh, low, y, z);
  if (sides.x_high) add_plate(mesh, low + x, z, y);
  if (sides.y_low) add_plate(mesh, low, z, x);
  if (sides.y_high) add_plate(mesh, low + y, x, z);
  return mesh;
}

TriangleMesh tube_mesh(double radius, double z_low, double z_high, double resolution,
                       const std::function<double(double u, double z)>& bump) {
  TriangleMesh mesh;
  const int around = pieces(2 * std::numbers::pi * radius, resolution, 12),
            along = bump ? pieces(z_high - z_low, resolution, 1) : 1;
  for (int k = 0; k <= along; ++k) {
    const double z = z_low + (z_high - z_low) * k / along;
    for (int i = 0; i < around; ++i) {
      const double angle = 2 * std::numbers::pi * i / around;
      const double r = radius - (bump ? std::min(bump(radius * angle, z), 0.5 * radius) : 0.0);
      add_vertex(mesh, {r * std::cos(angle), r * std::sin(angle), z});
    }
  }
  for (int k = 0; k < along; ++k)
    for (int i = 0; i < around; ++i) {
      const std::int32_t a = k * around + i, b = k * around + (i + 1) % around, c = a + around, d = b + around;
      mesh.triangles.push_back({a, c, b});
      mesh.triangles.push_back({b, c, d});
    }
  mesh.connect();
  return mesh;
}

void add_ring(TriangleMesh& mesh, double inner_radius, double outer_radius, double z, double resolution,
              bool front_up) {
  const int around = pieces(2 * std::numbers::pi * outer_radius, resolution, 12);
  const auto first = static_cast<std::int32_t>(mesh.vertices.size());
  const auto circle = [&](double r) {
    for (int i = 0; i < around; ++i) {
      const double angle = 2 * std::numbers::pi * i / around;
      add_vertex(mesh, {r * std::cos(angle), r * std::sin(angle), z});
    }
  };
  const auto triangle = [&](std::int32_t a, std::int32_t b, std::int32_t c) {
    if (front_up)
      mesh.triangles.push_back({a, b, c});
    else
      mesh.triangles.push_back({a, c, b});
  };
  circle(outer_radius);
  if (inner_radius > 0) {
    circle(inner_radius);
    for (int i = 0; i < around; ++i) {
      const std::int32_t a = first + i, b = first + (i + 1) % around, c = a + around, d = b + around;
      triangle(a, b, c);
      triangle(b, d, c);
    }
  } else {
    const std::int32_t centre = add_vertex(mesh, {0, 0, z});
    for (int i = 0; i < around; ++i) triangle(first + i, first + (i + 1) % around, centre);
  }
  mesh.connect();
}

TriangleMesh joined(const TriangleMesh& a, const TriangleMesh& b) {
  TriangleMesh out = a;
  const auto shift = static_cast<std::int32_t>(a.vertices.size());
  out.vertices.insert(out.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const auto& t : b.triangles) out.triangles.push_back({t[0] + shift, t[1] + shift, t[2] + shift});
  out.connect();
  return out;
}

}  // namespace drumsweep

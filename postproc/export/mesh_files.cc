#include "postproc/export/mesh_files.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <bit>
#include <cstdint>
#include <iterator>

namespace drumsweep {
namespace {

template <class T>
void append_little_endian(std::string& out, T value) {
  for (std::size_t i = 0; i < sizeof(T); ++i) out += static_cast<char>((value >> (8 * i)) & 0xFFu);
}

void append(std::string& out, const Eigen::Vector3d& v) {
  for (int k = 0; k < 3; ++k) append_little_endian(out, std::bit_cast<std::uint32_t>(static_cast<float>(v[k])));
}

}  // namespace

std::string stl_file(const TriangleMesh& mesh, const std::string& name) {
  // A header that begins with "solid" would be taken for the text variant.
  std::string out = fmt::format("drumsweep {}, in metres", name);
  out.resize(80, ' ');
  append_little_endian(out, static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3d &a = mesh.vertices[static_cast<std::size_t>(t[0])],
                          &b = mesh.vertices[static_cast<std::size_t>(t[1])],
                          &c = mesh.vertices[static_cast<std::size_t>(t[2])];
    const Eigen::Vector3d normal = (b - a).cross(c - a);
    append(out, normal.squaredNorm() > 0 ? Eigen::Vector3d(normal.normalized()) : Eigen::Vector3d::Zero());
    for (const Eigen::Vector3d* corner : {&a, &b, &c}) append(out, *corner);
    append_little_endian(out, std::uint16_t{0});
  }
  return out;
}

std::string obj_file(const TriangleMesh& mesh, const std::string& name) {
  std::string out = fmt::format("# drumsweep {}, in metres\no {}\n", name, name);
  for (const Eigen::Vector3d& v : mesh.vertices)
    fmt::format_to(std::back_inserter(out), "v {:.9g} {:.9g} {:.9g}\n", v[0], v[1], v[2]);
  for (const auto& t : mesh.triangles)
    fmt::format_to(std::back_inserter(out), "f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
  return out;
}

}  // namespace drumsweep

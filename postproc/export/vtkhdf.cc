#include "postproc/export/vtkhdf.h"

#include <cstdint>

#include "core/io/hdf5_image.h"

namespace drumsweep {
namespace {

constexpr std::uint8_t vtk_vertex = 1, vtk_triangle = 5;

std::vector<double> flat(const std::vector<Eigen::Vector3d>& vectors) {
  std::vector<double> out;
  out.reserve(3 * vectors.size());
  for (const Eigen::Vector3d& v : vectors) out.insert(out.end(), {v[0], v[1], v[2]});
  return out;
}

/// Points and cells that all have `corners` corners.
void write_grid(Hdf5Writer& file, const std::vector<Eigen::Vector3d>& points,
                const std::vector<std::int64_t>& connectivity, std::int64_t corners, std::uint8_t type) {
  const std::vector<std::int64_t> version = {1, 0};
  file.attribute("Version", version, "VTKHDF");
  file.attribute("Type", std::string("UnstructuredGrid"), "VTKHDF");
  const std::int64_t num_ids = static_cast<std::int64_t>(connectivity.size()), num_cells = num_ids / corners;
  const auto number = [&](const char* name, std::int64_t value) {
    file.dataset(std::string("VTKHDF/") + name, std::vector<std::int64_t>{value}, 1, "1", "");
  };
  number("NumberOfPoints", static_cast<std::int64_t>(points.size()));
  number("NumberOfCells", num_cells);
  number("NumberOfConnectivityIds", num_ids);
  std::vector<std::int64_t> offsets;
  for (std::int64_t i = 0; i <= num_cells; ++i) offsets.push_back(i * corners);
  file.dataset("VTKHDF/Points", flat(points), 3, "m", "");
  file.dataset("VTKHDF/Connectivity", connectivity, 1, "1", "");
  file.dataset("VTKHDF/Offsets", offsets, 1, "1", "");
  file.dataset("VTKHDF/Types", std::vector<std::uint8_t>(static_cast<std::size_t>(num_cells), type), 1, "1", "");
}

}  // namespace

std::string vtkhdf_balls(const Balls& balls, const std::vector<float>& landed_s) {
  Hdf5Writer file;
  std::vector<std::int64_t> connectivity, id;
  std::vector<double> diameter, speed;
  for (std::size_t i = 0; i < balls.size(); ++i) {
    connectivity.push_back(static_cast<std::int64_t>(i));
    id.push_back(balls.id[i]);
    diameter.push_back(2 * balls.radius[i]);
    speed.push_back(balls.velocity[i].norm());
  }
  write_grid(file, balls.position, connectivity, 1, vtk_vertex);
  const std::string data = "VTKHDF/PointData/";
  file.dataset(data + "velocity_m_s", flat(balls.velocity), 3, "m s-1", "");
  file.dataset(data + "diameter_m", diameter, 1, "m", "");
  file.dataset(data + "speed_m_s", speed, 1, "m s-1", "");
  file.dataset(data + "id", id, 1, "1", "in the order of feeding");
  file.dataset(data + "slot", balls.exit, 1, "1", "way out: 0 inside, 1... slot, 254 never moves, 255 over the end");
  if (landed_s.empty())
    file.dataset(data + "spin_rad_s", flat(balls.spin), 3, "rad s-1", "");
  else
    file.dataset(data + "landed_s", landed_s, 1, "s", "simulated time of the landing");
  return file.plain();
}

std::string vtkhdf_mesh(const TriangleMesh& mesh) {
  Hdf5Writer file;
  std::vector<std::int64_t> connectivity;
  for (const auto& t : mesh.triangles) connectivity.insert(connectivity.end(), t.begin(), t.end());
  write_grid(file, mesh.vertices, connectivity, 3, vtk_triangle);
  return file.plain();
}

}  // namespace drumsweep

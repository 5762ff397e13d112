#include "core/io/scene_image.h"

#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <map>

#include "core/io/h5md.h"

namespace drumsweep {
namespace {

constexpr const char* scene_kind = "scene";
constexpr int scene_layout = 3;

/// All walls behind one another; `wall` says of each triangle which one it is of.
void write_walls(Hdf5Writer& out, const std::vector<TriangleMesh>& walls) {
  std::vector<double> vertices;
  std::vector<std::uint32_t> triangles, of_wall;
  for (std::size_t w = 0; w < walls.size(); ++w) {
    const auto first = static_cast<std::uint32_t>(vertices.size() / 3);
    for (const Eigen::Vector3d& v : walls[w].vertices) vertices.insert(vertices.end(), {v[0], v[1], v[2]});
    for (const auto& t : walls[w].triangles) {
      for (const std::int32_t corner : t) triangles.push_back(first + static_cast<std::uint32_t>(corner));
      of_wall.push_back(static_cast<std::uint32_t>(w));
    }
  }
  out.dataset("drumsweep/walls/vertices", vertices, 3, "m", "in the room, at the end");
  out.dataset("drumsweep/walls/triangles", triangles, 3, "1",
              "rows of vertices, counter-clockwise seen from the side that balls touch");
  out.dataset("drumsweep/walls/wall", of_wall, 1, "1", "of each triangle");
}

/// One mesh a wall, each with the vertices that it uses.
std::vector<TriangleMesh> read_walls(const Hdf5Reader& file, const std::string& source) {
  const auto vertices = file.doubles("drumsweep/walls/vertices");
  const auto triangles = file.uint32s("drumsweep/walls/triangles"), of_wall = file.uint32s("drumsweep/walls/wall");
  std::vector<TriangleMesh> walls;
  std::map<std::uint32_t, std::int32_t> place;  // of a vertex in its wall
  for (std::size_t i = 0; i < of_wall.size(); ++i) {
    if (walls.empty() || of_wall[i] != of_wall[i - 1]) {
      walls.emplace_back();
      place.clear();
    }
    TriangleMesh& wall = walls.back();
    std::array<std::int32_t, 3> triangle{};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = triangles.at(3 * i + k);
      if (3 * std::size_t{v} + 2 >= vertices.size())
        throw StoreError(fmt::format("{}: damaged: triangle {} has a corner {} that is not there", source, i, v));
      const auto [found, is_new] = place.try_emplace(v, static_cast<std::int32_t>(wall.vertices.size()));
      if (is_new) wall.vertices.emplace_back(vertices[3 * v], vertices[3 * v + 1], vertices[3 * v + 2]);
      triangle[k] = found->second;
    }
    wall.triangles.push_back(triangle);
  }
  return walls;
}

}  // namespace

std::string pack_scene(SceneFile& file, const SceneResult& r) {
  Hdf5Writer out;
  out.attribute("scene", write_scene(file, false));
  out.attribute("program_version", std::string(DRUMSWEEP_VERSION));
  out.attribute("simulated_s", r.simulated_s);
  out.attribute("num_balls", r.num_balls);
  out.attribute("lost", r.lost);
  out.attribute("residual_mean_m_s", r.quality.residual.mean);
  out.attribute("residual_max_m_s", r.quality.residual.max);
  out.attribute("overlap_mean", r.quality.mean_overlap);
  out.attribute("overlap_95", r.quality.overlap_95);
  out.attribute("overlap_max", r.quality.max_overlap);
  out.attribute("force_balance_m_s", r.quality.force_balance);
  out.attribute("state_hash", fmt::format("{:016x}", state_hash(r.state)));
  // Those of one name are rows of one array.
  std::map<std::string, std::vector<double>> rows;
  std::map<std::string, const Observable*> first;
  for (const Observable& o : r.observables) {
    rows[o.name].insert(rows[o.name].end(), {o.position, o.value, o.sigma});
    first.try_emplace(o.name, &o);
  }
  for (const auto& [name, values] : rows)
    out.dataset("drumsweep/observables/" + name, values, 3, first[name]->unit,
                "position [" + first[name]->position_unit + "], value, standard error");
  for (const Series& s : r.series)
    out.dataset("drumsweep/series/" + s.name, s.values, s.columns.size(), "in the columns",
                fmt::format("columns: {}", fmt::join(s.columns, ", ")));
  write_walls(out, r.walls);
  write_h5md(out, r.state.balls, file.physics.material, r.state.num_steps, r.simulated_s);
  return out.seal(scene_kind, scene_layout);
}

StoredScene unpack_scene(const std::string& bytes, const std::string& source) {
  const Hdf5Reader file(bytes, scene_kind, scene_layout, source);
  const SceneFile scene = parse_scene(file.text("scene"), source + ": scene");
  return {scene.name, scene.type, file.real("simulated_s"), read_h5md(file), read_walls(file, source)};
}

}  // namespace drumsweep

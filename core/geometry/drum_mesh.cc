#include "core/geometry/drum_mesh.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace drumsweep {
namespace {

/// A row of vertices around the wall, in the order of growing u; closed rows repeat their first vertex at the end, one
/// turn on.
struct Row {
  std::vector<double> u;
  std::vector<std::int32_t> vertex;
};

struct Builder {
  DrumWall wall;
  double radius, circumference;

  std::int32_t vertex(double u, double s, double at_radius) {
    const double angle = u / radius;
    wall.mesh.vertices.emplace_back(at_radius * std::cos(angle), at_radius * std::sin(angle), s);
    return static_cast<std::int32_t>(wall.mesh.vertices.size()) - 1;
  }
  std::int32_t wall_vertex(double u, double s) {
    const double bump = std::min(wall.texture.height(u, s), 0.5 * radius);
    wall.highest_bump = std::max(wall.highest_bump, bump);
    return vertex(u, s, radius - bump);
  }
  /// Joins two rows by triangles, always advancing on the row that is behind. `below` is uphill of `above`.
  void zip(const Row& below, const Row& above) {
    std::size_t i = 0, j = 0;
    while (i + 1 < below.u.size() || j + 1 < above.u.size()) {
      const bool on_below = i + 1 < below.u.size() && (j + 1 >= above.u.size() || below.u[i + 1] <= above.u[j + 1]);
      // u grows counter-clockwise around +z, so (below, above, next) is counter-clockwise seen from the axis.
      if (on_below)
        wall.mesh.triangles.push_back({below.vertex[i], above.vertex[j], below.vertex[i + 1]});
      else
        wall.mesh.triangles.push_back({below.vertex[i], above.vertex[j], above.vertex[j + 1]});
      (on_below ? i : j) += 1;
    }
  }
  /// The same row with u scaled to [0, 1], for two rows whose ends belong together wherever they are.
  static Row scaled(Row row) {
    const double first = row.u.front(), length = row.u.back() - first;
    for (double& u : row.u) u = (u - first) / length;
    return row;
  }
};

int intervals(double length, double resolution) {
  return std::max(1, static_cast<int>(std::ceil(length / resolution - 1e-9)));
}

}  // namespace

DrumWall build_drum_wall(const Study& study, const OutletConfig& outlet_config) {
  const DrumConfig& drum = study.drum;
  const EffectsConfig& effects = study.effects;
  const OutletShape shape = outlet_shape(drum, outlet_config, effects.outlet_coating_m);
  Builder build{DrumWall{}, shape.radius, shape.circumference()};
  build.wall.outlet = shape;
  Texture& texture = build.wall.texture;
  texture.add(drum.texture, effects.texture_height_scale, shape.circumference(), -drum.length_m, 0, study.seed,
              Purpose::texture_drum);
  texture.add(drum.texture, effects.texture_height_scale, shape.circumference(), 0, shape.length,
              replicate_seed(study.seed, study.record.replicate), Purpose::texture_outlet);
  texture.add_coating(-drum.length_m, effects.drum_coating_m);
  if (effects.drum_coating_m > 0 || effects.outlet_coating_m > 0) texture.add_coating(0, effects.outlet_coating_m);
  const double resolution = drum.mesh_resolution_m;

  // Drum: closed rings of equally spaced vertices, from the upper end to one row short of the outlet.
  const int num_around = intervals(shape.circumference(), resolution), num_rows = intervals(drum.length_m, resolution);
  const auto ring = [&](auto&& make_vertex, int count) {
    Row row;
    for (int i = 0; i < count; ++i) {
      row.u.push_back(shape.circumference() * i / count);
      row.vertex.push_back(make_vertex(row.u.back()));
    }
    row.u.push_back(shape.circumference());
    row.vertex.push_back(row.vertex.front());
    return row;
  };
  std::vector<Row> rows;
  for (int r = 0; r < num_rows; ++r) {
    const double s = -drum.length_m + drum.length_m * r / num_rows;
    rows.push_back(ring([&](double u) { return build.wall_vertex(u, s); }, num_around));
  }

  // Plate at the upper end: rings that shrink to a point. It is flat, so its triangles may be larger.
  const double plate_resolution = std::max(resolution, 0.1 * shape.radius);
  const int num_rings = intervals(shape.radius, plate_resolution);
  Row outer = rows.front();
  for (int r = 1; r < num_rings; ++r) {
    // Inside the bumps of the ring that it joins.
    const double at = (shape.radius - build.wall.highest_bump) * (num_rings - r) / num_rings;
    const Row inner = ring([&](double u) { return build.vertex(u, -drum.length_m, at); },
                           std::max(6, intervals(2 * std::numbers::pi * at, plate_resolution)));
    build.zip(inner, outer);
    outer = inner;
  }
  const std::int32_t centre = build.vertex(0, -drum.length_m, 0);
  for (std::size_t i = 0; i + 1 < outer.vertex.size(); ++i)
    build.wall.mesh.triangles.push_back({centre, outer.vertex[i], outer.vertex[i + 1]});

  // Outlet: between two slots a finger of its own, each row from slot edge to slot edge.
  const int num_outlet_rows = intervals(shape.length, resolution);
  std::vector<std::vector<Row>> fingers(static_cast<std::size_t>(shape.num_slots));
  for (int k = 0; k < shape.num_slots; ++k)
    for (int r = 0; r <= num_outlet_rows; ++r) {
      const double s = shape.length * r / num_outlet_rows;
      const double from = shape.centre(k, s) + 0.5 * shape.width(s), to = shape.centre(k + 1, s) - 0.5 * shape.width(s);
      const int count = intervals(to - from, resolution);
      Row row;
      for (int i = 0; i <= count; ++i) {
        row.u.push_back(i == count ? to : from + (to - from) * i / count);
        row.vertex.push_back(build.wall_vertex(row.u.back(), s));
      }
      fingers[static_cast<std::size_t>(k)].push_back(row);
    }

  // The ring where both meet: first rows of the fingers, and the base of each slot filled in. It begins in slot 0.
  Row joint;
  const auto base_of_slot = [&](double from, double to, bool with_begin) {
    const int count = intervals(to - from, resolution);
    for (int i = with_begin ? 0 : 1; i < count; ++i) {
      joint.u.push_back(from + (to - from) * i / count);
      joint.vertex.push_back(build.wall_vertex(joint.u.back(), 0));
    }
  };
  base_of_slot(0, 0.5 * shape.base_width, true);
  for (int k = 0; k < shape.num_slots; ++k) {
    const Row& first = fingers[static_cast<std::size_t>(k)].front();
    joint.u.insert(joint.u.end(), first.u.begin(), first.u.end());
    joint.vertex.insert(joint.vertex.end(), first.vertex.begin(), first.vertex.end());
    const double next = shape.centre(k + 1, 0);
    base_of_slot(first.u.back(), k + 1 < shape.num_slots ? next + 0.5 * shape.base_width : next, false);
  }
  joint.u.push_back(shape.circumference());
  joint.vertex.push_back(joint.vertex.front());
  rows.push_back(joint);

  for (std::size_t r = 0; r + 1 < rows.size(); ++r) build.zip(rows[r], rows[r + 1]);
  for (const std::vector<Row>& finger : fingers)
    for (std::size_t r = 0; r + 1 < finger.size(); ++r)
      build.zip(Builder::scaled(finger[r]), Builder::scaled(finger[r + 1]));

  build.wall.mesh.connect();
  return std::move(build.wall);
}

}  // namespace drumsweep

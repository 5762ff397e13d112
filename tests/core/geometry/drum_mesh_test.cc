#include "core/geometry/drum_mesh.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <map>
#include <numbers>

#include "core/config/schema.h"
#include "support/small_drum.h"

namespace drumsweep {
namespace {

Study lab() {
  Study study;
  study.outlet.opening_angle_rad = 0.2;
  return study;
}

Study smooth(Study study) {
  study.drum.texture.density_1_m2 = 0;
  return study;
}

TEST(DrumMesh, borders_are_the_slots_and_the_open_end_and_nothing_else) {
  const Study study = small_drum();
  const DrumWall wall = build_drum_wall(study, study.outlet);
  std::size_t borders = 0;
  for (std::size_t t = 0; t < wall.mesh.triangles.size(); ++t)
    for (std::size_t e = 0; e < 3; ++e) {
      if ((wall.mesh.border[t] >> e & 1) == 0) continue;
      ++borders;
      const auto& a = wall.mesh.vertices[static_cast<std::size_t>(wall.mesh.triangles[t][e])];
      const auto& b = wall.mesh.vertices[static_cast<std::size_t>(wall.mesh.triangles[t][(e + 1) % 3])];
      const bool open_end = a[2] > study.outlet.length_m - 1e-12 && b[2] > study.outlet.length_m - 1e-12;
      const auto edge_of_slot = [&](const Eigen::Vector3d& v) {
        const auto near = wall.outlet.nearest_slot(v[2], std::atan2(v[1], v[0]) * wall.outlet.radius);
        return v[2] > -1e-12 && (std::abs(near.beyond) < 1e-12 || (v[2] < 1e-12 && near.beyond < 0));
      };
      EXPECT_TRUE(open_end || (edge_of_slot(a) && edge_of_slot(b))) << a.transpose() << " | " << b.transpose();
    }
  EXPECT_GT(borders, 50u);
}

TEST(DrumMesh, a_tenth_of_a_millimetre_of_slot_width_is_another_mesh_and_lies_exactly_there) {
  Study study = lab();
  const DrumWall one = build_drum_wall(study, study.outlet);
  study.outlet.base_width_m += 1e-4;
  const DrumWall two = build_drum_wall(study, study.outlet);
  // The vertex on the first slot's right edge where the outlet ends.
  const auto edge = [&](const DrumWall& wall) {
    const double u = wall.outlet.centre(0, wall.outlet.length) + 0.5 * wall.outlet.width(wall.outlet.length);
    double least = 1;
    for (const auto& v : wall.mesh.vertices)
      if (std::abs(v[2] - wall.outlet.length) < 1e-12)
        least = std::min(least, std::abs(std::remainder(std::atan2(v[1], v[0]) * wall.outlet.radius - u,
                                                        wall.outlet.circumference())));
    return least;
  };
  EXPECT_LT(edge(one), 1e-12);
  EXPECT_LT(edge(two), 1e-12);
  EXPECT_NEAR(two.outlet.width(0.3) - one.outlet.width(0.3), 1e-4, 1e-15);
}

TEST(DrumMesh, the_drum_is_the_same_for_all_outlets_but_for_the_row_that_joins_them) {
  Study study = lab();
  const DrumWall one = build_drum_wall(study, study.outlet);
  study.outlet.base_width_m = 0.1;
  const DrumWall two = build_drum_wall(study, study.outlet);
  std::size_t same = 0, drum = 0;
  for (std::size_t i = 0; i < std::min(one.mesh.vertices.size(), two.mesh.vertices.size()); ++i) {
    if (one.mesh.vertices[i][2] >= 0) continue;
    ++drum;
    same += one.mesh.vertices[i] == two.mesh.vertices[i] ? 1 : 0;
  }
  EXPECT_EQ(same, drum);
}

TEST(DrumMesh, area_of_the_smooth_wall_is_that_of_cylinder_and_plate_less_the_slots) {
  const Study study = smooth(lab());
  const DrumWall wall = build_drum_wall(study, study.outlet);
  double area = 0;
  for (const auto& t : wall.mesh.triangles) {
    const auto& a = wall.mesh.vertices[static_cast<std::size_t>(t[0])];
    area += 0.5 * (wall.mesh.vertices[static_cast<std::size_t>(t[1])] - a)
                      .cross(wall.mesh.vertices[static_cast<std::size_t>(t[2])] - a)
                      .norm();
  }
  const double r = 0.375, slots = 3 * 0.75 * 0.5 * (wall.outlet.width(0) + wall.outlet.width(0.75));
  const double expected = 2 * std::numbers::pi * r * (2.5 + 0.75) - slots + std::numbers::pi * r * r;
  EXPECT_NEAR(area, expected, 1e-3 * expected);
}

TEST(DrumMesh, triangles_face_the_inside_and_none_is_degenerate) {
  for (const double rad : {0.0, 0.2, 0.6}) {
    Study study = lab();
    study.outlet.opening_angle_rad = rad;
    study.outlet.base_width_m = rad == 0.6 ? 0.2 : 0.01;
    const DrumWall wall = build_drum_wall(smooth(study), study.outlet);
    const Eigen::Vector3d middle(0, 0, -1.25);
    for (const auto& t : wall.mesh.triangles) {
      const auto &a = wall.mesh.vertices[static_cast<std::size_t>(t[0])],
                 &b = wall.mesh.vertices[static_cast<std::size_t>(t[1])],
                 &c = wall.mesh.vertices[static_cast<std::size_t>(t[2])];
      const Eigen::Vector3d normal = (b - a).cross(c - a);
      EXPECT_GT(normal.norm(), 1e-8);
      EXPECT_GT(normal.dot(Eigen::Vector3d(0, 0, a[2] < -2.4999 ? -1.25 : a[2]) - a + Eigen::Vector3d(0, 0, 1e-9)), 0);
    }
  }
}

TEST(DrumMesh, the_outlet_of_s1_point_iv_leaves_fingers_of_the_width_that_algebra_gives) {
  Study study = lab();
  study.outlet.opening_angle_rad = 0.6;
  study.outlet.base_width_m = 0.2;
  validate(study);
  const OutletShape shape = outlet_shape(study.drum, study.outlet, 0);
  EXPECT_NEAR(shape.width(0.75), 0.664, 5e-4);
  EXPECT_NEAR(shape.circumference() / 3, 0.785, 5e-4);
  study.outlet.base_width_m = 0.33;
  EXPECT_THROW(validate(study), InputError);
}

TEST(DrumMesh, texture_is_as_dense_and_high_as_asked) {
  const Study study = lab();
  const DrumWall wall = build_drum_wall(study, study.outlet);
  EXPECT_NEAR(static_cast<double>(wall.texture.num_bumps()), 700 * wall.outlet.circumference() * 3.25, 2);
  EXPECT_GT(wall.highest_bump, 0.008);  // bumps add up where they meet
  EXPECT_LT(wall.highest_bump, 0.05);
}

TEST(DrumMesh, the_end_plate_faces_the_drum_however_high_the_bumps) {
  for (const std::int64_t seed : {1, 2, 3}) {
    Study study = small_drum();
    study.seed = seed;
    study.drum.diameter_m = 0.2;
    study.drum.texture = TextureConfig{};
    const DrumWall wall = build_drum_wall(study, study.outlet);
    for (const auto& t : wall.mesh.triangles) {
      const auto &a = wall.mesh.vertices[static_cast<std::size_t>(t[0])],
                 &b = wall.mesh.vertices[static_cast<std::size_t>(t[1])],
                 &c = wall.mesh.vertices[static_cast<std::size_t>(t[2])];
      if (std::max({a[2], b[2], c[2]}) > -study.drum.length_m + 1e-9) continue;
      EXPECT_GT((b - a).cross(c - a)[2], 1e-9) << "seed " << seed;
    }
  }
}

}  // namespace
}  // namespace drumsweep

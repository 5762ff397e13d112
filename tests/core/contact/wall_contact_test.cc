#include "core/contact/wall_contact.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numeric>

#include "core/geometry/drum_mesh.h"
#include "core/geometry/random.h"
#include "support/small_drum.h"

namespace drumsweep {
namespace {

/// Strip of right triangles over [0, n] x [0, 1] cells; `height` gives z.
template <class Height>
TriangleMesh surface(int n, double cell, Height&& height) {
  TriangleMesh mesh;
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= n; ++j) mesh.vertices.emplace_back(i * cell, j * cell, height(i * cell, j * cell));
  const auto v = [&](int i, int j) { return i * (n + 1) + j; };
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      mesh.triangles.push_back({v(i, j), v(i + 1, j), v(i + 1, j + 1)});
      mesh.triangles.push_back({v(i, j), v(i + 1, j + 1), v(i, j + 1)});
    }
  mesh.connect();
  return mesh;
}

std::vector<std::int32_t> all(const TriangleMesh& mesh) {
  std::vector<std::int32_t> list(mesh.triangles.size());
  std::iota(list.begin(), list.end(), 0);
  return list;
}

TEST(WallContact, a_ball_over_a_flat_wall_has_one_contact_wherever_it_is) {
  const TriangleMesh mesh = surface(6, 0.01, [](double, double) { return 0.0; });
  const auto triangles = all(mesh);
  std::vector<WallContact> contacts;
  // On faces, exactly on edges and exactly on vertices, and along lines that cross all of them.
  for (int i = 0; i <= 400; ++i)
    for (const double y : {0.02, 0.025, 0.03, 0.0317}) {
      const double x = 0.02 + 0.02 * i / 400;
      wall_contacts(mesh, triangles, {x, y, 0.0049}, 0.006, true, contacts);
      ASSERT_EQ(contacts.size(), 1u) << x << " " << y;
      EXPECT_NEAR(contacts[0].distance, 0.0049, 1e-12);
      EXPECT_NEAR(contacts[0].normal[2], 1, 1e-9);
    }
}

TEST(WallContact, a_ball_rolled_over_a_ridge_feels_one_contact_and_a_distance_without_jumps) {
  const TriangleMesh mesh = surface(6, 0.01, [](double x, double) { return 0.01 - 0.5 * std::abs(x - 0.03); });
  const auto triangles = all(mesh);
  std::vector<WallContact> contacts;
  double before = -1;
  for (int i = 0; i <= 2000; ++i) {
    // The centre moves on a level line; the distance to the ridge is smooth.
    const Eigen::Vector3d centre(0.02 + 0.02 * i / 2000, 0.0303, 0.0149);
    wall_contacts(mesh, triangles, centre, 0.01, true, contacts);
    ASSERT_EQ(contacts.size(), 1u) << i;
    if (before >= 0) {
      EXPECT_LT(std::abs(contacts[0].distance - before), 2e-5) << i;
    }
    before = contacts[0].distance;
  }
}

TEST(WallContact, a_ball_in_a_groove_touches_both_sides) {
  const TriangleMesh mesh = surface(6, 0.01, [](double x, double) { return std::abs(x - 0.03); });
  std::vector<WallContact> contacts;
  wall_contacts(mesh, all(mesh), {0.03, 0.0303, 0.006}, 0.006, true, contacts);
  ASSERT_EQ(contacts.size(), 2u);
  EXPECT_NEAR(contacts[0].distance, 0.006 / std::sqrt(2.0), 1e-9);
  EXPECT_NEAR(contacts[1].distance, 0.006 / std::sqrt(2.0), 1e-9);
}

TEST(WallContact, on_a_bumpy_wall_the_deepest_overlap_never_jumps) {
  const TriangleMesh mesh =
      surface(8, 0.01, [](double x, double y) { return 0.003 * std::sin(180 * x) * std::cos(140 * y); });
  const auto triangles = all(mesh);
  std::vector<WallContact> contacts;
  for (const double y : {0.031, 0.04, 0.0455}) {
    double before = -1;
    for (int i = 0; i <= 4000; ++i) {
      const Eigen::Vector3d centre(0.02 + 0.04 * i / 4000, y, 0.008);
      wall_contacts(mesh, triangles, centre, 0.02, true, contacts);
      ASSERT_FALSE(contacts.empty());
      // The step of the centre bounds the change of the least distance.
      if (before >= 0) {
        ASSERT_LE(std::abs(contacts[0].distance - before), 1.0001e-5) << y << " " << i;
      }
      before = contacts[0].distance;
    }
  }
}

TEST(WallContact, behind_a_wall_a_ball_is_pushed_back_or_away_as_it_belongs) {
  const TriangleMesh mesh = surface(6, 0.01, [](double, double) { return 0.0; });
  std::vector<WallContact> contacts;
  wall_contacts(mesh, all(mesh), {0.031, 0.033, -0.002}, 0.006, true, contacts);
  ASSERT_EQ(contacts.size(), 1u);
  EXPECT_NEAR(contacts[0].distance, -0.002, 1e-12);
  EXPECT_NEAR(contacts[0].normal[2], 1, 1e-12);
  wall_contacts(mesh, all(mesh), {0.031, 0.033, -0.002}, 0.006, false, contacts);
  ASSERT_EQ(contacts.size(), 1u);
  EXPECT_NEAR(contacts[0].distance, 0.002, 1e-12);
  EXPECT_NEAR(contacts[0].normal[2], -1, 1e-12);
}

TEST(WallContact, least_distance_equals_brute_force_over_the_drum) {
  const Study study = small_drum();
  const DrumWall wall = build_drum_wall(study, study.outlet);
  const auto triangles = all(wall.mesh);
  std::vector<WallContact> contacts;
  for (std::uint64_t i = 0; i < 200; ++i) {
    const auto r = uniform4(7, Purpose::fill, i);
    const double angle = 2 * M_PI * r[0], radius = 0.100 + 0.015 * r[1], s = -0.20 + 0.32 * r[2];
    const Eigen::Vector3d centre(radius * std::cos(angle), radius * std::sin(angle), s);
    double least = 1;
    for (const auto& t : wall.mesh.triangles)
      least = std::min(least, (closest_point(centre, wall.mesh.vertices[static_cast<std::size_t>(t[0])],
                                             wall.mesh.vertices[static_cast<std::size_t>(t[1])],
                                             wall.mesh.vertices[static_cast<std::size_t>(t[2])])
                                   .point -
                               centre)
                                  .norm());
    wall_contacts(wall.mesh, triangles, centre, 0.02, false, contacts);
    if (least <= 0.02) {
      ASSERT_FALSE(contacts.empty()) << i;
      EXPECT_NEAR(contacts[0].distance, least, 1e-12) << i;
    } else {
      EXPECT_TRUE(contacts.empty()) << i;
    }
  }
}

TEST(WallContact, what_is_remembered_of_far_triangles_changes_no_contact) {
  const TriangleMesh mesh =
      surface(12, 0.004, [](double x, double y) { return 0.002 * std::sin(300 * x) * std::cos(200 * y); });
  const auto triangles = all(mesh);
  std::vector<WallContact> fresh, remembering;
  for (std::uint64_t walk = 0; walk < 20; ++walk) {
    std::vector<float> reached_after(triangles.size(), 0.0f);
    Eigen::Vector3d centre(0.02, 0.025, 0.012);
    double travelled = 0;
    for (std::uint64_t step = 0; step < 200; ++step) {
      const auto r = uniform4(9 + walk, Purpose::fill, step);
      const double range = 0.005 + 0.003 * r[3];
      wall_contacts(mesh, triangles, centre, range, true, fresh);
      wall_contacts(mesh, triangles, centre, range, true, remembering, {reached_after, travelled});
      ASSERT_EQ(fresh.size(), remembering.size()) << walk << " " << step;
      for (std::size_t i = 0; i < fresh.size(); ++i) {
        EXPECT_EQ(fresh[i].distance, remembering[i].distance);
        EXPECT_EQ(fresh[i].normal, remembering[i].normal);
      }
      const Eigen::Vector3d way = 0.002 * Eigen::Vector3d(r[0] - 0.5, r[1] - 0.5, r[2] - 0.52);
      travelled += way.norm();
      centre += way;
    }
  }
}

TEST(WallContact, in_front_of_a_ridge_sharper_than_a_right_angle_no_face_claims_the_ball_is_behind) {
  const TriangleMesh mesh = surface(6, 0.01, [](double x, double) { return 0.06 - 2 * std::abs(x - 0.03); });
  const auto triangles = all(mesh);
  std::vector<WallContact> contacts;
  for (int i = 0; i <= 160; ++i) {
    const Eigen::Vector3d centre(0.022 + 0.016 * i / 160, 0.0303, 0.064);
    wall_contacts(mesh, triangles, centre, 0.02, true, contacts);
    for (const WallContact& c : contacts) EXPECT_GT(c.distance, 0) << i;
  }
}

}  // namespace
}  // namespace drumsweep

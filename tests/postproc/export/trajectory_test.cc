#include "postproc/export/trajectory.h"

#include <gtest/gtest.h>
#include <hdf5.h>

#include <regex>

#include "postproc/export/vtkhdf.h"
#include "support/open_image.h"

namespace drumsweep {
namespace {

Balls some_balls(std::uint32_t num) {
  Balls balls;
  for (std::uint32_t i = 0; i < num; ++i) {
    balls.add({0.5 * i, 1, 2}, 0.25, 10 + i);
    balls.velocity.back() = {3, 0, 4};
    balls.exit.back() = static_cast<std::uint8_t>(i);
  }
  return balls;
}

using Shape = std::vector<hsize_t>;

TEST(Trajectory, a_varying_number_of_balls_is_filled_up_as_h5md_asks) {
  Trajectory trajectory;
  trajectory.add(1.0, some_balls(2));
  trajectory.add(1.5, some_balls(3));
  const OpenImage image(trajectory.h5());
  const std::string balls = "/particles/balls/";
  EXPECT_EQ(image.shape(balls + "position/value"), (Shape{2, 3, 3}));
  EXPECT_EQ(image.shape(balls + "diameter/value"), (Shape{2, 3}));
  EXPECT_EQ(image.values(balls + "id/value"), (std::vector<double>{10, 11, -1, 10, 11, 12}));
  EXPECT_EQ(image.values(balls + "slot/value"), (std::vector<double>{0, 1, 0, 0, 1, 2}));
  EXPECT_EQ(image.values(balls + "speed/value"), (std::vector<double>{5, 5, 0, 5, 5, 5}));
  EXPECT_EQ(image.values(balls + "speed/time"), (std::vector<double>{1.0, 1.5}));
  EXPECT_EQ(image.values(balls + "position/value")[3 * 5], 1.0);
}

/// Every array that the XDMF text names is there with the shape that it says, and every frame selects its own rows.
TEST(Trajectory, the_xdmf_text_fits_its_hdf5_file) {
  Trajectory trajectory;
  trajectory.add(1.0, some_balls(2));
  trajectory.add(1.5, some_balls(3));
  const OpenImage image(trajectory.h5());
  const std::string xmf = trajectory.xmf("balls.h5");
  const std::regex item(
      "Dimensions=\"([0-9 ]+)\" NumberType=\"[A-Za-z]+\" Precision=\"[0-9]\" "
      "Format=\"HDF\">balls.h5:([^<]+)<");
  std::size_t num = 0;
  for (std::sregex_iterator at(xmf.begin(), xmf.end(), item), end; at != end; ++at, ++num) {
    std::string shape;
    for (const hsize_t n : image.shape((*at)[2])) shape += (shape.empty() ? "" : " ") + std::to_string(n);
    EXPECT_EQ(shape, (*at)[1].str()) << (*at)[2];
  }
  EXPECT_EQ(num, 2u * 7u);
  for (const char* word : {"Value=\"1\"", "Value=\"1.5\"", "NumberOfElements=\"2\"", "NumberOfElements=\"3\"",
                           ">0 0 0 1 1 1 1 2 3<", ">1 0 0 1 1 1 1 3 3<", "velocity_m_s", "diameter_m", "spin_rad_s"})
    EXPECT_NE(xmf.find(word), std::string::npos) << word;
}

TEST(Trajectory, walls_have_their_triangles_once_and_vertices_in_every_frame) {
  WallTrajectory wall;
  TriangleMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}, {}};
  wall.add(0, mesh);
  mesh.vertices[1][0] = 2;
  wall.add(1, mesh);
  const OpenImage image(wall.h5());
  EXPECT_EQ(image.shape("/triangles"), (Shape{1, 3}));
  EXPECT_EQ(image.values("/vertices/00000")[3], 1.0);
  EXPECT_EQ(image.values("/vertices/00001")[3], 2.0);
  EXPECT_NE(wall.xmf("w.h5").find("w.h5:/vertices/00001"), std::string::npos);
  mesh.triangles.push_back({0, 1, 2});
  EXPECT_THROW(wall.add(2, mesh), std::logic_error);
}

TEST(Landings, ride_on_the_belt_from_their_moment_on) {
  const std::vector<Landing> landings = {{1.0, 0.1, 0.2, 0, 0, -1, 0.005f, 3, 2},
                                         {2.0, 0.1, 0.3, 0, 0, -1, 0.005f, 4, 255}};
  std::vector<float> landed;
  EXPECT_EQ(landed_balls(landings, 0.5, 0.25, -0.3, landed).size(), 0u);
  const Balls balls = landed_balls(landings, 1.8, 0.25, -0.3, landed);
  ASSERT_EQ(balls.size(), 1u);
  EXPECT_NEAR((balls.position[0] - Eigen::Vector3d(0.3, 0.2, -0.295)).norm(), 0, 1e-9);
  EXPECT_EQ(landed, std::vector<float>{1.0f});
  EXPECT_EQ(balls.exit[0], 2);
}

TEST(Vtkhdf, has_what_version_1_0_asks_for) {
  {
    const OpenImage balls(vtkhdf_balls(some_balls(3)));
    EXPECT_EQ(balls.shape("/VTKHDF/Points"), (Shape{3, 3}));
    EXPECT_EQ(balls.values("/VTKHDF/Offsets"), (std::vector<double>{0, 1, 2, 3}));
    EXPECT_EQ(balls.values("/VTKHDF/Types"), (std::vector<double>{1, 1, 1}));
    EXPECT_EQ(balls.values("/VTKHDF/NumberOfPoints"), std::vector<double>{3});
    EXPECT_EQ(balls.values("/VTKHDF/PointData/diameter_m")[0], 0.5);
  }
  const OpenImage mesh(vtkhdf_mesh({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}, {{0, 1, 2}, {2, 1, 3}}, {}}));
  EXPECT_EQ(mesh.values("/VTKHDF/Connectivity"), (std::vector<double>{0, 1, 2, 2, 1, 3}));
  EXPECT_EQ(mesh.values("/VTKHDF/NumberOfCells"), std::vector<double>{2});
  EXPECT_EQ(mesh.values("/VTKHDF/Types"), (std::vector<double>{5, 5}));
}

}  // namespace
}  // namespace drumsweep

#include "postproc/export/mesh_files.h"

#include <gtest/gtest.h>

#include <cstring>
#include <sstream>

namespace drumsweep {
namespace {

/// Front up.
TriangleMesh square() { return {{{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}}, {{0, 1, 2}, {0, 2, 3}}, {}}; }

template <class T>
T at(const std::string& bytes, std::size_t place) {
  T value{};
  std::memcpy(&value, bytes.data() + place, sizeof(T));
  return value;
}

TEST(Stl, is_binary_with_normals_to_the_front) {
  const std::string stl = stl_file(square(), "drum");
  ASSERT_EQ(stl.size(), 84u + 2 * 50);
  EXPECT_NE(stl.rfind("solid", 0), 0u);
  EXPECT_EQ(at<std::uint32_t>(stl, 80), 2u);
  for (const std::size_t triangle : {84u, 134u}) {
    EXPECT_EQ(at<float>(stl, triangle), 0.0f);
    EXPECT_EQ(at<float>(stl, triangle + 8), 1.0f);
  }
  EXPECT_EQ(at<float>(stl, 84 + 12 + 12), 2.0f);  // x of the second corner, in metres
}

TEST(Obj, shares_vertices_and_counts_from_one) {
  std::istringstream lines(obj_file(square(), "drum"));
  std::size_t vertices = 0, faces = 0;
  for (std::string line; std::getline(lines, line);) {
    vertices += line.rfind("v ", 0) == 0;
    faces += line.rfind("f ", 0) == 0;
    if (faces == 1 && line.rfind("f ", 0) == 0) {
      EXPECT_EQ(line, "f 1 2 3");
    }
  }
  EXPECT_EQ(vertices, 4u);
  EXPECT_EQ(faces, 2u);
}

}  // namespace
}  // namespace drumsweep

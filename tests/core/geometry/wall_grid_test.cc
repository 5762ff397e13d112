#include "core/geometry/wall_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/geometry/drum_mesh.h"
#include "core/geometry/random.h"
#include "support/small_drum.h"

namespace drumsweep {
namespace {

TEST(WallGrid, no_triangle_within_reach_is_missed) {
  const Study study = small_drum();
  const DrumWall wall = build_drum_wall(study, study.outlet);
  const double reach = 0.0075;
  const WallGrid grid(wall.mesh, 0.02, reach);
  for (std::uint64_t i = 0; i < 300; ++i) {
    const auto r = uniform4(11, Purpose::fill, i);
    const Eigen::Vector3d p(0.26 * (r[0] - 0.5), 0.26 * (r[1] - 0.5), -0.22 + 0.36 * r[2]);
    const Eigen::Vector3d q = p + 0.03 * Eigen::Vector3d(r[3] - 0.5, r[0] - 0.5, 0.3);
    std::set<std::int32_t> on_the_way;
    const auto list = [&](const Eigen::Vector3d& low, const Eigen::Vector3d& high, std::set<std::int32_t>& out) {
      grid.near(low.cast<float>(), high.cast<float>(), [&](const WallGrid::Triangles& cell) {
        out.insert(cell.index.begin(), cell.index.end());
        EXPECT_TRUE(std::is_sorted(cell.index.begin(), cell.index.end()));
      });
    };
    std::set<std::int32_t> listed;
    list(p, p, listed);
    list(p.cwiseMin(q), p.cwiseMax(q), on_the_way);
    for (std::size_t t = 0; t < wall.mesh.triangles.size(); ++t) {
      const auto& [a, b, c] = wall.mesh.triangles[t];
      const auto distance = [&](const Eigen::Vector3d& x) {
        return (closest_point(x, wall.mesh.vertices[static_cast<std::size_t>(a)],
                              wall.mesh.vertices[static_cast<std::size_t>(b)],
                              wall.mesh.vertices[static_cast<std::size_t>(c)])
                    .point -
                x)
            .norm();
      };
      const auto id = static_cast<std::int32_t>(t);
      if (distance(p) < reach) {
        EXPECT_TRUE(listed.count(id));
      }
      for (const double along : {0.0, 0.4, 1.0})
        if (distance(p + along * (q - p)) < reach) {
          EXPECT_TRUE(on_the_way.count(id));
        }
    }
  }
}

}  // namespace
}  // namespace drumsweep

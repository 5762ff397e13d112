#include "core/io/scene_image.h"

#include <gtest/gtest.h>

#include "core/io/snapshot.h"
#include "support/scene_text.h"
#include "support/small_drum.h"

namespace drumsweep {
namespace {

TEST(SceneImage, balls_and_walls_come_back_as_they_were) {
  SceneFile file = parse_scene("name = \"a drop\"\n[scene]\ntype = \"drop\"\n", "scene.toml");
  SceneResult result = file.scene->run(file.physics, {});
  ASSERT_FALSE(result.walls.empty());
  // A second wall, to be told from the first.
  result.walls.push_back({{{0, 0, 1}, {1, 0, 1}, {0, 1, 1}}, {{0, 1, 2}}, {}});
  const StoredScene stored = unpack_scene(pack_scene(file, result), "drop.h5");
  EXPECT_EQ(stored.name, "a drop");
  EXPECT_EQ(stored.type, "drop");
  EXPECT_EQ(stored.time_s, result.simulated_s);
  ASSERT_EQ(stored.balls.size(), result.state.balls.size());
  EXPECT_EQ(stored.balls.position, result.state.balls.position);
  EXPECT_EQ(stored.balls.velocity, result.state.balls.velocity);
  EXPECT_EQ(stored.balls.id, result.state.balls.id);
  ASSERT_EQ(stored.walls.size(), result.walls.size());
  for (std::size_t w = 0; w < stored.walls.size(); ++w) {
    const TriangleMesh &a = stored.walls[w], &b = result.walls[w];
    ASSERT_EQ(a.triangles.size(), b.triangles.size());
    for (std::size_t i = 0; i < a.triangles.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k)
        EXPECT_EQ(a.vertices[static_cast<std::size_t>(a.triangles[i][k])],
                  b.vertices[static_cast<std::size_t>(b.triangles[i][k])]);
  }
}

TEST(SceneImage, other_files_are_refused_by_their_kind) {
  const std::string drum = pack_warm_state(small_drum(), {});
  EXPECT_THROW(unpack_scene(drum, "warm_state.h5"), StoreError);
  EXPECT_THROW(unpack_scene("no file of ours", "x.h5"), StoreError);
}

TEST(DrumMoment, a_warm_state_has_the_warm_ups_outlet_a_checkpoint_that_of_its_design) {
  Study study = small_drum();
  study.warmup.base_width_m = 0.02;
  WarmState warm;
  warm.state.balls.add({0.1, 0.2, 0.3}, 0.005, 7);
  EXPECT_EQ(unpack_drum_moment(pack_warm_state(study, warm), "w").outlet.base_width_m, 0.02);

  DesignProgress progress;
  progress.state = warm.state;
  const Design design{{"outlet.base_width_m", 0.035}};
  const DrumMoment moment = unpack_drum_moment(pack_progress(study, "id", design, progress, 1), "p");
  EXPECT_EQ(moment.outlet.base_width_m, 0.035);
  EXPECT_EQ(moment.study.outlet.base_width_m, 0.035);
  ASSERT_EQ(moment.state.balls.size(), 1u);
  EXPECT_EQ(moment.state.balls.id[0], 7u);
}

}  // namespace
}  // namespace drumsweep

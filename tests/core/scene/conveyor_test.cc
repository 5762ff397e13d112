#include "core/scene/conveyor.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/scene/scene_value.h"
#include "support/complaint.h"

namespace drumsweep {
namespace {

// A narrow and fast strip with about the bed of the lab drum's belt.
SceneFile conveyor(const std::string& keys, const std::string& tables = "") {
  return parse_scene(
      "[scene]\ntype = \"conveyor\"\nwidth_m = 0.06\nlength_m = 0.25\nmeasure_from_m = 0.12\nfeed_rate_kg_s = 0.5\n"
      "belt_speed_m_s = 0.5\nmeasure_s = 0.8\nsource_length_m = 0.1\n" +
          keys + "\n[effects]\nrolling_friction = 0.3\n" + tables,
      "test.toml");
}
const std::string even = "band_end_m = 0.06\nheap_at_m = 0.03\n";

class Conveyor : public testing::TestWithParam<const char*> {
 protected:
  SceneResult run(const std::string& keys) const {
    const SceneFile file = conveyor(keys, std::string("[step]\nmethod = \"") + GetParam() + "\"\n");
    return file.scene->run(file.physics, {});
  }
};

TEST_P(Conveyor, bed_is_as_high_as_feed_over_belt_speed_says) {
  const SceneResult r = run(even);
  // rate / (density packing width speed)
  EXPECT_NEAR(observed(r, "mean_height"), 0.5 / (2500 * 0.7 * 0.06 * 0.5), 0.04 * 0.01);
  EXPECT_NEAR(observed(r, "bed_speed_over_belt_speed"), 1, 0.01);
  EXPECT_NEAR(observed(r, "released"), 0.5, 0.01);
  EXPECT_EQ(observed(r, "spilled_share"), 0);
  EXPECT_EQ(r.lost, 0);
}

TEST_P(Conveyor, balls_fall_over_open_edges) {
  const SceneResult r = run(even + "edge = \"open\"\n");
  EXPECT_GT(observed(r, "spilled_share"), 0.02);
  EXPECT_LT(observed(r, "spilled_share"), 0.7);
  EXPECT_EQ(r.lost, 0);
}

INSTANTIATE_TEST_SUITE_P(, Conveyor, testing::Values("nonsmooth", "smooth"));

TEST(ConveyorScene, landings_are_where_a_ball_that_falls_freely_touches_the_belt) {
  const SceneFile file = conveyor(even);
  const SceneResult r = file.scene->run(file.physics, {});
  const std::vector<Landing> landings = ConveyorScene::landings(r);
  ASSERT_EQ(static_cast<std::int64_t>(landings.size()), r.num_balls);
  // The first ball is released when its mass has come, and falls 0.05 m from 0.5 m/s.
  const double mass = 2500 * 5.235988e-7, fall = (std::sqrt(0.25 + 2 * 9.81 * 0.05) - 0.5) / 9.81;
  EXPECT_NEAR(landings.front().time, mass / 0.5 + fall, file.physics.solver.outer_step_s);
  for (const Landing& l : landings) {
    EXPECT_LE(std::abs(l.x), 0.05);
    EXPECT_GE(l.y, 0.005);
    EXPECT_LE(l.y, 0.055);
  }
}

TEST(ConveyorScene, more_than_the_source_can_release_is_an_error_that_names_the_key) {
  const auto refusal = [](const std::string& keys) -> std::string { return complaint([&] { conveyor(keys); }); };
  EXPECT_NE(refusal(even + "exit_speed_m_s = 0.01").find("scene.feed_rate_kg_s = 0.5"), std::string::npos);
  EXPECT_NE(refusal("band_end_m = 0.2").find("scene.band_end_m"), std::string::npos);
  EXPECT_EQ(refusal(even), "");
}

}  // namespace
}  // namespace drumsweep

#include "core/scene/packing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/scene/scene_value.h"
#include "support/complaint.h"

namespace drumsweep {
namespace {

SceneFile packing(const std::string& keys, const std::string& tables = "", double side = 0.05) {
  const std::string width = "width_m = " + std::to_string(side) + "\ndepth_m = " + std::to_string(side) + "\n";
  return parse_scene("[scene]\ntype = \"packing\"\n" + width + "margin_diameters = 1.0\n" + keys + "\n" + tables,
                     "test.toml");
}

class Packing : public testing::TestWithParam<const char*> {
 protected:
  std::string method() const { return std::string("[step]\nmethod = \"") + GetParam() + "\"\n"; }
};

TEST_P(Packing, floor_and_walls_carry_the_weight) {
  const SceneFile file = packing("num_balls = 120\nrest_speed_m_s = 1e-3\nmeasure_s = 0.4", method());
  const SceneResult r = file.scene->run(file.physics, {});
  EXPECT_NEAR(observed(r, "carried"), 1, 0.005);
  EXPECT_EQ(r.lost, 0);
  double up = observed(r, "floor_normal_force");
  for (const std::string wall : {"wall_x_low", "wall_x_high", "wall_y_low", "wall_y_high"})
    up += observed(r, wall + "_upward_force");
  EXPECT_NEAR(up, observed(r, "weight"), 0.005 * up);
  EXPECT_NEAR(observed(r, "weight"), 120 * 2500 * std::numbers::pi / 6 * 1e-6 * 9.81, 1e-6);
}

TEST_P(Packing, periodic_box_has_no_walls_across_and_carries_the_weight_too) {
  const SceneFile file = packing("num_balls = 120\nperiodic = true\nrest_speed_m_s = 1e-3\nmeasure_s = 0.4", method());
  const SceneResult r = file.scene->run(file.physics, {});
  EXPECT_NEAR(observed(r, "carried"), 1, 0.005);
  EXPECT_TRUE(std::isnan(observed(r, "wall_y_low_normal_force")));
  EXPECT_EQ(r.lost, 0);
}

INSTANTIATE_TEST_SUITE_P(, Packing, testing::Values("nonsmooth", "smooth"));

TEST(PackingOfSmoothBalls, frictionless_stiff_balls_have_six_half_contacts_each) {
  // Balls this stiff overlap by 1e-5 d, which adds 0.03 (O'Hern et al. 2003).
  const SceneFile file = packing("num_balls = 80\nrest_speed_m_s = 1e-6\nmax_settle_s = 1.5\nmeasure_s = 0.05",
                                 "[material]\nfriction = 0.0\nstiffness_N_m15 = 1.6e9\n"
                                 "[solver]\nouter_step_s = 1e-3\nsub_steps = 1\niterations = 200\n");
  const SceneResult r = file.scene->run(file.physics, {});
  EXPECT_NEAR(observed(r, "twice_contacts_per_ball"), 6, 0.06);
  EXPECT_NEAR(observed(r, "floor_normal_force") / observed(r, "weight"), 1, 0.005);
}

TEST(PackingOfRoughBalls, rough_balls_fill_between_loose_and_dense_random_packing) {
  const SceneFile file = packing("num_balls = 150\nrest_speed_m_s = 1e-2");
  const SceneResult r = file.scene->run(file.physics, {});
  EXPECT_GT(observed(r, "packing_fraction"), 0.5);
  EXPECT_LT(observed(r, "packing_fraction"), 0.66);
}

TEST(PackingOfRoughBalls, box_narrower_than_its_balls_is_an_error_that_names_the_key) {
  EXPECT_NE(complaint([] { packing("periodic = true\nnum_balls = 10", "", 0.03); }).find("depth_m"), std::string::npos);
}

}  // namespace
}  // namespace drumsweep

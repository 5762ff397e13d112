#include "core/scene/incline.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/scene/scene_value.h"
#include "support/complaint.h"

namespace drumsweep {
namespace {

SceneFile incline(const std::string& keys, const std::string& tables = "") {
  return parse_scene("[scene]\ntype = \"incline\"\n" + keys +
                         "\n[solver]\nouter_step_s = 1e-3\nsub_steps = 1\niterations = 50\n" + tables,
                     "test.toml");
}

double observed(const SceneFile& file, const std::string& name) {
  return observed(file.scene->run(file.physics, {}), name);
}

std::string at_tangent(double tangent) {
  return "angle_deg = " + std::to_string(std::atan(tangent) * 180 / std::numbers::pi);
}

class Incline : public testing::TestWithParam<const char*> {
 protected:
  std::string method() const { return std::string("[step]\nmethod = \"") + GetParam() + "\"\n"; }
};

TEST_P(Incline, ball_rests_iff_tan_of_incline_is_below_rolling_friction) {
  const std::string rough = method() + "[effects]\nrolling_friction = 0.3\n";
  EXPECT_EQ(observed(incline(at_tangent(0.99 * 0.3), rough), "rests"), 1);
  EXPECT_EQ(observed(incline(at_tangent(1.01 * 0.3), rough), "rests"), 0);
}

TEST_P(Incline, ball_rolls_with_five_sevenths_of_gravity_less_rolling_friction) {
  const SceneFile file = incline("angle_deg = 30.0", method() + "[effects]\nrolling_friction = 0.2\n");
  const SceneResult r = file.scene->run(file.physics, {});
  EXPECT_NEAR(observed(r, "acceleration"), 5.0 / 7 * 9.81 * (0.5 - 0.2 * std::sqrt(0.75)), 2e-3);
  EXPECT_NEAR(observed(r, "rolling"), 1, 1e-4);
  EXPECT_EQ(r.lost, 0);
}

TEST_P(Incline, slipping_ball_ends_rolling_at_five_sevenths_of_its_speed) {
  const SceneFile file = incline("angle_deg = 0.0\nspeed_m_s = 1.0\nduration_s = 0.4", method());
  EXPECT_NEAR(observed(file, "speed"), 5.0 / 7, 5e-4);
}

TEST_P(Incline, ball_hangs_under_a_ceiling_iff_cohesion_exceeds_its_weight) {
  // A ball of 10 mm and 2500 kg/m3 weighs 12.84 mN.
  const std::string keys = "angle_deg = 180.0\nduration_s = 0.5";
  EXPECT_EQ(observed(incline(keys, method() + "[effects]\ncohesion_force_N = 0.0131\n"), "rests"), 1);
  EXPECT_EQ(observed(incline(keys, method() + "[effects]\ncohesion_force_N = 0.0126\n"), "rests"), 0);
}

TEST_P(Incline, pyramid_of_four_stands_iff_friction_exceeds_sqrt3_minus_sqrt2) {
  const std::string keys = "stack = \"pyramid\"\nangle_deg = 0.0\nduration_s = 0.6";
  const auto with = [&](double friction) {
    return method() + "[material]\nstiffness_N_m15 = 1e7\nwall_friction = 1.0\nfriction = " + std::to_string(friction) +
           "\n";
  };
  EXPECT_EQ(observed(incline(keys, with(0.30)), "stands"), 0);
  EXPECT_EQ(observed(incline(keys, with(0.34)), "stands"), 1);
}

TEST_P(Incline, result_depends_on_the_file_alone) {
  const SceneFile file = incline("stack = \"triangle\"\nlayers = 4\nangle_deg = 5.0\nduration_s = 0.2", method());
  EXPECT_EQ(state_hash(file.scene->run(file.physics, {}).state), state_hash(file.scene->run(file.physics, {}).state));
}

INSTANTIATE_TEST_SUITE_P(, Incline, testing::Values("nonsmooth", "smooth"));

TEST(InclineKeys, what_the_scene_cannot_do_is_an_error_that_names_the_key) {
  const auto refusal = [](const std::string& keys, const std::string& tables) -> std::string {
    return complaint([&] { incline(keys, tables); });
  };
  EXPECT_NE(refusal("", "[effects]\nsize_spread = 0.1\n").find("effects.size_spread = 0.1"), std::string::npos);
  EXPECT_NE(refusal("stack = \"pyramid\"\nspeed_m_s = 1.0", "").find("scene.speed_m_s = 1"), std::string::npos);
  EXPECT_NE(refusal("duration_s = 0.1", "").find("scene.fit_from_s"), std::string::npos);
  EXPECT_NE(refusal("angle_deg = 200.0", "").find("scene.angle_deg"), std::string::npos);
  EXPECT_NE(refusal("angel_deg = 20.0", "").find("did you mean"), std::string::npos);
}

}  // namespace
}  // namespace drumsweep

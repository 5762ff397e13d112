#include "core/scene/collapse.h"

#include <gtest/gtest.h>

#include "support/scene_text.h"

namespace drumsweep {
namespace {

std::string column_of_beads(const std::string& scene, const std::string& more = "") {
  return "[scene]\ntype = \"collapse\"\n" + scene +
         "\n[material]\ndiameter_m = 0.01\nfriction = 0.5\nstiffness_N_m15 = 1e6\ndamping_s = 0.0005\n"
         "[solver]\niterations = 10\n" +
         more;
}

const char* const small = "length_m = 0.06\nheight_m = 0.12\nwidth_m = 0.04\nlongest_settling_s = 1.0\n";

TEST(Collapse, gate_holds_the_column_and_it_runs_out_when_the_gate_is_gone) {
  const SceneResult r = run_scene(column_of_beads(small));
  EXPECT_EQ(r.lost, 0);
  EXPECT_EQ(value(r, "left_floor"), 0);
  EXPECT_NEAR(value(r, "aspect_ratio"), 2, 0.25);
  EXPECT_GT(value(r, "run_out"), 1.5);
  EXPECT_LT(value(r, "run_out"), 4.5);
  EXPECT_LT(value(r, "final_height"), value(r, "initial_height"));
  EXPECT_GT(value(r, "arrest_time"), 0.1);
}

TEST(Collapse, two_sided_column_runs_out_to_both_sides_alike) {
  const SceneResult r =
      run_scene(column_of_beads("length_m = 0.04\nheight_m = 0.04\nwidth_m = 0.04\ntwo_sided = true\n"
                                "base = \"smooth\"\nsides = \"smooth\"\nlongest_settling_s = 0.6\n"));
  EXPECT_EQ(r.lost, 0);
  double sum = 0;
  for (const Eigen::Vector3d& p : r.state.balls.position) sum += p[0] / static_cast<double>(r.state.balls.size());
  EXPECT_LT(std::abs(sum), 0.25 * value(r, "final_length"));
}

TEST(Collapse, axisymmetric_column_and_lifted_gate_lose_no_ball) {
  const SceneResult r =
      run_scene(column_of_beads("geometry = \"axisymmetric\"\nrelease = \"lifted\"\nlength_m = 0.04\nheight_m = 0.04\n"
                                "lift_speed_m_s = 1.0\nlongest_settling_s = 0.6\n"));
  EXPECT_EQ(r.lost, 0);
  EXPECT_GT(value(r, "run_out"), 0.3);
}

TEST(Collapse, smooth_step_collapses_too) {
  const SceneResult r = run_scene(column_of_beads(
      "length_m = 0.04\nheight_m = 0.02\nwidth_m = 0.03\nbase = \"smooth\"\nlongest_settling_s = 0.05\n",
      "[step]\nmethod = \"smooth\"\n"));
  EXPECT_EQ(r.lost, 0);
}

TEST(Collapse, what_the_scene_cannot_do_is_an_error_that_names_the_key) {
  EXPECT_NE(scene_error(column_of_beads("geometry = \"axisymmetric\"\ntwo_sided = true\n")).find("scene.two_sided"),
            std::string::npos);
  EXPECT_NE(scene_error(column_of_beads("geometry = \"axisymmetric\"\nsides = \"smooth\"\n")).find("scene.sides"),
            std::string::npos);
  EXPECT_NE(scene_error(column_of_beads("width_m = 0.01\n")).find("scene.width_m"), std::string::npos);
}

}  // namespace
}  // namespace drumsweep

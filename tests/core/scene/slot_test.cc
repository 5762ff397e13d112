#include "core/scene/slot.h"

#include <gtest/gtest.h>

#include "support/scene_text.h"

namespace drumsweep {
namespace {

std::string silo_of_beads(const std::string& scene, const std::string& more = "") {
  return "[scene]\ntype = \"slot\"\nopening_m = 0.06\nwidth_m = 0.14\ndepth_m = 0.03\nfill_height_m = 0.1\n" + scene +
         "\n[material]\ndiameter_m = 0.01\nfriction = 0.5\nstiffness_N_m15 = 1e6\ndamping_s = 0.0005\n"
         "[solver]\niterations = 10\n" +
         more;
}

TEST(Slot, recycled_silo_flows_steadily_and_nothing_leaks) {
  const SceneResult r = run_scene(silo_of_beads("adapt_s = 0.2\nrecord_s = 0.5\nlongest_settling_s = 0.5\n"));
  EXPECT_EQ(r.lost, 0);
  EXPECT_EQ(value(r, "leaked"), 0);
  EXPECT_EQ(value(r, "ran_empty"), 0);
  EXPECT_GT(value(r, "discharge_rate"), 20);  // Beverloo with C = 0.58 gives 26
  EXPECT_LT(value(r, "discharge_rate"), 70);
}

TEST(Slot, without_recycling_the_silo_runs_empty_through_a_round_orifice_too) {
  const SceneResult r =
      run_scene(silo_of_beads("opening = \"round\"\nrecycle = false\nadapt_s = 0.1\nrecord_s = 5\n"
                              "longest_settling_s = 0.4\n"));
  EXPECT_EQ(r.lost, 0);
  EXPECT_EQ(value(r, "leaked"), 0);
  EXPECT_EQ(value(r, "ran_empty"), 1);
  EXPECT_LT(value(r, "recorded_time"), 5);
  EXPECT_GT(value(r, "discharge_rate"), 0.5);  // Beverloo with C = 0.58 gives 1.15 kg/s
  EXPECT_LT(value(r, "discharge_rate"), 2);
}

TEST(Slot, smooth_step_flows_too) {
  const SceneResult r = run_scene(
      silo_of_beads("adapt_s = 0.02\nrecord_s = 0.03\nlongest_settling_s = 0.02\n", "[step]\nmethod = \"smooth\"\n"));
  EXPECT_EQ(r.lost, 0);
}

TEST(Slot, opening_smaller_than_a_ball_is_an_error_that_names_the_key) {
  const std::string text = silo_of_beads("");
  std::string narrow = text;
  narrow.replace(narrow.find("opening_m = 0.06"), 16, "opening_m = 0.009");
  EXPECT_NE(scene_error(narrow).find("scene.opening_m"), std::string::npos);
  EXPECT_EQ(scene_error(text), "");
}

}  // namespace
}  // namespace drumsweep

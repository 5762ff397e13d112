#include "core/scene/pile.h"

#include <gtest/gtest.h>

#include "core/scene/scene.h"
#include "support/scene_text.h"

namespace drumsweep {
namespace {

/// A small heap of S0's pellets; the file may end with more keys.
std::string pellets(const std::string& scene, const std::string& more = "", const std::string& radii = "0.09 0.02") {
  const std::size_t blank = radii.find(' ');
  return "[scene]\ntype = \"pile\"\nbase_radius_m = " + radii.substr(0, blank) +
         "\nsource_radius_m = " + radii.substr(blank + 1) + "\nrate_kg_s = 1.0\n" + scene +
         "\n[material]\ndiameter_m = 0.013\ndensity_kg_m3 = 3700\nfriction = 0.7\nyoungs_modulus_Pa = 6e6\n"
         "damping_s = 0.001\n[effects]\nrolling_friction = 0.3\n[solver]\niterations = 8\n" +
         more;
}

TEST(Pile, poured_heap_is_static_and_holds_all_that_was_poured) {
  const SceneResult r = run_scene(pellets("shape = \"plane\"\nmass_kg = 0.8\n"));
  EXPECT_EQ(r.lost, 0);
  EXPECT_NEAR(value(r, "mass_on_base") + value(r, "mass_left_base"), 0.8, 0.01);
  EXPECT_EQ(value(r, "at_rest"), 1);
  EXPECT_LT(value(r, "residual_kinetic_energy"), 1e-6);
  EXPECT_LT(value(r, "creep"), 1e-4);
  EXPECT_GT(value(r, "angle_of_repose"), 20);
  EXPECT_LT(value(r, "angle_of_repose"), 50);
}

TEST(Pile, disc_without_a_mass_is_poured_until_it_overflows) {
  const SceneResult r = run_scene(pellets("longest_settling_s = 0.5\n", "", "0.055 0.013"));
  EXPECT_EQ(r.lost, 0);
  EXPECT_GT(value(r, "mass_left_base"), 0);
  EXPECT_EQ(value(r, "base_radius"), 0.055);
}

TEST(Pile, rolling_resistance_makes_a_smooth_plate_hold_a_heap) {
  const std::string scene =
      "shape = \"plane\"\nbase = \"smooth\"\nprotocol = \"lifted_cylinder\"\nmass_kg = 0.5\n"
      "cylinder_radius_m = 0.04\nlift_speed_m_s = 0.1\nlongest_settling_s = 0.5\n";
  const SceneResult r = run_scene(pellets(scene));
  EXPECT_EQ(r.lost, 0);
  EXPECT_EQ(value(r, "glued_balls"), 0);
  EXPECT_GT(value(r, "height"), 0.02);
}

TEST(Pile, equal_file_and_seed_give_equal_heaps) {
  const std::string text = pellets("shape = \"plane\"\nmass_kg = 0.1\nlongest_settling_s = 0.1\n");
  EXPECT_EQ(state_hash(run_scene(text).state), state_hash(run_scene(text).state));
}

TEST(Pile, smooth_step_pours_too) {
  const SceneResult r = run_scene(
      pellets("shape = \"plane\"\nmass_kg = 0.03\nlongest_settling_s = 0.05\n", "[step]\nmethod = \"smooth\"\n"));
  EXPECT_EQ(r.lost, 0);
  EXPECT_EQ(r.num_balls, 7);
}

TEST(Pile, what_the_scene_cannot_do_is_an_error_that_names_the_key) {
  EXPECT_NE(scene_error(pellets("shape = \"plane\"\n")).find("scene.mass_kg"), std::string::npos);
  EXPECT_NE(scene_error(pellets("protocol = \"lifted_cylinder\"\n")).find("scene.mass_kg"), std::string::npos);
  EXPECT_NE(scene_error(pellets("source_height_m = 0.01\n")).find("scene.source_height_m"), std::string::npos);
}

}  // namespace
}  // namespace drumsweep

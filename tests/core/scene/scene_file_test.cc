#include <gtest/gtest.h>

#include <filesystem>
#include <set>

#include "core/config/toml_fields.h"
#include "core/scene/scene.h"
#include "support/scene_text.h"

namespace drumsweep {
namespace {

TEST(SceneFile, every_shipped_scene_is_valid_and_each_type_has_one) {
  std::set<std::string> types;
  for (const auto& entry : std::filesystem::directory_iterator(DRUMSWEEP_SOURCE_DIR "/schedules/scenes")) {
    const SceneFile file = read_scene(entry.path().string());
    types.insert(file.type);
    EXPECT_TRUE(is_scene_file(entry.path().string()));
  }
  for (const SceneType& type : scene_types()) EXPECT_EQ(types.count(type.name), 1u) << type.name;
}

TEST(SceneFile, written_out_with_all_keys_reads_back_to_the_same) {
  for (const auto& entry : std::filesystem::directory_iterator(DRUMSWEEP_SOURCE_DIR "/schedules/scenes")) {
    SceneFile one = read_scene(entry.path().string());
    for (const bool comments : {false, true}) {
      SceneFile two = parse_scene(write_scene(one, comments), "written");
      EXPECT_EQ(write_scene(two, false), write_scene(one, false)) << entry.path();
    }
  }
}

TEST(SceneFile, keys_set_on_the_command_line_stand_over_the_file) {
  const std::string path = DRUMSWEEP_SOURCE_DIR "/schedules/scenes/incline.toml";
  SceneFile file = read_scene(path, {"scene.angle_deg=7.5", "solver.iterations=77"});
  EXPECT_EQ(file.physics.solver.iterations, 77);
  EXPECT_NE(write_scene(file, false).find("angle_deg = 7.5"), std::string::npos);
  EXPECT_THROW(read_scene(path, {"scene.angle_deg=1000"}), InputError);
  EXPECT_THROW(read_scene(path, {" scene.type=drop"}), InputError);
}

TEST(SceneFile, complaints_name_file_line_key_value_and_what_is_accepted) {
  EXPECT_NE(scene_error("[scene]\nspeed_m_s = 1\n").find("needs type"), std::string::npos);
  const std::string type = scene_error("[scene]\ntype = \"dorp\"\n");
  EXPECT_NE(type.find("scene.toml:2:"), std::string::npos) << type;
  EXPECT_NE(type.find("did you mean drop?"), std::string::npos) << type;
  const std::string key = scene_error("[scene]\ntype = \"drop\"\nangel_deg = 3\n");
  EXPECT_NE(key.find("scene.toml:3:"), std::string::npos) << key;
  EXPECT_NE(key.find("did you mean scene.angle_deg?"), std::string::npos) << key;
  const std::string range = scene_error("[scene]\ntype = \"drop\"\nangle_deg = 120\n");
  EXPECT_NE(range.find("scene.angle_deg = 120.0: accepted is 0 to 89"), std::string::npos) << range;
  // What the scene has nothing for is refused, not ignored.
  const std::string effect = scene_error("[scene]\ntype = \"drop\"\n[effects]\noutlet_coating_m = 0.003\n");
  EXPECT_NE(effect.find("scene.toml:4:"), std::string::npos) << effect;
  EXPECT_NE(effect.find("effects.outlet_coating_m"), std::string::npos) << effect;
  const std::string iterations = scene_error("[scene]\ntype = \"drop\"\n[solver]\niterations = 0\n");
  EXPECT_NE(iterations.find("\"auto\""), std::string::npos) << iterations;
  EXPECT_EQ(scene_error("[scene]\ntype = \"drop\"\n[solver]\niterations = \"auto\"\n"), "");
}

TEST(SceneFile, a_study_table_in_a_scene_is_refused) {
  EXPECT_NE(scene_error("[scene]\ntype = \"drop\"\n[outlet]\nlength_m = 1\n").find("unknown key outlet"),
            std::string::npos);
}

}  // namespace
}  // namespace drumsweep

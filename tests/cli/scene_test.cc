#include <gtest/gtest.h>

#include <filesystem>

#include "cli/mini_json.h"
#include "cli/program.h"

namespace drumsweep {
namespace {

TEST(Scene, simulate_runs_a_scene_file_and_says_all_that_it_says_of_a_design) {
  const TestFolder folder;
  ASSERT_EQ(drumsweep(folder, {"init", "--preset", "scenes", "s"}).code, 0);
  const Finished run = drumsweep(folder, {"simulate", "s/drop.toml", "-o", "out", "--json"});
  ASSERT_EQ(run.code, 0) << run.err;
  const Json json = JsonReader::parse(run.out);
  for (const char* key : {"observables", "lost_balls", "mass_balance", "state_hash", "residual", "cpu_s"})
    EXPECT_TRUE(json.has(key)) << key;
  double restitution = 0;
  for (const Json& o : json["observables"].list)
    if (o["name"].text == "normal_restitution") restitution = o["value"].number;
  EXPECT_NEAR(restitution, 0.98, 1e-4);
  EXPECT_TRUE(std::filesystem::exists(folder / "out/drop.h5"));
  EXPECT_EQ(file_text(folder / "out/drop_observables.csv").rfind("name,position,position_unit,value,sigma,unit\n", 0),
            0u);

  EXPECT_EQ(drumsweep(folder, {"check", "s/drop.toml"}).code, 0);

  // The file with every key written out is the same scene.
  const Finished again = drumsweep(folder, {"simulate", "s/drop_all_keys.toml", "-o", "out2", "--json"});
  ASSERT_EQ(again.code, 0) << again.err;
  EXPECT_EQ(JsonReader::parse(again.out)["state_hash"].text, json["state_hash"].text);
}

TEST(Scene, bad_scene_files_are_refused_with_exit_2_and_nothing_is_written) {
  const TestFolder folder;
  write_text(folder / "bad.toml", "[scene]\ntype = \"drop\"\nspeed_m_s = -1\n");
  const Finished run = drumsweep(folder, {"simulate", "bad.toml", "-o", "out"});
  EXPECT_EQ(run.code, 2);
  EXPECT_NE(run.err.find("bad.toml:3:"), std::string::npos) << run.err;
  EXPECT_EQ(drumsweep(folder, {"simulate", "bad.toml", "--at", "1", "-o", "out"}).code, 2);
  EXPECT_FALSE(std::filesystem::exists(folder / "out"));
}

}  // namespace
}  // namespace drumsweep

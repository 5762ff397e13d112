#include "diagnosis/campaign/campaign.h"

#include <gtest/gtest.h>

#include "diagnosis/campaign/small_campaign.h"
#include "diagnosis/model/fit.h"
#include "postproc/child_process.h"
#include "support/complaint.h"

namespace drumsweep {
namespace {

struct Folder {
  const ScratchFolder scratch;
  const std::string path = scratch.path;
  Folder() { write_small_campaign(path, 0.1); }
};

std::string replaced_once(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

}  // namespace

TEST(Campaign, shipped_campaigns_are_valid) {
  for (const char* name : {"/schedules/campaign/campaign.toml", "/schedules/pellets_campaign.toml"}) {
    const Campaign campaign = read_campaign(std::string(DRUMSWEEP_SOURCE_DIR) + name);
    EXPECT_FALSE(read_measured(campaign).data.empty());
  }
}

TEST(Campaign, wrong_files_are_refused_with_what_is_accepted) {
  const Folder folder;
  const std::string good = small_campaign_text(), path = folder.path + "/campaign.toml";
  const struct {
    const char *from, *to, *says;
  } cases[] = {
      {"seed = 3", "sead = 3", "did you mean seed"},
      {"runs = 40", "runs = -1", "accepted is whole number"},
      {"\"rolling_resistance\"", "\"rolling_resistence\"", "did you mean rolling_resistance"},
      {"key = \"material.friction\"", "key = \"material.frictoin\"", "no condition has the numeric key"},
      {"sigma = 0.02", "sigma = 0.0", "accepted is above 0"},
      {"sigma = 0.02", "sigma = 0.5", "design reaches what cannot be simulated"},
      {"\"twisting_resistance\"", "\"belt_speed\"", "detection limit is infinite"},
      {"\"scene.angle_deg\"", "\"scene.angel_deg\"", "did you mean scene.angle_deg"},
      {"at_22", "at_20", "there twice"},
  };
  for (const auto& c : cases) {
    put(path, replaced_once(good, c.from, c.to));
    const std::string says = complaint([&] { read_campaign(path); });
    EXPECT_NE(says.find(c.says), std::string::npos) << c.to << ": " << says;
  }
}

TEST(Measured, wrong_rows_are_refused_with_line_and_what_is_accepted) {
  const Folder folder;
  const Campaign campaign = read_campaign(folder.path + "/campaign.toml");
  const std::string header = "condition,quantity,position,value,sigma,unit,use\n";
  const std::string rest = "at_24,acceleration,,2,0.1,m/s2,fit\nat_28,acceleration,,2,0.1,m/s2,fit\n";
  const struct {
    const char *row, *says;
  } cases[] = {
      {"at_20,acceleration,,2,0,m/s2,fit\n", ":2: sigma = 0"},
      {"at_20,acceleration,,2,-1,m/s2,fit\n", "accepted is above 0"},
      {"at_20,acceleration,,2,,m/s2,fit\n", "sigma: missing"},
      {"at_20,acceleration,,2,assumed,m/s2,fit\n", "assumed_relative_sigma"},
      {"at_20,acceleration,,nan,0.1,m/s2,fit\n", "accepted is a finite number"},
      {"at_20,acceleration,,,0.1,m/s2,fit\n", "accepted is a finite number"},
      {"at_20,acceleration,,2,0.1,m/s2,fitt\n", "accepted is fit | holdout | available"},
      {"at_21,acceleration,,2,0.1,m/s2,fit\n", "the campaign has no such one"},
      {"at_22,acceleration,,2,0.1,m/s2,fit\n", "held-out condition must not be used for fitting"},
      {"at_24,acceleration,,2,0.1,m/s2,fit\n", "there twice"},
      {"at_24,speed,,2,0.1,m/s,holdout\n", "must not be used for fitting"},
      {"at_20,acceleration,,2,0.1,m/s2\n", "6 columns"},
  };
  for (const auto& c : cases) {
    const std::string says = complaint([&] { parse_measured(header + c.row + rest, "data.csv", campaign); });
    EXPECT_NE(says.find(c.says), std::string::npos) << c.row << says;
  }
  EXPECT_NE(complaint([&] {
              parse_measured(header + "at_20,acceleration,,2,0.1,m/s2,fit\n", "data.csv", campaign);
            }).find("more data than free parameters"),
            std::string::npos);
  EXPECT_NE(complaint([&] { parse_measured("a,b\n", "data.csv", campaign); }).find("needed is condition"),
            std::string::npos);
}

TEST(Measured, quantities_units_and_positions_must_be_those_of_the_condition) {
  const Folder folder;
  const Campaign campaign = read_campaign(folder.path + "/campaign.toml");
  std::vector<std::vector<Observable>> offered(campaign.conditions.size(), {observable("acceleration", 2, 0.1, "m/s2"),
                                                                            observable("speed", 1, 0.1, "m/s"),
                                                                            {"height", 0.1, 5, 1, "m"},
                                                                            {"height", 0.3, 7, 1, "m"}});
  const auto says = [&](const std::string& row) {
    return complaint([&] {
      MeasuredData m = parse_measured(
          "condition,quantity,position,value,sigma,unit,use\n" + row + "\nat_24,speed,,200,10,cm/s,fit\n", "data.csv",
          campaign);
      match_measured(m, "data.csv", campaign, offered);
      EXPECT_DOUBLE_EQ(m.data.back().value, 2.0);
      EXPECT_DOUBLE_EQ(m.data.back().sigma, 0.1);
    });
  };
  EXPECT_NE(says("at_20,accelaration,,2,0.1,m/s2,fit").find("did you mean acceleration"), std::string::npos);
  EXPECT_NE(says("at_20,acceleration,,2,0.1,kg,fit").find("acceleration is in m/s2"), std::string::npos);
  EXPECT_NE(says("at_20,acceleration,1,2,0.1,m/s2,fit").find("leave it empty"), std::string::npos);
  EXPECT_NE(says("at_20,height,,2,0.1,m,fit").find("needs one"), std::string::npos);
  EXPECT_NE(says("at_20,height,0.4,2,0.1,m,fit").find("simulated from 0.1 to 0.3"), std::string::npos);
  EXPECT_EQ(says("at_20,height,0.2,2,0.1,m,fit"), "");
  EXPECT_DOUBLE_EQ(read_off(offered[0], "height", 0.2), 6);
}

TEST(Candidates, built_in_ones_are_valid_and_off_at_zero) {
  const Condition drum = read_condition("drum", DRUMSWEEP_SOURCE_DIR "/schedules/campaign/drum.toml", {});
  std::vector<KeyChange> off;
  for (int i = 0; i < num_embedded_candidates; ++i) {
    const Candidate c = find_candidate(embedded_candidates[i].id, ".");
    EXPECT_EQ(c.effect.id, embedded_candidates[i].id);
    EXPECT_FALSE(c.effect.about.empty());
    const std::vector<KeyChange> more = c.apply(drum, 0);
    off.insert(off.end(), more.begin(), more.end());
    EXPECT_EQ(c.observe("drum", "charge_angle", 31.0, 0), 31.0);
  }
  EXPECT_GT(num_embedded_candidates, 18);
  EXPECT_GT(off.size(), 10u);
  // Bit for bit the plain model.
  const auto go_on = [] { return true; };
  EXPECT_EQ(drum.simulate(7, off, {}, 1, go_on).state_hash, drum.simulate(7, {}, {}, 1, go_on).state_hash);
}

TEST(Candidates, a_file_of_ones_own_changes_inputs_and_readings) {
  const Candidate c = parse_candidate(
      "id = \"mine\"\nunit = \"mm\"\nlow = -1\nhigh = 2\nprior_scale = 1\n"
      "change = [ { key = \"scene.fill\", add = 0.01, of = [\"drum\"] }, { key = \"material.friction\", scale = 0.5, "
      "of = [\"pile\"] } ]\n"
      "observe = [ { quantity = \"charge_angle\", add = 3.0 } ]\n",
      "mine.toml");
  const Condition drum = read_condition("drum", DRUMSWEEP_SOURCE_DIR "/schedules/campaign/drum.toml", {});
  ASSERT_EQ(c.apply(drum, 2).size(), 1u);
  EXPECT_DOUBLE_EQ(c.apply(drum, 2)[0].value, 0.02);
  EXPECT_DOUBLE_EQ(c.observe("drum", "charge_angle", 30, 2), 36);
  EXPECT_DOUBLE_EQ(c.observe("drum", "axial_velocity", 30, 2), 30);
  EXPECT_NE(complaint([] {
              parse_candidate("id = \"x\"\nunit = \"1\"\nlow = 1\nhigh = 2\nprior_scale = 1\nnumerics = true\n",
                              "x.toml");
            }).find("low <= 0 <= high"),
            std::string::npos);
}

}  // namespace drumsweep

#include "diagnosis/adversary/seal.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "core/config/schema.h"
#include "core/io/durable_file.h"
#include "postproc/child_process.h"

namespace drumsweep {
namespace {

struct SealFolders {
  ScratchFolder scratch;
  std::string root = scratch.path.string();
  SealFolders() {
    HiddenTruth truth;
    truth.name = "single";
    truth.effects = {{"rolling_resistance", 0.06}};
    truth.outsider = {{KeyChange::How::set, "material.restitution", 0.5}};
    seal_case(root + "/data", root + "/keys", "000", {}, truth.key({}));
    std::filesystem::create_directories(root + "/verdicts");
  }
  std::vector<OpenedCase> open() const { return open_seal(root + "/data", root + "/keys", root + "/verdicts"); }
  void say(const std::string& text) const { write_durably(root + "/verdicts/000.txt", text); }
};

constexpr const char* verdict = "verdict established\np 0.002\ncause rolling_resistance 0.058 0.04 0.07\ngain 1 5 1\n";

}  // namespace

TEST(Seal, data_do_not_hold_the_key) {
  const SealFolders f;
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(f.root + "/data/000"), {}), 2);
  EXPECT_EQ(read_whole_file(f.root + "/data/000/commitment.txt").find("rolling"), std::string::npos);
}

TEST(Seal, opens_when_every_case_has_its_verdict_and_gives_truth_and_verdict) {
  const SealFolders f;
  EXPECT_THROW(f.open(), InputError);
  f.say(verdict);
  const std::vector<OpenedCase> opened = f.open();
  ASSERT_EQ(opened.size(), 1u);
  EXPECT_EQ(opened[0].truth.effects, (std::vector<std::pair<std::string, double>>{{"rolling_resistance", 0.06}}));
  EXPECT_EQ(opened[0].truth.outsider.at(0).key, "material.restitution");
  EXPECT_EQ(to_text(opened[0].said), verdict);
  EXPECT_EQ(judge(opened[0].truth, opened[0].said), Judgement::misnamed);
  EXPECT_EQ(f.open().size(), 1u);  // again: the same
}

TEST(Seal, verdict_that_was_changed_after_the_opening_is_refused) {
  const SealFolders f;
  f.say(verdict);
  f.open();
  f.say("verdict none_of_these\np 0.002\ngain nan nan 0\n");
  EXPECT_THROW(f.open(), InputError);
}

TEST(Seal, another_key_is_refused) {
  const SealFolders f;
  f.say(verdict);
  write_durably(f.root + "/keys/000.txt", "case none\n");
  EXPECT_THROW(f.open(), InputError);
}

}  // namespace drumsweep

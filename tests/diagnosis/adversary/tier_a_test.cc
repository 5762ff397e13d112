/// The gates of the method on synthetic machines, with fixed seeds; the full numbers: `drumsweep-adversary tier-a`.
#include "diagnosis/adversary/tier_a.h"

#include <gtest/gtest.h>

#include "diagnosis/adversary/sha256.h"

namespace drumsweep {
namespace {

std::string lines(const std::vector<std::string>& list) {
  std::string out;
  for (const std::string& s : list) out += s + "\n";
  return out;
}

#ifdef DRUMSWEEP_SANITIZE
constexpr int part = 4;
#else
constexpr int part = 1;
#endif

}  // namespace

TEST(Adversary, digest_is_sha_256) {
  EXPECT_EQ(sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256(std::string(56, 'a')), "b35439a4ac6f0948b6d6f9e3c6af0f5f590ce20f1bde7090ef7970686ec6738a");
}

TEST(TierA, gates_are_met_on_six_machines) {
  const TierAScore score =
      run_tier_a({.machines = 6 / part, .cases_per_class = 8 / part, .num_bootstraps = 199 / part});
  EXPECT_TRUE(score.missed().empty()) << lines(score.missed()) << score.table();
}

TEST(TierA, false_alarms_stay_right_below_the_budget_law) {
  const TierAScore score = run_tier_a(
      {.machines = 4, .cases_per_class = 24 / part, .num_bootstraps = 199, .num_runs = 220, .only_null = true});
  EXPECT_TRUE(score.missed().empty()) << lines(score.missed()) << score.table();
}

/// Each of these must be seen by the gates.
class TierAMutation : public testing::Test {
 protected:
  void SetUp() override {
#ifdef DRUMSWEEP_SANITIZE
    GTEST_SKIP() << "numbers only; the release build runs it";
#endif
  }
};
TEST_F(TierAMutation, simulation_noise_dropped_fails) {
  EXPECT_FALSE(run_tier_a({.machines = 2,
                           .cases_per_class = 12,
                           .num_bootstraps = 99,
                           .num_runs = 140,
                           .only_null = true,
                           .mutation = {.drop_simulation_noise = true}})
                   .missed()
                   .empty());
}
TEST_F(TierAMutation, refit_skipped_fails) {
  EXPECT_FALSE(run_tier_a({.machines = 1,
                           .cases_per_class = 12,
                           .num_bootstraps = 99,
                           .only_null = true,
                           .mutation = {.skip_refit = true}})
                   .missed()
                   .empty());
}
TEST_F(TierAMutation, covariance_halved_fails) {
  EXPECT_FALSE(run_tier_a({.machines = 2,
                           .cases_per_class = 12,
                           .num_bootstraps = 99,
                           .only_null = true,
                           .mutation = {.halve_covariance = true}})
                   .missed()
                   .empty());
}
TEST_F(TierAMutation, shared_seeds_fail) {
  EXPECT_FALSE(run_tier_a({.machines = 2,
                           .cases_per_class = 12,
                           .num_bootstraps = 99,
                           .only_null = true,
                           .mutation = {.share_seeds = true}})
                   .missed()
                   .empty());
}
TEST_F(TierAMutation, swapped_labels_fail) {
  EXPECT_FALSE(
      run_tier_a({.machines = 1, .cases_per_class = 8, .num_bootstraps = 99, .mutation = {.swap_labels = true}})
          .missed()
          .empty());
}
TEST_F(TierAMutation, flipped_sign_fails) {
  EXPECT_FALSE(run_tier_a({.machines = 1, .cases_per_class = 8, .num_bootstraps = 99, .mutation = {.flip_sign = true}})
                   .missed()
                   .empty());
}
TEST_F(TierAMutation, held_out_check_removed_fails) {
  EXPECT_FALSE(
      run_tier_a({.machines = 1, .cases_per_class = 12, .num_bootstraps = 99, .mutation = {.skip_held_out = true}})
          .missed()
          .empty());
}

}  // namespace drumsweep

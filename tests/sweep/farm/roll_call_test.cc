#include "sweep/farm/roll_call.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <thread>

namespace drumsweep {
namespace {

TEST(RollCall, a_process_of_our_host_that_is_gone_is_missed_at_once_and_one_elsewhere_after_its_silence) {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(0);
  ::waitpid(child, nullptr, 0);
  RollCall roll(3, 0.1, "here");
  roll.heard(0, roll.here());
  roll.heard(1, std::to_string(child) + " here");
  roll.heard(2, std::to_string(child) + " elsewhere");
  EXPECT_FALSE(roll.missing(0));
  EXPECT_TRUE(roll.missing(1));
  EXPECT_FALSE(roll.missing(2));
  std::this_thread::sleep_for(std::chrono::milliseconds(150));
  EXPECT_TRUE(roll.missing(2));
  roll.heard(2);
  EXPECT_FALSE(roll.missing(2));
  roll.strike(1);
  EXPECT_FALSE(roll.missing(1));
}

TEST(RollCall, words_are_due_some_times_in_a_silence) {
  RollCall roll(1, 0.4, "here");
  EXPECT_TRUE(roll.due());
  EXPECT_FALSE(roll.due());
  std::this_thread::sleep_for(std::chrono::milliseconds(60));
  EXPECT_TRUE(roll.due());
}

}  // namespace
}  // namespace drumsweep

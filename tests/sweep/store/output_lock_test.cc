#include "sweep/store/output_lock.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>

#include "postproc/child_process.h"

namespace drumsweep {
namespace {

struct LockTest : testing::Test {
  const ScratchFolder scratch;
  const std::string folder = scratch.path, path = folder + "/lock";
};

TEST_F(LockTest, the_second_is_refused_and_told_who_holds_it) {
  const OutputLock first(path);
  ASSERT_TRUE(first.held());
  try {
    const OutputLock second(path);
    FAIL() << "two hold the lock";
  } catch (const LockHeldError& error) {
    EXPECT_NE(std::string(error.what()).find("pid " + std::to_string(::getpid())), std::string::npos) << error.what();
  }
}

TEST_F(LockTest, asking_takes_nothing_and_sees_what_the_holder_says) {
  EXPECT_FALSE(read_held_lock(path).has_value());
  EXPECT_FALSE(std::filesystem::exists(path));
  {
    OutputLock lock(path);
    lock.say("phase one\nrunning a b c\n");
    lock.say("phase two\n");
    const std::string text = read_held_lock(path).value();
    EXPECT_NE(text.find("phase two\n"), std::string::npos);
    EXPECT_EQ(text.find("running"), std::string::npos) << "a longer text before is not cut off";
  }
  EXPECT_FALSE(read_held_lock(path).has_value());
}

TEST_F(LockTest, a_killed_holders_lock_is_free_at_once_though_the_file_still_names_it) {
  int ready[2];
  ASSERT_EQ(::pipe(ready), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    const OutputLock lock(path);
    [[maybe_unused]] const ssize_t n = ::write(ready[1], "x", 1);
    ::pause();
  }
  char byte = 0;
  ASSERT_EQ(::read(ready[0], &byte, 1), 1);
  EXPECT_TRUE(read_held_lock(path).has_value());
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  EXPECT_FALSE(read_held_lock(path).has_value());
  EXPECT_GT(std::filesystem::file_size(path), 0u);
  EXPECT_NO_THROW(const OutputLock next(path));
}

}  // namespace
}  // namespace drumsweep

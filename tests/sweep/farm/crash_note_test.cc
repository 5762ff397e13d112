#include "sweep/farm/crash_note.h"

#include <gtest/gtest.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <optional>
#include <utility>

#include "postproc/child_process.h"

namespace drumsweep {
namespace {

struct CrashNoteTest : testing::Test {
  const ScratchFolder scratch;
  const std::string folder = scratch.path, path = folder + "/x.crashed";

  /// A child process that dies of this signal. @return the signal that it died of
  int crash(int number, bool armed) const {
    const pid_t child = ::fork();
    if (child == 0) {
      ::signal(number, SIG_DFL);  // a sanitizer's handler would turn it into an exit
      install_crash_handler();
      std::optional<CrashNote> note;
      note.emplace(path, 3);
      if (!armed) note.reset();
      ::raise(number);
      ::_exit(0);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    return WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  }
};

TEST_F(CrashNoteTest, names_attempt_and_signal_and_the_process_still_dies_of_it) {
  for (const auto& [number, name] : {std::pair{SIGSEGV, "SIGSEGV"},
                                     {SIGBUS, "SIGBUS"},
                                     {SIGILL, "SIGILL"},
                                     {SIGFPE, "SIGFPE"},
                                     {SIGABRT, "SIGABRT"}}) {
    EXPECT_EQ(crash(number, true), number);
    const std::optional<Crash> note = read_crash_note(path);
    ASSERT_TRUE(note.has_value()) << name;
    EXPECT_EQ(note->attempt, 3);
    EXPECT_EQ(note->signal, name);
  }
}

TEST_F(CrashNoteTest, outside_of_designs_there_is_none_and_a_torn_one_is_none) {
  EXPECT_EQ(crash(SIGSEGV, false), SIGSEGV);
  EXPECT_FALSE(std::filesystem::exists(path));
  std::ofstream(path) << "drumsweep design crashed in attempt 3 by SIGSE";
  EXPECT_FALSE(read_crash_note(path).has_value());
}

}  // namespace
}  // namespace drumsweep

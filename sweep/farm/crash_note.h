/// The last words of a process that dies of its own fault: SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT, or a hang.
#pragma once

#include <optional>
#include <string>

namespace drumsweep {

/// From now on such a signal first leaves the note of the CrashNote that is alive, then does what it did before. To be
/// called once, after MPI (which has handlers of its own) has begun. The handler only opens, writes and closes a file,
/// from text prepared beforehand. A stack that has run over is handled on a stack of its own.
void install_crash_handler();

/// Dies of SIGABRT, with "hang" in the note. From any thread.
[[noreturn]] void abort_as_hang();

/// While it lives, a crash writes `path`: which attempt, and which signal. One at a time.
class CrashNote {
 public:
  CrashNote(const std::string& path, int attempt);
  ~CrashNote();
  CrashNote(const CrashNote&) = delete;
  CrashNote& operator=(const CrashNote&) = delete;
};

struct Crash {
  int attempt;
  std::string signal;  ///< its name, or "hang"
};
/// Nothing where there is no such file or it is torn.
std::optional<Crash> read_crash_note(const std::string& path);

}  // namespace drumsweep

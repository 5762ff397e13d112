/// One run at a time on an output folder.
#pragma once

#include <optional>
#include <stdexcept>
#include <string>

namespace drumsweep {

/// Another run holds the folder. Exit code 6.
struct LockHeldError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A lock that the kernel drops when its holder dies, however it dies. The file says who holds it and what is going on;
/// it stays behind when the run ends, and then means nothing.
///
/// A record lock of the open file (F_OFD_SETLK) rather than flock(): others can ask whether it is held without taking
/// it, so `status` never gets in the way of a run that is about to start. Where the file system has no locks the run
/// goes on without (see held()): results are immutable and the same whoever writes them, a second run only wastes time.
class OutputLock {
 public:
  /// @throws LockHeldError naming the holder, WriteError when the file cannot be made
  explicit OutputLock(const std::string& path);
  ~OutputLock();
  OutputLock(const OutputLock&) = delete;
  OutputLock& operator=(const OutputLock&) = delete;

  /// False where the file system refuses locks.
  bool held() const { return held_; }

  /// Replaces what the file says below the holder's line. Best effort: it is for people and for `status`.
  void say(const std::string& text);

 private:
  std::string path_, holder_;
  int descriptor_ = -1;
  bool held_ = false;
};

/// What the file says if the lock is held by somebody now. Takes no lock, changes nothing.
std::optional<std::string> read_held_lock(const std::string& path);

}  // namespace drumsweep

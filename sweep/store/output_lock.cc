#include "sweep/store/output_lock.h"

#include <fcntl.h>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>

#include "core/io/durable_file.h"

namespace drumsweep {
namespace {

struct flock whole_file() {
  struct flock range {};
  range.l_type = F_WRLCK;
  range.l_whence = SEEK_SET;
  return range;
}

std::string host_name() {
  std::array<char, 256> name{};
  ::gethostname(name.data(), name.size() - 1);
  return name.data();
}

std::string contents(int descriptor) {
  std::array<char, 65536> buffer{};
  const ssize_t n = ::pread(descriptor, buffer.data(), buffer.size(), 0);
  return n > 0 ? std::string(buffer.data(), static_cast<std::size_t>(n)) : std::string();
}

}  // namespace

OutputLock::OutputLock(const std::string& path) : path_(path) {
  descriptor_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (descriptor_ < 0) throw WriteError(fmt::format("{}: open failed: {}", path, std::strerror(errno)));
  struct flock range = whole_file();
  if (::fcntl(descriptor_, F_OFD_SETLK, &range) == 0) {
    held_ = true;
  } else if (errno == EAGAIN || errno == EACCES) {
    const std::string text = contents(descriptor_);
    ::close(descriptor_);
    throw LockHeldError(fmt::format("{}: another run holds this output folder{}", path,
                                    text.empty() ? "" : ": " + text.substr(0, text.find('\n'))));
  }
  holder_ = fmt::format("pid {} on {} since {:%Y-%m-%d %H:%M:%S} UTC\n", ::getpid(), host_name(),
                        fmt::gmtime(std::time(nullptr)));
  say("");
}

OutputLock::~OutputLock() {
  [[maybe_unused]] const int ignored = ::ftruncate(descriptor_, 0);
  ::close(descriptor_);
}

void OutputLock::say(const std::string& text) {
  const std::string all = holder_ + text;
  // In place, not by renaming: the lock belongs to this very file.
  if (::pwrite(descriptor_, all.data(), all.size(), 0) == static_cast<ssize_t>(all.size())) {
    [[maybe_unused]] const int ignored = ::ftruncate(descriptor_, static_cast<off_t>(all.size()));
  }
}

std::optional<std::string> read_held_lock(const std::string& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return std::nullopt;
  struct flock range = whole_file();
  const bool held = ::fcntl(descriptor, F_OFD_GETLK, &range) == 0 && range.l_type != F_UNLCK;
  const std::string text = held ? contents(descriptor) : std::string();
  ::close(descriptor);
  return held ? std::optional(text) : std::nullopt;
}

}  // namespace drumsweep

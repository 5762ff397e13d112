#include "core/io/durable_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

namespace drumsweep {
namespace {

struct Descriptor {
  int fd;
  ~Descriptor() {
    if (fd >= 0) ::close(fd);
  }
};

[[noreturn]] void fail(const std::string& path, const char* action, int error) {
  throw WriteError(fmt::format("{}: {} failed: {}", path, action, std::strerror(error)));
}

}  // namespace

void sync_folder(const std::string& folder) {
  const Descriptor directory{::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)};
  if (directory.fd < 0) fail(folder, "open", errno);
  if (::fsync(directory.fd) != 0 && errno != EINVAL && errno != EROFS) fail(folder, "fsync", errno);
}

void write_durably(const std::string& path, std::string_view bytes) {
  const std::filesystem::path target(path);
  const std::string folder = target.has_parent_path() ? target.parent_path().string() : ".";
  const std::string temporary = fmt::format("{}.{}.tmp", path, ::getpid());
  try {
    const Descriptor file{::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644)};
    if (file.fd < 0) fail(temporary, "open", errno);
    for (std::size_t written = 0; written < bytes.size();) {
      const ssize_t n = ::write(file.fd, bytes.data() + written, bytes.size() - written);
      if (n < 0 && errno == EINTR) continue;
      if (n < 0) fail(temporary, "write", errno);
      if (n == 0) fail(temporary, "write", ENOSPC);
      written += static_cast<std::size_t>(n);
    }
    if (::fsync(file.fd) != 0) fail(temporary, "fsync", errno);
    if (::rename(temporary.c_str(), path.c_str()) != 0) fail(path, "rename", errno);
  } catch (const WriteError&) {
    ::unlink(temporary.c_str());
    throw;
  }
  sync_folder(folder);
}

std::string read_whole_file(const std::string& path) {
  const Descriptor file{::open(path.c_str(), O_RDONLY | O_CLOEXEC)};
  if (file.fd < 0) throw std::runtime_error(fmt::format("{}: cannot be read: {}", path, std::strerror(errno)));
  struct stat info {};
  if (::fstat(file.fd, &info) != 0)
    throw std::runtime_error(fmt::format("{}: cannot be read: {}", path, std::strerror(errno)));
  if (S_ISDIR(info.st_mode)) throw std::runtime_error(path + ": is a folder");
  std::string bytes(static_cast<std::size_t>(info.st_size), '\0');
  std::size_t have = 0;
  while (true) {
    if (have == bytes.size()) bytes.resize(have + 4096);
    const ssize_t n = ::read(file.fd, bytes.data() + have, bytes.size() - have);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) throw std::runtime_error(fmt::format("{}: cannot be read: {}", path, std::strerror(errno)));
    if (n == 0) break;
    have += static_cast<std::size_t>(n);
  }
  bytes.resize(have);
  return bytes;
}

}  // namespace drumsweep

#include "sweep/doctor/folder_check.h"

#include <fmt/format.h>
#include <sys/vfs.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <map>
#include <random>

#include "core/io/durable_file.h"

namespace drumsweep {
namespace {

namespace fs = std::filesystem;
using Level = Finding::Level;
using Clock = std::chrono::steady_clock;

constexpr std::size_t recording_bytes = 300'000;  // of a typical design
constexpr double slow_write_ms = 500;

/// The folder, or the nearest one above it that exists.
std::string existing_part(const std::string& folder) {
  fs::path path = fs::absolute(folder).lexically_normal();
  std::error_code error;
  while (!fs::is_directory(path, error) && path.has_relative_path()) path = path.parent_path();
  const std::string text = path.string();
  return text.size() > 1 && text.ends_with('/') ? text.substr(0, text.size() - 1) : text;
}

/// Names of statfs(2), the ones that clusters and laptops have.
std::string file_system(long type) {
  static const std::map<long, std::string> names = {
      {0xEF53, "ext4"},        {0x58465342, "xfs"}, {0x9123683E, "btrfs"},  {0x01021994, "tmpfs"},
      {0x794C7630, "overlay"}, {0x6969, "NFS"},     {0x0BD00BD0, "Lustre"}, {0x47504653, "GPFS"},
      {0x19830326, "BeeGFS"},  {0x2FC12FC1, "ZFS"}, {0x00C36400, "CephFS"}, {0xFF534D42, "CIFS"},
      {0x65735546, "FUSE"}};
  const auto found = names.find(type);
  return found == names.end() ? fmt::format("file system {:#x}", type) : found->second;
}

}  // namespace

FolderCheck::FolderCheck(const std::string& folder) {
  const std::string there = existing_part(folder);
  token_ = fmt::format("{:08x}{:08x}", std::random_device{}(), std::random_device{}());
  base_ = fmt::format("{}/.drumsweep-doctor-{}", there == "/" ? "" : there, token_);
  look_at_space(there);
  try_writing();
  if (writable()) try_locking();
}

FolderCheck::~FolderCheck() {
  lock_.reset();
  std::error_code ignored;
  fs::remove(probe(), ignored);
  fs::remove(lock(), ignored);
}

void FolderCheck::look_at_space(const std::string& folder) {
  struct statfs info {};
  if (::statfs(folder.c_str(), &info) != 0) {
    findings_.push_back(
        {Level::problem, "folder", fmt::format("{}: {}", folder, std::strerror(errno)), "choose another with -o"});
    return;
  }
  const double free_gb = 1e-9 * static_cast<double>(info.f_bavail) * static_cast<double>(info.f_bsize);
  const std::string type = file_system(info.f_type);
  const std::string text = fmt::format("{} ({}): {:.1f} GB free", folder, type, free_gb);
  if (type == "tmpfs")
    findings_.push_back({Level::warning, "folder", text,
                         "this is memory: results are gone after a restart, and no other node sees them"});
  else if (free_gb < 1)
    findings_.push_back({Level::warning, "folder", text, "a design takes about 0.3 MB and more; make room"});
  else
    findings_.push_back({Level::ok, "folder", text, ""});
}

void FolderCheck::try_writing() {
  std::array<double, 5> ms{};
  try {
    const std::string bytes(recording_bytes, 'x');
    for (double& time : ms) {
      const auto begin = Clock::now();
      write_durably(probe(), bytes);
      time = std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
    }
    write_durably(probe(), token_);
  } catch (const WriteError& error) {
    findings_.push_back(
        {Level::problem, "writing", error.what(), "choose another folder with -o, or make it writable"});
    return;
  }
  std::sort(ms.begin(), ms.end());
  write_ms_ = ms[ms.size() / 2];
  const bool slow = write_ms_ > slow_write_ms;
  findings_.push_back({slow ? Level::warning : Level::ok, "writing",
                       fmt::format("a durable write of 0.3 MB takes {:.1f} ms (median of {}, longest {:.1f} ms)",
                                   write_ms_, ms.size(), ms.back()),
                       slow ? "designs of a few seconds would wait for the disk; use a faster file system" : ""});
}

void FolderCheck::try_locking() {
  const std::string advice =
      "two runs on one output folder would not notice each other: never start two (results stay right, time is lost)";
  try {
    lock_ = std::make_unique<OutputLock>(lock());
    if (!lock_->held()) {
      findings_.push_back({Level::warning, "locking", "the file system refuses locks", advice});
      return;
    }
    const OutputLock second(lock());
    findings_.push_back({Level::warning, "locking", "a file could be locked twice", advice});
  } catch (const LockHeldError&) {
    findings_.push_back({Level::ok, "locking", "works: a second run would be refused", ""});
  } catch (const WriteError& error) {
    findings_.push_back({Level::problem, "locking", error.what(), "choose another folder with -o"});
  }
}

}  // namespace drumsweep

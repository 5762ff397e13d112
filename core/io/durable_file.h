/// Files that are either whole or absent: temporary file, one write, fsync, rename, fsync of the folder.
#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace drumsweep {

/// A write that did not become durable (full disk, no permission ...), naming path and cause. What was there before is
/// untouched.
struct WriteError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Replaces the file at `path`. @throws WriteError
void write_durably(const std::string& path, std::string_view bytes);

/// Makes names in a folder durable: without it a power cut may lose a new one, or bring back one that was removed.
/// @throws WriteError
void sync_folder(const std::string& folder);

/// @throws std::runtime_error naming path and cause
std::string read_whole_file(const std::string& path);

}  // namespace drumsweep

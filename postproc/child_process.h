/// Other programs as child processes: gnuplot for figures, POV-Ray for pictures, FFmpeg for animations.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace drumsweep {

/// Runs a program in a folder, without a shell, so that no name needs quoting.
/// @param command  program and arguments
/// @param advice  what to do when the program is not installed, for the message
/// @throws std::runtime_error when it cannot be started or fails; the message holds what it said.
void run_program(const std::filesystem::path& folder, std::vector<std::string> command, const std::string& advice);

/// For use before long work. @throws std::runtime_error with the advice when no such program is in PATH
void need_program(const std::string& program, const std::string& advice);

/// A folder of its own under the system's temporary one; goes away with the object.
struct ScratchFolder {
  std::filesystem::path path;
  ScratchFolder();
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
};

}  // namespace drumsweep

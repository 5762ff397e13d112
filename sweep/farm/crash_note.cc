#include "sweep/farm/crash_note.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <climits>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>

namespace drumsweep {
namespace {

struct Fatal {
  int number;
  const char* name;
};
constexpr std::array<Fatal, 5> fatal = {
    {{SIGSEGV, "SIGSEGV\n"}, {SIGBUS, "SIGBUS\n"}, {SIGILL, "SIGILL\n"}, {SIGFPE, "SIGFPE\n"}, {SIGABRT, "SIGABRT\n"}}};

// All that the handler touches: it can reach nothing but globals.
std::array<struct sigaction, fatal.size()> before;
std::array<char, PATH_MAX> note_path;
std::array<char, 128> note_text;
volatile std::sig_atomic_t note_size = 0;  ///< 0: nothing to write
volatile std::sig_atomic_t hangs = 0;
alignas(16) std::array<char, 65536> handler_stack;

extern "C" void leave_note(int number) {
  std::size_t i = 0;
  while (i + 1 < fatal.size() && fatal[i].number != number) ++i;
  if (note_size > 0) {
    const int file = ::open(note_path.data(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
    if (file >= 0) {
      // One write, so that the note is whole or can be told to be torn.
      char text[192];
      const char* const cause = hangs ? "hang\n" : fatal[i].name;
      const auto size = static_cast<std::size_t>(note_size), name = std::strlen(cause);
      std::memcpy(text, note_text.data(), size);
      std::memcpy(text + size, cause, name);
      [[maybe_unused]] const ssize_t ignored = ::write(file, text, size + name);
      ::fsync(file);
      ::close(file);
    }
  }
  ::sigaction(number, &before[i], nullptr);
  ::raise(number);
}

}  // namespace

void install_crash_handler() {
  stack_t stack{};
  stack.ss_sp = handler_stack.data();
  stack.ss_size = handler_stack.size();
  ::sigaltstack(&stack, nullptr);
  for (std::size_t i = 0; i < fatal.size(); ++i) {
    struct sigaction action {};
    action.sa_handler = leave_note;
    action.sa_flags = SA_ONSTACK;
    ::sigaction(fatal[i].number, &action, &before[i]);
  }
}

void abort_as_hang() {
  hangs = 1;
  std::abort();
}

CrashNote::CrashNote(const std::string& path, int attempt) {
  note_size = 0;
  const std::string text = fmt::format("drumsweep design crashed in attempt {} by ", attempt);
  if (path.size() >= note_path.size() || text.size() >= note_text.size()) return;
  std::memcpy(note_path.data(), path.c_str(), path.size() + 1);
  std::memcpy(note_text.data(), text.data(), text.size());
  note_size = static_cast<int>(text.size());
}

CrashNote::~CrashNote() { note_size = 0; }

std::optional<Crash> read_crash_note(const std::string& path) {
  std::ifstream stream(path);
  std::string line;
  if (!std::getline(stream, line) || stream.eof()) return std::nullopt;
  int attempt = 0;
  char signal[16] = "";
  if (std::sscanf(line.c_str(), "drumsweep design crashed in attempt %d by %15s", &attempt, signal) != 2)
    return std::nullopt;
  return Crash{attempt, signal};
}

}  // namespace drumsweep

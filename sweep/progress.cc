#include "sweep/progress.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <spdlog/sinks/basic_file_sink.h>
#include <spdlog/spdlog.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>

#include "core/io/durable_file.h"

namespace drumsweep {
namespace {

/// Is somebody watching? Under mpirun our standard error is a pipe to it, and its own is what counts (same host only).
bool stderr_is_terminal() {
  if (::isatty(STDERR_FILENO) != 0) return true;
  if (std::getenv("OMPI_COMM_WORLD_SIZE") == nullptr) return false;
  std::error_code error;
  const auto target = std::filesystem::read_symlink(fmt::format("/proc/{}/fd/2", ::getppid()), error);
  return !error && target.string().rfind("/dev/pts/", 0) == 0;
}

/// Columns of the terminal; 80 where it cannot be asked (behind mpirun).
std::size_t terminal_columns() {
  winsize size{};
  return ::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 20 ? size.ws_col : 80;
}

spdlog::level::level_enum level_from_environment() {
  const char* text = std::getenv("DRUMSWEEP_LOG");
  return text == nullptr || *text == '\0' ? spdlog::level::info : spdlog::level::from_str(text);
}

std::string describe(const Progress& run) {
  return fmt::format("{} {:.1f}/{}{:.4g} turns, {} balls, t = {:.1f} s", run.what, run.turns,
                     std::string_view(run.what) == "warm-up" ? "at most " : "", run.turns_planned, run.balls,
                     run.time_s);
}

}  // namespace

std::string clock_text(double seconds) {
  if (!(seconds < 3.6e9)) return "?";
  const auto s = static_cast<long long>(std::llround(std::max(0.0, seconds)));
  return fmt::format("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60);
}

Reporter::Reporter()
    : level_(level_from_environment()), terminal_(stderr_is_terminal()), colour_(std::getenv("NO_COLOR") == nullptr) {}

Reporter::~Reporter() { clear(); }

void Reporter::log_to(const std::string& path) {
  try {
    file_ = std::make_shared<spdlog::logger>("run", std::make_shared<spdlog::sinks::basic_file_sink_mt>(path));
  } catch (const spdlog::spdlog_ex& error) {
    throw WriteError(path + ": " + error.what());
  }
  file_->set_pattern("%Y-%m-%d %H:%M:%S %l %v");
  file_->set_level(static_cast<spdlog::level::level_enum>(level_));
  file_->flush_on(spdlog::level::trace);
  // A log that cannot be written is no reason to lose a run; a result that cannot be written stops it elsewhere.
  file_->set_error_handler([](const std::string&) {});
}

void Reporter::info(const std::string& text) { say(spdlog::level::info, text); }
void Reporter::warn(const std::string& text) { say(spdlog::level::warn, text); }
void Reporter::error(const std::string& text) { say(spdlog::level::err, text); }

void Reporter::say(int level, const std::string& text) {
  if (file_) file_->log(static_cast<spdlog::level::level_enum>(level), text);
  if (level < level_) return;
  clear();
  const char* mark = level >= spdlog::level::err ? "error: " : level >= spdlog::level::warn ? "warning: " : "";
  fmt::print(stderr, "{:%H:%M:%S} {}{}\n", fmt::localtime(std::time(nullptr)), mark, text);
  std::fflush(stderr);
}

void Reporter::clear() {
  if (bar_width_ == 0) return;
  fmt::print(stderr, "\r{:{}}\r", "", bar_width_);
  std::fflush(stderr);
  bar_width_ = 0;
}

bool Reporter::due() const {
  return Clock::now() - shown_ > (terminal_ ? std::chrono::milliseconds(200) : std::chrono::milliseconds(60000));
}

std::string Reporter::remaining(const SweepCounts& counts, double fraction_of_running) {
  if (counts.total == 0) return "";
  if (!begun_) begin_ = Clock::now();
  begun_ = true;
  // Designs under way count by the share that this rank has done of its own.
  const double under_way = static_cast<double>(counts.running) * fraction_of_running;
  const double made = static_cast<double>(counts.done_now) + under_way;
  const double left = static_cast<double>(counts.total - counts.done) - under_way;
  const double elapsed = std::chrono::duration<double>(Clock::now() - begin_).count();
  const std::string eta = made > 0.02 && elapsed > 1 ? clock_text(elapsed * left / made) : "?";
  return fmt::format("designs {}/{}, ETA {}, ", counts.done, counts.total, eta);
}

void Reporter::update(const Progress& run, const SweepCounts& counts) {
  const bool designs = std::string_view(run.what) != "warm-up";
  const double fraction = run.turns_planned > 0 ? std::min(1.0, run.turns / run.turns_planned) : 0;
  if (designs && !begun_) remaining(counts, 0);
  if (!due()) return;
  const double all = counts.total == 0 || !designs
                         ? fraction
                         : (static_cast<double>(counts.done) + fraction * static_cast<double>(counts.running)) /
                               static_cast<double>(counts.total);
  // The end of the work first: a narrow terminal cuts the rest.
  show(std::min(1.0, all), (designs ? remaining(counts, fraction) : std::string()) + describe(run));
}

void Reporter::update(const SceneProgress& scene) {
  if (!due()) return;
  show(scene.end_s > 0 ? std::min(1.0, scene.time_s / scene.end_s) : 0,
       fmt::format("{}: {:.3g} of at most {:.3g} s simulated, {} balls", scene.what, scene.time_s, scene.end_s,
                   scene.balls));
}

void Reporter::update_waiting(const SweepCounts& counts) {
  if (!due()) return;
  show(static_cast<double>(counts.done) / static_cast<double>(std::max<std::size_t>(1, counts.total)),
       fmt::format("{}waiting for {} designs on other ranks", remaining(counts, 0.5), counts.running));
}

void Reporter::show(double fraction, const std::string& text) {
  shown_ = Clock::now();
  if (!terminal_) {
    say(spdlog::level::info, text);
    return;
  }
  if (level_ > spdlog::level::info) return;
  if (file_ && shown_ - logged_ > std::chrono::minutes(1)) {
    file_->info(text);
    logged_ = shown_;
  }
  // A line longer than the terminal would wrap and could not be taken back.
  constexpr std::size_t cells = 16;
  const auto full = static_cast<std::size_t>(fraction * cells);
  const std::string bar = std::string(full, '#') + std::string(cells - full, '.');
  const std::string words = text.substr(0, terminal_columns() - cells - 4);
  const std::size_t width = cells + 3 + words.size(), before = bar_width_;
  fmt::print(stderr, "\r{}[{}]{} {}{:{}}", colour_ ? "\x1b[36m" : "", bar, colour_ ? "\x1b[0m" : "", words, "",
             before > width ? before - width : 0);
  std::fflush(stderr);
  bar_width_ = std::max(before, width);
}

}  // namespace drumsweep

#include "sweep/farm/design_run.h"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <new>
#include <sstream>
#include <stdexcept>

#include "core/io/durable_file.h"
#include "core/scene/cpu_clock.h"
#include "sweep/farm/checkpoint.h"
#include "sweep/farm/crash_note.h"
#include "sweep/farm/hang_watch.h"
#include "sweep/farm/test_fault.h"

namespace drumsweep {
namespace {

/// What is stored is finite: a recording that cannot be evaluated would be called done for ever.
void refuse_non_finite(const Recording& recording) {
  for (const Landing& l : recording.landings)
    for (const double value : {l.time, l.x, l.y, static_cast<double>(l.vx), static_cast<double>(l.vy),
                               static_cast<double>(l.vz), static_cast<double>(l.radius)})
      if (!std::isfinite(value))
        throw std::runtime_error(fmt::format("landing of ball {} at {} s: not a finite number", l.ball_id, l.time));
}

}  // namespace

DesignOutcome simulate_and_store(const OutputPaths& paths, const Study& study, const DrumState& warm,
                                 const PlannedDesign& design, std::size_t index, const std::string& host,
                                 const Observer& observer, const RunHow& how) {
  const auto begin = std::chrono::steady_clock::now();
  const double cpu_begin = cpu_seconds(CLOCK_PROCESS_CPUTIME_ID);
  DesignOutcome outcome{index, DesignOutcome::Kind::done, 0, 0, host, "", ""};
  const CrashNote crash_note(paths.crash(design.id), how.attempt);
  Checkpoint checkpoint(paths, study, design, how.attempt, how.checkpoint_interval_s);
  TestFault fault(index);
  HangWatch watch(fmt::format("design {} on {}", design.id, host), how.hang_s);
  try {
    DesignProgress progress = checkpoint.read();
    outcome.note = checkpoint.note();
    if (progress.begun)
      outcome.note = fmt::format("goes on from its checkpoint at outer step {}", progress.state.num_steps);
    const Observer between_steps = [&](const Progress& at) {
      {
        const HangWatch::Counting pause(watch, false);
        checkpoint.between_steps(progress, at);
      }
      fault.between_steps(at, progress);
      const HangWatch::Counting pause(watch, false);
      return !observer || observer(at);
    };
    const Recording recording = [&] {
      const HangWatch::Counting engine(watch, true);
      return continue_design(study, warm, design.values, progress, between_steps, how.threads);
    }();
    if (recording.stopped) {
      outcome.kind = DesignOutcome::Kind::stopped;
      checkpoint.save(progress);
    } else {
      refuse_non_finite(recording);
      write_recording(paths, study, design, recording);
      checkpoint.remove();
    }
  } catch (const WriteError&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    outcome.kind = DesignOutcome::Kind::failed;
    outcome.reason = error.what();
    write_failure(paths, design, outcome.reason);
    checkpoint.remove();
  }
  outcome.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  outcome.cpu_s = cpu_seconds(CLOCK_PROCESS_CPUTIME_ID) - cpu_begin;
  return outcome;
}

std::string pack_assignment(const Assignment& a) {
  std::string text = fmt::format("{} {} {}", a.index, a.attempt, a.design.id);
  for (const auto& [key, value] : a.design.values) text += fmt::format(" {} {}", key, value);
  return text;
}

Assignment unpack_assignment(const std::string& text) {
  Assignment a;
  std::istringstream stream(text);
  bool good = static_cast<bool>(stream >> a.index >> a.attempt >> a.design.id);
  std::string key;
  while (good && stream >> key) {
    double value = 0;
    good = static_cast<bool>(stream >> value);
    a.design.values.emplace_back(key, value);
  }
  if (!good) throw std::runtime_error("message with a design that cannot be read: " + text);
  return a;
}

std::string pack_outcome(const DesignOutcome& o) {
  return fmt::format("{} {} {} {} {}\n{}\n{}", o.index, static_cast<int>(o.kind), o.wall_s, o.cpu_s, o.host, o.note,
                     o.reason);
}

DesignOutcome unpack_outcome(const std::string& text) {
  DesignOutcome o;
  int kind = 0;
  std::istringstream stream(text);
  if (!(stream >> o.index >> kind >> o.wall_s >> o.cpu_s >> o.host) || kind < 0 || kind > 2)
    throw std::runtime_error("message with an outcome that cannot be read: " + text);
  o.kind = static_cast<DesignOutcome::Kind>(kind);
  // The note is one line, the reason all that follows.
  const std::size_t line = text.find('\n'), next = line == std::string::npos ? line : text.find('\n', line + 1);
  if (next == std::string::npos) throw std::runtime_error("message with an outcome that is cut off: " + text);
  o.note = text.substr(line + 1, next - line - 1);
  o.reason = text.substr(next + 1);
  return o;
}

}  // namespace drumsweep

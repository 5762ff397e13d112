#include "sweep/farm/design_run.h"

#include <fmt/format.h>

#include <chrono>
#include <new>
#include <sstream>
#include <stdexcept>

#include "core/io/durable_file.h"
#include "core/scene/cpu_clock.h"

namespace drumsweep {

DesignOutcome simulate_and_store(const OutputPaths& paths, const Study& study, const DrumState& warm,
                                 const PlannedDesign& design, std::size_t index, const std::string& host,
                                 const Observer& observer, int threads) {
  const auto begin = std::chrono::steady_clock::now();
  const double cpu_begin = cpu_seconds(CLOCK_PROCESS_CPUTIME_ID);
  DesignOutcome outcome{index, DesignOutcome::Kind::done, 0, 0, host, ""};
  try {
    const Recording recording = run_design(study, warm, design.values, observer, threads);
    if (recording.stopped)
      outcome.kind = DesignOutcome::Kind::stopped;
    else
      write_recording(paths, study, design, recording);
  } catch (const WriteError&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    outcome.kind = DesignOutcome::Kind::failed;
    outcome.reason = error.what();
    write_failure(paths, design, outcome.reason);
  }
  outcome.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  outcome.cpu_s = cpu_seconds(CLOCK_PROCESS_CPUTIME_ID) - cpu_begin;
  return outcome;
}

std::string pack_assignment(const Assignment& a) {
  std::string text = fmt::format("{} {}", a.index, a.design.id);
  for (const auto& [key, value] : a.design.values) text += fmt::format(" {} {}", key, value);
  return text;
}

Assignment unpack_assignment(const std::string& text) {
  Assignment a;
  std::istringstream stream(text);
  bool good = static_cast<bool>(stream >> a.index >> a.design.id);
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
  return fmt::format("{} {} {} {} {}\n{}", o.index, static_cast<int>(o.kind), o.wall_s, o.cpu_s, o.host, o.reason);
}

DesignOutcome unpack_outcome(const std::string& text) {
  DesignOutcome o;
  int kind = 0;
  std::istringstream stream(text);
  if (!(stream >> o.index >> kind >> o.wall_s >> o.cpu_s >> o.host) || kind < 0 || kind > 2)
    throw std::runtime_error("message with an outcome that cannot be read: " + text);
  o.kind = static_cast<DesignOutcome::Kind>(kind);
  const std::size_t line = text.find('\n');
  if (line != std::string::npos) o.reason = text.substr(line + 1);
  return o;
}

}  // namespace drumsweep

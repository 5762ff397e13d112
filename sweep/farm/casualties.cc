#include "sweep/farm/casualties.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "core/config/toml_reader.h"
#include "core/io/durable_file.h"
#include "sweep/farm/checkpoint.h"
#include "sweep/farm/crash_note.h"

namespace drumsweep {
namespace {

namespace fs = std::filesystem;

/// The crash of the attempt that is open, if it was one.
std::optional<Crash> last_crash(const OutputPaths& paths, const std::string& id, int attempt) {
  std::optional<Crash> crash = read_crash_note(paths.crash(id));
  if (crash && crash->attempt != attempt) crash.reset();
  return crash;
}

}  // namespace

std::vector<std::string> Casualties::settle_last_run() {
  std::vector<ProvenanceLine> crashed, others;
  std::vector<std::string> say;
  for (const std::string& id : provenance_.open_designs()) {
    const int attempt = provenance_.attempts(id);
    const std::optional<Crash> crash = last_crash(paths_, id, attempt);
    // A recording whose line did not come any more is no loss.
    const char* event = crash                             ? "crashed"
                        : has_loose_recording(paths_, id) ? "done"
                        : has_failure(paths_, id)         ? "failed"
                                                          : "lost";
    (crash ? crashed : others).push_back({event, id, attempt, 0, "", 0, 0, "", ""});
    if (crash)
      say.push_back(fmt::format("design {} has crashed its process in attempt {} ({})", id, attempt, crash->signal));
  }
  for (ProvenanceLine& line : others)
    if (!crashed.empty() && line.event == "lost") line.event = "aborted";
  crashed.insert(crashed.end(), others.begin(), others.end());
  if (!crashed.empty()) provenance_.add(std::move(crashed));
  return say;
}

std::string Casualties::bury(const PlannedDesign& design, int rank) {
  const int attempt = provenance_.attempts(design.id);
  const std::optional<Crash> crash = last_crash(paths_, design.id, attempt);
  provenance_.add({crash ? "crashed" : "lost", design.id, attempt, rank, "", 0, 0, "", ""});
  return fmt::format("design {} was lost with rank {}{}", design.id, rank, crash ? " (" + crash->signal + ")" : "");
}

int Casualties::suspicion(const std::string& design_id) const {
  const std::vector<int>& lost = provenance_.history(design_id).lost;
  // A single loss says nothing, and the loss of a whole job must not cost a look at every checkpoint.
  if (lost.size() < 2) return 0;
  const int progress = last_attempt_with_progress(paths_, design_id);
  const auto without = std::count_if(lost.begin(), lost.end(), [&](int attempt) { return attempt > progress; });
  return without < 2 ? 0 : static_cast<int>(without);
}

std::optional<std::string> Casualties::judge(const PlannedDesign& design) {
  const DesignHistory& history = provenance_.history(design.id);
  std::string reason;
  if (history.crashes >= crashes_until_quarantine) {
    const std::optional<Crash> crash = read_crash_note(paths_.crash(design.id));
    reason = fmt::format("{}crashed its process {} times ({})", quarantined, history.crashes,
                         crash ? crash->signal : "signal unknown");
  } else if (suspicion(design.id) >= losses_until_quarantine) {
    reason = fmt::format("{}its process was killed {} times in a row before it got any further", quarantined,
                         losses_until_quarantine);
  }
  if (reason.empty()) return std::nullopt;
  dump(design, reason);
  write_failure(paths_, design, reason);
  std::error_code ignored;
  fs::remove(paths_.checkpoint(design.id), ignored);
  return reason;
}

/// The study with this design as its only stage. Not the outlet's own keys: they may decide the warm drum too.
void Casualties::dump(const PlannedDesign& design, const std::string& reason) const {
  Study study = study_;
  study.stages = {{design.id, "points", {}}};
  std::vector<double> at;
  for (const auto& [key, value] : design.values) {
    StageVariable& variable = study.stages.front().variables.emplace_back();
    variable.key = key;
    variable.values = {value};
    at.push_back(value);
  }
  make_folder(paths_.quarantine());
  const std::string file = fmt::format("{}/{}.toml", paths_.quarantine(), design.id);
  write_durably(file, fmt::format("# Design {}, {}\n# drumsweep simulate {} --at {} -o {}\n\n{}", design.id, reason,
                                  file, fmt::join(at, ","), paths_.quarantine(), write_study(study, false)));
  // Beside the warm drum the same steps are taken again.
  std::error_code error;
  const std::string warm = paths_.quarantine() + "/warm_state.h5";
  if (!fs::exists(warm, error)) {
    fs::create_hard_link(paths_.warm_state(), warm, error);
    if (error) fs::copy_file(paths_.warm_state(), warm, error);
  }
}

std::vector<std::string> Casualties::retry(bool failed, bool lost) {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(paths_.designs()))
    if (entry.path().extension() == ".failed") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  std::vector<fs::path> chosen;
  std::vector<ProvenanceLine> lines;
  std::vector<std::string> say;
  for (const fs::path& file : files) {
    const std::string id = file.stem().string(), text = read_whole_file(file.string());
    const std::string reason = text.substr(std::min(text.size(), text.find('\n') + 1));
    if (!(reason.rfind(quarantined, 0) == 0 ? lost : failed)) continue;
    chosen.push_back(file);
    lines.push_back({"retry", id, std::max(1, provenance_.attempts(id)), 0, "", 0, 0, "", ""});
    say.push_back(fmt::format("design {} is tried again; it was {}", id, reason.substr(0, reason.find('\n'))));
  }
  // The ledger first: a crash in between leaves the failures, which are asked for again.
  if (!lines.empty()) provenance_.add(std::move(lines));
  for (const fs::path& file : chosen) {
    std::error_code error;
    fs::remove(paths_.crash(file.stem().string()), error);
    if (!fs::remove(file, error))
      throw WriteError(fmt::format("{}: cannot be removed: {}", file.string(), error.message()));
  }
  return say;
}

}  // namespace drumsweep

#include "sweep/why.h"

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <filesystem>

#include "core/config/schema.h"
#include "sweep/farm/casualties.h"
#include "sweep/find_design.h"
#include "sweep/status.h"
#include "sweep/store/recordings.h"
#include "sweep/store/results_image.h"

namespace drumsweep {
namespace {

std::vector<DesignStory::Attempt> attempts_of(const std::string& id, const std::vector<ProvenanceLine>& lines) {
  std::vector<DesignStory::Attempt> attempts;
  for (const ProvenanceLine& line : lines) {
    if (line.design_id != id) continue;
    if (line.event == "started") {
      attempts.push_back({line.attempt, line.rank, line.host, line.time_utc, "", "", 0, 0});
    } else if (!attempts.empty() && attempts.back().end_utc.empty()) {
      DesignStory::Attempt& last = attempts.back();
      last.end_utc = line.time_utc;
      last.event = line.event;
      last.wall_s = line.wall_s;
      last.cpu_s = line.cpu_s;
      if (!line.host.empty()) last.host = line.host;
    }
  }
  return attempts;
}

/// All that lies in designs/ under its id, and the pack that holds its recording.
std::vector<std::string> files_of(const OutputPaths& paths, const RecordingIndex& recordings, const std::string& id) {
  std::vector<std::string> files;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(paths.designs(), error))
    if (entry.path().filename().string().starts_with(id)) files.push_back(entry.path().string());
  const std::string file = recordings.file_of(id);
  if (!file.empty() && std::find(files.begin(), files.end(), file) == files.end()) files.push_back(file);
  std::sort(files.begin(), files.end());
  return files;
}

/// State and row from what is stored.
void look_up_result(const OutputPaths& paths, const Study& study, RecordingIndex& recordings, DesignStory& story) {
  const PlannedDesign& design = story.design;
  if (!design.impossible.empty()) {
    story.state = "failed";
    story.reason = design.impossible;
    story.retry = "there is no such drum; change the stage";
    return;
  }
  if (!recordings.has_recording(design.id) && !recordings.has_failure(design.id)) return;
  try {
    const bool steady = read_warm_state(paths.warm_state(), study).value_or(WarmState{}).steady;
    story.row = stored_row(recordings, {}, study, design, steady);
  } catch (const std::exception& error) {
    story.state = "damaged";
    story.reason = error.what();
    story.retry = "run the same command again: the file is set aside and the design simulated anew";
    return;
  }
  if (!story.row) return;
  story.state = story.row->state;
  story.reason = story.row->reason;
  if (recordings.has_recording(design.id))
    story.retry = story.state == "done" ? "" : "its landings are stored; other settings need another output folder";
  else
    story.retry = fmt::format("run the same command again with --retry {}",
                              story.reason.rfind(quarantined, 0) == 0 ? "lost" : "failed");
}

}  // namespace

DesignStory story_of(const std::string& folder, const std::string& which, const std::vector<double>& at) {
  const OutputPaths paths{folder};
  const Study study = read_frozen_study(folder);
  const Plan plan = plan_of_folder(paths, study);
  DesignStory story;
  story.design = at.empty() ? design_with_id(plan, which) : design_with_values(plan, study, at);
  story.columns = plan.columns;
  const std::string& id = story.design.id;
  RecordingIndex recordings(paths);
  story.attempts = attempts_of(id, read_provenance(paths.provenance()));
  story.files = files_of(paths, recordings, id);
  look_up_result(paths, study, recordings, story);

  const std::optional<ActiveRun> run = active_run(paths);
  const bool running = run && run->designs.count(id) > 0;
  if (!story.attempts.empty() && story.attempts.back().end_utc.empty())
    story.attempts.back().event = running ? "running" : "lost";
  if (story.state.empty()) {
    story.retry = "run the same command again";
    if (running) {
      story.state = "running";
      story.retry.clear();
    } else if (story.attempts.empty()) {
      story.state = "pending";
      story.reason = "not begun yet";
    } else if (story.attempts.back().event == "lost") {
      story.state = "lost";
      story.reason = "its process ended without a word: killed, crashed, or the machine went down; see run.log";
    } else {
      story.state = story.attempts.back().event == "stopped" ? "stopped" : "pending";
      story.reason = story.state == "stopped" ? "the run was stopped" : "its result is not there any more";
    }
  }
  return story;
}

}  // namespace drumsweep

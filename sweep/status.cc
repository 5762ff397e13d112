#include "sweep/status.h"

#include <algorithm>
#include <exception>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>

#include "core/config/schema.h"
#include "core/io/durable_file.h"
#include "sweep/plan/findings.h"
#include "sweep/store/output_lock.h"
#include "sweep/store/provenance.h"
#include "sweep/store/recordings.h"
#include "sweep/store/results.h"
#include "sweep/store/results_image.h"
#include "sweep/store/store.h"

namespace drumsweep {
namespace {

std::map<std::string, ResultRow> rows_of_table(const OutputPaths& paths) {
  std::map<std::string, ResultRow> rows;
  std::error_code error;
  if (!std::filesystem::exists(paths.results(), error)) return rows;
  for (ResultRow& row : read_results_csv(paths.results()).rows) rows.emplace(row.design_id, std::move(row));
  return rows;
}

/// Its process died, and the run that found out has not begun it again yet.
bool is_loss(const std::string& event) { return event == "lost" || event == "crashed" || event == "aborted"; }

}  // namespace

std::optional<ActiveRun> active_run(const OutputPaths& paths) {
  const auto text = read_held_lock(paths.lock());
  if (!text) return std::nullopt;
  ActiveRun run;
  std::istringstream lines(*text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string word;
    words >> word;
    if (word == "phase") run.phase = line.substr(std::min(line.size(), word.size() + 1));
    if (word == "running")
      while (words >> word) run.designs.insert(word);
  }
  return run;
}

Plan plan_of_folder(const OutputPaths& paths, const Study& study) {
  Plan plan = plan_designs(study);
  std::error_code error;
  if (!std::filesystem::exists(paths.findings(), error)) return plan;
  Plan with_searches = plan;
  try {
    restore_searches(with_searches, study, read_whole_file(paths.findings()), paths.findings());
  } catch (const InputError&) {
    // Of the study before stages were appended: the run that takes them up writes it anew.
    return plan;
  }
  return with_searches;
}

SweepStatus read_status(const std::string& folder) {
  const OutputPaths paths{folder};
  const Study study = read_frozen_study(folder);
  const Plan plan = plan_of_folder(paths, study);
  const bool complete =
      std::all_of(plan.stages.begin(), plan.stages.end(), [](const StageSummary& s) { return s.complete; });
  SweepStatus status;
  status.total = plan.designs.size();
  status.variable_names = plan.columns;

  std::set<std::string> running;
  if (auto run = active_run(paths)) {
    status.active = true;
    status.phase = std::move(run->phase);
    running = std::move(run->designs);
  }

  // The last word on each design.
  std::map<std::string, std::string> last_event;
  const std::vector<ProvenanceLine> provenance = read_provenance(paths.provenance());
  status.timeline = timeline_of(provenance, status.active, now_s());
  for (const ProvenanceLine& line : provenance) {
    status.cpu_s += line.cpu_s;
    if (!line.design_id.empty()) last_event[line.design_id] = line.event;
  }

  // A design has a result when its file is there; the table may be some seconds behind.
  const std::map<std::string, ResultRow> table = rows_of_table(paths);
  RecordingIndex recordings(paths);
  std::optional<bool> steady;
  std::vector<ResultRow> rows;
  for (const StageSummary& stage : plan.stages) status.stages.push_back({stage.name, stage.type, 0, 0, stage.complete});
  for (const PlannedDesign& design : plan.designs) {
    std::optional<ResultRow> row;
    ++status.stages[design.stage_number].designs;
    if (!design.impossible.empty()) {
      row = failed_row(design, design.impossible);
    } else if (recordings.has_recording(design.id) || recordings.has_failure(design.id)) {
      if (const auto found = table.find(design.id); found != table.end()) {
        row = found->second;
      } else {
        try {
          if (!steady) steady = read_warm_state(paths.warm_state(), study).value_or(WarmState{}).steady;
          row = stored_row(recordings, {}, study, design, *steady);
        } catch (const std::exception&) {
          // Damaged: the next run sets it aside and simulates the design again.
        }
      }
    }
    if (row) {
      ++status.stages[design.stage_number].ended;
      (row->state == "done"        ? status.state.done
       : row->state == "untrusted" ? status.state.untrusted
                                   : status.state.failed)++;
      rows.push_back(std::move(*row));
    } else if (running.count(design.id) > 0) {
      ++status.state.running;
    } else {
      const auto event = last_event.find(design.id);
      const bool begun = event != last_event.end();
      // While a run is on, "started" without an end is the moment before the lock file says so.
      std::size_t& counter = !begun                       ? status.state.pending
                             : event->second == "stopped" ? status.state.stopped
                             : is_loss(event->second)     ? status.state.lost
                             : event->second != "started" ? status.state.pending
                             : status.active              ? status.state.running
                                                          : status.state.lost;
      ++counter;
    }
  }
  status.finished = complete && rows.size() == plan.designs.size();
  if (const auto best = best_row(rows)) status.best = rows[*best];
  status.rows = std::move(rows);
  return status;
}

}  // namespace drumsweep

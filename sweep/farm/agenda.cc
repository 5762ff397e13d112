#include "sweep/farm/agenda.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <utility>

#include "core/io/durable_file.h"
#include "sweep/farm/checkpoint.h"
#include "sweep/store/results.h"

namespace drumsweep {
namespace {

using Clock = std::chrono::steady_clock;

/// The table in the folder is at most this old while designs come in.
constexpr auto table_interval = std::chrono::seconds(10);

}  // namespace

Agenda::Agenda(const Study& study, const std::string& folder, Reporter& reporter)
    : study_(study), reporter_(reporter), planner_(study), store_(folder, study), recordings_(store_.paths()) {
  reporter_.log_to(paths().log());
  provenance_.emplace(paths().provenance());
  casualties_.emplace(paths(), study_, *provenance_);
}

void Agenda::settle_the_past(bool retry_failed, bool retry_lost) {
  for (const std::string& note : casualties_->settle_last_run()) reporter_.warn(note);
  for (const std::string& note : casualties_->retry(retry_failed, retry_lost)) reporter_.info(note);
  remove_stale_checkpoints(paths());
  recordings_ = RecordingIndex(paths());
}

// --- what is there, what is missing

void Agenda::take_stock(bool steady, const GoOn& go_on) {
  steady_ = steady;
  known_ = KnownRows(paths().results_image(), study_, steady_);
  known_.confirm(recordings_, study_, plan(), steady_);
  // What is stored may let searches ask for more, which may be stored too.
  stocked_ = look_up_new_designs(go_on);
  const bool grown = grow(go_on, stocked_);
  if (grown && stocked_ && !pending_.empty()) publish_plan();
  if (const std::size_t stored = num_rows_; stored > 0)
    reporter_.info(fmt::format("{} of {} designs are there already", stored, plan().designs.size()));
}

bool Agenda::refill(const GoOn& go_on) {
  bool going_on = true;
  const bool grown = grow(go_on, going_on);
  if (grown) publish_plan();
  return grown;
}

/// Lets searches ask until there is something to run. @param going_on  becomes false when told to end
/// @return whether there is anything new
bool Agenda::grow(const GoOn& go_on, bool& going_on) {
  bool grown = false;
  while (going_on && pending_.empty() && extend_plan()) {
    going_on = look_up_new_designs(go_on);
    grown = true;
  }
  return grown;
}

/// For whoever looks at the folder meanwhile: which designs searches have asked for.
void Agenda::publish_plan() const { replace(paths().findings(), to_toml(plan(), std::nullopt)); }

RowOf Agenda::row_of() const {
  return [this](const PlannedDesign& design) {
    const std::size_t i = plan().index_of_id.at(design.id);
    return i < rows_.size() && rows_[i] ? &*rows_[i] : nullptr;
  };
}

/// Lets searches ask for designs, and says what they have decided. True when there is something new.
bool Agenda::extend_plan() {
  std::vector<std::size_t> num_notes;
  for (const StageSummary& stage : plan().stages) num_notes.push_back(stage.notes.size());
  const bool grown = planner_.extend(row_of());
  for (std::size_t s = 0; s < num_notes.size(); ++s)
    for (std::size_t n = num_notes[s]; n < plan().stages[s].notes.size(); ++n)
      reporter_.info(fmt::format("stage \"{}\": {}", plan().stages[s].name, plan().stages[s].notes[n]));
  return grown;
}

/// Rows of designs that the plan has got since the last call, or a place among the pending ones. False when told to end.
bool Agenda::look_up_new_designs(const GoOn& go_on) {
  const std::size_t begin = rows_.size(), end = plan().designs.size();  // go_on() may let the plan grow
  rows_.resize(end);
  bool going_on = true;
  for (std::size_t i = begin; i < end && going_on; ++i) {
    const PlannedDesign& design = plan().designs[i];
    if (!design.impossible.empty()) {
      set_row(i, failed_row(design, design.impossible));
    } else if (!load_row(i) && !in_quarantine(i)) {
      pending_.push_back(i);
    } else if (rows_[i]->state == "failed" && recordings_.has_failure(design.id)) {
      reporter_.info(fmt::format("design {} has failed before ({}); --retry {} has it tried again", design.id,
                                 rows_[i]->reason, rows_[i]->reason.rfind(quarantined, 0) == 0 ? "lost" : "failed"));
    }
    going_on = go_on();
  }
  put_suspects_last();
  return going_on;
}

void Agenda::set_row(std::size_t i, ResultRow row) {
  num_rows_ += rows_[i] ? 0 : 1;
  rows_[i] = std::move(row);
}

/// Row of a stored design; false when nothing usable is stored. What a damaged pack still has is found at the second
/// look.
bool Agenda::load_row(std::size_t i) {
  const PlannedDesign& design = plan().designs[i];
  for (int look = 0; look < 2 && !rows_[i]; ++look) {
    try {
      if (std::optional<ResultRow> row = stored_row(recordings_, known_, study_, design, steady_))
        set_row(i, std::move(*row));
      break;
    } catch (const StoreError& error) {
      reporter_.warn(recordings_.set_aside(design.id, error.what()));
    }
  }
  return rows_[i].has_value();
}

// --- designs that are given out and come back

std::optional<std::size_t> Agenda::take() {
  if (pending_.empty()) return std::nullopt;
  const std::size_t index = pending_.front();
  pending_.pop_front();
  return index;
}

const ResultRow& Agenda::enter(std::size_t index) {
  const std::string& id = plan().designs[index].id;
  recordings_.look_again(id);
  if (!load_row(index)) throw WriteError(paths().recording(id) + ": was written, yet is damaged");
  return *rows_[index];
}

bool Agenda::bury(std::size_t index, int rank) {
  const PlannedDesign& design = plan().designs[index];
  reporter_.warn(casualties_->bury(design, rank));
  recordings_.look_again(design.id);
  if (recordings_.has_recording(design.id) && load_row(index)) return false;
  if (in_quarantine(index)) return false;
  pending_.push_back(index);
  return true;
}

/// Whether this design has killed its process too often; it has its row then.
bool Agenda::in_quarantine(std::size_t i) {
  const std::string& id = plan().designs[i].id;
  const std::optional<std::string> reason = casualties_->judge(plan().designs[i]);
  if (!reason) return false;
  reporter_.warn(fmt::format("design {} is {}; its input: {}/{}.toml", id, *reason, paths().quarantine(), id));
  recordings_.look_again(id);
  return load_row(i);
}

/// So that all others are done before one of them can end the job again.
void Agenda::put_suspects_last() {
  std::map<std::size_t, int> suspicion;
  for (const std::size_t index : pending_) suspicion[index] = casualties_->suspicion(plan().designs[index].id);
  std::stable_sort(pending_.begin(), pending_.end(),
                   [&](std::size_t a, std::size_t b) { return suspicion[a] < suspicion[b]; });
}

// --- files

ResultTable Agenda::table() const {
  ResultTable out{plan().columns, {}};
  for (const std::size_t i : table_order(plan()))
    if (i < rows_.size() && rows_[i]) out.rows.push_back(*rows_[i]);
  return out;
}

void Agenda::write_tables() {
  table_written_ = Clock::now();
  replace(paths().results(), to_csv(table()));
  replace(paths().results_image(), pack_results(study_, table(), steady_, recordings_, provenance_->lines()));
  if (!stocked_) return;
  for (const std::string& note : recordings_.pack()) reporter_.info(note);
}

void Agenda::write_tables_now_and_then() {
  if (Clock::now() - table_written_ > table_interval) write_tables();
}

std::optional<Findings> Agenda::write_findings() {
  std::optional<Findings> findings = find(study_, plan(), row_of());
  replace(paths().findings(), to_toml(plan(), findings));
  return findings;
}

void Agenda::replace(const std::string& path, const std::string& text) const {
  std::error_code error;
  const bool there = std::filesystem::exists(path, error);
  if (there && (!stocked_ || read_whole_file(path) == text)) return;
  write_durably(path, text);
}

}  // namespace drumsweep

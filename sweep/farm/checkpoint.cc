#include "sweep/farm/checkpoint.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "core/io/durable_file.h"
#include "sweep/stop.h"

namespace drumsweep {
namespace {

namespace fs = std::filesystem;

constexpr double cost_per_time = 0.01;
/// Within a turn a checkpoint is due after this many intervals.
constexpr double intervals_within_turn = 60;
/// A request that comes so soon after a checkpoint adds nothing: rank 0 passes on what mpirun has sent to all [s].
constexpr double fresh_s = 0.5;

}  // namespace

Checkpoint::Checkpoint(const OutputPaths& paths, const Study& study, const PlannedDesign& design, int attempt,
                       double interval_s)
    : path_(paths.checkpoint(design.id)),
      study_(study),
      design_(design),
      attempt_(attempt),
      interval_s_(interval_s),
      requests_seen_(num_checkpoint_requests()) {}

DesignProgress Checkpoint::read() {
  std::error_code error;
  on_disk_ = fs::exists(path_, error);
  if (!on_disk_) return {};
  try {
    StoredProgress stored = unpack_progress(read_whole_file(path_), study_, design_.id, design_.values, path_);
    saved_at_step_ = stored.progress.state.num_steps;
    return std::move(stored.progress);
  } catch (const std::exception& cause) {
    note_ = fmt::format("{}; this checkpoint is ignored and the design begun anew", cause.what());
    std::replace(note_.begin(), note_.end(), '\n', ' ');
    return {};
  }
}

bool Checkpoint::due(double turns) {
  const double since = std::chrono::duration<double>(Clock::now() - saved_).count();
  if (const int requests = num_checkpoint_requests(); requests != requests_seen_) {
    requests_seen_ = requests;
    return since > fresh_s || saved_at_step_ < 0;
  }
  const bool first = whole_turns_ < 0, turn_ended = !first && std::floor(turns) > whole_turns_;
  whole_turns_ = std::floor(turns);
  if (interval_s_ == 0) return turn_ended;
  return since >= std::max(interval_s_ * (turn_ended ? 1 : intervals_within_turn), cost_s_ / cost_per_time);
}

void Checkpoint::between_steps(const DesignProgress& progress, const Progress& at) {
  // After the last step there is nothing to go on with.
  if (at.turns < at.turns_planned && due(at.turns)) save(progress);
}

void Checkpoint::save(const DesignProgress& progress) {
  if (progress.state.num_steps == saved_at_step_) return;
  const auto begin = Clock::now();
  write_durably(path_, pack_progress(study_, design_.id, design_.values, progress, attempt_));
  on_disk_ = true;
  saved_at_step_ = progress.state.num_steps;
  saved_ = Clock::now();
  cost_s_ = std::chrono::duration<double>(saved_ - begin).count();
}

void Checkpoint::remove() {
  std::error_code ignored;  // what is left is removed by the next run
  if (on_disk_) fs::remove(path_, ignored);
}

int last_attempt_with_progress(const OutputPaths& paths, const std::string& design_id) {
  std::ifstream stream(paths.checkpoint(design_id), std::ios::binary);
  std::string first, second;
  return std::getline(stream, first) && std::getline(stream, second) ? attempt_in_head(second) : 0;
}

void remove_stale_checkpoints(const OutputPaths& paths) {
  std::vector<fs::path> stale;
  for (const fs::directory_entry& entry : fs::directory_iterator(paths.designs()))
    if (entry.path().extension() == ".part" && has_loose_recording(paths, entry.path().stem().string()))
      stale.push_back(entry.path());
  std::error_code ignored;
  for (const fs::path& path : stale) fs::remove(path, ignored);
}

}  // namespace drumsweep

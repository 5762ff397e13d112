/// Rank 0.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <deque>
#include <exception>
#include <filesystem>
#include <type_traits>

#include "core/config/schema.h"
#include "core/config/toml_reader.h"
#include "core/io/durable_file.h"
#include "core/parallel/parallel_for.h"
#include "core/scene/cpu_clock.h"
#include "sweep/farm/design_run.h"
#include "sweep/progress.h"
#include "sweep/stop.h"
#include "sweep/store/provenance.h"
#include "sweep/store/recordings.h"
#include "sweep/store/results.h"
#include "sweep/store/results_image.h"
#include "sweep/store/store.h"
#include "sweep/sweep.h"

namespace drumsweep {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point t) { return std::chrono::duration<double>(Clock::now() - t).count(); }

/// Rank 0 waits this long for others to leave. After SIGTERM from mpirun there is one second until SIGKILL.
constexpr double patience_s = 10.0;
/// A recording that another rank has just written must show up here within this time (network file systems are late).
constexpr double visibility_s = 30.0;
/// The table in the folder is at most this old while designs come in.
constexpr double table_interval_s = 10.0;

class Master {
 public:
  Master(Farm& farm, const Study& study, const Plan& plan, const std::string& folder, int threads)
      : farm_(farm),
        study_(study),
        plan_(plan),
        threads_(threads),
        store_(folder, study),
        recordings_(store_.paths()),
        rows_(plan.designs.size()) {
    reporter_.log_to(store_.paths().log());
    provenance_.emplace(store_.paths().provenance());
    busy_.resize(static_cast<std::size_t>(farm.size()));
  }

  SweepOutcome run() {
    reporter_.info(fmt::format("drumsweep {}: {} designs on {} rank{}, into {}", DRUMSWEEP_VERSION,
                               plan_.designs.size(), farm_.size(), farm_.size() == 1 ? "" : "s",
                               store_.paths().folder));
    for (const std::string& note : store_.notes()) reporter_.warn(note);
    try {
      farm_.send_all(Tag::study, store_.paths().folder + "\n" + write_study(study_, false));
      const std::string warm_bytes = make_warm_drum();
      if (!stopping()) take_stock();
      write_tables();
      if (!stopping() && !pending_.empty()) {
        farm_.send_all(Tag::warm, std::to_string(warm_bytes.size()));
        std::string bytes = warm_bytes;
        farm_.broadcast(bytes);
        hand_out();
      }
    } catch (const WriteError& error) {
      stop(error.what());
      note_stopped(0);
    }
    return finish();
  }

 private:
  // --- the warm drum

  /// Makes or completes the warm drum; returns its file, which all ranks start from.
  std::string make_warm_drum() {
    const std::string path = store_.paths().warm_state();
    WarmState warm;
    std::string bytes;
    try {
      if (auto stored = read_warm_state(path, study_, &bytes)) warm = std::move(*stored);
    } catch (const StoreError& error) {
      reporter_.warn(set_aside(path, error.what()));
      bytes.clear();
    }
    if (!warm.finished) {
      if (!fill_drum(path, warm)) return "";
      // What counts is what is on disk.
      warm = read_warm_state(path, study_, &bytes).value();
    }
    steady_ = warm.steady;
    warm_ = std::move(warm.state);
    if (!steady_)
      reporter_.warn(fmt::format(
          "the warm drum is NOT STEADY after {} turns ({} balls inside): all results are marked untrusted. Allow more "
          "turns (warmup.max_turns, into a new output folder) or look at the feed",
          warm.windows.empty() ? 0 : warm.windows.back().turns_end, warm_.balls.size()));
    return bytes;
  }

  bool fill_drum(const std::string& path, WarmState& warm) {
    note_begin();
    reporter_.info(warm.windows.empty() ? "warm-up: filling the empty drum"
                                        : fmt::format("warm-up: going on at turn {}", warm.windows.back().turns_end));
    const auto begin = Clock::now();
    const double cpu_begin = cpu_seconds(CLOCK_PROCESS_CPUTIME_ID);
    const auto save = [&](const WarmState& w) {
      write_durably(path, pack_warm_state(study_, w));
      const WarmupWindow& last = w.windows.back();
      reporter_.info(fmt::format("warm-up: {} turns, in the last window {} balls in and {} out, {} inside",
                                 last.turns_end, last.fed, last.left, last.inside));
    };
    // The other ranks wait: where this one is not bound to a core, theirs are free.
    const int threads = std::max(threads_, std::min(available_threads(), farm_.size()));
    const bool ended =
        observed([&](const Observer& observer) { return warm_up(study_, warm, observer, save, threads); });
    // A cap of no turns at all ends without a window and so without having been saved.
    if (ended && warm.windows.empty()) write_durably(path, pack_warm_state(study_, warm));
    provenance_->add({"warm_up", "", 1, 0, farm_.host(), seconds_since(begin),
                      cpu_seconds(CLOCK_PROCESS_CPUTIME_ID) - cpu_begin, "", ""});
    if (ended && warm.steady)
      reporter_.info(fmt::format("warm-up: steady after {} turns with {} balls inside", warm.windows.back().turns_end,
                                 warm.state.balls.size()));
    return ended;
  }

  // --- what is there, what is missing

  void take_stock() {
    known_ = KnownRows(store_.paths().results_image(), study_, steady_);
    known_.confirm(recordings_, study_, plan_, steady_);
    for (std::size_t i = 0; i < plan_.designs.size() && !stopping(); ++i) {
      const PlannedDesign& design = plan_.designs[i];
      if (!design.impossible.empty()) {
        rows_[i] = failed_row(design, design.impossible);
      } else if (!load_row(i)) {
        pending_.push_back(i);
      } else if (rows_[i]->state == "failed" && recordings_.has_failure(design.id)) {
        reporter_.info(fmt::format("design {} has failed before ({}); to have it tried again delete {}", design.id,
                                   rows_[i]->reason, store_.paths().failure(design.id)));
      }
      poll_ranks();
    }
    stocked_ = !stopping();
    if (const std::size_t stored = num_rows(); stored > 0)
      reporter_.info(fmt::format("{} of {} designs are there already", stored, plan_.designs.size()));
  }

  /// Row of a stored design; false when nothing usable is stored. What a damaged pack still has is found at the second
  /// look.
  bool load_row(std::size_t i) {
    const PlannedDesign& design = plan_.designs[i];
    for (int look = 0; look < 2 && !rows_[i]; ++look) {
      try {
        rows_[i] = stored_row(recordings_, known_, study_, design, steady_);
        break;
      } catch (const StoreError& error) {
        reporter_.warn(recordings_.set_aside(design.id, error.what()));
      }
    }
    return rows_[i].has_value();
  }

  // --- handing out

  void hand_out() {
    note_begin();
    for (int rank = 1; rank < farm_.size(); ++rank) give(rank);
    while (!stopping() && (!pending_.empty() || num_busy() > 0)) {
      if (!pending_.empty()) {
        simulate_one();
      } else {
        poll_ranks();
        reporter_.update_waiting(counts());
        tell_status("waiting for other ranks");
        Farm::nap();
      }
    }
  }

  /// Gives the next design to a rank; the line in provenance.csv is durable before the rank hears of it.
  std::optional<std::size_t> give(int rank) {
    if (pending_.empty() || stopping()) return std::nullopt;
    const std::size_t index = pending_.front();
    const std::string& id = plan_.designs[index].id;
    provenance_->add({"started", id, provenance_->attempts(id) + 1, rank, rank == 0 ? farm_.host() : "", 0, 0, "", ""});
    pending_.pop_front();
    busy_[static_cast<std::size_t>(rank)] = index;
    if (rank != 0) farm_.send(rank, Tag::design, std::to_string(index));
    return index;
  }

  void simulate_one() {
    const std::optional<std::size_t> index = give(0);
    if (!index) return;
    const DesignOutcome outcome = observed([&](const Observer& observer) {
      return simulate_and_store(store_.paths(), study_, warm_, plan_, *index, farm_.host(), observer, threads_);
    });
    accept(0, outcome);
  }

  /// Runs something under the observer that serves the other ranks. What goes wrong in serving must not look like a
  /// failure of the design at hand: it is carried around the engine.
  template <class Run>
  std::invoke_result_t<Run, const Observer&> observed(const Run& run) {
    std::exception_ptr trouble;
    const Observer observer = [&](const Progress& progress) {
      try {
        poll_ranks();
        reporter_.update(progress, counts());
        tell_status(fmt::format("{} {:.1f} of {} turns, {} balls", progress.what, progress.turns,
                                progress.turns_planned, progress.balls));
      } catch (...) {
        trouble = std::current_exception();
        return false;
      }
      return !stopping();
    };
    auto result = run(observer);
    if (trouble) std::rethrow_exception(trouble);
    return result;
  }

  void poll_ranks() {
    while (const std::optional<Message> message = farm_.poll()) {
      switch (message->tag) {
        case Tag::done:
          accept(message->from, unpack_outcome(message->body));
          give(message->from);
          break;
        case Tag::broken:
          stop(message->body);
          note_stopped(message->from);
          break;
        case Tag::bye:
          ++num_gone_;
          break;
        default:
          break;
      }
    }
    if (farm_.orphaned()) stop("mpirun has died");
    if (stop_requested()) stop(stop_signal());
  }

  /// A rank has ended its design.
  void accept(int rank, const DesignOutcome& outcome) {
    const PlannedDesign& design = plan_.designs.at(outcome.index);
    busy_[static_cast<std::size_t>(rank)].reset();
    const bool stopped = outcome.kind == DesignOutcome::Kind::stopped;
    const char* event = stopped ? "stopped" : outcome.kind == DesignOutcome::Kind::failed ? "failed" : "done";
    provenance_->add({event, design.id, std::max(1, provenance_->attempts(design.id)), rank, outcome.host,
                      outcome.wall_s, outcome.cpu_s, "", ""});
    if (stopped) {
      pending_.push_front(outcome.index);
      stop(fmt::format("rank {} was asked to stop", rank));
      return;
    }

    // The row comes from the file, so what is called done is what can be read.
    const auto begin = Clock::now();
    while (!has_loose_recording(store_.paths(), design.id) && !has_failure(store_.paths(), design.id)) {
      if (seconds_since(begin) > visibility_s || stop_requested())
        throw WriteError(
            fmt::format("{}: not visible on {} though rank {} on {} has written it; is the output folder on a "
                        "file system that all nodes share?",
                        store_.paths().recording(design.id), farm_.host(), rank, outcome.host));
      Farm::nap();
    }
    recordings_.look_again(design.id);
    if (!load_row(outcome.index))
      throw WriteError(store_.paths().recording(design.id) + ": was written, yet is damaged");
    ++done_now_;
    const ResultRow& row = *rows_[outcome.index];
    const std::string result =
        row.state == "failed" ? "FAILED: " + row.reason : fmt::format("f = {:.4g} +- {:.2g} m", row.f_m, row.sigma_f_m);
    reporter_.info(fmt::format("design {}/{} {} ({}): {}{}, {:.1f} s on rank {}", num_rows(), plan_.designs.size(),
                               design.id, drumsweep::describe(plan_, design),
                               row.state == "untrusted" ? "untrusted, " : "", result, outcome.wall_s, rank));
    if (row.lost_balls > 0) reporter_.warn(fmt::format("design {}: {} balls were lost", design.id, row.lost_balls));
    if (seconds_since(table_written_) > table_interval_s) write_tables();
  }

  // --- the end

  bool stopping() const { return !stop_cause_.empty(); }

  void stop(const std::string& cause) {
    if (stopping()) return;
    stop_cause_ = cause;
    reporter_.warn("stopping: " + cause);
    dismiss();
  }

  /// A rank has given up the design it was at. The disk may be full: then there is no line, which says the same.
  void note_stopped(int rank) {
    std::optional<std::size_t>& index = busy_[static_cast<std::size_t>(rank)];
    if (!index) return;
    const std::string& id = plan_.designs[*index].id;
    index.reset();
    try {
      provenance_->add({"stopped", id, std::max(1, provenance_->attempts(id)), rank, "", 0, 0, "", ""});
    } catch (const WriteError&) {
    }
  }

  /// A run that finds nothing to compute leaves no trace.
  void note_begin() {
    if (!begun_) provenance_->add({"run_begin", "", 1, 0, farm_.host(), 0, 0, "", "", farm_.size()});
    begun_ = true;
  }

  void dismiss() {
    if (!dismissed_) farm_.send_all(Tag::stop, "");
    dismissed_ = true;
  }

  /// Table first, as there may be little time; then the others' last words.
  SweepOutcome finish() {
    const auto attempt = [&](const auto& action) {
      try {
        action();
      } catch (const WriteError& error) {
        stop(error.what());
      }
    };
    attempt([&] { write_tables(); });
    dismiss();
    const auto begin = Clock::now();
    const std::size_t rows_before = num_rows();
    while (num_gone_ < farm_.size() - 1 && seconds_since(begin) < patience_s) {
      attempt([&] { poll_ranks(); });
      Farm::nap();
    }
    if (num_rows() != rows_before) attempt([&] { write_tables(); });
    if (begun_) attempt([&] { provenance_->add({"run_end", "", 1, 0, farm_.host(), 0, 0, "", ""}); });
    if (num_gone_ == farm_.size() - 1)
      farm_.close();
    else
      reporter_.warn(fmt::format("{} ranks do not answer and are left to the launcher", farm_.size() - 1 - num_gone_));

    SweepOutcome outcome;
    outcome.finished = num_rows() == plan_.designs.size();
    outcome.stop_cause = stop_cause_;
    outcome.output = store_.paths().folder;
    outcome.table = table();
    for (const ResultRow& row : outcome.table.rows) outcome.failed += row.state == "failed" ? 1 : 0;
    if (outcome.finished)
      reporter_.info(fmt::format("finished: {} designs, {} failed", num_rows(), outcome.failed));
    else
      reporter_.info(fmt::format("stopped early: {}what is stored stays; run the same command again to go on",
                                 stocked_ ? fmt::format("{} of {} designs are done; ", num_rows(), rows_.size()) : ""));
    return outcome;
  }

  ResultTable table() const {
    ResultTable out{plan_.columns, {}};
    for (const auto& row : rows_)
      if (row) out.rows.push_back(*row);
    return out;
  }

  /// Rebuilds results.csv and results.h5 where they are not the same already, and packs recordings once there are many.
  /// Not before all stored designs have been looked at: a stop during that must not shorten the table.
  void write_tables() {
    table_written_ = Clock::now();
    replace(store_.paths().results(), to_csv(table()));
    replace(store_.paths().results_image(), pack_results(study_, table(), steady_, recordings_, provenance_->lines()));
    if (!stocked_) return;
    for (const std::string& note : recordings_.pack()) reporter_.info(note);
  }

  void replace(const std::string& path, const std::string& text) const {
    std::error_code error;
    const bool there = std::filesystem::exists(path, error);
    if (there && (!stocked_ || read_whole_file(path) == text)) return;
    write_durably(path, text);
  }

  // --- numbers for people

  std::size_t num_rows() const {
    return static_cast<std::size_t>(
        std::count_if(rows_.begin(), rows_.end(), [](const auto& row) { return row.has_value(); }));
  }
  std::size_t num_busy() const {
    return static_cast<std::size_t>(
        std::count_if(busy_.begin(), busy_.end(), [](const auto& b) { return b.has_value(); }));
  }
  SweepCounts counts() const { return {num_rows(), plan_.designs.size(), done_now_, num_busy()}; }

  /// Once a second into the lock file, for `status`.
  void tell_status(const std::string& phase) {
    if (seconds_since(told_) < 1) return;
    told_ = Clock::now();
    std::string running;
    for (const auto& index : busy_)
      if (index) running += " " + plan_.designs[*index].id;
    store_.lock().say(fmt::format("phase {}\nrunning{}\n", phase, running));
  }

  Farm& farm_;
  const Study& study_;
  const Plan& plan_;
  int threads_;
  Store store_;
  RecordingIndex recordings_;
  KnownRows known_;  ///< from results.h5 of an earlier run
  Reporter reporter_;
  std::optional<Provenance> provenance_;
  DrumState warm_;
  bool steady_ = false;
  std::vector<std::optional<ResultRow>> rows_;    ///< (num_designs) of the table
  std::deque<std::size_t> pending_;               ///< designs to simulate
  std::vector<std::optional<std::size_t>> busy_;  ///< (num_ranks) what each is at
  std::size_t done_now_ = 0;
  int num_gone_ = 0;  ///< ranks that said bye
  bool dismissed_ = false;
  bool begun_ = false;    ///< there is a line run_begin
  bool stocked_ = false;  ///< rows_ holds all that was stored when the run began
  std::string stop_cause_;
  Clock::time_point table_written_{}, told_{};
};

/// Tells the others to leave when this rank cannot even begin, so that nobody waits for it.
void send_home(Farm& farm) {
  farm.send_all(Tag::stop, "");
  const auto begin = Clock::now();
  for (int gone = 0; gone < farm.size() - 1;) {
    if (seconds_since(begin) > patience_s) return;
    if (const std::optional<Message> message = farm.poll()) {
      gone += message->tag == Tag::bye ? 1 : 0;
    } else {
      Farm::nap();
    }
  }
  farm.close();
}

}  // namespace

SweepOutcome run_sweep(Farm& farm, const SweepOptions& options) {
  try {
    const Study study = read_study(options.study_path);
    if (study.stages.empty())
      throw InputError(options.study_path +
                       ": has no [[stage]], so there is nothing to sweep; `drumsweep simulate` runs "
                       "a single design");
    const Plan plan = plan_designs(study);
    const std::string folder =
        options.output.empty() ? std::filesystem::path(options.study_path).stem().string() + "_result" : options.output;
    // The other ranks may have another current folder.
    return Master(farm, study, plan, std::filesystem::absolute(folder).lexically_normal().string(), options.threads)
        .run();
  } catch (...) {
    send_home(farm);
    throw;
  }
}

}  // namespace drumsweep

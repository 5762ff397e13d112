/// Rank 0: who does what, when to stop, what to say. What is wanted and what is stored: agenda.h.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <type_traits>
#include <utility>

#include "core/config/schema.h"
#include "core/config/toml_reader.h"
#include "core/io/durable_file.h"
#include "core/parallel/parallel_for.h"
#include "core/scene/cpu_clock.h"
#include "postproc/objective.h"
#include "sweep/farm/agenda.h"
#include "sweep/farm/design_run.h"
#include "sweep/farm/hang_watch.h"
#include "sweep/farm/roll_call.h"
#include "sweep/plan/findings.h"
#include "sweep/progress.h"
#include "sweep/stop.h"
#include "sweep/store/provenance.h"
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
/// Above this many ranks rank 0 only serves, unless told otherwise.
constexpr int most_ranks_of_a_working_master = 32;
/// Looking at all ranks costs microseconds each.
constexpr double roll_interval_s = 0.2;
/// Messages that share one durable write of provenance.csv.
constexpr int largest_batch = 256;

/// Of --stop-before, kept for the last checkpoints, the table and the goodbyes [s].
double reserve_s(double stop_before_s) { return std::clamp(0.01 * stop_before_s, 1.0, 60.0); }

class Master {
 public:
  Master(Farm& farm, const Study& study, const std::string& folder, const SweepOptions& options)
      : farm_(farm),
        study_(study),
        options_(options),
        agenda_(study, folder, reporter_),
        roll_(farm.size(), options.silence_s, farm.host()) {
    busy_.resize(static_cast<std::size_t>(farm.size()));
    dedicated_ = farm.size() > 1 && options.dedicated_master.value_or(farm.size() > most_ranks_of_a_working_master);
    if (options.stop_before_s)
      stop_at_ = options.begin + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(
                                     *options.stop_before_s - reserve_s(*options.stop_before_s)));
  }

  SweepOutcome run() {
    reporter_.info(fmt::format("drumsweep {}: {} designs{} on {} rank{}, into {}", DRUMSWEEP_VERSION,
                               plan().designs.size(), agenda_.complete() ? "" : " and those that searches will ask for",
                               farm_.size(), farm_.size() == 1 ? "" : "s", agenda_.paths().folder));
    for (const std::string& note : agenda_.store().notes()) reporter_.warn(note);
    if (options_.dedicated_master.value_or(false) && !dedicated_)
      reporter_.warn("--dedicated-master: this rank is the only one, so it works too");
    const char* recovery = std::getenv("OMPI_MCA_orte_enable_recovery");
    if (options_.survive && farm_.size() > 1 && (recovery == nullptr || std::string(recovery) != "1"))
      reporter_.warn(
          "--survive: mpirun was started without --enable-recovery --mca orte_abort_on_non_zero_status 0: it will end "
          "the job when a rank dies");
    try {
      agenda_.settle_the_past(options_.retry_failed, options_.retry_lost);
      farm_.send_all(Tag::study, agenda_.paths().folder + "\n" + write_study(study_, false));
      const std::string warm_bytes = make_warm_drum();
      if (!stopping()) agenda_.take_stock(steady_, go_on());
      agenda_.write_tables();
      if (!stopping() && agenda_.has_pending()) {
        // A broadcast would wait for the dead.
        farm_.send_all(Tag::warm, std::to_string(options_.survive ? 0 : warm_bytes.size()));
        std::string bytes = warm_bytes;
        if (!options_.survive) farm_.broadcast(bytes);
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
    const std::string path = agenda_.paths().warm_state();
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
    const double turns =
        static_cast<double>(warm.state.num_steps) * study_.solver.outer_step_s / duration_of_turns(1, study_.drum);
    reporter_.info(turns == 0 ? "warm-up: filling the empty drum"
                              : fmt::format("warm-up: going on at turn {:.4g}", turns));
    const auto begin = Clock::now();
    const double cpu_begin = cpu_seconds(CLOCK_PROCESS_CPUTIME_ID);
    const auto save = [&](const WarmState& w) { write_durably(path, pack_warm_state(study_, w)); };
    HangWatch watch(fmt::format("warm-up on {}", farm_.host()), options_.hang_s);
    const auto end_window = [&](const WarmState& w) {
      const HangWatch::Counting pause(watch, false);
      save(w);
      const WarmupWindow& last = w.windows.back();
      reporter_.info(fmt::format("warm-up: {} turns, in the last window {} balls in and {} out, {} inside",
                                 last.turns_end, last.fed, last.left, last.inside));
    };
    // The other ranks wait: where this one is not bound to a core, theirs are free.
    const int threads = std::max(options_.threads, std::min(available_threads(), farm_.size()));
    int requests = num_checkpoint_requests();
    const bool ended = observed([&](const Observer& observer) {
      const Observer between_steps = [&](const Progress& at) {
        const HangWatch::Counting pause(watch, false);
        if (requests != num_checkpoint_requests()) save(warm);
        requests = num_checkpoint_requests();
        return observer(at);
      };
      const HangWatch::Counting engine(watch, true);
      return warm_up(study_, warm, between_steps, end_window, threads);
    });
    // Stopped inside a window; or a cap of no turns at all, which ends without any.
    if (!ended || warm.windows.empty()) save(warm);
    agenda_.provenance().add({"warm_up", "", 1, 0, farm_.host(), seconds_since(begin),
                              cpu_seconds(CLOCK_PROCESS_CPUTIME_ID) - cpu_begin, "", ""});
    if (ended && warm.steady)
      reporter_.info(fmt::format("warm-up: steady after {} turns with {} balls inside", warm.windows.back().turns_end,
                                 warm.state.balls.size()));
    return ended;
  }

  const Plan& plan() const { return agenda_.plan(); }

  // --- who is there

  /// With --survive: ranks that are no more there.
  void call_the_roll() {
    if (!options_.survive || seconds_since(roll_called_) < roll_interval_s) return;
    roll_called_ = Clock::now();
    if (roll_.due())
      for (int rank = 1; rank < farm_.size(); ++rank)
        if (roll_.listed(rank)) farm_.send(rank, Tag::alive, roll_.here());
    for (int rank = 1; rank < farm_.size(); ++rank)
      if (roll_.missing(rank)) lose(rank);
  }

  /// A rank has died: its design goes to another one.
  void lose(int rank) {
    roll_.strike(rank);
    ++num_gone_;
    ++num_dead_;
    std::optional<std::size_t>& at = busy_[static_cast<std::size_t>(rank)];
    if (!at) return reporter_.warn(fmt::format("rank {} is gone", rank));
    const std::size_t index = *at;
    at.reset();
    --num_busy_;
    flush();
    if (!agenda_.bury(index, rank)) return;
    give_to_idle_ranks();
    flush();
  }

  // --- handing out

  void hand_out() {
    note_begin();
    give_to_idle_ranks();
    flush();
    while (!stopping() && (agenda_.has_pending() || num_busy_ > 0)) {
      if (agenda_.has_pending() && !dedicated_) {
        simulate_one();
      } else {
        if (agenda_.has_pending() && num_dead_ == farm_.size() - 1) return stop("all other ranks have died");
        poll_ranks();
        reporter_.update_waiting(counts());
        tell_status("waiting", " for other ranks");
        farm_.rest();
      }
    }
  }

  void give_to_idle_ranks() {
    for (int rank = 1; rank < farm_.size() && agenda_.has_pending(); ++rank)
      if (roll_.listed(rank) && !busy_[static_cast<std::size_t>(rank)]) give(rank);
  }

  /// After a result: searches may ask for more, as soon as a rank would have nothing to do.
  void refill() {
    if (!stopping()) agenda_.refill(go_on());
    give_to_idle_ranks();
  }

  /// Gives the next design to a rank, which hears of it in flush().
  std::optional<std::size_t> give(int rank) {
    if (stopping()) return std::nullopt;
    const std::optional<std::size_t> index = agenda_.take();
    if (!index) return std::nullopt;
    const PlannedDesign& design = plan().designs[*index];
    const int attempt = agenda_.provenance().attempts(design.id) + 1;
    lines_.push_back({"started", design.id, attempt, rank, rank == 0 ? farm_.host() : "", 0, 0, "", ""});
    busy_[static_cast<std::size_t>(rank)] = index;
    ++num_busy_;
    if (rank != 0) orders_.emplace_back(rank, pack_assignment({*index, attempt, design}));
    return index;
  }

  /// Makes the lines of all that has happened durable, with one write; only then the ranks hear what to do next.
  void flush() {
    // Taken before the write: an order whose line did not become durable must never go out.
    const auto orders = std::exchange(orders_, {});
    if (!lines_.empty()) agenda_.provenance().add(std::exchange(lines_, {}));
    for (const auto& [rank, order] : orders) farm_.send(rank, Tag::design, order);
  }

  void simulate_one() {
    const std::optional<std::size_t> index = give(0);
    if (!index) return;
    flush();
    const PlannedDesign design = plan().designs[*index];  // a copy: the plan may grow meanwhile
    const RunHow how{options_.threads, agenda_.provenance().attempts(design.id), options_.checkpoint_interval_s,
                     options_.hang_s};
    const DesignOutcome outcome = observed([&](const Observer& observer) {
      return simulate_and_store(agenda_.paths(), study_, warm_, design, *index, farm_.host(), observer, how);
    });
    accept(0, outcome);
    refill();
    flush();
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
        tell_status(progress.what, fmt::format(" {:.1f} of {} turns, {} balls", progress.turns, progress.turns_planned,
                                               progress.balls));
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

  /// For long look-ups: the ranks are served meanwhile.
  Agenda::GoOn go_on() {
    return [this] {
      poll_ranks();
      return !stopping();
    };
  }

  void poll_ranks() {
    for (int i = 0; i < largest_batch; ++i) {
      const std::optional<Message> message = farm_.poll();
      if (!message) break;
      serve(*message);
    }
    flush();
    call_the_roll();
    if (farm_.orphaned()) stop("mpirun has died");
    if (stop_requested()) stop(stop_signal());
    if (stop_at_ && Clock::now() > *stop_at_)
      stop(fmt::format("--stop-before {}", clock_text(*options_.stop_before_s)));
    if (checkpoints_passed_on_ != num_checkpoint_requests()) {
      checkpoints_passed_on_ = num_checkpoint_requests();
      reporter_.info("checkpoint asked for by SIGUSR1");
      farm_.send_all(Tag::checkpoint, "");
    }
  }

  void serve(const Message& message) {
    if (!roll_.listed(message.from)) {
      // Taken for dead, and yet it speaks: its design is somebody else's now.
      if (num_dead_ > 0 && message.tag != Tag::bye) farm_.send(message.from, Tag::stop, "");
      return;
    }
    roll_.heard(message.from);
    switch (message.tag) {
      case Tag::done:
        accept(message.from, unpack_outcome(message.body));
        give(message.from);
        refill();
        break;
      case Tag::broken:
        stop(message.body);
        note_stopped(message.from);
        break;
      case Tag::bye:
        roll_.strike(message.from);
        ++num_gone_;
        break;
      case Tag::alive:
        roll_.heard(message.from, message.body);
        break;
      default:
        break;
    }
  }

  /// A rank has ended its design.
  void accept(int rank, const DesignOutcome& outcome) {
    const PlannedDesign& design = plan().designs.at(outcome.index);
    // One that has given up before, and answers an order that was on its way, was noted then.
    if (!std::exchange(busy_[static_cast<std::size_t>(rank)], std::nullopt)) return;
    --num_busy_;
    const bool stopped = outcome.kind == DesignOutcome::Kind::stopped;
    const char* event = stopped ? "stopped" : outcome.kind == DesignOutcome::Kind::failed ? "failed" : "done";
    lines_.push_back({event, design.id, std::max(1, agenda_.provenance().attempts(design.id)), rank, outcome.host,
                      outcome.wall_s, outcome.cpu_s, "", ""});
    if (!outcome.note.empty()) reporter_.info(fmt::format("design {}: {}", design.id, outcome.note));
    if (stopped) {
      agenda_.put_back(outcome.index);
      stop(fmt::format("rank {} was asked to stop", rank));
      return;
    }

    // The row comes from the file, so what is called done is what can be read.
    const auto begin = Clock::now();
    while (!has_loose_recording(agenda_.paths(), design.id) && !has_failure(agenda_.paths(), design.id)) {
      if (seconds_since(begin) > visibility_s || stop_requested())
        throw WriteError(
            fmt::format("{}: not visible on {} though rank {} on {} has written it; is the output folder on a "
                        "file system that all nodes share?",
                        agenda_.paths().recording(design.id), farm_.host(), rank, outcome.host));
      Farm::nap();
    }
    const ResultRow& row = agenda_.enter(outcome.index);
    ++done_now_;
    const std::string result =
        row.state == "failed" ? "FAILED: " + row.reason : fmt::format("f = {:.4g} +- {:.2g} m", row.f_m, row.sigma_f_m);
    reporter_.info(fmt::format("design {}/{} {} ({}): {}{}, {:.1f} s on rank {}", agenda_.num_rows(),
                               plan().designs.size(), design.id, drumsweep::describe(plan(), design),
                               row.state == "untrusted" ? "untrusted, " : "", result, outcome.wall_s, rank));
    if (row.lost_balls > 0) reporter_.warn(fmt::format("design {}: {} balls were lost", design.id, row.lost_balls));
    agenda_.write_tables_now_and_then();
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
    const std::string& id = plan().designs[*index].id;
    index.reset();
    --num_busy_;
    try {
      lines_.push_back({"stopped", id, std::max(1, agenda_.provenance().attempts(id)), rank, "", 0, 0, "", ""});
      flush();
    } catch (const WriteError&) {
    }
  }

  /// A run that finds nothing to compute leaves no trace.
  void note_begin() {
    if (!begun_) agenda_.provenance().add({"run_begin", "", 1, 0, farm_.host(), 0, 0, "", "", farm_.size()});
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
    attempt([&] { agenda_.write_tables(); });
    dismiss();
    const auto begin = Clock::now();
    const std::size_t rows_before = agenda_.num_rows();
    while (num_gone_ < farm_.size() - 1 && seconds_since(begin) < patience_s) {
      attempt([&] { poll_ranks(); });
      Farm::nap();
    }
    if (agenda_.num_rows() != rows_before) attempt([&] { agenda_.write_tables(); });
    std::optional<Findings> findings;
    if (agenda_.stocked() && !stopping()) attempt([&] { findings = agenda_.write_findings(); });
    if (begun_) attempt([&] { agenda_.provenance().add({"run_end", "", 1, 0, farm_.host(), 0, 0, "", ""}); });
    if (options_.survive) say_end();
    if (num_dead_ == 0 && num_gone_ == farm_.size() - 1)
      farm_.close();
    else if (num_gone_ < farm_.size() - 1)
      reporter_.warn(fmt::format("{} ranks do not answer and are left to the launcher", farm_.size() - 1 - num_gone_));

    SweepOutcome outcome;
    outcome.finished = agenda_.finished();
    outcome.stop_cause = stop_cause_;
    outcome.output = agenda_.paths().folder;
    outcome.table = agenda_.table();
    outcome.findings = findings;
    for (const ResultRow& row : outcome.table.rows) outcome.failed += row.state == "failed" ? 1 : 0;
    if (outcome.finished)
      reporter_.info(fmt::format("finished: {} designs, {} failed", agenda_.num_rows(), outcome.failed));
    else
      reporter_.info(fmt::format(
          "stopped early: {}what is stored stays; run the same command again to go on",
          agenda_.stocked() ? fmt::format("{} of {} designs are done; ", agenda_.num_rows(), plan().designs.size())
                            : ""));
    return outcome;
  }

  /// Only when nobody has died MPI can be ended, as that waits for all.
  void say_end() {
    const bool all = num_dead_ == 0 && num_gone_ == farm_.size() - 1;
    for (int rank = 1; rank < farm_.size(); ++rank) farm_.send(rank, Tag::end, all ? "1" : "0");
    // Out before we leave; what is for the dead stays.
    for (int i = 0; i < 100; ++i) {
      farm_.poll();
      Farm::nap();
    }
  }

  // --- numbers for people

  SweepCounts counts() const { return {agenda_.num_rows(), plan().designs.size(), done_now_, num_busy_}; }

  /// Into the lock file, for `status`: once a second, and at once when something else begins.
  void tell_status(const std::string& phase, const std::string& how_far) {
    if (phase == told_phase_ && seconds_since(told_) < 1) return;
    told_phase_ = phase;
    told_ = Clock::now();
    std::string running;
    for (const auto& index : busy_)
      if (index) running += " " + plan().designs[*index].id;
    agenda_.store().lock().say(fmt::format("phase {}{}\nrunning{}\n", phase, how_far, running));
  }

  Farm& farm_;
  const Study& study_;
  const SweepOptions& options_;
  Reporter reporter_;
  Agenda agenda_;
  DrumState warm_;
  bool steady_ = false;
  std::vector<std::optional<std::size_t>> busy_;  ///< (num_ranks) what each is at
  std::size_t done_now_ = 0, num_busy_ = 0;
  std::vector<ProvenanceLine> lines_;                ///< not yet durable ...
  std::vector<std::pair<int, std::string>> orders_;  ///< ... and what ranks will hear when they are
  RollCall roll_;
  int num_gone_ = 0;  ///< ranks that said bye, or have died
  int num_dead_ = 0;
  bool dedicated_ = false;
  int checkpoints_passed_on_ = num_checkpoint_requests();
  std::optional<Clock::time_point> stop_at_;
  bool dismissed_ = false;
  bool begun_ = false;  ///< there is a line run_begin
  std::string stop_cause_;
  Clock::time_point told_{}, roll_called_{};
  std::string told_phase_;
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
    const Study study = read_study(options.study_path, options.changes);
    if (study.stages.empty())
      throw InputError(options.study_path +
                       ": has no [[stage]], so there is nothing to sweep; `drumsweep simulate` runs "
                       "a single design");
    const std::string folder =
        options.output.empty() ? std::filesystem::path(options.study_path).stem().string() + "_result" : options.output;
    // The other ranks may have another current folder.
    return Master(farm, study, std::filesystem::absolute(folder).lexically_normal().string(), options).run();
  } catch (...) {
    send_home(farm);
    throw;
  }
}

}  // namespace drumsweep

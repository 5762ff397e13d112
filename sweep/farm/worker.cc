/// Every rank but 0.
#include <fmt/format.h>

#include <cstdio>
#include <exception>
#include <optional>

#include "core/config/toml_reader.h"
#include "sweep/farm/design_run.h"
#include "sweep/farm/roll_call.h"
#include "sweep/stop.h"
#include "sweep/store/store.h"
#include "sweep/sweep.h"

namespace drumsweep {
namespace {

/// A rank that has asked for a stop and hears nothing for this long leaves without ceremony [ms].
constexpr int patience_ms = 20000;
/// The warm drum that rank 0 has written must show up here within this time (network file systems are late) [ms].
constexpr int visibility_ms = 30000;

struct Worker {
  Farm& farm;
  const SweepOptions& options;
  RollCall roll;  ///< of rank 0
  OutputPaths paths{};
  Study study{};
  std::optional<WarmState> warm{};
  bool told_to_stop = false, gave_up = false, alone = false;

  void give_up(const std::string& cause) {
    if (!gave_up) farm.send(0, Tag::broken, cause);
    gave_up = true;
  }

  void begin(const std::string& body) {
    const std::size_t line = body.find('\n');
    paths.folder = body.substr(0, line);
    study = parse_study(body.substr(line + 1), "study from rank 0");
  }

  void receive_warm_state(const std::string& body) {
    std::string bytes(std::stoull(body), '\0');
    if (bytes.empty()) return read_warm_state_from_folder();
    farm.broadcast(bytes);
    warm = unpack_warm_state(bytes, study, "warm state from rank 0");
  }

  void read_warm_state_from_folder() {
    for (int waited_ms = 0; waited_ms < visibility_ms; ++waited_ms) {
      std::optional<WarmState> stored = read_warm_state(paths.warm_state(), study);
      if (stored && stored->finished) {
        warm = std::move(stored);
        return;
      }
      Farm::nap();
    }
    throw std::runtime_error(paths.warm_state() + ": not visible here, though rank 0 has written it");
  }

  /// With --survive: says that we are here, and looks whether rank 0 is.
  void call_the_roll() {
    if (!options.survive || alone) return;
    if (roll.due()) farm.send(0, Tag::alive, roll.here());
    alone = roll.missing(0);
  }

  /// Between two steps of a design, what rank 0 may want.
  bool go_on() {
    while (const std::optional<Message> message = farm.poll()) {
      if (message->tag == Tag::stop) told_to_stop = true;
      note(*message);
    }
    call_the_roll();
    return !told_to_stop && !alone && !stop_requested() && !farm.orphaned();
  }

  void note(const Message& message) {
    if (message.tag == Tag::checkpoint) request_checkpoint();
    if (message.tag == Tag::alive) roll.heard(0, message.body);
    roll.heard(0);
  }

  void simulate(const std::string& body) {
    std::exception_ptr trouble;
    const Assignment given = unpack_assignment(body);
    DesignOutcome outcome{given.index, DesignOutcome::Kind::stopped, 0, 0, farm.host(), "", ""};
    const RunHow how{options.threads, given.attempt, options.checkpoint_interval_s, options.hang_s};
    if (!gave_up && !stop_requested())
      outcome = simulate_and_store(
          paths, study, warm.value().state, given.design, outcome.index, outcome.host,
          [&](const Progress&) {
            // What goes wrong in serving must not look like a failure of the design: it is carried around the engine.
            try {
              return go_on();
            } catch (...) {
              trouble = std::current_exception();
              return false;
            }
          },
          how);
    if (trouble) std::rethrow_exception(trouble);
    farm.send(0, Tag::done, pack_outcome(outcome));
  }

  void handle(const Message& message) {
    note(message);
    switch (message.tag) {
      case Tag::study:
        return begin(message.body);
      case Tag::warm:
        return receive_warm_state(message.body);
      case Tag::design:
        return simulate(message.body);
      case Tag::checkpoint:
      case Tag::alive:
        return;
      default:
        told_to_stop = true;
    }
  }
};

/// After the goodbye, the last word of rank 0: without it, or when it says no, MPI must not be ended.
bool nobody_has_died(Farm& farm) {
  for (int waited_ms = 0; waited_ms < patience_ms; ++waited_ms) {
    while (const std::optional<Message> message = farm.poll())
      if (message->tag == Tag::end) return message->body == "1";
    if (farm.orphaned()) return false;
    Farm::nap();
  }
  return false;
}

}  // namespace

void serve_sweep(Farm& farm, const SweepOptions& options) {
  Worker worker{farm, options, RollCall(1, options.silence_s, farm.host())};
  int waited_ms = 0;
  while (!worker.told_to_stop) {
    if (farm.orphaned()) return;
    if (worker.alone) return fmt::print(stderr, "drumsweep: rank {} leaves: rank 0 is gone\n", farm.rank());
    try {
      if (stop_requested()) worker.give_up("rank " + std::to_string(farm.rank()) + " got " + stop_signal());
      worker.call_the_roll();
      if (const std::optional<Message> message = farm.poll()) {
        worker.handle(*message);
        continue;
      }
    } catch (const std::exception& error) {
      worker.give_up(fmt::format("rank {} on {}: {}", farm.rank(), farm.host(), error.what()));
    }
    if (!worker.gave_up) {
      farm.rest();
      continue;
    }
    Farm::nap();
    if (++waited_ms > patience_ms) {
      fmt::print(stderr, "drumsweep: rank {} leaves: rank 0 does not answer\n", farm.rank());
      return;
    }
  }
  farm.send(0, Tag::bye, "");
  if (!options.survive || nobody_has_died(farm)) farm.close();
}

}  // namespace drumsweep

/// Every rank but 0.
#include <fmt/format.h>

#include <cstdio>
#include <exception>
#include <optional>

#include "core/config/toml_reader.h"
#include "sweep/farm/design_run.h"
#include "sweep/stop.h"
#include "sweep/store/store.h"
#include "sweep/sweep.h"

namespace drumsweep {
namespace {

/// A rank that has asked for a stop and hears nothing for this long leaves without ceremony [ms].
constexpr int patience_ms = 20000;

struct Worker {
  Farm& farm;
  int threads;
  OutputPaths paths{};
  Study study{};
  std::optional<WarmState> warm{};
  bool told_to_stop = false, gave_up = false;

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
    farm.broadcast(bytes);
    warm = unpack_warm_state(bytes, study, "warm state from rank 0");
  }

  /// Between two steps of a design, a word from rank 0 can only be "stop".
  bool go_on() {
    while (const std::optional<Message> message = farm.poll())
      if (message->tag == Tag::stop) told_to_stop = true;
    return !told_to_stop && !stop_requested() && !farm.orphaned();
  }

  void simulate(const std::string& body) {
    std::exception_ptr trouble;
    const Assignment given = unpack_assignment(body);
    DesignOutcome outcome{given.index, DesignOutcome::Kind::stopped, 0, 0, farm.host(), ""};
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
          threads);
    if (trouble) std::rethrow_exception(trouble);
    farm.send(0, Tag::done, pack_outcome(outcome));
  }

  void handle(const Message& message) {
    switch (message.tag) {
      case Tag::study:
        return begin(message.body);
      case Tag::warm:
        return receive_warm_state(message.body);
      case Tag::design:
        return simulate(message.body);
      default:
        told_to_stop = true;
    }
  }
};

}  // namespace

void serve_sweep(Farm& farm, int threads) {
  Worker worker{farm, threads};
  int waited_ms = 0;
  while (!worker.told_to_stop) {
    if (farm.orphaned()) return;
    try {
      if (stop_requested()) worker.give_up("rank " + std::to_string(farm.rank()) + " got " + stop_signal());
      if (const std::optional<Message> message = farm.poll()) {
        worker.handle(*message);
        continue;
      }
    } catch (const std::exception& error) {
      worker.give_up(fmt::format("rank {} on {}: {}", farm.rank(), farm.host(), error.what()));
    }
    Farm::nap();
    if (worker.gave_up && ++waited_ms > patience_ms) {
      fmt::print(stderr, "drumsweep: rank {} leaves: rank 0 does not answer\n", farm.rank());
      return;
    }
  }
  farm.send(0, Tag::bye, "");
  farm.close();
}

}  // namespace drumsweep

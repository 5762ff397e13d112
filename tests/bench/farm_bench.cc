// Designs that cost nothing, through the farm: `mpirun --oversubscribe -n 8 build/release/tests/farm_bench [DESIGNS]`.
//
// messages  what rank 0 and the others say to each other for a design, through the real Farm; nothing is stored
// durable   the same, each with its lines in provenance.csv and a recording of 200 landings, read back by rank 0
// idle      CPU of a rank that waits for five seconds
#include <fmt/format.h>
#include <stdlib.h>
#include <sys/resource.h>

#include <chrono>
#include <filesystem>

#include "core/config/toml_reader.h"
#include "core/scene/cpu_clock.h"
#include "sweep/farm/design_run.h"
#include "sweep/farm/farm.h"
#include "sweep/store/provenance.h"
#include "sweep/store/store.h"

namespace drumsweep {
namespace {

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point t) { return std::chrono::duration<double>(Clock::now() - t).count(); }

PlannedDesign design_of(std::size_t index) {
  PlannedDesign design;
  design.values = {{"outlet.base_width_m", 0.03 + 1e-6 * static_cast<double>(index)}};
  design.id = design_id(design.values);
  return design;
}

Study small_study() {
  Study study;
  study.outlet.opening_angle_deg = 1;
  return study;
}

Recording small_recording() {
  Recording recording;
  recording.turns = 2;
  for (std::uint32_t i = 0; i < 200; ++i)
    recording.landings.push_back({0.01 * i, 0.1, 0.2, 0.1F, 0.2F, -1.5F, 0.005F, i, 1});
  recording.quality_of_steps.assign(6 * 400, 0.001F);
  return recording;
}

/// Rank 0: everybody has a design, until all are done. @return designs a second
double serve(Farm& farm, std::size_t num_designs, const std::string& folder) {
  const OutputPaths paths{folder};
  const Study study = small_study();
  std::optional<Provenance> provenance;
  if (!folder.empty()) provenance.emplace(paths.provenance());
  std::vector<ProvenanceLine> lines;
  std::vector<int> asking;
  std::size_t given = 0, done = 0;
  const auto begin = Clock::now();
  for (int rank = 1; rank < farm.size(); ++rank) asking.push_back(rank);
  while (done < num_designs) {
    std::vector<std::pair<int, std::string>> orders;
    for (const int rank : asking)
      if (given < num_designs) {
        if (provenance) lines.push_back({"started", design_of(given).id, 1, rank, "", 0, 0, "", ""});
        orders.emplace_back(rank, fmt::format("{} 1", given++));
      }
    asking.clear();
    // One write for all that came together, as in the master.
    if (!lines.empty()) provenance->add(std::exchange(lines, {}));
    for (const auto& [rank, order] : orders) farm.send(rank, Tag::design, order);
    while (const std::optional<Message> message = farm.poll()) {
      const DesignOutcome outcome = unpack_outcome(message->body);
      if (provenance) {
        const PlannedDesign design = design_of(outcome.index);
        if (!read_design(paths, study, design).recording) throw std::runtime_error(design.id + ": not stored");
        lines.push_back({"done", design.id, 1, message->from, "", 0, 0, "", ""});
      }
      asking.push_back(message->from);
      ++done;
    }
    if (asking.empty()) farm.rest();
  }
  if (!lines.empty()) provenance->add(std::move(lines));
  return static_cast<double>(num_designs) / seconds_since(begin);
}

/// Every other rank, until it is told to stop.
void work(Farm& farm) {
  std::string folder;
  const Study study = small_study();
  const Recording recording = small_recording();
  while (true) {
    const std::optional<Message> message = farm.poll();
    if (!message) {
      farm.rest();
    } else if (message->tag == Tag::study) {
      folder = message->body;
    } else if (message->tag == Tag::design) {
      const DesignOutcome outcome{std::stoull(message->body), DesignOutcome::Kind::done, 0, 0, farm.host(), "", ""};
      if (!folder.empty()) write_recording({folder}, study, design_of(outcome.index), recording);
      farm.send(0, Tag::done, pack_outcome(outcome));
    } else {
      return;
    }
  }
}

double idle_share(Farm& farm) {
  const auto begin = Clock::now();
  const double cpu = cpu_seconds(CLOCK_PROCESS_CPUTIME_ID);
  while (seconds_since(begin) < 5) {
    farm.poll();
    farm.rest();
  }
  return (cpu_seconds(CLOCK_PROCESS_CPUTIME_ID) - cpu) / seconds_since(begin);
}

}  // namespace
}  // namespace drumsweep

int main(int argc, char** argv) {
  using namespace drumsweep;
  Farm farm;
  if (farm.rank() != 0) {
    work(farm);
  } else if (farm.size() < 2) {
    fmt::print("run it under mpirun with at least two ranks\n");
  } else {
    const std::size_t num_designs = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 50000;
    serve(farm, 1000, "");
    fmt::print("messages: {:.0f} designs/s on {} ranks\n", serve(farm, num_designs, ""), farm.size());
    fmt::print("idle: {:.1f} % of a core\n", 100 * idle_share(farm));

    std::string folder = (std::filesystem::current_path() / "farm-bench-XXXXXX").string();
    if (::mkdtemp(folder.data()) == nullptr) return 1;
    make_folder(OutputPaths{folder}.designs());
    farm.send_all(Tag::study, folder);
    const std::size_t num_durable = std::max<std::size_t>(100, num_designs / 50);
    const double durable = serve(farm, num_durable, folder);
    fmt::print("durable: {:.0f} designs/s ({} kB each, in the current folder's file system)\n", durable,
               std::filesystem::file_size(OutputPaths{folder}.recording(design_of(0).id)) / 1000);
    std::filesystem::remove_all(folder);
    rusage usage{};
    ::getrusage(RUSAGE_SELF, &usage);
    fmt::print("memory of rank 0 at most: {} MB\n", usage.ru_maxrss / 1000);
    farm.send_all(Tag::stop, "");
  }
  farm.close();
}

/// Writes the output folder of a sweep whose designs are all finished, with made-up landings, to measure what looks at
/// such folders: finished_folder OUT ROWS COLUMNS LANDINGS [SPREAD]. The study is OUT.toml.
/// SPREAD: share of the belt's width on which the balls land [0.6]; the smaller, the longer their heap topples.
///
///   finished_folder out 100 100 200 && time drumsweep run out.toml -o out && time drumsweep status out
#include <fmt/format.h>

#include <cstdlib>

#include "core/config/toml_reader.h"
#include "core/io/durable_file.h"
#include "support/stored_designs.h"
#include "sweep/store/provenance.h"

int main(int argc, char** argv) {
  using namespace drumsweep;
  if (argc != 5 && argc != 6) {
    fmt::print(stderr, "usage: finished_folder OUT ROWS COLUMNS LANDINGS [SPREAD]\n");
    return 2;
  }
  const std::string folder = argv[1];
  const Study study = grid_study(std::atoll(argv[2]), std::atoll(argv[3]));
  const auto num_landings = static_cast<std::uint32_t>(std::atoll(argv[4]));
  const double spread = argc == 6 ? std::atof(argv[5]) : 0.6;
  write_durably(folder + ".toml", write_study(study, false));
  const Store store(folder, study);
  write_durably(store.paths().warm_state(), pack_warm_state(study, made_up_warm_drum()));
  const Plan plan = plan_designs(study);
  Provenance provenance(store.paths().provenance());
  provenance.add({"run_begin", "", 1, 0, "here", 0, 0, "", "", 1});
  std::uint32_t number = 0;
  for (const PlannedDesign& design : plan.designs) {
    if (!design.impossible.empty()) continue;
    provenance.add({"started", design.id, 1, 0, "here", 0, 0, "", ""});
    write_recording(store.paths(), study, design, made_up_recording(study, number++, num_landings, spread));
    provenance.add({"done", design.id, 1, 0, "here", 0.001, 0.001, "", ""});
  }
  provenance.add({"run_end", "", 1, 0, "here", 0, 0, "", ""});
  fmt::print("{} recordings in {}\n", number, folder);
}

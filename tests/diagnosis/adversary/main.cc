/// drumsweep-adversary: hides effects and scores verdicts.
#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "diagnosis/adversary/tier_a.h"

int main(int argc, char** argv) {
  using namespace drumsweep;
  CLI::App app{"drumsweep-adversary - hides an effect, and scores what the diagnosis says"};
  app.require_subcommand(1);
  TierAOptions a;
  CLI::App* tier_a = app.add_subcommand("tier-a", "Truth from a synthetic machine: rates of all gates");
  tier_a->add_option("--machines", a.machines, "synthetic machines, each with its emulator")->capture_default_str();
  tier_a->add_option("--cases", a.cases_per_class, "of each class and machine")->capture_default_str();
  tier_a->add_option("--bootstraps", a.num_bootstraps, "of each diagnosis")->capture_default_str();
  tier_a->add_option("--seed", a.first_seed, "of the first machine")->capture_default_str();
  tier_a->callback([&] {
    const TierAScore score = run_tier_a(a);
    fmt::print("{}", score.table());
    for (const std::string& miss : score.missed()) fmt::print("MISSED {}\n", miss);
  });
  CLI11_PARSE(app, argc, argv);
  return 0;
}

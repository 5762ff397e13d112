/// drumsweep-adversary: hides effects and scores verdicts.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <map>
#include <random>

#include "core/io/durable_file.h"
#include "diagnosis/adversary/hide.h"
#include "diagnosis/adversary/sha256.h"
#include "diagnosis/adversary/tier_a.h"
#include "diagnosis/report/report.h"

namespace drumsweep {
namespace {

struct HideOptions {
  std::string campaign, folder, kind = "random";
  std::vector<std::string> effects, outsiders;
  std::int64_t seed = -1;
  int repeats = 10, threads = 2, cases = 12;
  bool smooth = false;
};

std::int64_t seed_or_entropy(std::int64_t seed) {
  std::random_device entropy;
  return seed >= 0 ? seed
                   : static_cast<std::int64_t>((static_cast<std::uint64_t>(entropy()) << 20 | entropy() >> 12) &
                                               ((1ull << 50) - 1));
}

std::pair<std::string, double> assignment(const std::string& text) {
  const std::size_t at = text.find('=');
  if (at == std::string::npos) throw InputError(text + ": needed is NAME=NUMBER");
  return {text.substr(0, at), std::stod(text.substr(at + 1))};
}

MeasuredData wanted_of(const Campaign& campaign) {
  MeasuredData wanted = read_measured(campaign);
  const auto one = simulate_run(campaign, design_point(campaign, 0, 1), 1, [] { return true; });
  match_measured(wanted, campaign.measured, campaign, one->observables);
  return wanted;
}

void hide(const HideOptions& o) {
  const Campaign campaign = read_campaign(o.campaign);
  const std::int64_t seed = seed_or_entropy(o.seed);
  std::string kind = o.kind;
  if (kind == "random")
    kind = std::vector<std::string>{"none", "single", "single", "pair", "outsider"}[static_cast<std::size_t>(seed % 5)];
  HiddenTruth truth = o.effects.empty() && o.outsiders.empty() ? draw_truth(campaign, kind, seed) : HiddenTruth{};
  truth.seed = seed;
  truth.repeats = o.repeats;
  truth.smooth = o.smooth;
  for (const std::string& e : o.effects) truth.effects.push_back(assignment(e));
  for (const std::string& e : o.outsiders)
    truth.outsider.push_back({KeyChange::How::set, assignment(e).first, assignment(e).second});
  const MeasuredData measured = measure_hidden(campaign, wanted_of(campaign), truth, o.threads);
  const std::string key = truth.key(campaign);
  std::filesystem::create_directories(o.folder);
  write_durably(o.folder + "/measured.csv", measured_csv(measured));
  write_durably(o.folder + "/commitment.txt", sha256(key) + "\n");
  write_durably(o.folder + "/key.txt", key);
  fmt::print("{}/measured.csv; the key in key.txt is sealed by SHA-256 {}\n", o.folder, sha256(key));
}

/// Many cases against one finished campaign folder: the confusion matrix in counts.
void tier_b(const HideOptions& o) {
  const Campaign campaign = read_campaign(o.campaign);
  const MeasuredData wanted = wanted_of(campaign);
  const CampaignOutputs outputs = read_runs(campaign, o.folder, wanted);
  std::map<std::pair<std::string, std::string>, int> matrix;
  Count false_alarm, strength, gain;
  for (int i = 0; i < o.cases; ++i) {
    const std::int64_t seed = o.seed >= 0 ? o.seed + i : seed_or_entropy(-1);
    const char* kinds[] = {"none", "single", "single", "pair", "outsider", "single"};
    HiddenTruth truth = draw_truth(campaign, o.kind == "random" ? kinds[i % 6] : o.kind, seed);
    truth.repeats = o.repeats;
    truth.smooth = o.smooth;
    const MeasuredData measured = measure_hidden(campaign, wanted, truth, o.threads);
    const std::string commitment = sha256(truth.key(campaign));
    DiagnosisOptions how;
    how.seed = campaign.seed;
    const DiagnosisReport report = make_report(campaign, measured, outputs, how);
    // The verdict is there; now the seal.
    const Judgement judgement = judge(truth, campaign, report.result);
    std::string hidden = truth.name;
    for (const auto& [id, phi] : truth.effects) hidden += fmt::format(" {}={:.3g}", id, phi);
    for (const KeyChange& c : truth.outsider) hidden += fmt::format(" {}={:.3g}", c.key, c.value);
    fmt::print("{} {:.12} {:<60} {:<11} {}\n", seed, commitment, hidden, to_text(judgement), headline(report));
    ++matrix[{truth.name, to_text(judgement)}];
    if (truth.name == "none") false_alarm.add(judgement != Judgement::right);
    for (const Explanation& e : report.result.causes)
      for (const NamedEffect& n : e.effects)
        for (const auto& [id, phi] : truth.effects)
          if (campaign.candidates[static_cast<std::size_t>(n.effect)].effect.id == id &&
              e.effects.size() == truth.effects.size())
            strength.add(phi >= n.low && phi <= n.high);
    if (!report.result.causes.empty() && truth.listed()) gain.add(report.result.gain.adopted);
  }
  fmt::print("\n");
  for (const auto& [cell, count] : matrix) fmt::print("{:<10} {:<12} {}\n", cell.first, cell.second, count);
  fmt::print("false alarms {} of {}; strength inside its interval {} of {}; gain adopted {} of {}\n", false_alarm.yes,
             false_alarm.of, strength.yes, strength.of, gain.yes, gain.of);
}

}  // namespace
}  // namespace drumsweep

int main(int argc, char** argv) {
  using namespace drumsweep;
  CLI::App app{"drumsweep-adversary - hides an effect from drumsweep diagnose, and scores what it says"};
  app.require_subcommand(1);
  TierAOptions a;
  CLI::App* tier_a = app.add_subcommand("tier-a", "Truth from synthetic machines: rates of all gates");
  tier_a->add_option("--machines", a.machines, "synthetic machines, each with its emulator")->capture_default_str();
  tier_a->add_option("--cases", a.cases_per_class, "of each class and machine")->capture_default_str();
  tier_a->add_option("--bootstraps", a.num_bootstraps, "of each diagnosis")->capture_default_str();
  tier_a->add_option("--seed", a.first_seed, "of the first machine")->capture_default_str();
  tier_a->callback([&] {
    const TierAScore score = run_tier_a(a);
    fmt::print("{}", score.table());
    for (const std::string& miss : score.missed()) fmt::print("MISSED {}\n", miss);
  });

  HideOptions h;
  const auto common = [&](CLI::App* command) {
    command->add_option("CAMPAIGN", h.campaign, "campaign file; its measured.csv says what is measured, and how well")
        ->required();
    command->add_option("--case", h.kind, "none | single | pair | outsider | random, or a candidate's id")
        ->capture_default_str();
    command->add_option("--seed", h.seed, "of the truth; left out: from entropy");
    command->add_option("--repeats", h.repeats, "seeds over which the truth is averaged")->capture_default_str();
    command->add_option("--threads", h.threads, "side by side")->capture_default_str();
    command->add_flag("--smooth", h.smooth, "truth from the smooth reference stepper");
  };
  CLI::App* hides = app.add_subcommand("hide", "Draws a truth and writes measured.csv, the sealed key and its SHA-256");
  common(hides);
  hides->add_option("--effect", h.effects, "ID=STRENGTH instead of a drawn case; repeatable");
  hides->add_option("--outsider", h.outsiders, "KEY=VALUE that is set in all conditions; repeatable");
  hides->add_option("-o,--output", h.folder, "folder")->required();
  hides->callback([&] { hide(h); });
  CLI::App* b = app.add_subcommand(
      "tier-b", "Hides cases from a finished campaign, one after the other: confusion matrix in counts");
  common(b);
  b->add_option("--runs", h.folder, "output folder of `drumsweep diagnose CAMPAIGN`")->required();
  b->add_option("--cases", h.cases, "how many")->capture_default_str();
  b->callback([&] { tier_b(h); });
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error);
  } catch (const std::exception& error) {
    fmt::print(stderr, "drumsweep-adversary: {}\n", error.what());
    return 2;
  }
  return 0;
}

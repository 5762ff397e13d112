/// drumsweep-adversary: hides effects and scores verdicts.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <map>
#include <random>

#include "core/io/durable_file.h"
#include "diagnosis/adversary/hide.h"
#include "diagnosis/adversary/seal.h"
#include "diagnosis/adversary/tier_a.h"
#include "diagnosis/campaign/second_wave.h"
#include "diagnosis/report/report.h"

namespace drumsweep {
namespace {

struct HideOptions {
  std::string campaign, folder, kind = "random", data, keys, verdicts;
  std::vector<std::string> effects, outsiders;
  std::int64_t seed = -1;
  int repeats = 10, threads = 2, cases = 12;
  std::int64_t second_wave = 0;
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

/// The truth of one case: what was asked for, or drawn.
HiddenTruth truth_of(const HideOptions& o, const Campaign& campaign, int number) {
  const std::int64_t seed = o.seed >= 0 ? o.seed + number : seed_or_entropy(-1);
  const char* kinds[] = {"none", "single", "single", "pair", "outsider", "single"};
  HiddenTruth truth;
  if (o.effects.empty() && o.outsiders.empty())
    truth = draw_truth(campaign, o.kind == "random" ? kinds[number % 6] : o.kind, seed);
  truth.seed = seed;
  truth.repeats = o.repeats;
  truth.smooth = o.smooth;
  for (const std::string& e : o.effects) truth.effects.push_back(assignment(e));
  for (const std::string& e : o.outsiders)
    truth.outsider.push_back({KeyChange::How::set, assignment(e).first, assignment(e).second});
  return truth;
}

std::string case_name(int number) { return fmt::format("{:03}", number); }

void hide(const HideOptions& o) {
  const Campaign campaign = read_campaign(o.campaign);
  const MeasuredData wanted = wanted_of(campaign);
  for (int i = 0; i < o.cases; ++i) {
    if (std::filesystem::exists(o.keys + "/" + case_name(i) + ".txt")) continue;  // hidden before an interruption
    HiddenTruth truth = truth_of(o, campaign, i);
    const MeasuredData measured = measure_hidden(campaign, wanted, truth, o.threads);
    seal_case(o.data, o.keys, case_name(i), measured, truth.key(campaign));
  }
  fmt::print("{} cases in {}; their keys in {} are for `score` only\n", o.cases, o.data, o.keys);
}

/// Knows the data and nothing of the keys.
void say(const HideOptions& o) {
  Campaign campaign = read_campaign(o.campaign);
  campaign.second_wave = o.second_wave;
  const MeasuredData wanted = wanted_of(campaign);
  const CampaignOutputs first = read_runs(campaign, o.folder, wanted);
  std::filesystem::create_directories(o.verdicts);
  for (int i = 0; i < o.cases; ++i) {
    const std::string path = fmt::format("{}/{}.txt", o.verdicts, case_name(i));
    if (std::filesystem::exists(path)) continue;
    campaign.measured = fmt::format("{}/{}/measured.csv", o.data, case_name(i));
    MeasuredData measured = read_measured(campaign);
    for (std::size_t k = 0; k < measured.data.size(); ++k) {
      const double value = measured.data[k].value;
      measured.data[k] = wanted.data[k];
      measured.data[k].value = value;
    }
    DiagnosisOptions how;
    how.seed = campaign.seed;
    how.details = false;
    CampaignOutputs outputs = first;
    simulate_second_wave(campaign, plan_second_wave(campaign, measured, first, how), measured, o.threads, outputs);
    const DiagnosisReport report = make_report(campaign, measured, outputs, how);
    write_durably(path, to_text(statement_of(report.problem, report.result)));
  }
}

/// The confusion matrix in counts.
void score(const HideOptions& o) {
  std::map<std::pair<std::string, std::string>, int> matrix;
  Count false_alarm, strength, gain, null_gain;
  double sum_off = 0, num_off = 0;
  for (const OpenedCase& c : open_seal(o.data, o.keys, o.verdicts)) {
    const Judgement judgement = judge(c.truth, c.said);
    std::string hidden = c.truth.name, said = fmt::format("{} p = {:.2g}", c.said.verdict, c.said.p_value);
    for (const auto& [id, phi] : c.truth.effects) hidden += fmt::format(" {}={:.3g}", id, phi);
    for (const KeyChange& k : c.truth.outsider) hidden += fmt::format(" {}={:.3g}", k.key, k.value);
    for (const auto& cause : c.said.causes) {
      for (const Statement::Named& n : cause) {
        said += fmt::format(" {} {:.3g} [{:.3g}, {:.3g}]", n.id, n.strength, n.low, n.high);
        for (const auto& [id, phi] : c.truth.effects) {
          if (id != n.id || !is_truth(c.truth, cause)) continue;
          strength.add(phi >= n.low && phi <= n.high);
          sum_off += (n.strength - phi) / phi;
          ++num_off;
        }
      }
      said += " |";
    }
    fmt::print("{} {:<60} {:<11} {}\n", c.name, hidden, to_text(judgement), said);
    ++matrix[{c.truth.name, to_text(judgement)}];
    if (c.truth.name == "none") {
      false_alarm.add(judgement != Judgement::right);
      null_gain.add(c.said.gain_adopted);
    } else if (c.truth.listed() && !c.said.causes.empty()) {
      gain.add(c.said.gain_adopted);
    }
  }
  fmt::print("\n");
  for (const auto& [cell, count] : matrix) fmt::print("{:<10} {:<12} {}\n", cell.first, cell.second, count);
  fmt::print(
      "false alarms {} of {}; strength inside its interval {} of {}, mean error {:+.0f} %; gain adopted {} of {}, on "
      "null data {} of {}\n",
      false_alarm.yes, false_alarm.of, strength.yes, strength.of, 100 * sum_off / std::max(1.0, num_off), gain.yes,
      gain.of, null_gain.yes, null_gain.of);
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
  tier_a->add_option("--kink", a.kink, "lack of fit: by how much effects bend at half of their range")
      ->capture_default_str();
  tier_a->add_option("--second-wave", a.second_wave, "runs round each leading explanation")->capture_default_str();
  tier_a->callback([&] {
    const TierAScore score = run_tier_a(a);
    fmt::print("{}", score.table());
    for (const std::string& miss : score.missed()) fmt::print("MISSED {}\n", miss);
  });

  HideOptions h;
  const auto campaign_of = [&](CLI::App* command) {
    command->add_option("CAMPAIGN", h.campaign, "campaign file; its measured.csv says what is measured, and how well")
        ->required();
    command->add_option("--cases", h.cases, "how many")->capture_default_str();
    command->add_option("--threads", h.threads, "side by side")->capture_default_str();
  };
  const auto truth_of_all = [&](CLI::App* command) {
    command->add_option("--case", h.kind, "none | single | pair | outsider | random, or a candidate's id")
        ->capture_default_str();
    command->add_option("--seed", h.seed, "of the first truth; left out: from entropy");
    command->add_option("--repeats", h.repeats, "seeds over which the truth is averaged")->capture_default_str();
    command->add_flag("--smooth", h.smooth, "truth from the smooth reference stepper");
    command->add_option("--effect", h.effects, "ID=STRENGTH instead of a drawn case; repeatable");
    command->add_option("--outsider", h.outsiders, "KEY=VALUE that is set in all conditions; repeatable");
  };
  const auto runs_of = [&](CLI::App* command) {
    command->add_option("--runs", h.folder, "output folder of `drumsweep diagnose CAMPAIGN`")->required();
    command->add_option("--second-wave", h.second_wave, "runs round each explanation, as in a campaign file")
        ->capture_default_str();
  };
  const auto folders = [&](CLI::App* command, bool keys, bool verdicts) {
    command->add_option("--data", h.data, "folder of the hidden cases' data")->required();
    if (keys) command->add_option("--keys", h.keys, "folder of their keys")->required();
    if (verdicts) command->add_option("--verdicts", h.verdicts, "folder of what was said")->required();
  };
  CLI::App* hides =
      app.add_subcommand("hide", "Draws truths: data with the SHA-256 of their keys here, the keys there");
  campaign_of(hides);
  truth_of_all(hides);
  folders(hides, true, false);
  hides->callback([&] { hide(h); });
  CLI::App* says = app.add_subcommand("say", "Diagnoses hidden cases; has no access to the keys");
  campaign_of(says);
  runs_of(says);
  folders(says, false, true);
  says->callback([&] { say(h); });
  CLI::App* scores = app.add_subcommand("score", "Opens the seal, once every case has its verdict: confusion matrix");
  folders(scores, true, true);
  scores->callback([&] { score(h); });
  CLI::App* b = app.add_subcommand("tier-b", "hide, say and score against a finished campaign, in one go");
  campaign_of(b);
  truth_of_all(b);
  runs_of(b);
  folders(b, true, true);
  b->callback([&] {
    hide(h);
    say(h);
    score(h);
  });
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

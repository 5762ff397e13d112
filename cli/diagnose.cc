/// drumsweep diagnose
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "cli/commands.h"
#include "cli/json.h"
#include "core/config/schema.h"
#include "core/config/toml_fields.h"
#include "core/config/toml_reader.h"
#include "core/io/durable_file.h"
#include "diagnosis/campaign/second_wave.h"
#include "diagnosis/campaign/template.h"
#include "diagnosis/report/report.h"
#include "sweep/farm/farm.h"
#include "sweep/stop.h"
#include "sweep/store/store.h"

namespace drumsweep {
namespace {

struct DiagnoseArguments {
  std::string campaign, folder, template_folder, before;
  std::vector<std::string> after;
  int threads = 1;
  bool json = false, plan = false;
};

std::string json_of(const DiagnosisReport& r) {
  const Diagnosis& d = r.result;
  std::vector<std::string> causes, limits;
  for (const Explanation& e : d.causes) {
    std::vector<std::string> effects;
    for (const NamedEffect& n : e.effects) {
      const CandidateEffect& effect = r.problem.effects[static_cast<std::size_t>(n.effect)];
      effects.push_back(JsonObject()
                            .text("id", effect.id)
                            .number("strength", n.strength)
                            .number("low", n.low)
                            .number("high", n.high)
                            .text("unit", effect.unit)
                            .str());
    }
    causes.push_back(json_list(effects));
  }
  for (std::size_t k = 0; k < d.detection.size(); ++k)
    limits.push_back(JsonObject()
                         .text("id", r.problem.effects[k].id)
                         .number("low", d.detection[k].limit_low)
                         .number("high", d.detection[k].limit_high)
                         .number("sigma_at_end", d.detection[k].d_at_end)
                         .text("unit", r.problem.effects[k].unit)
                         .str());
  std::vector<std::string> conditions, notes;
  for (const std::string& c : d.gain.conditions) conditions.push_back(json_text(c));
  for (const auto* list : {&r.notes, &r.second_wave})
    for (const std::string& n : *list) notes.push_back(json_text(n));
  JsonObject gain, all;
  gain.number("mean", d.gain.mean)
      .number("low", d.gain.low)
      .number("high", d.gain.high)
      .raw("held_out_conditions", json_list(conditions));
  gain.flag("adopted", d.gain.adopted);
  all.text("verdict", to_text(d.verdict)).number("p_value", d.p_value).raw("causes", json_list(causes));
  if (d.advice.empty())
    all.raw("next_measurement", "null");
  else
    all.raw("next_measurement", JsonObject()
                                    .text("condition", d.advice.front().measurement)
                                    .number("distance_sigma", d.advice.front().distance)
                                    .number("power", d.advice.front().power)
                                    .number("cost", r.advice_cost.front())
                                    .str());
  all.raw("gain", gain.str()).raw("detection_limits", json_list(limits));
  all.text("headline", headline(r))
      .number("birge", d.birge)
      .count("runs", static_cast<std::int64_t>(r.num_runs))
      .raw("notes", json_list(notes));
  if (r.change) {
    const DesignChange::Member& best = r.change->members.front();
    JsonObject change;
    change.number("regret_m", best.of_old.f_m).number("sigma_regret_m", best.of_old.sigma_m);
    change.count("members", static_cast<std::int64_t>(r.change->members.size())).flag("agree", r.change->agree());
    all.raw("design_change", change.str());
  }
  return all.str();
}

int write_template(const std::string& folder) {
  for (const TemplateFile& file : template_files())
    if (std::filesystem::exists(folder + "/" + file.name))
      throw InputError(folder + "/" + file.name +
                       ": is there already and is not overwritten; choose another folder or remove it");
  make_folder(folder);
  for (const TemplateFile& file : template_files()) {
    write_durably(folder + "/" + file.name, file.text);
    fmt::print("{}/{}\n", folder, file.name);
  }
  fmt::print("next: drumsweep diagnose {}/campaign.toml --plan\n", folder);
  return exit_done;
}

/// What the campaign offers, from the first run there is: so that wrong names are known before anything long begins.
std::vector<std::vector<Observable>> offered_by(const Campaign& campaign, int threads) {
  const std::optional<RunResult> one =
      simulate_run(campaign, design_point(campaign, 0, 1), threads, [] { return !stop_requested(); });
  if (!one) return {};
  for (std::size_t i = 0; i < campaign.conditions.size(); ++i)
    if (!one->failure[i].empty())
      throw InputError(fmt::format("{}: condition {}: {}", campaign.path, campaign.conditions[i].id, one->failure[i]));
  return one->observables;
}

int print_plan(const Campaign& campaign, const std::string& folder) {
  const CampaignPlan plan = plan_campaign(campaign, folder);
  fmt::print("{}: {} conditions, {} free parameters, {} candidates: {} coefficients\n", campaign.name,
             campaign.conditions.size(), campaign.parameters.size(), campaign.candidates.size(),
             campaign.num_coefficients());
  fmt::print("runs     {} of the design{} + {} for numerics (half of them about 5 times as long); {} stored\n",
             plan.num_runs, campaign.runs == 0 ? " (3 a coefficient)" : "", plan.num_numerics, plan.stored);
  if (plan.most_local > 0)
    fmt::print("then     up to {} runs close round what explains the data, where something is wrong (second_wave)\n",
               plan.most_local);
  fmt::print("one run  {:.2f} s CPU, measured now\nleft     {:.2f} core-hours\n", plan.cpu_s_per_run,
             plan.cpu_s_left / 3600);
  fmt::print(
      "The budget law asks for 9 x {} x (sigma_s / sigma_m)^2 runs, where sigma_s is the scatter of a simulated number "
      "from seed to seed:\n"
      "{} where it is that of the measurement, {} where it is half of it. The diagnosis says when it had fewer.\n",
      campaign.num_coefficients(), 9 * campaign.num_coefficients(), 9 * campaign.num_coefficients() / 4);
  return exit_done;
}

/// Whether the folders are sweeps of the plain study and of the extended ones, as far as the causes go.
void check_swept(const DiagnosisReport& report, const std::string& before, const std::vector<std::string>& after) {
  const auto studies = extended_studies(report);
  if (after.size() > studies.size())
    throw InputError(fmt::format("--after is there {} times: accepted is at most {}, the number of extended studies",
                                 after.size(), studies.size()));
  const Study plain = parse_study(read_text(report.campaign.study), report.campaign.study),
              old_sweep = read_frozen_study(before);
  const auto same = [](double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); };
  for (std::size_t i = 0; i < after.size(); ++i) {
    Study extended = parse_study(studies[i].second, studies[i].first);
    const Study new_sweep = read_frozen_study(after[i]);
    const auto check = [&](const std::string& folder, const std::string& key, double has, const std::string& of,
                           double needs) {
      if (!same(has, needs))
        throw InputError(
            fmt::format("{}: {} = {} there: accepted is a sweep of {}, which has {}", folder, key, has, of, needs));
    };
    for (const Field& field : fields(extended)) {
      const auto* value = std::get_if<double*>(&field.value);
      if (value == nullptr || same(**value, get_number(plain, field.key))) continue;
      check(before, field.key, get_number(old_sweep, field.key), report.campaign.study, get_number(plain, field.key));
      check(after[i], field.key, get_number(new_sweep, field.key), studies[i].first, **value);
    }
  }
}

int diagnose_campaign(const DiagnoseArguments& options) {
  if (!options.template_folder.empty()) return write_template(options.template_folder);
  if (options.campaign.empty()) throw InputError("CAMPAIGN.toml or --template DIR: one of them is needed");
  Farm farm;
  install_stop_signals();
  if (farm.rank() != 0) {
    serve_campaign(farm, options.threads);
    return exit_done;
  }
  // What throws before the farm is at work must not leave the others waiting.
  struct Dismissal {
    Farm& farm;
    bool needed = true;
    ~Dismissal() {
      if (!needed) return;
      farm.send_all(Tag::stop, "");
      farm.close();
    }
  } dismissal{farm};
  const Campaign campaign = read_campaign(options.campaign);
  if (options.plan) return print_plan(campaign, options.folder);
  const std::string folder = options.folder.empty()
                                 ? std::filesystem::path(campaign.path).stem().string() + "_diagnosis"
                                 : std::filesystem::path(options.folder).lexically_normal().string();
  MeasuredData measured = read_measured(campaign);
  CampaignStore{folder}.check(campaign);
  const std::vector<std::vector<Observable>> offered = offered_by(campaign, options.threads);
  if (offered.empty()) return exit_stopped;
  match_measured(measured, campaign.measured, campaign, offered);
  Reporter reporter;
  dismissal.needed = false;
  DiagnosisOptions how;
  how.seed = campaign.seed;
  how.num_bootstraps = static_cast<int>(campaign.bootstraps);
  std::vector<LocalCentre> second_wave;
  const TaskOutcome outcome = run_campaign(farm, campaign, folder, options.threads, reporter, [&] {
    return second_wave = plan_second_wave(campaign, measured, read_runs(campaign, folder, measured), how);
  });
  if (!outcome.finished) {
    fmt::print(stderr, "drumsweep: stopped early: {}; the same command goes on\n", outcome.stop_cause);
    return exit_stopped;
  }
  DiagnosisReport report = make_report(campaign, measured, read_runs(campaign, folder, measured, second_wave), how);
  if (!options.before.empty() || !options.after.empty()) {
    if (options.before.empty() || options.after.empty()) throw InputError("--before and --after: both are needed");
    check_swept(report, options.before, options.after);
    report.change = change_of_design(options.before, options.after, campaign.seed);
  }
  const std::vector<std::string> paths = write_report(report, folder);
  if (options.json)
    fmt::print("{}\n", json_of(report));
  else
    fmt::print("{}\nwritten: {}\n", report_text(report), fmt::join(paths, ", "));
  return exit_done;
}

}  // namespace

void add_diagnose(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<DiagnoseArguments>();
  CLI::App* command = app.add_subcommand(
      "diagnose", "Measured data against the model: what is wrong, why, and what an extension gains.");
  command->add_option("CAMPAIGN", options->campaign,
                      "campaign file (TOML): conditions, free parameters, candidate causes, measured data");
  command->add_option("-o,--output", options->folder, "output folder [default: CAMPAIGN's name + _diagnosis, here]");
  command->add_option(
      "--template", options->template_folder,
      "write a commented campaign.toml with scenes and measured.csv into this folder, which runs as it is");
  command->add_option("--before", options->before,
                      "output folder of the campaign's study, swept: what the extension changes in the optimum ...");
  command
      ->add_option("--after", options->after,
                   "... and of extended.toml; once more for extended_2.toml and so on: whether all agree on the design")
      ->allow_extra_args(false);
  command->add_flag("--plan", options->plan, "what would run and what it costs; runs nothing but one run for its time");
  command->add_option("--threads", options->threads, "threads of each rank; more ranks are better")
      ->capture_default_str()
      ->check(CLI::Range(1, 1024));
  command->add_flag("--json", options->json, "one JSON object on standard output");
  command->footer(
      "Examples:\n  drumsweep diagnose --template campaign\n"
      "  drumsweep diagnose campaign/campaign.toml --plan\n"
      "  mpirun -n 2 drumsweep diagnose campaign/campaign.toml -o found   again = go on\n"
      "Every run is stored when it is done; after a kill or Ctrl-C (exit 3) the same command goes on, and the result "
      "is the same bit for bit\n"
      "for any number of ranks. In OUT: diagnosis.txt, .html, .h5, misfit.csv, candidates.csv, isolation.csv, "
      "gain.csv, extended.toml "
      "(for `drumsweep run`).\n"
      "Measured values may be changed without simulating anything again; a change of what is simulated is refused "
      "(exit 5).");
  command->callback([options, &exit_code] { exit_code = diagnose_campaign(*options); });
}

}  // namespace drumsweep

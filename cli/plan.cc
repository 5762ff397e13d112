/// drumsweep plan
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "cli/arguments.h"
#include "cli/commands.h"
#include "cli/estimate.h"
#include "cli/json.h"
#include "core/config/schema.h"
#include "core/config/stages.h"
#include "core/config/toml_reader.h"
#include "core/io/snapshot.h"
#include "sweep/plan/planner.h"
#include "sweep/progress.h"
#include "sweep/store/provenance.h"
#include "sweep/store/recordings.h"
#include "sweep/store/results.h"
#include "sweep/store/store.h"

namespace drumsweep {
namespace {

struct PlanArguments {
  std::string study, folder;
  std::vector<std::string> changes;
  int ranks = 1;
  bool json = false;
};

/// What a folder has for this study.
struct Stored {
  bool warm = false;                      ///< the warm drum is finished
  std::map<std::string, ResultRow> rows;  ///< by design
  double seconds_per_design = 0;          ///< of one rank, mean of those done; 0: none done yet
};

/// Rows that searches decide from come from results.csv, which is of the frozen study: where the new one evaluates
/// differently they are only counted as done.
Stored look_into(const std::string& folder, const Study& study, Planner& planner, std::vector<std::string>& warnings) {
  Stored stored;
  const OutputPaths paths{folder};
  std::error_code error;
  if (!std::filesystem::exists(paths.study(), error)) return stored;
  const Study frozen = read_frozen_study(folder);
  if (const std::string text = explain_differences(frozen, study, true); !text.empty())
    throw MismatchError(fmt::format("{}: was made with other settings; `run` would refuse it:\n{}", folder, text));
  const std::vector<Difference> changed = differences(frozen, study);
  const bool same_numbers =
      std::none_of(changed.begin(), changed.end(), [](const Difference& d) { return d.scope == Scope::evaluation; });
  if (!same_numbers)
    warnings.push_back("stored landings will be evaluated anew, so searches may decide differently than shown");

  if (const auto warm = read_warm_state(paths.warm_state(), study)) stored.warm = warm->finished;
  double seconds = 0;
  int num_done = 0;
  for (const ProvenanceLine& line : read_provenance(paths.provenance())) {
    if (line.event != "done") continue;
    seconds += line.wall_s;
    ++num_done;
  }
  if (num_done > 0) stored.seconds_per_design = seconds / num_done;

  const RecordingIndex recordings(paths);
  if (std::filesystem::exists(paths.results(), error))
    for (ResultRow& row : read_results_csv(paths.results()).rows)
      if (recordings.has_recording(row.design_id) || recordings.has_failure(row.design_id))
        stored.rows.emplace(row.design_id, std::move(row));
  const RowOf row_of = [&](const PlannedDesign& design) -> const ResultRow* {
    const auto found = stored.rows.find(design.id);
    if (found != stored.rows.end()) return &found->second;
    if (design.impossible.empty()) return nullptr;
    return &(stored.rows[design.id] = failed_row(design, design.impossible));
  };
  while (planner.extend(row_of)) {
  }
  return stored;
}

/// How many designs one after the other, at most: a batch waits for the one before it, a start of an optimiser for its
/// last value.
double rounds(const Study& study, std::size_t s, std::size_t num_designs, int ranks) {
  const StageConfig& stage = study.stages[s];
  const auto in_rounds = [&](double n) { return std::ceil(n / ranks); };
  const auto n = static_cast<double>(num_designs);
  if (stage.type == "adaptive") {
    const double initial = std::min(n, static_cast<double>(stage.initial)), batch = static_cast<double>(stage.batch);
    return in_rounds(initial) + std::ceil((n - initial) / batch) * in_rounds(batch);
  }
  if (stage.type == "refine") {
    const auto starts = static_cast<double>(study.refine.starts);
    return std::ceil(n / starts) * in_rounds(starts);
  }
  return in_rounds(n);
}

void plan(const PlanArguments& options) {
  const Study study = read_study(options.study, options.changes);
  if (study.stages.empty()) throw InputError(options.study + ": has no [[stage]], so there is nothing to plan");
  const std::string folder =
      options.folder.empty() ? std::filesystem::path(options.study).stem().string() + "_result" : options.folder;
  Planner planner(study);
  std::vector<std::string> warnings;
  const Stored stored = look_into(folder, study, planner, warnings);
  const Plan& plan = planner.plan();
  const CostEstimate e = estimate_cost(study);
  const bool measured = stored.seconds_per_design > 0;
  const double per_design = measured ? stored.seconds_per_design : e.design_core_s;

  struct Tally {
    std::size_t run = 0, reused = 0, impossible = 0, further = 0;
  };
  std::vector<Tally> lines(plan.stages.size());
  for (const PlannedDesign& design : plan.designs) {
    Tally& line = lines[design.stage_number];
    if (!design.impossible.empty())
      ++line.impossible;
    else
      ++(stored.rows.count(design.id) > 0 ? line.reused : line.run);
  }
  // Stages wait for the ones before them, so each ends with its own last round.
  Tally all;
  double wall_s = stored.warm ? 0 : e.warmup_core_s;
  for (std::size_t s = 0; s < lines.size(); ++s) {
    lines[s].further = most_further_designs(study, plan, s);
    all.run += lines[s].run;
    all.reused += lines[s].reused;
    all.impossible += lines[s].impossible;
    all.further += lines[s].further;
    wall_s += per_design * rounds(study, s, lines[s].run + lines[s].further, options.ranks);
  }
  const double core_s = (stored.warm ? 0 : e.warmup_core_s) + per_design * static_cast<double>(all.run + all.further);

  if (options.json) {
    std::vector<std::string> stages;
    const auto count = [](std::size_t n) { return static_cast<std::int64_t>(n); };
    for (std::size_t s = 0; s < lines.size(); ++s)
      stages.push_back(JsonObject()
                           .text("name", plan.stages[s].name)
                           .text("type", plan.stages[s].type)
                           .count("to_run", count(lines[s].run))
                           .count("reused", count(lines[s].reused))
                           .count("impossible", count(lines[s].impossible))
                           .count("at_most_more", count(lines[s].further))
                           .str());
    fmt::print("{}\n", JsonObject()
                           .raw("stages", json_list(stages))
                           .count("to_run", count(all.run))
                           .count("reused", count(all.reused))
                           .count("at_most_more", count(all.further))
                           .flag("warm_up", !stored.warm)
                           .count("ranks", options.ranks)
                           .number("core_hours", core_s / 3600)
                           .number("wall_s", wall_s)
                           .flag("measured", measured)
                           .str());
    return;
  }
  fmt::print("{}: study \"{}\" into {}\n\n", options.study, study.name, folder);
  fmt::print("warm-up     {}\n",
             stored.warm ? "there already" : "to do, " + clock_text(e.warmup_core_s) + " of one core");
  for (std::size_t s = 0; s < lines.size(); ++s) {
    fmt::print("stage       \"{}\" ({}): {} to run, {} there already{}{}{}\n", plan.stages[s].name, plan.stages[s].type,
               lines[s].run, lines[s].reused,
               plan.stages[s].shared > 0 ? fmt::format(", {} shared with earlier stages", plan.stages[s].shared) : "",
               lines[s].impossible > 0 ? fmt::format(", {} impossible", lines[s].impossible) : "",
               lines[s].further > 0 ? fmt::format(", then up to {} more, decided from results", lines[s].further) : "");
    for (const std::string& note : plan.stages[s].notes) fmt::print("              {}\n", note);
  }
  for (std::size_t s = 0; s < lines.size(); ++s)
    if (is_search(study.stages[s])) {
      fmt::print("resolution ");
      for (const DesignAxis& axis : search_box(study, s))
        fmt::print(" {} {} to {} in steps of {};", axis.key, axis.low, axis.high, axis.resolution);
      fmt::print(" in \"{}\"\n", plan.stages[s].name);
    }
  fmt::print("\na design    {} of one core ({})\n", clock_text(per_design),
             measured ? "mean of those done there" : "estimate, may be off by a factor of two");
  fmt::print("all         {}{} designs, {:.3g} core-hours, {} on {} rank{}\n", all.further > 0 ? "at most " : "",
             all.run + all.further, core_s / 3600, clock_text(wall_s), options.ranks, options.ranks == 1 ? "" : "s");
  for (const std::string& text : warnings) fmt::print("warning: {}\n", text);
}

}  // namespace

void add_plan(CLI::App& app, int&) {
  auto options = std::make_shared<PlanArguments>();
  CLI::App* command =
      app.add_subcommand("plan", "What a run would simulate, what is there already, and what it costs. Runs nothing.");
  command->add_option("STUDY", options->study, "study file (TOML)")->required();
  command->add_option("-n,--ranks", options->ranks, "ranks of the run")
      ->capture_default_str()
      ->check(CLI::Range(1, 10000000));
  command->add_option("-o,--output", options->folder, "output folder [default: STUDY's name + _result, here]");
  add_set_option(*command, options->changes);
  command->add_flag("--json", options->json, "one JSON object on standard output");
  command->footer(
      "Examples:\n  drumsweep plan study/quick.toml -n 8\n  drumsweep plan study/quick.toml -n 8 -o out   what is left "
      "to do there\n"
      "Stages that decide from results are shown as far as the stored results let them decide. Times are those "
      "measured\n"
      "in the folder, or estimates. Exit code 5 when the folder holds another study.");
  command->callback([options] { plan(*options); });
}

}  // namespace drumsweep

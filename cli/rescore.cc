/// drumsweep rescore
#include "sweep/rescore.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "cli/arguments.h"
#include "cli/commands.h"
#include "cli/json.h"
#include "core/config/schema.h"
#include "core/io/durable_file.h"

namespace drumsweep {
namespace {

struct RescoreArguments {
  std::string folder, file;
  std::vector<std::vector<std::string>> named;  ///< values of named_keys, in their order
  std::vector<std::string> set;
  bool json = false;
};

struct NamedKey {
  const char *flag, *key, *help;
};
constexpr NamedKey named_keys[] = {
    {"--weights", "objective.weights", "decaying, growing or uniform"},
    {"--modes", "objective.modes", "lowest modes that count, or auto: all"},
    {"--window", "objective.window", "belt or footprint"},
    {"--normalization", "objective.normalization", "modes or samples"},
    {"--belt-speed", "belt.speed_m_s", "of the belt [m/s]"},
    {"--friction-angle", "objective.friction_angle_deg", "steepest slope of the bed [deg]"},
    {"--packing", "objective.packing", "packing fraction of the bed"},
    {"--cell", "objective.cell_diameters", "size of a bed cell [ball diameters]"},
};

/// The values of one key, each as a change: "KEY=a,b" -> "KEY=a", "KEY=b".
std::vector<std::string> changes_of(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos) throw InputError(fmt::format("--set {}: needs KEY=VALUE[,VALUE ...]", text));
  std::vector<std::string> changes;
  for (std::size_t begin = equals + 1; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    changes.push_back(text.substr(0, equals + 1) + text.substr(begin, end - begin));
    begin = end + 1;
  }
  return changes;
}

/// All combinations of the values that were given for each key, the first key slowest.
std::vector<KeyChanges> combinations(const RescoreArguments& options) {
  constexpr std::size_t most = 1000;
  std::vector<std::string> keys;
  for (std::size_t i = 0; i < options.named.size(); ++i)
    if (!options.named[i].empty())
      keys.push_back(fmt::format("{}={}", named_keys[i].key, fmt::join(options.named[i], ",")));
  keys.insert(keys.end(), options.set.begin(), options.set.end());
  if (keys.empty()) throw InputError("rescore: nothing to change; `drumsweep rescore --help` lists what can be");
  std::vector<KeyChanges> sets = {{}};
  std::vector<std::string> seen;
  for (const std::string& key : keys) {
    const std::string name = key.substr(0, key.find('='));
    if (std::find(seen.begin(), seen.end(), name) != seen.end())
      throw InputError(fmt::format("{} is given twice; give its values together, as in --set {}=A,B", name, name));
    seen.push_back(name);
    const std::vector<std::string> values = changes_of(key);
    std::vector<KeyChanges> longer;
    for (const KeyChanges& set : sets)
      for (const std::string& value : values) {
        longer.push_back(set);
        longer.back().push_back(value);
      }
    if (longer.size() > most)
      throw InputError(fmt::format("rescore: {} combinations of values, accepted is up to {}", longer.size(), most));
    sets = std::move(longer);
  }
  return sets;
}

std::string json_of(const std::optional<RescoredOptimum>& o) {
  if (!o) return "null";
  return JsonObject()
      .text("design_id", o->before.design_id)
      .number("old_f_m", o->before.f_m)
      .number("new_f_m", o->after.f_m)
      .number("change_percent", change_of_f_percent(*o))
      .number("old_f_over_mean_height", o->before.f_m / o->before.mean_height_m)
      .number("new_f_over_mean_height", o->after.f_m / o->after.mean_height_m)
      .number("change_over_mean_height_percent", change_of_f_over_height_percent(*o))
      .str();
}

void print_json(const Rescored& all, const std::string& file) {
  std::vector<std::string> cases;
  for (const Rescoring& one : all.cases)
    cases.push_back(JsonObject()
                        .text("changes", one.changes)
                        .count("compared", static_cast<std::int64_t>(one.compared))
                        .number("rank_correlation", one.rank_correlation)
                        .raw("old_optimum", json_of(one.old_optimum))
                        .raw("new_optimum", json_of(one.new_optimum))
                        .str());
  fmt::print("{}\n", JsonObject()
                         .count("designs", static_cast<std::int64_t>(all.before.size()))
                         .count("without_landings", static_cast<std::int64_t>(all.without_landings))
                         .count("damaged", static_cast<std::int64_t>(all.warnings.size()))
                         .raw("cases", json_list(cases))
                         .text("table", file)
                         .str());
}

std::string place_of(const Rescored& all, const RescoredOptimum& o) {
  const std::vector<std::string> names = with_means_of_replicates({all.variable_names, {}}).variable_names;
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i)
    text += fmt::format("{}{} = {}", i == 0 ? "" : ", ", names[i], o.before.variables.at(i));
  return text;
}

void print_text(const Rescored& all, const std::string& file, const std::string& summary) {
  fmt::print(
      "{} designs with landings{}\n", all.before.size(),
      all.without_landings > 0
          ? fmt::format(", {} without{}", all.without_landings,
                        all.warnings.empty() ? "" : fmt::format(" ({} damaged: NOT compared)", all.warnings.size()))
          : "");
  for (const Rescoring& one : all.cases) {
    fmt::print("{}\n", one.changes);
    if (!one.old_optimum || !one.new_optimum) {
      fmt::print("  no design can be compared\n");
      continue;
    }
    const RescoredOptimum &was = *one.old_optimum, &is = *one.new_optimum;
    fmt::print("  order of {} designs: rank correlation {:.3f}\n", one.compared, one.rank_correlation);
    fmt::print(
        "  lowest before: {} ({}): f {:.4g} -> {:.4g} m ({:+.1f} %), over the mean height {:.3g} -> {:.3g} ({:+.1f} "
        "%)\n",
        was.before.design_id, place_of(all, was), was.before.f_m, was.after.f_m, change_of_f_percent(was),
        was.before.f_m / was.before.mean_height_m, was.after.f_m / was.after.mean_height_m,
        change_of_f_over_height_percent(was));
    if (is.before.design_id == was.before.design_id && is.before.stage == was.before.stage)
      fmt::print("  lowest now: the same design\n");
    else
      fmt::print("  lowest now: {} ({}): f {:.4g} -> {:.4g} m\n", is.before.design_id, place_of(all, is), is.before.f_m,
                 is.after.f_m);
  }
  fmt::print("{} and {}\n", file, summary);
}

void run_rescore(const RescoreArguments& options) {
  if (!options.file.ends_with(".csv")) throw InputError(options.file + ": unknown ending, accepted: .csv");
  need_place_for(options.file);
  const Rescored all = rescore(options.folder, combinations(options));
  for (const std::string& warning : all.warnings) fmt::print(stderr, "drumsweep: {}; left out\n", warning);
  if (all.before.empty()) throw InputError(options.folder + ": no design with landings yet; nothing to evaluate");
  const std::string summary = options.file.substr(0, options.file.size() - 4) + "_summary.csv";
  write_durably(options.file, to_csv(all));
  write_durably(summary, summary_csv(all));
  if (options.json)
    print_json(all, options.file);
  else
    print_text(all, options.file, summary);
}

}  // namespace

void add_rescore(CLI::App& app, int&) {
  auto options = std::make_shared<RescoreArguments>();
  options->named.resize(std::size(named_keys));
  CLI::App* command = app.add_subcommand(
      "rescore", "Evaluate the stored landings of all designs with other weights, belt speed ...; simulates nothing.");
  command->add_option("OUT", options->folder, "output folder of a run; it is not changed")->required();
  command->add_option("-o,--output", options->file, "FILE.csv, a line a design; FILE_summary.csv goes beside it")
      ->required();
  for (std::size_t i = 0; i < std::size(named_keys); ++i)
    command->add_option(named_keys[i].flag, options->named[i], std::string(named_keys[i].help))->delimiter(',');
  command->add_option("--set", options->set,
                      "KEY=VALUE[,VALUE ...]: any [objective] key, belt.speed_m_s or solver.residual_limit_m_s");
  command->add_flag("--json", options->json, "one JSON object on standard output");
  command->footer(
      "Examples:\n  drumsweep rescore out --belt-speed 0.125,0.25,0.5 -o speed.csv\n"
      "  drumsweep rescore out --weights uniform --window footprint -o even.csv\n"
      "  drumsweep rescore out --set objective.packing=0.6,0.64 -o packing.csv\n"
      "Several values of a key are tried in turn, of several keys in all combinations. For each: old and new f [m] of\n"
      "every design, rank correlation of the two orders, and what becomes of the optimum. Heights, and f with them, "
      "go\n"
      "with 1 / belt speed and 1 / packing: there look at f over the mean height.");
  command->callback([options] { run_rescore(*options); });
}

}  // namespace drumsweep

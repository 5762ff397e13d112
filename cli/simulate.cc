/// drumsweep simulate
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "cli/commands.h"
#include "cli/json.h"
#include "core/config/schema.h"
#include "core/config/toml_reader.h"
#include "sweep/single_design.h"
#include "sweep/stop.h"

namespace drumsweep {
namespace {

struct Options {
  std::string study, folder;
  std::vector<double> at;
  bool json = false;
};

void print_json(const SingleDesign& d) {
  std::vector<std::string> list;
  for (const Observable& o : d.observables)
    list.push_back(JsonObject()
                       .text("name", o.name)
                       .number("position", o.position)
                       .number("value", o.value)
                       .number("sigma", o.sigma)
                       .text("unit", o.unit)
                       .str());
  const Recording& r = d.recording;
  JsonObject balance, all;
  balance.count("fed", r.counts.fed).count("landed", r.counts.landed).count("spilled", r.counts.spilled);
  balance.count("inside", r.inside).count("removed", r.counts.removed);
  all.text("design_id", d.design.id)
      .text("state", d.state)
      .text("reason", d.reason)
      .flag("steady", d.steady)
      .raw("observables", json_list(list));
  all.count("lost_balls", r.lost).raw("mass_balance", balance.str());
  all.text("state_hash", fmt::format("{:016x}", r.hash)).number("residual", r.quality.residual.mean);
  all.number("cpu_s", d.cpu_s).text("recording", d.recording_path);
  fmt::print("{}\n", all.str());
}

void print_text(const SingleDesign& d) {
  fmt::print("design {}{}\n", d.design.id, d.state == "done" ? "" : fmt::format(" ({}: {})", d.state, d.reason));
  for (const Observable& o : d.observables)
    fmt::print("  {:<22}{:>10} {:>12.5g}{} {}\n", o.name,
               std::isnan(o.position) ? "" : fmt::format("{:.4g} m", o.position), o.value,
               std::isnan(o.sigma) ? "" : fmt::format(" +- {:.2g}", o.sigma), o.unit);
  const Recording& r = d.recording;
  fmt::print("balls since the empty drum: {} fed = {} landed + {} spilled + {} inside + {} removed\n", r.counts.fed,
             r.counts.landed, r.counts.spilled, r.inside, r.counts.removed);
  fmt::print("{:.1f} s CPU; {} and {}\n", d.cpu_s, d.recording_path, d.observables_path);
}

int simulate(const Options& options) {
  install_stop_signals();
  Study study = read_study(options.study);
  std::vector<double> at = options.at;
  if (at.empty()) {
    // The outlet as it is in the study.
    study.stages.clear();
    for (const std::string& key : keys_of_values(study)) at.push_back(get_number(study, key));
  }
  Reporter reporter;
  const SingleDesign design =
      run_single_design(study, at, std::filesystem::path(options.folder).lexically_normal().string(), reporter);
  reporter.clear();
  if (design.stopped) {
    fmt::print(stderr, "drumsweep: stopped by {}; the warm-up goes on from its last window when run again\n",
               stop_signal());
    return exit_stopped;
  }
  if (options.json)
    print_json(design);
  else
    print_text(design);
  return exit_done;
}

}  // namespace

void add_simulate(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("simulate", "Run one design and print its observables with errors.");
  command->add_option("STUDY", options->study, "study file (TOML)")->required();
  command
      ->add_option(
          "--at", options->at,
          "the design: values of the stages' variables in order (or of the outlet's angle and base width [m], if "
          "there is no stage), in the units of the keys; left out: the study's own outlet")
      ->delimiter(',');
  command->add_option("-o,--output", options->folder, "folder; its warm_state.h5 is used again where it fits")
      ->required();
  command->add_flag("--json", options->json, "one JSON object on standard output");
  command->footer(
      "Example:\n  drumsweep simulate study/quick.toml --at 2,0.04 -o one --json\n"
      "Writes warm_state.h5, ID.h5 (landings) and ID_observables.csv: f [m], bed height across the belt [m], shares of "
      "the\n"
      "outflow by slot, holdup [balls].");
  command->callback([options, &exit_code] { exit_code = simulate(*options); });
}

}  // namespace drumsweep

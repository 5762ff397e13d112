/// drumsweep simulate
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "cli/arguments.h"
#include "cli/commands.h"
#include "cli/json.h"
#include "core/config/schema.h"
#include "core/config/toml_reader.h"
#include "core/io/durable_file.h"
#include "core/io/scene_image.h"
#include "core/parallel/parallel_for.h"
#include "sweep/single_design.h"
#include "sweep/stop.h"
#include "sweep/store/store.h"

namespace drumsweep {
namespace {

struct SimulateArguments {
  std::string study, folder;
  std::vector<std::string> changes;
  std::vector<double> at;
  int threads = 0;
  bool json = false;

  int threads_to_use() const { return threads > 0 ? threads : available_threads(); }
};

std::string json_of(const std::vector<Observable>& observables) {
  std::vector<std::string> list;
  for (const Observable& o : observables)
    list.push_back(JsonObject()
                       .text("name", o.name)
                       .number("position", o.position)
                       .text("position_unit", std::isnan(o.position) ? "" : o.position_unit)
                       .number("value", o.value)
                       .number("sigma", o.sigma)
                       .text("unit", o.unit)
                       .str());
  return json_list(list);
}

void print_observables(const std::vector<Observable>& observables) {
  for (const Observable& o : observables)
    fmt::print("  {:<26}{:>12} {:>12.5g}{} {}\n", o.name,
               std::isnan(o.position) ? "" : fmt::format("{:.4g} {}", o.position, o.position_unit), o.value,
               std::isnan(o.sigma) ? "" : fmt::format(" +- {:.2g}", o.sigma), o.unit);
}

void print_json(const SingleDesign& d) {
  const Recording& r = d.recording;
  JsonObject balance, all;
  balance.count("fed", r.counts.fed).count("landed", r.counts.landed).count("spilled", r.counts.spilled);
  balance.count("inside", r.inside).count("removed", r.counts.removed);
  all.text("design_id", d.design.id)
      .text("state", d.state)
      .text("reason", d.reason)
      .flag("steady", d.steady)
      .raw("observables", json_of(d.observables));
  all.count("lost_balls", r.lost).raw("mass_balance", balance.str());
  all.text("state_hash", fmt::format("{:016x}", r.hash)).number("residual", r.quality.residual.mean);
  all.number("cpu_s", d.cpu_s).text("recording", d.recording_path);
  fmt::print("{}\n", all.str());
}

void print_text(const SingleDesign& d) {
  fmt::print("design {}{}\n", d.design.id, d.state == "done" ? "" : fmt::format(" ({}: {})", d.state, d.reason));
  print_observables(d.observables);
  const Recording& r = d.recording;
  fmt::print("balls since the empty drum: {} fed = {} landed + {} spilled + {} inside + {} removed\n", r.counts.fed,
             r.counts.landed, r.counts.spilled, r.inside, r.counts.removed);
  fmt::print("{:.1f} s CPU; {} and {}\n", d.cpu_s, d.recording_path, d.observables_path);
}

int simulate_scene(const SimulateArguments& options) {
  if (!options.at.empty()) throw InputError("--at: is for studies; a scene has its numbers in its file");
  SceneFile file = read_scene(options.study, options.changes);
  file.scene->threads = options.threads_to_use();
  Reporter reporter;
  SceneResult r = file.scene->run(file.physics, [&](const SceneProgress& progress) {
    reporter.update(progress);
    return !stop_requested();
  });
  reporter.clear();
  if (r.stopped) {
    fmt::print(stderr, "drumsweep: stopped by {}; nothing was written, a scene begins anew when run again\n",
               stop_signal());
    return exit_stopped;
  }
  const std::string folder = std::filesystem::path(options.folder).lexically_normal().string();
  const std::string stem = folder + "/" + file.type, csv = stem + "_observables.csv", image = stem + ".h5";
  make_folder(folder);
  write_durably(csv, observables_csv(r.observables));
  write_durably(image, pack_scene(file, r));
  if (r.lost > 0) reporter.warn(fmt::format("{} balls were lost: do not trust this result", r.lost));

  const std::string hash = fmt::format("{:016x}", state_hash(r.state));
  if (options.json) {
    std::int64_t inside = 0;
    for (const std::uint8_t exit : r.state.balls.exit) inside += exit == static_cast<std::uint8_t>(Exit::fixed) ? 0 : 1;
    JsonObject balance, all;
    balance.count("fed", r.num_balls).count("landed", r.num_balls - inside - r.lost).count("spilled", 0);
    balance.count("inside", inside).count("removed", r.lost);
    all.text("scene", file.type).raw("observables", json_of(r.observables)).count("lost_balls", r.lost);
    all.raw("mass_balance", balance.str()).text("state_hash", hash).number("residual", r.quality.residual.mean);
    all.number("overlap_95", r.quality.overlap_95).number("force_balance", r.quality.force_balance);
    all.number("cpu_s", r.cpu_s).number("simulated_s", r.simulated_s).text("result", image);
    fmt::print("{}\n", all.str());
    return exit_done;
  }
  fmt::print("{} ({})\n", file.name, file.type);
  print_observables(r.observables);
  fmt::print("{} balls, {:.3g} s simulated; mean residual {:.2g} m/s, 95 % of overlaps below {:.2g} % of d, {} lost\n",
             r.num_balls, r.simulated_s, r.quality.residual.mean, 100 * r.quality.overlap_95, r.lost);
  fmt::print("{:.1f} s CPU; {} and {}\n", r.cpu_s, image, csv);
  return exit_done;
}

int simulate(const SimulateArguments& options) {
  install_stop_signals();
  if (is_scene_file(options.study)) return simulate_scene(options);
  Study study = read_study(options.study, options.changes);
  std::vector<double> at = options.at;
  if (at.empty()) {
    // The outlet as it is in the study.
    study.stages.clear();
    for (const std::string& key : keys_of_values(study)) at.push_back(get_number(study, key));
  }
  Reporter reporter;
  const SingleDesign design = run_single_design(
      study, at, std::filesystem::path(options.folder).lexically_normal().string(), options.threads_to_use(), reporter);
  reporter.clear();
  if (design.stopped) {
    fmt::print(stderr,
               "drumsweep: stopped by {}; when run again the warm-up goes on where it was, a design begins anew\n",
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
  auto options = std::make_shared<SimulateArguments>();
  CLI::App* command =
      app.add_subcommand("simulate", "Run one design of a study, or one scene, and print its observables with errors.");
  command->add_option("FILE", options->study, "study file, or scene file with [scene] type = ... (TOML)")->required();
  command
      ->add_option(
          "--at", options->at,
          "the design: values of the stages' variables in order (or of the outlet's angle and base width [m], if "
          "there is no stage), in the units of the keys; left out: the study's own outlet")
      ->delimiter(',');
  add_set_option(*command, options->changes);
  command->add_option("-o,--output", options->folder, "folder; its warm_state.h5 is used again where it fits")
      ->required();
  command->add_option("--threads", options->threads, "threads; 0: one a core. The result is the same bit for bit")
      ->capture_default_str()
      ->check(CLI::Range(0, 1024));
  command->add_flag("--json", options->json, "one JSON object on standard output");
  command->footer(
      "Example:\n  drumsweep simulate study/quick.toml --at 2,0.04 -o one --json\n"
      "Writes warm_state.h5, ID.h5 (landings) and ID_observables.csv: f [m], bed height across the belt [m], shares of "
      "the\n"
      "outflow by slot, holdup [balls].\n"
      "  drumsweep simulate study/drop.toml -o drop\n"
      "A scene is a small experiment (`drumsweep init --preset scenes` writes one of each); it writes TYPE.h5 and\n"
      "TYPE_observables.csv.");
  command->callback([options, &exit_code] { exit_code = simulate(*options); });
}

}  // namespace drumsweep

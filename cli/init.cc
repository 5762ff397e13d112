/// drumsweep init
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "cli/commands.h"
#include "cli/embedded_schedules.h"
#include "core/config/schema.h"
#include "core/config/toml_reader.h"
#include "core/io/durable_file.h"
#include "core/scene/scene.h"
#include "sweep/store/store.h"

namespace drumsweep {
namespace {

const std::vector<std::string> presets = {"quick", "lab2013", "plant", "scenes"};

std::vector<Schedule> schedules_of(const std::string& preset) {
  std::vector<Schedule> list;
  for (int i = 0; i < num_embedded_schedules; ++i)
    if (std::string(embedded_schedules[i].name).rfind(preset, 0) == 0) list.push_back(embedded_schedules[i]);
  return list;
}

/// Presets that have a schedule in this build.
std::set<std::string> offered() {
  std::set<std::string> names;
  for (const std::string& preset : presets)
    if (!schedules_of(preset).empty()) names.insert(preset);
  return names;
}

struct InitArguments {
  std::string preset = "quick", folder;
};

std::string file_name(const Schedule& schedule) {
  const std::string name = std::filesystem::path(schedule.name).filename().string();
  return name.ends_with(".toml") ? name : name + ".toml";
}

/// The same file with every key, its help and its range.
std::string explained(const Schedule& schedule) {
  if (std::string(schedule.name).rfind("scenes/", 0) != 0)
    return write_study(parse_study(schedule.text, file_name(schedule)), true);
  SceneFile file = parse_scene(schedule.text, file_name(schedule));
  return write_scene(file, true);
}

void init(const InitArguments& options) {
  const std::vector<Schedule> list = schedules_of(options.preset);
  const bool scenes = options.preset == "scenes";
  std::vector<std::pair<std::string, std::string>> files;
  for (const Schedule& schedule : list) files.emplace_back(file_name(schedule), schedule.text);
  // One explanation serves all studies of a preset; each scene has keys of its own.
  if (scenes)
    for (const Schedule& schedule : list)
      files.emplace_back(std::filesystem::path(file_name(schedule)).stem().string() + "_all_keys.toml",
                         explained(schedule));
  else
    files.emplace_back(options.preset + "_all_keys.toml", explained(list.front()));

  // Nothing is written unless everything can be.
  for (const auto& [name, text] : files) {
    std::error_code error;
    if (std::filesystem::exists(options.folder + "/" + name, error))
      throw InputError(options.folder + "/" + name +
                       ": is there already and is not overwritten; choose another folder or remove it");
  }
  make_folder(options.folder);
  for (const auto& [name, text] : files) {
    write_durably(options.folder + "/" + name, text);
    fmt::print("{}/{}{}\n", options.folder, name, name.ends_with("_all_keys.toml") ? " (every key, explained)" : "");
  }
  const std::string first = options.folder + "/" + file_name(list.front());
  if (scenes)
    fmt::print("next: drumsweep simulate {} -o result\n", first);
  else
    fmt::print("next: drumsweep check {}\n", first);
}

}  // namespace

void add_init(CLI::App& app, int&) {
  auto options = std::make_shared<InitArguments>();
  CLI::App* command = app.add_subcommand("init", "Write commented study files that run as they are.");
  command
      ->add_option("--preset", options->preset,
                   "which study: quick (two minutes), lab2013 (the published lab drum), plant (a full-size drum, for "
                   "a cluster), scenes (small "
                   "experiments for `simulate`)")
      ->check(CLI::IsMember(offered()))
      ->capture_default_str();
  command->add_option("DIR", options->folder, "folder for the files; made if it is not there")->required();
  command->footer(
      "Example:\n  drumsweep init --preset quick study\n"
      "Units are part of the key names (diameter_m, opening_angle_deg); change values and run\n"
      "`drumsweep check FILE`. Existing files are never overwritten.");
  command->callback([options] { init(*options); });
}

}  // namespace drumsweep

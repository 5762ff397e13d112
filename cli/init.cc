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
#include "sweep/store.h"

namespace drumsweep {
namespace {

const std::vector<std::string> presets = {"quick", "lab2013", "plant"};

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

struct Options {
  std::string preset = "quick", folder;
};

std::string file_name(const Schedule& schedule) {
  const std::string name = schedule.name;
  return name.ends_with(".toml") ? name : name + ".toml";
}

void init(const Options& options) {
  const std::vector<Schedule> list = schedules_of(options.preset);
  const auto place = [&](const std::string& name) { return options.folder + "/" + name; };
  const std::string reference = place(options.preset + "_all_keys.toml");

  // Nothing is written unless everything can be.
  std::vector<std::string> paths{reference};
  for (const Schedule& schedule : list) paths.push_back(place(file_name(schedule)));
  for (const std::string& path : paths) {
    std::error_code error;
    if (std::filesystem::exists(path, error))
      throw InputError(path + ": is there already and is not overwritten; choose another folder or remove it");
  }
  make_folder(options.folder);
  for (const Schedule& schedule : list) {
    write_durably(place(file_name(schedule)), schedule.text);
    fmt::print("{}\n", place(file_name(schedule)));
  }
  // The same study with every key, its help and its range.
  write_durably(reference, write_study(parse_study(list.front().text, file_name(list.front())), true));
  fmt::print("{} (every key, explained)\n", reference);
  fmt::print("next: drumsweep check {}/{}\n", options.folder, file_name(list.front()));
}

}  // namespace

void add_init(CLI::App& app, int&) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("init", "Write commented study files that run as they are.");
  command->add_option("--preset", options->preset, "which study: quick (two minutes), lab2013 (the published lab drum)")
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

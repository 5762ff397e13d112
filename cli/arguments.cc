#include "cli/arguments.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "core/config/schema.h"
#include "sweep/store/store.h"

namespace drumsweep {

CLI::Validator number_between(double low, double high) {
  return CLI::Validator(
      [low, high](const std::string& text) -> std::string {
        double value = std::nan("");
        // Written so that a NaN is outside.
        if (CLI::detail::lexical_cast(text, value) && value >= low && value <= high) return "";
        return fmt::format("{}: accepted is a number from {:g} to {:g}", text, low, high);
      },
      fmt::format("FLOAT in [{:g} - {:g}]", low, high));
}

void add_set_option(CLI::App& command, std::vector<std::string>& changes) {
  command
      .add_option("--set", changes,
                  "KEY=VALUE: a key of the study with another value than in the file, as solver.iterations=50; may be "
                  "given several times")
      ->allow_extra_args(false);
}

void need_place_for(const std::string& file) {
  std::error_code error;
  if (std::filesystem::is_directory(file, error)) throw InputError(file + ": is a folder, not a file");
  if (std::filesystem::exists(file, error) && !std::filesystem::is_regular_file(file, error))
    throw InputError(file + ": is there and is no file; what is written is a file");
  std::filesystem::path folder = std::filesystem::path(file).parent_path();
  if (folder.empty()) folder = ".";
  if (!std::filesystem::is_directory(folder, error))
    throw InputError(fmt::format("{}: there is no folder {}; make it first", file, folder.string()));
  const OutputPaths run{folder.string()};
  const auto own = {run.study(),         run.warm_state(), run.results(), run.findings(),
                    run.results_image(), run.provenance(), run.log(),     run.lock()};
  const std::string path = (folder / std::filesystem::path(file).filename()).string();
  if (std::filesystem::exists(run.study(), error) && std::find(own.begin(), own.end(), path) != own.end())
    throw InputError(file + ": is the run's own file; choose another name");
  if (::access(folder.c_str(), W_OK) != 0)
    throw InputError(fmt::format("{}: the folder {} cannot be written to", file, folder.string()));
}

}  // namespace drumsweep

/// drumsweep contour
#include "postproc/contour.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>

#include "cli/commands.h"
#include "core/config/schema.h"
#include "sweep/store/store.h"

namespace drumsweep {
namespace {

struct Options {
  std::string folder, file;
  ContourOptions contour;
};

void contour(Options options) {
  const OutputPaths paths{options.folder};
  options.contour.title = read_frozen_study(options.folder).name;
  std::error_code error;
  if (!std::filesystem::exists(paths.results(), error))
    throw InputError(paths.results() + ": is not there yet; `drumsweep run` writes it");
  const ResultTable table = with_means_of_replicates(read_results_csv(paths.results()));
  const std::string& stage = options.contour.stage;
  const auto in_stage = [&](const ResultRow& row) { return row.stage == stage; };
  if (!stage.empty() && std::none_of(table.rows.begin(), table.rows.end(), in_stage))
    throw InputError(fmt::format("--stage {}: no result of such a stage in {}", stage, paths.results()));
  write_contour(table, options.contour, options.file);
  fmt::print("{}\n", options.file);
}

}  // namespace

void add_contour(CLI::App& app, int&) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("contour", "f over two design variables, as a table or a figure.");
  command->add_option("OUT", options->folder, "output folder of a run")->required();
  command->add_option("-o,--output", options->file, "FILE.csv (table), .png or .svg (figure), .gp (gnuplot script)")
      ->required();
  command->add_flag("--matrix", options->contour.matrix,
                    ".csv: a matrix, x in the first row and y in the first column");
  command->add_option("--stage", options->contour.stage, "only this stage");
  command->add_option("--x", options->contour.x_variable, "variable along x [default: the first that varies]");
  command->add_option("--y", options->contour.y_variable, "variable along y [default: the second that varies]");
  command->add_option("--value", options->contour.value, "what is drawn, in metres")
      ->check(CLI::IsMember({"f_m", "f_footprint_m"}))
      ->capture_default_str();
  command->footer(
      "Examples:\n  drumsweep contour out -o contour.csv\n  drumsweep contour out -o contour.png\n"
      "f is in metres, design variables in the units of their names; the bold line of the figure is f = 0.01 m.\n"
      "A figure needs gnuplot.");
  command->callback([options] { contour(*options); });
}

}  // namespace drumsweep

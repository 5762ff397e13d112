/// drumsweep contour
#include "postproc/contour.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "cli/arguments.h"
#include "cli/commands.h"
#include "core/config/schema.h"
#include "sweep/plan/contour_fit.h"
#include "sweep/status.h"
#include "sweep/store/store.h"

namespace drumsweep {
namespace {

struct ContourArguments {
  std::string folder, file, surface = "auto";
  std::vector<std::string> slices;
  double tolerance_m = not_given;
  ContourOptions contour;
};

/// "KEY=VALUE". @throws InputError
std::pair<std::string, double> slice_of(const std::string& text) {
  const std::size_t equals = text.find('=');
  double value = 0;
  if (equals != std::string::npos && equals > 0) {
    const char *begin = text.data() + equals + 1, *end = text.data() + text.size();
    const auto [stopped, error] = std::from_chars(begin, end, value);
    if (error == std::errc() && stopped == end && std::isfinite(value)) return {text.substr(0, equals), value};
  }
  throw InputError(fmt::format("--slice {}: KEY=VALUE expected, a variable of the table and a number", text));
}

bool is_figure(const std::string& file) {
  const std::string ending = std::filesystem::path(file).extension().string();
  return ending == ".png" || ending == ".svg" || ending == ".gp";
}

void contour(ContourArguments options) {
  need_place_for(options.file);
  if (options.contour.matrix && std::filesystem::path(options.file).extension() != ".csv")
    throw InputError(fmt::format("--matrix: makes a table, {} is to be a figure; accepted: .csv", options.file));
  const OutputPaths paths{options.folder};
  const Study study = read_frozen_study(options.folder);
  options.contour.title = study.name;
  std::error_code error;
  if (!std::filesystem::exists(paths.results(), error))
    throw InputError(paths.results() + ": is not there yet; `drumsweep run` writes it");
  const ResultTable all = read_results_csv(paths.results());
  const ResultTable table = with_means_of_replicates(all);
  const std::string& stage = options.contour.stage;
  const auto in_stage = [&](const ResultRow& row) { return row.stage == stage; };
  if (!stage.empty() && std::none_of(table.rows.begin(), table.rows.end(), in_stage)) {
    std::vector<std::string> stages;
    for (const StageConfig& s : study.stages) stages.push_back(s.name);
    throw InputError(fmt::format("--stage {}: no result of such a stage in {}; the study has {}", stage,
                                 paths.results(), fmt::join(stages, ", ")));
  }
  for (const std::string& text : options.slices) options.contour.slice.push_back(slice_of(text));
  if (!std::isnan(options.tolerance_m))
    options.contour.tolerance_m = options.tolerance_m;
  else if (study.refine.tolerance_f_m > 0)
    options.contour.tolerance_m = study.refine.tolerance_f_m;

  if (is_figure(options.file) && options.surface != "linear") {
    // A stage is shown with what was known when it had ended.
    std::size_t num_stages = study.stages.size();
    for (std::size_t s = 0; s < study.stages.size(); ++s)
      if (study.stages[s].name == stage) num_stages = s + 1;
    const StudyFit fit = fit_of_study(study, plan_of_folder(paths, study), all, options.contour.value, num_stages);
    options.contour.fit = contour_fit(fit, table, options.contour);
    if (options.contour.fit && !options.contour.fit->usable)
      fmt::print(stderr, "drumsweep: no fit is drawn: {}\n", options.contour.fit->verdict);
  }
  write_contour(table, options.contour, options.file);
  fmt::print("{}\n", options.file);
}

}  // namespace

void add_contour(CLI::App& app, int&) {
  auto options = std::make_shared<ContourArguments>();
  CLI::App* command = app.add_subcommand("contour", "f over two design variables, as a table or a figure.");
  command->add_option("OUT", options->folder, "output folder of a run")->required();
  command
      ->add_option(
          "-o,--output", options->file,
          "FILE.csv: table; FILE.png, FILE.svg: figure; FILE.gp: gnuplot script, with its data in FILE.dat, that "
          "draws FILE.png")
      ->required();
  command->add_flag("--matrix", options->contour.matrix,
                    ".csv: f of one stage as a matrix, x in the first row and y in the first column");
  command->add_option("--stage", options->contour.stage, "only designs of this stage [default: all stages together]");
  command->add_option("--x", options->contour.x_variable, "variable along x [default: the first that varies]");
  command->add_option("--y", options->contour.y_variable, "variable along y [default: the second that varies]");
  command
      ->add_option("--slice", options->slices,
                   "KEY=VALUE: hold another variable at a value in its unit; once for each that varies beside x and y. "
                   "Values between those of the designs need a fit")
      ->allow_extra_args(false);
  command
      ->add_option(
          "--surface", options->surface,
          "what is coloured: auto, the fit of findings.toml if it is to be trusted, else linear; linear, between "
          "neighbouring designs of grids only")
      ->check(CLI::IsMember({"auto", "linear"}))
      ->capture_default_str();
  command
      ->add_option("--tolerance", options->tolerance_m,
                   "the bold line [m] [default: refine.tolerance_f_m of the study if above 0, else 0.01, as in S1]")
      ->check(number_between(1e-9, 1000));
  command
      ->add_option("--value", options->contour.value,
                   "what is shown [m]: f_m in the study's window, or f_footprint_m, f under the outlet alone")
      ->check(CLI::IsMember({"f_m", "f_footprint_m"}))
      ->capture_default_str();
  command->footer(
      "Examples:\n"
      "  drumsweep contour out -o contour.csv\n"
      "  drumsweep contour out -o contour.png --tolerance 0.012\n"
      "  drumsweep contour out -o map.svg --x opening_angle_deg --y base_width_m --slice length_m=0.3\n"
      "Tables have f in metres and design variables in the units of their names. In the figure designs are filled with "
      "the\n"
      "colour of their own f, designs without a result are hatched as far as they are the nearest, and nothing is\n"
      "coloured outside the designs. Replicates of a design count as one, their mean. A figure needs gnuplot.");
  command->callback([options] { contour(*options); });
}

}  // namespace drumsweep

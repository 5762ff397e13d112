/// drumsweep sample
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/commands.h"
#include "cli/json.h"
#include "core/config/schema.h"
#include "postproc/contour.h"
#include "postproc/sample_figure.h"
#include "sweep/find_design.h"
#include "sweep/status.h"
#include "sweep/store/recordings.h"
#include "sweep/store/results.h"

namespace drumsweep {
namespace {

struct SampleArguments {
  std::string folder, id, output;
  std::vector<double> at;
  std::optional<double> replicate;
  bool json = false;
};

/// A design with its landings, evaluated.
struct Looked {
  PlannedDesign design;
  std::vector<std::string> columns;
  ResultRow row;
  DesignSample sample;
};

/// Why there are no landings to look at. @throws InputError always
[[noreturn]] void refuse(const OutputPaths& paths, const PlannedDesign& design, const std::string& values,
                         const RecordingIndex& recordings) {
  std::string why = "it has not ended yet";
  if (!design.impossible.empty())
    why = "there is no such drum: " + design.impossible;
  else if (recordings.has_failure(design.id))
    why = "it failed: " + read_failure(paths, design.id);
  throw InputError(fmt::format("design {} ({}) has no landings: {}; `drumsweep why {} {}` says more", design.id, values,
                               why, paths.folder, design.id));
}

std::string lost_trust(const ResultRow& row) {
  return row.state == "done" ? ""
                             : fmt::format("{}: {}", row.state == "untrusted" ? "UNTRUSTED" : row.state, row.reason);
}

std::vector<std::string> notes_of(const Looked& looked) {
  std::string where;
  for (std::size_t c = 0; c < looked.columns.size(); ++c)
    if (std::isfinite(looked.design.row[c]))
      where += (where.empty() ? "" : ", ") + value_text(looked.columns[c], looked.design.row[c]);
  const Objective& o = looked.sample.evaluation.objective;
  std::vector<std::string> notes = {
      where,
      fmt::format("f = {} mm with the {} as window", with_error(1e3 * o.f_m, 1e3 * o.sigma_f_m),
                  looked.sample.footprint_counts ? "outlet's footprint" : "whole belt"),
      fmt::format("{} balls in {:g} turns; mean height {:.3g} mm; largest |aₙ| / a₀ = {:.2g}", o.landed,
                  looked.sample.turns, 1e3 * o.mean_height_m, o.max_an_over_a0)};
  if (const std::string warning = lost_trust(looked.row); !warning.empty()) notes.push_back(warning);
  return notes;
}

Looked look(const SampleArguments& options) {
  const OutputPaths paths{options.folder};
  const Study study = read_frozen_study(options.folder);
  const Plan plan = plan_of_folder(paths, study);
  Looked out;
  out.design = options.id.empty() ? design_with_values(plan, study, options.at, options.replicate)
                                  : design_with_id(plan, options.id);
  out.columns = plan.columns;
  RecordingIndex recordings(paths);
  if (!recordings.has_recording(out.design.id)) refuse(paths, out.design, describe(plan, out.design), recordings);
  const StoredDesign stored = recordings.read(study, out.design);
  const Recording& recording = stored.recording.value();
  const bool steady = read_warm_state(paths.warm_state(), study).value_or(WarmState{}).steady;
  out.row = evaluated_row(study, out.design, recording, steady);
  out.sample =
      design_sample(recording.landings, recording.begin_s, recording.turns, study_of_design(study, out.design.values));
  out.sample.notes = notes_of(out);
  return out;
}

/// Balls by exit: slot 1 ... n, then over the end.
std::vector<std::int64_t> balls_by_exit(const DesignSample& sample) {
  std::vector<std::int64_t> balls(static_cast<std::size_t>(sample.num_slots) + 1, 0);
  for (const BeltLanding& landing : sample.landings)
    ++balls[landing.exit >= 1 && landing.exit <= sample.num_slots ? landing.exit - 1u : balls.size() - 1];
  return balls;
}

std::string name_of_exit(std::size_t k, std::size_t count) {
  return k + 1 == count ? "end" : fmt::format("slot {}", k + 1);
}

void print_json(const Looked& looked, const std::vector<std::string>& files) {
  JsonObject values, all;
  for (std::size_t c = 0; c < looked.columns.size(); ++c) values.number(looked.columns[c], looked.design.row[c]);
  std::vector<std::string> exits, paths;
  const std::vector<std::int64_t> balls = balls_by_exit(looked.sample);
  for (std::size_t k = 0; k < balls.size(); ++k)
    exits.push_back(JsonObject().text("exit", name_of_exit(k, balls.size())).count("balls", balls[k]).str());
  for (const std::string& file : files) paths.push_back(json_text(file));
  const Objective& o = looked.sample.evaluation.objective;
  all.text("design_id", looked.design.id).text("stage", looked.design.stage).raw("values", values.str());
  all.text("state", looked.row.state).text("reason", looked.row.reason);
  all.number("f_m", o.f_m).number("sigma_f_m", o.sigma_f_m);
  all.number("f_footprint_m", o.f_footprint_m).number("sigma_f_footprint_m", o.sigma_f_footprint_m);
  all.number("max_an_over_a0", o.max_an_over_a0).number("mean_height_m", o.mean_height_m);
  all.number("turns", looked.sample.turns).count("landed", o.landed).count("spilled", o.spilled);
  all.raw("exits", json_list(exits)).raw("files", json_list(paths));
  fmt::print("{}\n", all.str());
}

void print_text(const Looked& looked, const std::vector<std::string>& files) {
  fmt::print("design     {} of stage {}: ", looked.design.id, looked.design.stage);
  for (std::size_t c = 0; c < looked.columns.size(); ++c)
    fmt::print("{}{} = {}", c == 0 ? "" : ", ", looked.columns[c], looked.design.row[c]);
  fmt::print("\nstate      {}{}\n", looked.row.state, looked.row.reason.empty() ? "" : ": " + looked.row.reason);
  const Objective& o = looked.sample.evaluation.objective;
  fmt::print("f          {:.4g} +- {:.2g} m; under the outlet alone {:.4g} +- {:.2g} m\n", o.f_m, o.sigma_f_m,
             o.f_footprint_m, o.sigma_f_footprint_m);
  const bool met = o.max_an_over_a0 <= 0.1;
  fmt::print("modes      largest |a_n| / a_0 = {:.3g}: S1's stop test (0.1) is {}\n", o.max_an_over_a0,
             met ? "met" : "not met");
  fmt::print("bed        {} balls in {:g} turns, mean height {:.4g} m\n", o.landed, looked.sample.turns,
             o.mean_height_m);
  const std::vector<std::int64_t> balls = balls_by_exit(looked.sample);
  fmt::print("outflow   ");
  for (std::size_t k = 0; k < balls.size(); ++k)
    fmt::print("{} {} {:.1f} %", k == 0 ? "" : ",", name_of_exit(k, balls.size()),
               100.0 * static_cast<double>(balls[k]) /
                   static_cast<double>(std::max<std::size_t>(1, looked.sample.landings.size())));
  fmt::print("\n");
  for (const std::string& file : files) fmt::print("file       {}\n", file);
}

void sample(const SampleArguments& options) {
  if (options.id.empty() == options.at.empty())
    throw InputError("sample: needs --at with values or --id, and not both; `drumsweep sample --help` has examples");
  if (options.replicate && !options.id.empty())
    throw InputError("--replicate: goes with --at; an id has its replicate");
  const Looked looked = look(options);
  const std::string folder = std::filesystem::path(options.output).lexically_normal().string();
  make_folder(folder);
  const SampleFiles written = write_sample(looked.sample, folder);
  std::vector<std::string> files;
  for (const std::string& name : written.names) files.push_back((std::filesystem::path(folder) / name).string());
  // As with a table, and unlike with `contour`, what was asked for is there: the picture is one of its forms.
  if (!written.no_picture.empty())
    fmt::print(stderr, "drumsweep: no picture: {}\n{}/sample.gp draws it from the tables where gnuplot is\n",
               written.no_picture, folder);
  if (options.json)
    print_json(looked, files);
  else
    print_text(looked, files);
}

}  // namespace

void add_sample(CLI::App& app, int&) {
  auto options = std::make_shared<SampleArguments>();
  CLI::App* command = app.add_subcommand(
      "sample", "Landings, bed, mean profile and spectrum of one finished design, from its stored landings.");
  command->add_option("OUT", options->folder, "output folder of a run")->required();
  command
      ->add_option(
          "--at", options->at,
          "the design: its values in the order and units of the table's columns; replicate and turns may be left "
          "out. It must be one of the study's: the nearest is not taken instead, but named")
      ->delimiter(',');
  command->add_option("--id", options->id, "the design: its id as in results.csv, or an unambiguous beginning of it");
  command->add_option("--replicate", options->replicate,
                      "with --at: which of the design's runs [default: the study's record.replicate]");
  command->add_option("-o,--output", options->output, "folder for the files; made if need be")->required();
  command->add_flag("--json", options->json, "one JSON object on standard output");
  command->footer(
      "Examples:\n  drumsweep sample out --at 3,0.035 -o sample\n  drumsweep sample out --id 052d --json -o sample\n"
      "Writes into the folder (as in a column of S1's Fig. 9; nothing is simulated):\n"
      "  landings.csv  time [s], place along and across the belt [m], slot (0: over the outlet's end)\n"
      "  surface.csv   bed height [m] at places along and across the belt [m]\n"
      "  profile.csv   height averaged along the belt and its standard error [m], across the belt [m]\n"
      "  spectrum.csv  modes of the profile in the window of f: wavelength [m], |a_n| [m], |a_n| / a_0\n"
      "  sample.png, sample.svg  the four together; sample.gp draws sample.png from the tables\n"
      "The pictures need gnuplot; without it the rest is written, and said.");
  command->callback([options] { sample(*options); });
}

}  // namespace drumsweep

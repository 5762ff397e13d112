#include "cli/moment.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <utility>

#include "cli/arguments.h"
#include "core/config/schema.h"
#include "core/io/durable_file.h"
#include "core/parallel/parallel_for.h"
#include "postproc/result_table.h"
#include "sweep/stop.h"
#include "sweep/store/results.h"
#include "sweep/store/store.h"
#include "sweep/why.h"

namespace drumsweep {
namespace {

constexpr const char* what_is_shown =
    "accepted: warm_state.h5, a checkpoint designs/ID.part, a scene's TYPE.h5, or the output folder of a run";

/// Id of the design with the lowest f.
std::string best_design(const OutputPaths& paths) {
  std::error_code error;
  if (!std::filesystem::exists(paths.results(), error))
    throw InputError(paths.results() + ": is not there yet, so there is no best design; give --id or --at");
  const ResultTable table = read_results_csv(paths.results());
  const auto best = best_row(table.rows);
  if (!best) throw InputError(paths.results() + ": has no design with a result; give --id or --at");
  return table.rows[*best].design_id;
}

Moment of_folder(const MomentOptions& options) {
  if (!options.at.empty() && !options.id.empty()) throw InputError("--id and --at: one of the two, not both");
  const OutputPaths paths{options.path};
  const Study study = read_frozen_study(options.path);
  const std::string id = !options.at.empty() ? "" : !options.id.empty() ? options.id : best_design(paths);
  const DesignStory story = story_of(options.path, id, options.at);
  if (!story.design.impossible.empty())
    throw InputError(fmt::format("design {}: there is no such drum: {}", story.design.id, story.design.impossible));
  std::optional<WarmState> warm = read_warm_state(paths.warm_state(), study);
  if (!warm) throw InputError(paths.warm_state() + ": is not there yet; `drumsweep run` makes it");
  Moment moment;
  moment.design = story.design;
  const Study of_design = study_of_design(study, story.design.values);
  moment.drum = DrumMoment{of_design, of_design.outlet, std::move(warm->state)};
  moment.text = fmt::format("design {}", story.design.id);
  for (std::size_t i = 0; i < story.columns.size(); ++i)
    moment.text += fmt::format("{}{} = {:.6g}", i == 0 ? ": " : ", ", story.columns[i], story.design.row[i]);
  return moment;
}

Moment of_file(const MomentOptions& options) {
  if (!options.at.empty() || !options.id.empty())
    throw InputError(
        fmt::format("--{}: is for output folders; {} is a file", options.at.empty() ? "id" : "at", options.path));
  const std::string bytes = read_whole_file(options.path), kind = verify_seal(bytes, options.path).kind;
  Moment moment;
  if (kind == "scene") {
    moment.scene = unpack_scene(bytes, options.path);
    moment.text = fmt::format("scene {} ({})", moment.scene->name, moment.scene->type);
  } else if (kind == "warm_state" || kind == "design_progress") {
    moment.drum = unpack_drum_moment(bytes, options.path);
    moment.text = fmt::format("drum of {}", moment.drum->study.name);
  } else {
    throw InputError(
        fmt::format("{}: is a {}, which has no balls at one moment; {}", options.path, kind, what_is_shown));
  }
  return moment;
}

Discharge discharge_of(Moment& moment) {
  DrumMoment& drum = moment.drum.value();
  Discharge discharge(drum.study, drum.outlet, std::move(drum.state));
  discharge.threads = available_threads();
  return discharge;
}

bool run_lead(Discharge& discharge, double lead_s, Reporter& reporter) {
  const double end = discharge.time() + lead_s;
  return discharge.run_until(end, [&] {
    reporter.update({"simulating", discharge.time(), end, discharge.state().balls.size()});
    return !stop_requested();
  });
}

}  // namespace

void add_moment_options(CLI::App& command, MomentOptions& options) {
  command.add_option("STATE", options.path, "state file of a drum or a scene, or output folder of a run")->required();
  command
      .add_option("--at", options.at,
                  "folder: the design's values, in the order and the units of the table's columns [default: the best]")
      ->delimiter(',');
  command.add_option("--id", options.id, "folder: the design's id, or an unambiguous beginning of it");
  command
      .add_option("--lead", options.lead_s,
                  "simulated seconds before the (first) picture; balls then lie on the belt [default: folder: "
                  "record.adapt_turns; file: 0; several frames: what the belt needs for its bed]")
      ->check(number_between(0, 1e4));
  command.add_option("--seconds", options.seconds, "simulated seconds from the first frame on [default: one turn]")
      ->check(number_between(1e-3, 1e4));
}

Moment read_moment(const MomentOptions& options) {
  std::error_code error;
  if (!std::filesystem::exists(options.path, error))
    throw InputError(fmt::format("{}: is not there; {}", options.path, what_is_shown));
  return std::filesystem::is_directory(options.path, error) ? of_folder(options) : of_file(options);
}

double lead_of(const MomentOptions& options, const Moment& moment, bool with_bed) {
  if (options.lead_s) return *options.lead_s;
  if (!moment.drum) return 0;
  const Study& study = moment.drum->study;
  double lead = 0;
  if (moment.design)
    lead = study.record.adapt_turns * 2 * std::numbers::pi / std::abs(study.drum.angular_velocity_rad_s);
  const BeltPiece belt = belt_piece(study);
  if (with_bed && study.belt.speed_m_s > 0) lead = std::max(lead, (belt.end - belt.begin) / study.belt.speed_m_s);
  return lead;
}

std::optional<Still> still_after_lead(Moment moment, double lead_s, Reporter& reporter) {
  if (moment.scene) {
    if (lead_s > 0) throw InputError("--lead: only a drum can be simulated on; a scene is shown as it is stored");
    return still_of(std::move(*moment.scene));
  }
  Discharge discharge = discharge_of(moment);
  if (!run_lead(discharge, lead_s, reporter)) return std::nullopt;
  reporter.clear();
  return still_of(discharge);
}

double frame_interval(const MomentOptions& options, const Moment& moment) {
  if (!moment.drum) throw InputError(moment.text + ": only a drum can be simulated on; accepted are its states");
  const double turn = 2 * std::numbers::pi / std::abs(moment.drum->study.drum.angular_velocity_rad_s);
  return options.seconds.value_or(turn) / options.frames;
}

bool film(Moment moment, double lead_s, const MomentOptions& options, Reporter& reporter,
          const std::function<void(const Still&, double)>& show) {
  const double interval = frame_interval(options, moment);
  Discharge discharge = discharge_of(moment);
  if (!run_lead(discharge, lead_s, reporter)) return false;
  const double begin = discharge.time();
  for (int i = 0; i < options.frames; ++i) {
    if (!discharge.run_until(begin + interval * i, [] { return !stop_requested(); })) return false;
    try {
      show(still_of(discharge), interval * i);
    } catch (const std::exception&) {
      // Ctrl-C on a terminal ends the renderer, too.
      if (stop_requested()) return false;
      throw;
    }
    reporter.update(
        {"frames", begin + interval * (i + 1), begin + interval * options.frames, discharge.state().balls.size()});
    if (stop_requested()) return false;
  }
  reporter.clear();
  return true;
}

}  // namespace drumsweep

#include "sweep/single_design.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/config/schema.h"
#include "core/config/stages.h"
#include "core/io/durable_file.h"
#include "core/scene/cpu_clock.h"
#include "postproc/objective.h"
#include "postproc/result_table.h"
#include "sweep/farm/design_run.h"
#include "sweep/stop.h"
#include "sweep/store/output_lock.h"
#include "sweep/store/results.h"
#include "sweep/store/store.h"

namespace drumsweep {
namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();

/// Share of the landings that left by `exit`, and its error from the blocks.
Observable share(const std::string& name, std::uint8_t exit, const Study& study, const Recording& recording) {
  // Blocks are whole turns: within one, the slots take turns.
  const double duration = duration_of_turns(recording.turns, study.drum);
  const auto num_blocks = static_cast<std::int64_t>(recording.turns);
  std::vector<double> by_exit(static_cast<std::size_t>(num_blocks)), all(by_exit.size());
  for (const Landing& l : recording.landings) {
    const auto block =
        static_cast<std::int64_t>((l.time - recording.begin_s) / duration * static_cast<double>(num_blocks));
    const auto i = static_cast<std::size_t>(std::clamp<std::int64_t>(block, 0, num_blocks - 1));
    all[i] += 1;
    if (l.exit == exit) by_exit[i] += 1;
  }
  double sum = 0, total = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    sum += by_exit[i];
    total += all[i];
  }
  const double mean = total > 0 ? sum / total : none;

  // Ratio estimator: the blocks' residuals about the common share.
  double squares = 0;
  for (std::size_t i = 0; i < all.size(); ++i) squares += std::pow(by_exit[i] - mean * all[i], 2);
  const auto count = static_cast<double>(num_blocks);
  const double sigma = total > 0 && num_blocks > 1 ? std::sqrt(squares * count / (count - 1)) / total : none;
  return {name, none, mean, sigma, "1"};
}

/// The warm drum of this folder: stored, completed, or made from nothing; false when a signal stopped it.
bool make_warm_drum(const Study& study, const std::string& path, const Observer& observer, int threads,
                    Reporter& reporter, WarmState& warm) {
  try {
    if (auto stored = read_warm_state(path, study)) warm = std::move(*stored);
  } catch (const StoreError& error) {
    reporter.warn(set_aside(path, error.what()));
  }
  if (warm.finished) {
    reporter.info("warm drum: " + path);
    return true;
  }
  reporter.info("warm-up: no finished warm drum in the folder, making one");
  const auto save = [&](const WarmState& w) { write_durably(path, pack_warm_state(study, w)); };
  const bool ended = warm_up(study, warm, observer, save, threads);
  if (!ended || warm.windows.empty()) save(warm);
  if (!ended) return false;
  // Start from what is on disk, so that the next run from it gives the same bits.
  warm = read_warm_state(path, study).value();
  return true;
}

}  // namespace

std::vector<std::string> keys_of_values(const Study& study) {
  if (!study.stages.empty()) return plan_designs(study).keys;
  return {std::isnan(study.outlet.opening_angle_deg) ? "outlet.opening_angle_rad" : "outlet.opening_angle_deg",
          "outlet.base_width_m"};
}

PlannedDesign design_at(const Study& study, const std::vector<double>& values) {
  std::vector<std::string> keys = keys_of_values(study);
  // Replicate and turns may be left out: they are the study's then.
  if (values.size() < keys.size()) std::erase_if(keys, is_measuring_key);
  if (values.size() != keys.size())
    throw InputError(
        fmt::format("--at: {} values given, {} needed: {}", values.size(), keys.size(), fmt::join(keys, ", ")));
  PlannedDesign design;
  for (std::size_t i = 0; i < keys.size(); ++i) design.values.emplace_back(keys[i], rounded(values[i]));
  design.row = values;
  std::sort(design.values.begin(), design.values.end());
  design.id = design_id(design.values);
  try {
    study_of_design(study, design.values);
  } catch (const InputError& error) {
    throw InputError(std::string("--at: ") + error.what());
  }
  return design;
}

std::vector<Observable> observables(const Study& base, const PlannedDesign& design, const Recording& recording) {
  const Study study = study_of_design(base, design.values);
  const Evaluation e = evaluate_in_detail(recording.landings, recording.begin_s, recording.turns, study);
  std::vector<Observable> list;
  list.push_back({"f", none, e.objective.f_m, e.objective.sigma_f_m, "m"});
  list.push_back({"f_belt", none, e.objective.f_belt_m, e.objective.sigma_f_belt_m, "m"});
  list.push_back({"f_footprint", none, e.objective.f_footprint_m, e.objective.sigma_f_footprint_m, "m"});
  list.push_back({"max_an_over_a0", none, e.objective.max_an_over_a0, none, "1"});
  list.push_back({"mean_height", none, e.objective.mean_height_m, none, "m"});

  // Bed across the belt.
  const std::vector<double> sigma = standard_error(e.belt_blocks);
  for (std::size_t i = 0; i < e.belt.height_m.size(); ++i)
    list.push_back({"bed_height", e.belt.centre_m(i), e.belt.height_m[i], sigma[i], "m"});

  // Where the balls left the drum.
  for (std::int64_t slot = 1; slot <= study.outlet.num_slots; ++slot)
    list.push_back(
        share(fmt::format("outflow_share_slot_{}", slot), static_cast<std::uint8_t>(slot), study, recording));
  list.push_back(outflow_share_over_end(study, recording));

  list.push_back({"holdup", none, static_cast<double>(recording.inside), none, "balls"});
  list.push_back({"lost_balls", none, static_cast<double>(recording.lost), none, "balls"});
  return list;
}

Observable outflow_share_over_end(const Study& study, const Recording& recording) {
  return share("outflow_share_end", static_cast<std::uint8_t>(Exit::end), study, recording);
}

SingleDesign run_single_design(const Study& study, const std::vector<double>& values, const std::string& folder,
                               int threads, Reporter& reporter) {
  SingleDesign out;
  out.design = design_at(study, values);
  const OutputPaths paths{folder};
  make_folder(folder);
  const OutputLock lock(paths.lock());
  const double cpu_begin = cpu_seconds(CLOCK_PROCESS_CPUTIME_ID);
  const Observer observer = [&](const Progress& progress) {
    reporter.update(progress, {});
    return !stop_requested();
  };

  WarmState warm;
  out.stopped = !make_warm_drum(study, paths.warm_state(), observer, threads, reporter, warm);
  if (out.stopped) return out;
  out.steady = warm.steady;

  out.recording = run_design(study, warm.state, out.design.values, observer, threads);
  out.stopped = out.recording.stopped;
  if (out.stopped) return out;
  out.observables = observables(study, out.design, out.recording);
  const ResultRow row = evaluated_row(study, out.design, out.recording, warm.steady);
  out.state = row.state;
  out.reason = row.reason;
  if (out.state != "done") reporter.warn(out.state + ": " + out.reason);
  out.recording_path = folder + "/" + out.design.id + ".h5";
  out.observables_path = folder + "/" + out.design.id + "_observables.csv";
  write_durably(out.recording_path, pack_recording(study, out.design.id, out.design.values, out.recording));
  write_durably(out.observables_path, observables_csv(out.observables));
  out.cpu_s = cpu_seconds(CLOCK_PROCESS_CPUTIME_ID) - cpu_begin;
  return out;
}

}  // namespace drumsweep

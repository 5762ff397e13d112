#include "sweep/compare.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "core/config/schema.h"
#include "sweep/single_design.h"
#include "sweep/status.h"
#include "sweep/store/provenance.h"
#include "sweep/store/recordings.h"
#include "sweep/store/results.h"
#include "sweep/store/store.h"

namespace drumsweep {
namespace {

struct Folder {
  Study study;
  Plan plan;
};

/// Design variables of all studies, in order of appearance, each with its name in tables.
std::vector<std::pair<std::string, std::string>> all_variables(const std::vector<Folder>& folders) {
  std::vector<std::pair<std::string, std::string>> list;
  for (const Folder& f : folders)
    for (std::size_t c = 0; c < f.plan.keys.size(); ++c)
      if (const std::pair one(f.plan.keys[c], f.plan.columns[c]);
          std::find(list.begin(), list.end(), one) == list.end())
        list.push_back(one);
  return list;
}

/// Keys that change a number of the table; what a study is called and how it searches does not.
std::vector<std::string> differing_keys(const std::vector<Folder>& folders,
                                        const std::vector<std::pair<std::string, std::string>>& variables) {
  const auto is_variable = [&](const std::string& key) {
    return std::any_of(variables.begin(), variables.end(), [&](const auto& v) { return v.first == key; });
  };
  std::set<std::string> differ;
  for (const Folder& f : folders)
    for (const Difference& d : differences(folders.front().study, f.study))
      if (d.key != "name" && d.scope != Scope::search && (d.scope == Scope::warm_state || !is_variable(d.key)))
        differ.insert(d.key);
  std::vector<std::string> keys;
  Study copy = folders.front().study;
  for (const Field& field : fields(copy))
    if (differ.count(field.key) > 0) keys.push_back(field.key);
  return keys;
}

std::vector<std::string> values_of(const Study& study, const std::vector<std::string>& keys) {
  std::vector<std::string> values;
  Study copy = study;
  for (const Field& field : fields(copy))
    if (std::find(keys.begin(), keys.end(), field.key) != keys.end()) {
      const auto* text = std::get_if<std::string*>(&field.value);
      const auto* number = std::get_if<double*>(&field.value);
      const bool left_out = number != nullptr && std::isnan(**number);
      values.push_back(text != nullptr ? **text : left_out ? "" : to_toml(field));
    }
  return values;
}

/// CPU time of each design, all attempts together.
std::map<std::string, double> cpu_of_designs(const OutputPaths& paths) {
  std::map<std::string, double> cpu_s;
  for (const ProvenanceLine& line : read_provenance(paths.provenance())) cpu_s[line.design_id] += line.cpu_s;
  return cpu_s;
}

/// A design that has ended, or none. @throws StoreError, MismatchError
std::optional<ComparedDesign> ended_design(const OutputPaths& paths, const Study& study, const PlannedDesign& design,
                                           RecordingIndex& recordings, bool steady) {
  ComparedDesign out;
  if (recordings.has_recording(design.id)) {
    const Recording recording = recordings.read(study, design).recording.value();
    out.row = evaluated_row(study, design, recording, steady);
    const Observable over_end = outflow_share_over_end(study, recording);
    out.over_end = over_end.value;
    out.sigma_over_end = over_end.sigma;
    out.holdup = recording.inside;
  } else if (!design.impossible.empty() || recordings.has_failure(design.id)) {
    out.row = failed_row(design, design.impossible.empty() ? read_failure(paths, design.id) : design.impossible);
  } else {
    return std::nullopt;
  }
  return out;
}

}  // namespace

Comparison compare(const std::vector<std::string>& paths_of_folders) {
  std::vector<Folder> folders;
  for (const std::string& path : paths_of_folders) {
    Study study = read_frozen_study(path);
    Plan plan = plan_of_folder({path}, study);
    folders.push_back({std::move(study), std::move(plan)});
  }
  const auto variables = all_variables(folders);
  Comparison all;
  all.keys = differing_keys(folders, variables);
  for (const auto& [key, name] : variables) all.variable_names.push_back(name);

  for (std::size_t i = 0; i < folders.size(); ++i) {
    const auto& [study, plan] = folders[i];
    const OutputPaths paths{paths_of_folders[i]};
    ComparedFolder folder;
    folder.path = paths.folder;
    folder.values = values_of(study, all.keys);
    try {
      if (const auto warm = read_warm_state(paths.warm_state(), study);
          warm && warm->finished && !warm->windows.empty()) {
        folder.warm_balls = warm->windows.back().inside;
        folder.warm_turns = warm->windows.back().turns_end;
        folder.steady = warm->steady;
      } else {
        all.warnings.push_back(paths.folder + ": has no finished warm drum, so it is not known to be steady");
      }
    } catch (const std::runtime_error& unfit) {
      all.warnings.emplace_back(unfit.what());
    }
    const std::map<std::string, double> cpu_s = cpu_of_designs(paths);
    RecordingIndex recordings(paths);
    StudyProbe own(study);
    std::size_t missing = 0;
    for (const std::size_t k : table_order(plan)) {
      const PlannedDesign& design = plan.designs[k];
      try {
        std::optional<ComparedDesign> one = ended_design(paths, study, design, recordings, folder.steady);
        if (!one) {
          ++missing;
          continue;
        }
        if (const auto found = cpu_s.find(design.id); found != cpu_s.end()) one->cpu_s = found->second;
        own.reset();
        for (const auto& [key, value] : design.values) own.set(key, value);
        for (const auto& [key, name] : variables) one->variables.push_back(own.get(key));
        folder.designs.push_back(std::move(*one));
      } catch (const std::runtime_error& damaged) {
        all.warnings.emplace_back(damaged.what());
      }
    }
    if (missing > 0)
      all.warnings.push_back(
          fmt::format("{}: {} of {} designs are not there (yet)", paths.folder, missing, plan.designs.size()));
    all.folders.push_back(std::move(folder));
  }
  return all;
}

std::string to_csv(const Comparison& all) {
  std::vector<std::string> head = {"folder"};
  head.insert(head.end(), all.keys.begin(), all.keys.end());
  head.insert(head.end(), {"warm_balls", "warm_turns", "steady", "stage"});
  head.insert(head.end(), all.variable_names.begin(), all.variable_names.end());
  head.insert(head.end(), {"state", "f_m", "sigma_f_m", "f_footprint_m", "sigma_f_footprint_m", "max_an_over_a0",
                           "mean_height_m", "over_end", "sigma_over_end", "holdup_balls", "landed", "residual",
                           "overlap_95", "force_balance_m_s", "iterations", "cpu_s", "state_hash", "reason"});
  std::string csv;
  const auto add = [&](std::vector<std::string> cells) {
    cells.resize(head.size());
    for (std::string& cell : cells) cell = csv_text(cell);
    csv += fmt::format("{}\n", fmt::join(cells, ","));
  };
  add(head);
  for (const ComparedFolder& f : all.folders) {
    std::vector<std::string> begin = {f.path};
    begin.insert(begin.end(), f.values.begin(), f.values.end());
    begin.push_back(f.warm_balls ? std::to_string(*f.warm_balls) : "");
    begin.push_back(csv_number(f.warm_turns));
    begin.push_back(f.warm_balls ? (f.steady ? "true" : "false") : "");
    if (f.designs.empty()) add(begin);
    for (const ComparedDesign& d : f.designs) {
      const ResultRow& r = d.row;
      std::vector<std::string> cells = begin;
      cells.push_back(r.stage);
      for (const double value : d.variables) cells.push_back(csv_number(value));
      cells.push_back(r.state);
      for (const double value : {r.f_m, r.sigma_f_m, r.f_footprint_m, r.sigma_f_footprint_m, r.max_an_over_a0,
                                 r.mean_height_m, d.over_end, d.sigma_over_end})
        cells.push_back(csv_number(value));
      cells.push_back(d.holdup ? std::to_string(*d.holdup) : "");
      cells.push_back(d.holdup ? std::to_string(r.landed) : "");
      for (const double value : {r.residual, r.overlap_95, r.force_balance_m_s, r.iterations, d.cpu_s})
        cells.push_back(csv_number(value));
      cells.push_back(r.state_hash);
      cells.push_back(r.reason);
      add(cells);
    }
  }
  return csv;
}

}  // namespace drumsweep

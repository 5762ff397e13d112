#include "sweep/compare.h"

#include <fmt/format.h>

#include <algorithm>
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

/// Keys that change a number of the table; what a study is called and how it searches does not, and variables have
/// columns of their own.
std::vector<std::string> differing_keys(const std::vector<Folder>& folders,
                                        const std::vector<std::pair<std::string, std::string>>& variables) {
  std::set<std::string> differ;
  for (const Folder& f : folders)
    for (const Difference& d : differences(folders.front().study, f.study))
      if (d.key != "name" && d.scope != Scope::search) differ.insert(d.key);
  for (const auto& [key, name] : variables) differ.erase(key);
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
      values.push_back(text != nullptr ? **text : to_toml(field));
    }
  return values;
}

/// CPU time of each design, all attempts together.
std::map<std::string, double> cpu_of_designs(const OutputPaths& paths) {
  std::map<std::string, double> cpu_s;
  for (const ProvenanceLine& line : read_provenance(paths.provenance())) cpu_s[line.design_id] += line.cpu_s;
  return cpu_s;
}

ComparedDesign compared(const Study& study, const PlannedDesign& design, const Recording& recording, bool steady) {
  ComparedDesign out;
  out.row = evaluated_row(study, design, recording, steady);
  for (const Observable& o : observables(study, design, recording))
    if (o.name == "outflow_share_end") {
      out.over_end = o.value;
      out.sigma_over_end = o.sigma;
    }
  out.holdup = recording.inside;
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
    ComparedFolder folder{paths.folder, values_of(study, all.keys), {}, ResultRow::none, false};
    if (const auto warm = read_warm_state(paths.warm_state(), study);
        warm && warm->finished && !warm->windows.empty()) {
      folder.warm_balls = warm->windows.back().inside;
      folder.warm_turns = warm->windows.back().turns_end;
      folder.steady = warm->steady;
    }
    const std::map<std::string, double> cpu_s = cpu_of_designs(paths);
    RecordingIndex recordings(paths);
    std::size_t missing = 0;
    for (const std::size_t k : table_order(plan)) {
      const PlannedDesign& design = plan.designs[k];
      if (!recordings.has_recording(design.id)) {
        ++missing;
        continue;
      }
      try {
        ComparedDesign one = compared(study, design, recordings.read(study, design).recording.value(), folder.steady);
        one.folder = i;
        if (const auto found = cpu_s.find(design.id); found != cpu_s.end()) one.cpu_s = found->second;
        const Study own = study_of_design(study, design.values);
        for (const auto& [key, name] : variables) one.variables.push_back(get_number(own, key));
        all.designs.push_back(std::move(one));
      } catch (const StoreError& damaged) {
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
  std::string csv = "folder";
  for (const std::string& key : all.keys) csv += "," + csv_text(key);
  csv += ",warm_balls,warm_turns,steady,stage";
  for (const std::string& name : all.variable_names) csv += "," + csv_text(name);
  csv +=
      ",state,f_m,sigma_f_m,f_footprint_m,sigma_f_footprint_m,max_an_over_a0,mean_height_m,over_end,sigma_over_end,"
      "holdup_balls,landed,residual,overlap_95,force_balance_m_s,iterations,cpu_s,state_hash,reason\n";
  const auto begin_of_line = [&](const ComparedFolder& f) {
    std::string line = csv_text(f.path);
    for (const std::string& value : f.values) line += "," + csv_text(value);
    return line + fmt::format(",{},{},{}", f.warm_balls ? std::to_string(*f.warm_balls) : "", csv_number(f.warm_turns),
                              f.warm_balls ? (f.steady ? "true" : "false") : "");
  };
  std::vector<bool> has_design(all.folders.size(), false);
  for (const ComparedDesign& d : all.designs) {
    has_design[d.folder] = true;
    const ResultRow& r = d.row;
    csv += begin_of_line(all.folders[d.folder]) + "," + csv_text(r.stage);
    for (const double value : d.variables) csv += "," + csv_number(value);
    csv += "," + r.state;
    for (const double value : {r.f_m, r.sigma_f_m, r.f_footprint_m, r.sigma_f_footprint_m, r.max_an_over_a0,
                               r.mean_height_m, d.over_end, d.sigma_over_end})
      csv += "," + csv_number(value);
    csv += fmt::format(",{},{}", d.holdup, r.landed);
    for (const double value : {r.residual, r.overlap_95, r.force_balance_m_s, r.iterations, d.cpu_s})
      csv += "," + csv_number(value);
    csv += fmt::format(",{},{}\n", r.state_hash, csv_text(r.reason));
  }
  for (std::size_t i = 0; i < all.folders.size(); ++i)
    if (!has_design[i]) csv += begin_of_line(all.folders[i]) + std::string(all.variable_names.size() + 19, ',') + "\n";
  return csv;
}

}  // namespace drumsweep

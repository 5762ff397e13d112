#include "sweep/rescore.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/config/schema.h"
#include "core/config/toml_reader.h"
#include "sweep/status.h"
#include "sweep/store/recordings.h"
#include "sweep/store/results.h"
#include "sweep/store/store.h"

namespace drumsweep {
namespace {

/// The study with a set of changes, which must leave its landings what they are.
Study study_with(const Study& study, const KeyChanges& changes) {
  Study changed = study;
  for (const std::string& change : changes) {
    const Study before = changed;
    changed = changed_study(changed, {change}, "--set " + change);
    for (const Difference& d : differences(before, changed))
      if (d.scope != Scope::evaluation)
        throw InputError(fmt::format(
            "--set {}: {} was {} when the designs were simulated; stored landings can only be evaluated with "
            "other [objective] keys, belt.speed_m_s and solver.residual_limit_m_s",
            change, d.key, d.stored));
  }
  return changed;
}

/// Mean ranks, from 1.
std::vector<double> ranks_of(const std::vector<double>& values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });
  std::vector<double> ranks(values.size());
  for (std::size_t i = 0; i < order.size();) {
    std::size_t end = i;
    while (end < order.size() && values[order[end]] == values[order[i]]) ++end;
    for (std::size_t k = i; k < end; ++k) ranks[order[k]] = 0.5 * static_cast<double>(i + end + 1);
    i = end;
  }
  return ranks;
}

bool both_done(const ResultRow& a, const ResultRow& b) { return a.state == "done" && b.state == "done"; }

/// The best of `by`, evaluated in both ways. Tables of the same designs in the same order keep it when replicates
/// become means.
std::optional<RescoredOptimum> optimum_of(const ResultTable& by, const ResultTable& before, const ResultTable& after) {
  const auto best = best_row(by.rows);
  if (!best) return std::nullopt;
  return RescoredOptimum{before.rows.at(*best), after.rows.at(*best)};
}

void summarise(const Rescored& all, Rescoring& one) {
  std::vector<double> old_f, new_f;
  for (std::size_t i = 0; i < one.rows.size(); ++i)
    if (both_done(all.before[i], one.rows[i])) {
      old_f.push_back(all.before[i].f_m);
      new_f.push_back(one.rows[i].f_m);
    }
  one.compared = old_f.size();
  one.rank_correlation = rank_correlation(old_f, new_f);
  const ResultTable before = with_means_of_replicates({all.variable_names, all.before});
  const ResultTable after = with_means_of_replicates({all.variable_names, one.rows});
  one.old_optimum = optimum_of(before, before, after);
  one.new_optimum = optimum_of(after, before, after);
}

double over_height(const ResultRow& row) { return row.f_m / row.mean_height_m; }

/// Place in ascending order of f among the designs that are done, from 1; NaN for the others.
std::vector<double> places_of(const std::vector<ResultRow>& rows) {
  std::vector<double> f, places(rows.size(), ResultRow::none);
  for (const ResultRow& row : rows)
    if (row.state == "done") f.push_back(row.f_m);
  const std::vector<double> ranks = ranks_of(f);
  for (std::size_t i = 0, k = 0; i < rows.size(); ++i)
    if (rows[i].state == "done") places[i] = ranks[k++];
  return places;
}

std::string values_csv(const std::vector<double>& values) {
  std::string text;
  for (const double value : values) text += "," + csv_number(value);
  return text;
}

}  // namespace

double change_of_f_percent(const RescoredOptimum& o) { return 100 * (o.after.f_m / o.before.f_m - 1); }

double change_of_f_over_height_percent(const RescoredOptimum& o) {
  return 100 * (over_height(o.after) / over_height(o.before) - 1);
}

double rank_correlation(const std::vector<double>& a, const std::vector<double>& b) {
  if (a.size() < 2 || a.size() != b.size()) return std::numeric_limits<double>::quiet_NaN();
  const std::vector<double> ra = ranks_of(a), rb = ranks_of(b);
  const double mean = 0.5 * static_cast<double>(a.size() + 1);
  double aa = 0, bb = 0, ab = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    aa += (ra[i] - mean) * (ra[i] - mean);
    bb += (rb[i] - mean) * (rb[i] - mean);
    ab += (ra[i] - mean) * (rb[i] - mean);
  }
  return aa > 0 && bb > 0 ? ab / std::sqrt(aa * bb) : std::numeric_limits<double>::quiet_NaN();
}

Rescored rescore(const std::string& folder, const std::vector<KeyChanges>& sets) {
  const OutputPaths paths{folder};
  const Study study = read_frozen_study(folder);
  const Plan plan = plan_of_folder(paths, study);
  std::vector<Study> studies;
  Rescored all;
  all.variable_names = plan.columns;
  for (const KeyChanges& set : sets) {
    studies.push_back(study_with(study, set));
    all.cases.emplace_back();
    all.cases.back().changes = fmt::format("{}", fmt::join(set, " "));
  }

  // Each recording is read once, and evaluated in all ways before the next.
  const bool steady = read_warm_state(paths.warm_state(), study).value_or(WarmState{}).steady;
  RecordingIndex recordings(paths);
  for (const std::size_t i : table_order(plan)) {
    const PlannedDesign& design = plan.designs[i];
    if (!recordings.has_recording(design.id)) {
      ++all.without_landings;
      continue;
    }
    try {
      const StoredDesign stored = recordings.read(study, design);
      all.before.push_back(evaluated_row(study, design, stored.recording.value(), steady));
      for (std::size_t k = 0; k < studies.size(); ++k)
        all.cases[k].rows.push_back(evaluated_row(studies[k], design, *stored.recording, steady));
    } catch (const StoreError& damaged) {
      all.warnings.emplace_back(damaged.what());
      ++all.without_landings;
    }
  }
  for (Rescoring& one : all.cases) summarise(all, one);
  return all;
}

std::string to_csv(const Rescored& all) {
  std::string csv = "changes,design_id,stage";
  for (const std::string& name : all.variable_names) csv += "," + csv_text(name);
  csv +=
      ",old_state,new_state,old_f_m,new_f_m,difference_m,old_sigma_f_m,new_sigma_f_m,old_f_over_mean_height,"
      "new_f_over_mean_height,old_max_an_over_a0,new_max_an_over_a0,old_place,new_place\n";
  const std::vector<double> old_places = places_of(all.before);
  for (const Rescoring& one : all.cases) {
    const std::vector<double> new_places = places_of(one.rows);
    for (std::size_t i = 0; i < one.rows.size(); ++i) {
      const ResultRow &before = all.before[i], &after = one.rows[i];
      csv += fmt::format("{},{},{}{},{},{}{}\n", csv_text(one.changes), before.design_id, csv_text(before.stage),
                         values_csv(before.variables), before.state, after.state,
                         values_csv({before.f_m, after.f_m, after.f_m - before.f_m, before.sigma_f_m, after.sigma_f_m,
                                     over_height(before), over_height(after), before.max_an_over_a0,
                                     after.max_an_over_a0, old_places[i], new_places[i]}));
    }
  }
  return csv;
}

std::string summary_csv(const Rescored& all) {
  std::string csv = "changes,compared,rank_correlation";
  for (const char* which : {"old_optimum", "new_optimum"}) {
    csv += fmt::format(",{}", which);
    // Without the columns that replicates differ in: an optimum is a mean over these.
    for (const std::string& name : with_means_of_replicates({all.variable_names, {}}).variable_names)
      csv += fmt::format(",{}_{}", which, name);
    for (const char* what : {"old_f_m", "new_f_m", "change_percent", "old_f_over_mean_height", "new_f_over_mean_height",
                             "change_over_mean_height_percent"})
      csv += fmt::format(",{}_{}", which, what);
  }
  csv += "\n";
  const std::size_t num_variables = with_means_of_replicates({all.variable_names, {}}).variable_names.size();
  for (const Rescoring& one : all.cases) {
    csv += fmt::format("{},{},{}", csv_text(one.changes), one.compared, csv_number(one.rank_correlation));
    for (const auto& o : {one.old_optimum, one.new_optimum}) {
      if (o)
        csv += fmt::format(",{}{}{}", o->before.design_id, values_csv(o->before.variables),
                           values_csv({o->before.f_m, o->after.f_m, change_of_f_percent(*o), over_height(o->before),
                                       over_height(o->after), change_of_f_over_height_percent(*o)}));
      else
        csv += std::string(num_variables + 7, ',');
    }
    csv += "\n";
  }
  return csv;
}

}  // namespace drumsweep

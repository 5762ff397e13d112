#include "sweep/report/report_data.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <map>

#include "core/config/schema.h"
#include "sweep/store/provenance.h"
#include "sweep/store/recordings.h"
#include "sweep/store/results.h"

namespace drumsweep {
namespace {

std::string column_of(const Plan& plan, const std::string& key) {
  for (std::size_t i = 0; i < plan.keys.size(); ++i)
    if (plan.keys[i] == key) return plan.columns[i];
  return key;
}

Answer answer_of(const ReportData& data) {
  Answer a;
  const auto& found = data.findings;
  const bool fitted = found && found->optimum && found->gate.fit_is_usable();
  const auto place = [&](const Point& at) {
    for (std::size_t i = 0; i < at.size(); ++i) a.at.emplace_back(column_of(data.plan, found->box[i].key), at[i]);
    if (!fitted) return;
    for (std::size_t i = 0; i < at.size(); ++i)
      a.region_95.emplace_back(found->optimum->low[i], found->optimum->high[i]);
  };
  if (found && found->confirmation) {
    const Confirmation& c = *found->confirmation;
    a.kind = Answer::Kind::confirmed;
    place(c.at);
    a.f_m = c.f_m;
    a.sigma_m = c.sigma_m;
    a.num_runs = c.num_runs;
    a.max_an_over_a0 = c.max_an_over_a0;
  } else if (fitted) {
    a.kind = Answer::Kind::fit;
    place(found->optimum->at);
    a.f_m = found->optimum->f_m;
    a.sigma_m = found->optimum->sigma_m;
    a.num_runs = found->gate.figures.num_rows;
  } else if (const auto& best = data.status.best) {
    a.kind = Answer::Kind::single_run;
    for (std::size_t i = 0; i < best->variables.size(); ++i)
      a.at.emplace_back(data.table.variable_names[i], best->variables[i]);
    a.f_m = best->f_m;
    a.sigma_m = best->sigma_f_m;
    a.num_runs = 1;
    a.max_an_over_a0 = best->max_an_over_a0;
    a.untrusted = best->state == "untrusted";
  }
  return a;
}

/// The simulated design nearest to the answer, distances over the range of each variable among the rows.
const ResultRow* row_near(const ReportData& data, const Answer& answer) {
  const ResultRow* nearest = nullptr;
  double least = 0;
  for (const ResultRow& row : data.table.rows) {
    if (row.state != "done" && !(answer.untrusted && row.has_value())) continue;
    double distance = 0;
    for (const auto& [name, value] : answer.at) {
      const auto column = std::find(data.table.variable_names.begin(), data.table.variable_names.end(), name);
      if (column == data.table.variable_names.end()) continue;
      const auto i = static_cast<std::size_t>(column - data.table.variable_names.begin());
      double low = row.variables[i], high = low;
      for (const ResultRow& other : data.table.rows) {
        low = std::min(low, other.variables[i]);
        high = std::max(high, other.variables[i]);
      }
      if (high > low) distance += std::pow((row.variables[i] - value) / (high - low), 2);
    }
    // Of equally near ones (replicates) the first in the table.
    if (nearest == nullptr || distance < least) {
      nearest = &row;
      least = distance;
    }
  }
  return nearest;
}

std::optional<DetailedDesign> detail_of(ReportData& data, RecordingIndex& recordings, const ResultRow& row) {
  const auto found = data.plan.index_of_id.find(row.design_id);
  if (found == data.plan.index_of_id.end()) return std::nullopt;
  const PlannedDesign& design = data.plan.designs[found->second];
  try {
    StoredDesign stored = recordings.read(data.study, design);
    if (!stored.recording) throw std::runtime_error("its recording is not there");
    DetailedDesign detail{row, study_of_design(data.study, design.values), std::move(*stored.recording), {}};
    detail.evaluation =
        evaluate_in_detail(detail.recording.landings, detail.recording.begin_s, detail.recording.turns, detail.study);
    return detail;
  } catch (const std::exception& error) {
    data.unreadable.emplace_back(row.design_id, error.what());
    data.notes.push_back(fmt::format("design {} cannot be shown: {}", row.design_id, error.what()));
    return std::nullopt;
  }
}

/// S1, Table 1. Its optimum is stated to 0.01 deg and 3 mm, so a design that near stands for the point.
struct SamplePoint {
  const char* name;
  double opening_angle, base_width_m;
};
constexpr SamplePoint sample_points[] = {{"I, S1's optimum", 0.20, 0.048},
                                         {"II, on S1's tolerance line", 0.17, 0.051},
                                         {"III, too narrow gaps", 0.0, 0.01},
                                         {"IV, too large gaps", 0.6, 0.2}};

void find_samples(ReportData& data, RecordingIndex& recordings) {
  if (data.study.drum.diameter_m != 0.75 || data.study.drum.length_m != 2.5) return;
  const auto& names = data.table.variable_names;
  const auto column = [&](std::initializer_list<const char*> wanted) {
    for (std::size_t i = 0; i < names.size(); ++i)
      for (const char* name : wanted)
        if (names[i] == name) return std::optional(i);
    return std::optional<std::size_t>();
  };
  const auto angle = column({"opening_angle_deg", "opening_angle_rad"}), width = column({"base_width_m"});
  if (!angle || !width) return;
  for (const SamplePoint& point : sample_points) {
    const ResultRow* nearest = nullptr;
    double least = 1;
    for (const ResultRow& row : data.table.rows) {
      if (!row.has_value()) continue;
      const double distance = std::hypot((row.variables[*angle] - point.opening_angle) / 0.0101,
                                         (row.variables[*width] - point.base_width_m) / 0.00301);
      if (distance < least) {
        least = distance;
        nearest = &row;
      }
    }
    const auto is_nearest = [&](const auto& u) { return u.first == nearest->design_id; };
    if (nearest == nullptr || std::any_of(data.unreadable.begin(), data.unreadable.end(), is_nearest)) continue;
    if (auto detail = detail_of(data, recordings, *nearest)) data.samples.emplace_back(point.name, std::move(*detail));
  }
}

}  // namespace

ReportData gather_report(const std::string& folder) {
  ReportData data;
  data.folder = folder;
  data.paths = OutputPaths{folder};
  data.study = read_frozen_study(folder);
  data.plan = plan_of_folder(data.paths, data.study);
  data.status = read_status(folder);
  data.provenance = read_provenance(data.paths.provenance());
  try {
    data.warm = read_warm_state(data.paths.warm_state(), data.study);
    if (!data.warm) data.warm_trouble = "The warm-up has not begun.";
  } catch (const std::exception& error) {
    data.warm_trouble = fmt::format("The warm drum cannot be read: {}", error.what());
  }

  // What has ended, in the order of the table.
  std::map<std::string, const ResultRow*> by_id;
  for (const ResultRow& row : data.status.rows) by_id.emplace(row.design_id, &row);
  data.table.variable_names = data.plan.columns;
  for (const std::size_t i : table_order(data.plan))
    if (const auto row = by_id.find(data.plan.designs[i].id); row != by_id.end())
      data.table.rows.push_back(*row->second);
  std::map<std::string, std::size_t> order;
  for (const ProvenanceLine& line : data.provenance)
    if (line.event == "started") order.emplace(line.design_id, order.size() + 1);
  for (const ResultRow& row : data.table.rows) {
    const auto at = order.find(row.design_id);
    data.run_number.push_back(at == order.end() ? 0 : at->second);
  }

  data.findings = find(data.study, data.plan, [&](const PlannedDesign& design) {
    const auto row = by_id.find(design.id);
    return row == by_id.end() ? nullptr : row->second;
  });
  data.answer = answer_of(data);
  RecordingIndex recordings(data.paths);
  if (data.answer.kind != Answer::Kind::none)
    if (const ResultRow* row = row_near(data, data.answer)) data.best = detail_of(data, recordings, *row);
  find_samples(data, recordings);
  return data;
}

}  // namespace drumsweep

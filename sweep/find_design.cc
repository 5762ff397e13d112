#include "sweep/find_design.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/config/schema.h"

namespace drumsweep {
namespace {

bool same(double of_design, double asked) {
  return of_design == rounded(asked) || (std::isnan(of_design) && std::isnan(asked));
}

/// Up to `most` designs nearest to the values at these columns, each variable in units of its range in the plan.
std::vector<const PlannedDesign*> nearest(const Plan& plan, const std::vector<std::size_t>& columns,
                                          const std::vector<double>& at, std::size_t most) {
  std::vector<double> range;
  for (const std::size_t c : columns) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const PlannedDesign& design : plan.designs) {
      low = std::fmin(low, design.row[c]);
      high = std::fmax(high, design.row[c]);
    }
    range.push_back(high > low ? high - low : 1.0);
  }
  std::vector<std::pair<double, const PlannedDesign*>> order;
  for (const PlannedDesign& design : plan.designs) {
    double sum = 0;
    for (std::size_t k = 0; k < columns.size(); ++k) {
      const double away = (design.row[columns[k]] - at[k]) / range[k];
      // The angle in the other unit says nothing about distance.
      sum += std::isnan(away) ? 1.0 : away * away;
    }
    order.emplace_back(sum, &design);
  }
  std::stable_sort(order.begin(), order.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<const PlannedDesign*> found;
  for (std::size_t k = 0; k < std::min(most, order.size()); ++k) found.push_back(order[k].second);
  return found;
}

std::string list_of(const Plan& plan, const std::vector<const PlannedDesign*>& designs) {
  std::string text;
  for (const PlannedDesign* design : designs) text += fmt::format("\n  {}  {}", design->id, describe(plan, *design));
  return text;
}

/// Of designs that differ in keys of [record] only, the one that the study itself would make.
std::vector<const PlannedDesign*> with_own_record(const Plan& plan, const Study& study,
                                                  const std::vector<const PlannedDesign*>& designs) {
  std::vector<const PlannedDesign*> own;
  for (const PlannedDesign* design : designs) {
    bool all = true;
    for (std::size_t c = 0; c < plan.keys.size(); ++c)
      if (plan.keys[c] == replicate_key || plan.keys[c] == turns_key)
        all = all && design->row[c] == get_number(study, plan.keys[c]);
    if (all) own.push_back(design);
  }
  return own;
}

}  // namespace

const PlannedDesign& design_with_id(const Plan& plan, const std::string& which) {
  std::vector<const PlannedDesign*> found;
  for (const PlannedDesign& design : plan.designs)
    if (design.id.starts_with(which)) found.push_back(&design);
  if (found.empty())
    throw InputError(
        fmt::format("{}: no design of the study has an id that begins so; results.csv lists the ids", which));
  if (found.size() == 1) return *found.front();
  std::string list;
  for (std::size_t i = 0; i < std::min<std::size_t>(5, found.size()); ++i) list += " " + found[i]->id;
  throw InputError(
      fmt::format("{}: is the beginning of {} ids:{}{}", which, found.size(), list, found.size() > 5 ? " ..." : ""));
}

const PlannedDesign& design_with_values(const Plan& plan, const Study& study, const std::vector<double>& at,
                                        std::optional<double> replicate) {
  std::vector<std::size_t> all, variables;
  std::vector<std::string> names;
  for (std::size_t c = 0; c < plan.columns.size(); ++c) {
    all.push_back(c);
    if (plan.keys[c] == replicate_key || plan.keys[c] == turns_key) continue;
    variables.push_back(c);
    names.push_back(plan.columns[c]);
  }
  if (at.size() != all.size() && at.size() != variables.size())
    throw InputError(
        fmt::format("--at: {} values given, {} needed: {}{}", at.size(), names.size(), fmt::join(names, ", "),
                    names.size() == all.size() ? "" : fmt::format("; or all of {}", fmt::join(plan.columns, ", "))));
  const std::vector<std::size_t>& columns = at.size() == all.size() ? all : variables;

  std::vector<const PlannedDesign*> found;
  for (const PlannedDesign& design : plan.designs) {
    bool fits = true;
    for (std::size_t k = 0; k < columns.size(); ++k) fits = fits && same(design.row[columns[k]], at[k]);
    if (fits) found.push_back(&design);
  }
  if (found.empty()) {
    const auto near = nearest(plan, columns, at, 3);
    throw InputError(fmt::format("--at {}: the study has no such design{}", fmt::join(at, ","),
                                 near.empty() ? "" : "; the nearest are" + list_of(plan, near)));
  }
  if (replicate) {
    const auto known = found;
    const auto column = std::find(plan.keys.begin(), plan.keys.end(), replicate_key);
    std::erase_if(found, [&](const PlannedDesign* design) {
      const double own = column == plan.keys.end() ? study.record.replicate
                                                   : design->row[static_cast<std::size_t>(column - plan.keys.begin())];
      return own != *replicate;
    });
    if (found.empty())
      throw InputError(
          fmt::format("--replicate {}: not one of this design's runs; there are{}", *replicate, list_of(plan, known)));
  }
  if (found.size() > 1)
    if (const auto own = with_own_record(plan, study, found); own.size() == 1) return *own.front();
  if (found.size() > 1)
    throw InputError(fmt::format("--at {}: {} runs of this design, choose one by its id or --replicate:{}",
                                 fmt::join(at, ","), found.size(), list_of(plan, found)));
  return *found.front();
}

}  // namespace drumsweep

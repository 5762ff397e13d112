#include "sweep/plan/designs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>

#include "core/config/schema.h"
#include "core/config/stages.h"

namespace drumsweep {
namespace {

std::string last_part(const std::string& key) {
  const std::size_t dot = key.rfind('.');
  return dot == std::string::npos ? key : key.substr(dot + 1);
}

std::string canonical_text(const Design& values) {
  std::string text;
  for (const auto& [key, value] : values) text += fmt::format("{}={};", key, value);
  return text;
}

/// i-th of `count` evenly spaced values; the ends are met exactly.
double grid_value(const StageVariable& v, std::int64_t i) {
  if (v.count == 1 || i == 0) return rounded(v.from);
  if (i == v.count - 1) return rounded(v.to);
  return rounded(v.from + (v.to - v.from) * static_cast<double>(i) / static_cast<double>(v.count - 1));
}

/// Order of the table: numbers ascending, an absent one (angle given in the other unit) first.
bool row_before(const std::vector<double>& a, const std::vector<double>& b) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    const bool no_a = std::isnan(a[i]), no_b = std::isnan(b[i]);
    if (no_a != no_b) return no_a;
    if (!no_a && a[i] != b[i]) return a[i] < b[i];
  }
  return false;
}

/// Values of all columns, and whether such a drum exists.
void complete(StudyProbe& probe, const std::vector<std::string>& keys, PlannedDesign& design) {
  try {
    for (const auto& [key, value] : design.values) probe.set(key, value);
    probe.validate();
  } catch (const InputError& error) {
    design.impossible = error.what();
  }
  for (const std::string& key : keys) {
    const auto own = std::find_if(design.values.begin(), design.values.end(),
                                  [&](const auto& key_value) { return key_value.first == key; });
    design.row.push_back(own != design.values.end() ? own->second : probe.get(key));
  }
  probe.reset();
}

std::pair<std::size_t, bool> add(Plan& plan, StudyProbe& probe, std::size_t stage, Design values) {
  std::sort(values.begin(), values.end());
  StageSummary& summary = plan.stages.at(stage);
  ++summary.nodes;
  const std::string id = design_id(values);
  const auto [known, is_new] = plan.index_of_id.try_emplace(id, plan.designs.size());
  const std::size_t index = known->second;
  if (!is_new) {
    const Design& other = plan.designs[index].values;
    if (other != values)
      throw InputError(fmt::format("stage \"{}\": designs {} and {} have the same id {}; shift a value by 1e-9",
                                   summary.name, canonical_text(other), canonical_text(values), id));
    ++summary.shared;
    summary.designs.push_back(index);
    return {index, false};
  }
  PlannedDesign design{id, summary.name, std::move(values), {}, {}, stage};
  complete(probe, plan.keys, design);
  if (!design.impossible.empty()) ++summary.impossible;
  plan.designs.push_back(std::move(design));
  summary.designs.push_back(index);
  return {index, true};
}

}  // namespace

std::vector<Design> nodes_of_stage(const StageConfig& stage) {
  std::vector<Design> nodes;
  if (stage.type == "points") {
    for (std::size_t i = 0; i < stage.variables.front().values.size(); ++i) {
      Design node;
      for (const StageVariable& v : stage.variables) node.emplace_back(v.key, rounded(v.values[i]));
      nodes.push_back(std::move(node));
    }
    return nodes;
  }
  // Grid: one variable after the other, so the first is the slowest.
  nodes.emplace_back();
  for (const StageVariable& v : stage.variables) {
    std::vector<Design> longer;
    for (const Design& node : nodes)
      for (std::int64_t i = 0; i < v.count; ++i) {
        longer.push_back(node);
        longer.back().emplace_back(v.key, grid_value(v, i));
      }
    nodes = std::move(longer);
  }
  return nodes;
}

double rounded(double value) {
  // Dividing a whole number by 1e9 is correctly rounded; multiplying by 1e-9 would not be. Adding 0 turns -0 into 0.
  const double steps = std::round(value * design_steps_per_unit);
  return std::abs(steps) < 9e15 ? steps / design_steps_per_unit + 0.0 : value;
}

std::string design_id(const Design& values) {
  Design sorted = values;
  std::sort(sorted.begin(), sorted.end());
  // FNV-1a over the text, then a finalizer (SplitMix64) that spreads the last characters over all bits.
  std::uint64_t hash = 14695981039346656037ull;
  for (const char c : canonical_text(sorted)) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ull;
  hash = (hash ^ (hash >> 30)) * 0xbf58476d1ce4e5b9ull;
  hash = (hash ^ (hash >> 27)) * 0x94d049bb133111ebull;
  hash ^= hash >> 31;
  return fmt::format("{:010x}", hash >> 24);
}

std::pair<std::size_t, bool> add_design(Plan& plan, const Study& study, std::size_t stage, Design values) {
  StudyProbe probe(study);
  return add(plan, probe, stage, std::move(values));
}

Plan plan_designs(const Study& study) {
  Plan plan;
  const auto need_key = [&](const std::string& key) {
    if (std::find(plan.keys.begin(), plan.keys.end(), key) == plan.keys.end()) plan.keys.push_back(key);
  };
  for (std::size_t s = 0; s < study.stages.size(); ++s) {
    const StageConfig& stage = study.stages[s];
    for (const StageVariable& v : is_search(stage) ? search_ranges(study, s) : stage.variables) need_key(v.key);
  }
  for (const StageConfig& stage : study.stages) {
    if (stage.type == "adaptive" || stage.type == "replicate") need_key(replicate_key);
    if (stage.type == "replicate" && !std::isnan(stage.turns)) need_key(turns_key);
  }
  for (const std::string& key : plan.keys) {
    const auto same = [&](const std::string& other) { return last_part(other) == last_part(key); };
    const bool ambiguous = std::count_if(plan.keys.begin(), plan.keys.end(), same) > 1;
    plan.columns.push_back(ambiguous ? key : last_part(key));
  }

  for (const StageConfig& stage : study.stages)
    plan.stages.push_back({stage.name, stage.type, 0, 0, 0, !is_search(stage), {}, {}});
  StudyProbe probe(study);
  for (std::size_t s = 0; s < study.stages.size(); ++s) {
    if (is_search(study.stages[s])) continue;
    for (Design& node : nodes_of_stage(study.stages[s])) add(plan, probe, s, std::move(node));
  }
  return plan;
}

std::vector<std::size_t> table_order(const Plan& plan) {
  std::vector<std::size_t> order(plan.designs.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) {
    const PlannedDesign &a = plan.designs[i], &b = plan.designs[j];
    return a.stage_number != b.stage_number ? a.stage_number < b.stage_number : row_before(a.row, b.row);
  });
  return order;
}

std::string describe(const Plan& plan, const PlannedDesign& design) {
  std::string text;
  for (std::size_t i = 0; i < plan.columns.size(); ++i)
    if (!std::isnan(design.row[i]))
      text += fmt::format("{}{} = {}", text.empty() ? "" : ", ", plan.columns[i], design.row[i]);
  return text;
}

}  // namespace drumsweep

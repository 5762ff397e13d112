#include "sweep/plan/designs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>

#include "core/config/schema.h"

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

/// All nodes of a stage, values in the order of its variables.
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

}  // namespace

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

Plan plan_designs(const Study& study) {
  Plan plan;
  for (const StageConfig& stage : study.stages)
    for (const StageVariable& v : stage.variables)
      if (std::find(plan.keys.begin(), plan.keys.end(), v.key) == plan.keys.end()) plan.keys.push_back(v.key);
  for (const std::string& key : plan.keys) {
    const auto same = [&](const std::string& other) { return last_part(other) == last_part(key); };
    const bool ambiguous = std::count_if(plan.keys.begin(), plan.keys.end(), same) > 1;
    plan.columns.push_back(ambiguous ? key : last_part(key));
  }

  StudyProbe probe(study);
  std::map<std::string, std::string> text_of_id;
  for (const StageConfig& stage : study.stages) {
    StageSummary summary{stage.name, 0, 0, 0};
    std::vector<PlannedDesign> fresh;
    for (Design& node : nodes_of_stage(stage)) {
      ++summary.nodes;
      std::sort(node.begin(), node.end());
      PlannedDesign design{design_id(node), stage.name, node, {}, {}};
      const std::string text = canonical_text(node);
      const auto [found, is_new] = text_of_id.try_emplace(design.id, text);
      if (found->second != text)
        throw InputError(fmt::format("stage \"{}\": designs {} and {} have the same id {}; shift a value by 1e-9",
                                     stage.name, found->second, text, design.id));
      if (!is_new) {
        ++summary.shared;
        continue;
      }
      complete(probe, plan.keys, design);
      if (!design.impossible.empty()) ++summary.impossible;
      fresh.push_back(std::move(design));
    }
    std::stable_sort(fresh.begin(), fresh.end(),
                     [](const PlannedDesign& a, const PlannedDesign& b) { return row_before(a.row, b.row); });
    for (PlannedDesign& design : fresh) plan.designs.push_back(std::move(design));
    plan.stages.push_back(summary);
  }
  return plan;
}

std::string describe(const Plan& plan, const PlannedDesign& design) {
  std::string text;
  for (std::size_t i = 0; i < plan.columns.size(); ++i)
    if (!std::isnan(design.row[i]))
      text += fmt::format("{}{} = {}", text.empty() ? "" : ", ", plan.columns[i], design.row[i]);
  return text;
}

}  // namespace drumsweep

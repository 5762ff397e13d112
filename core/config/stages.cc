#include "core/config/stages.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <sstream>
#include <string_view>

#include "core/config/field_table.h"
#include "core/config/toml_fields.h"

namespace drumsweep {
namespace {

const std::vector<std::string> stage_types = {"grid", "points", "zoom", "adaptive", "refine", "replicate"};

/// The keys that a stage of this type takes beside its variables; without prefix those that are written.
std::vector<Field> stage_fields(StageConfig& s, const char* prefix) {
  std::vector<Field> list;
  FieldTable table{list, prefix, Scope::search};
  table.text("name", s.name, {}, "column `stage` of the result table");
  table.text("type", s.type, stage_types, "");
  if (s.type == "points" && *prefix != '\0') {
    table.text("file", s.file, {}, "CSV file with the points, beside the study");
  } else if (s.type == "zoom") {
    table.count("nodes", s.nodes, 2, 1000, "along each variable");
    table.number("margin", s.margin, 0, 10, "added at each end, as a share of the region's size");
  } else if (s.type == "adaptive") {
    table.count("budget", s.budget, 1, 100000, "designs, the initial ones included");
    table.count("initial", s.initial, 1, 100000, "spread evenly before the first fit; earlier results count");
    table.count("batch", s.batch, 1, 1000, "designs chosen together from one fit");
    table.number("least_gain_m", s.least_gain_m, 0, 1,
                 "ends when a batch is expected to lower f by less; 0: spends the budget");
  } else if (s.type == "replicate") {
    table.count("designs", s.designs, 1, 100000, "the optimum of the fit, then the best simulated ones");
    table.count("replicates", s.replicates, 1, 100000, "of each design");
    table.number("turns", s.turns, 1, 1e5, "recorded, instead of record.turns", true);
  }
  return list;
}

[[noreturn]] void unknown_key(const toml::node& value, const std::string& source, const std::string& key,
                              const std::vector<std::string>& names) {
  const std::string near = did_you_mean(key, names);
  throw InputError(fmt::format(
      "{}unknown key stage.{}{}", place(source, value.source()), key,
      near.empty() ? "; known are " + fmt::format("{}", fmt::join(names, ", ")) : "; did you mean " + near + "?"));
}

StageVariable read_variable(const toml::node& item, const std::string& source) {
  if (!item.is_table())
    throw InputError(place(source, item.source()) + "stage.variables: needs { key = \"outlet...\", ... }");
  StageVariable variable;
  for (const auto& [inner, v] : *item.as_table()) {
    const std::string word(inner.str()), here = place(source, v.source());
    if (word == "key") {
      if (!v.is_string()) throw InputError(here + "stage.variables.key: needs a text in quotes");
      variable.key = v.as_string()->get();
    } else if (word == "from") {
      variable.from = real_number(v, here, "stage.variables.from");
    } else if (word == "to") {
      variable.to = real_number(v, here, "stage.variables.to");
    } else if (word == "resolution") {
      variable.resolution = real_number(v, here, "stage.variables.resolution");
    } else if (word == "count") {
      if (!v.is_integer()) throw InputError(here + "stage.variables.count: needs a whole number");
      variable.count = v.as_integer()->get();
    } else if (word == "values") {
      if (!v.is_array()) throw InputError(here + "stage.variables.values: needs a list of numbers");
      for (const toml::node& number : *v.as_array())
        variable.values.push_back(real_number(number, place(source, number.source()), "stage.variables.values"));
    } else {
      unknown_key(v, source, "variables." + word,
                  {"variables.key", "variables.from", "variables.to", "variables.count", "variables.values",
                   "variables.resolution"});
    }
  }
  return variable;
}

/// Columns of a CSV file as variables; names are keys, or the last part of one.
std::vector<StageVariable> read_points(const std::string& path) {
  Study any;
  std::vector<std::string> keys;
  for (const Field& f : fields(any))
    if (std::holds_alternative<double*>(f.value)) keys.push_back(f.key);
  std::istringstream lines(read_text(path));
  std::vector<StageVariable> columns;
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (line.empty() || line.front() == '#') continue;
    std::vector<std::string> cells;
    std::istringstream stream(line);
    for (std::string cell; std::getline(stream, cell, ',');) {
      cell.erase(0, cell.find_first_not_of(" \t\""));
      cell.erase(cell.find_last_not_of(" \t\"") + 1);
      cells.push_back(cell);
    }
    const std::string here = fmt::format("{}:{}: ", path, number);
    if (columns.empty()) {
      for (const std::string& cell : cells) {
        const auto names = [&](const std::string& key) {
          return key == cell ||
                 (key.size() > cell.size() && key.substr(key.rfind('.') + 1) == cell && key.rfind("warmup.", 0) != 0);
        };
        const auto key = std::find_if(keys.begin(), keys.end(), names);
        if (key == keys.end()) {
          const std::string near = did_you_mean(cell, keys);
          throw InputError(fmt::format("{}column \"{}\" is no numeric key of a study{}", here, cell,
                                       near.empty() ? "" : "; did you mean " + near + "?"));
        }
        columns.push_back({*key, not_given, not_given, 1, {}});
      }
      continue;
    }
    if (cells.size() != columns.size())
      throw InputError(fmt::format("{}{} values in a table of {} columns", here, cells.size(), columns.size()));
    for (std::size_t i = 0; i < cells.size(); ++i) {
      char* end = nullptr;
      const double value = std::strtod(cells[i].c_str(), &end);
      if (cells[i].empty() || *end != '\0' || !std::isfinite(value))
        throw InputError(fmt::format("{}{} = \"{}\" is not a number", here, columns[i].key, cells[i]));
      columns[i].values.push_back(value);
    }
  }
  if (columns.empty() || columns.front().values.empty())
    throw InputError(path + ": needs a line with keys and at least one line with values");
  return columns;
}

/// Largest of 1, 2 and 5 times a power of ten that is not above `x`.
double round_down_to_125(double x) {
  const double power = std::pow(10, std::floor(std::log10(x) + 1e-9));
  for (const double step : {5.0, 2.0})
    if (x * (1 + 1e-9) >= step * power) return step * power;
  return power;
}

void validate_variables(const StageConfig& stage, const std::string& here) {
  for (std::size_t i = 0; i < stage.variables.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const std::string &one = stage.variables[j].key, &two = stage.variables[i].key;
      const auto is_angle = [](const std::string& key) { return key.rfind("outlet.opening_angle_", 0) == 0; };
      if (one == two || (is_angle(one) && is_angle(two)))
        throw InputError(here + "variables: " + one +
                         (one == two ? " stands there twice" : " and " + two + " are the same quantity"));
    }
}

void validate_numbers(const StageConfig& stage, const StageVariable& v, const std::string& here) {
  if (stage.type == "points") {
    if (v.values.empty() || v.values.size() != stage.variables.front().values.size())
      throw InputError(fmt::format("{}{}: {} values: needs at least one, and as many as the other variables", here,
                                   v.key, v.values.size()));
    return;
  }
  const bool grid = stage.type == "grid";
  if (grid && !(v.count >= 1 && v.count <= 100000))
    throw InputError(fmt::format("{}{}: count = {}: accepted is 1 to 100000", here, v.key, v.count));
  const bool ordered = grid ? v.from <= v.to && (v.count > 1 || v.from == v.to) : v.from < v.to;
  if (!std::isfinite(v.from) || !std::isfinite(v.to) || !ordered)
    throw InputError(
        grid ? fmt::format("{}{}: from = {}, to = {}, count = {}: needs finite from <= to (equal for one node)", here,
                           v.key, v.from, v.to, v.count)
             : fmt::format("{}{}: from = {}, to = {}: needs finite from < to", here, v.key, v.from, v.to));
  if (!grid && !std::isnan(v.resolution) && !(v.resolution >= 1e-9 && v.resolution <= v.to - v.from))
    throw InputError(fmt::format("{}{}: resolution = {}: accepted is 1e-9 to the range, {}", here, v.key, v.resolution,
                                 v.to - v.from));
  if (!grid && is_measuring_key(v.key))
    throw InputError(here + v.key + ": says how a design is measured and cannot be searched for");
}

}  // namespace

bool is_search(const StageConfig& stage) { return stage.type != "grid" && stage.type != "points"; }

bool is_measuring_key(const std::string& key) { return key.rfind("record.", 0) == 0; }

StageConfig read_stage(const toml::table& node, const std::string& source) {
  StageConfig out;
  // The type decides which keys there are.
  if (const auto type = node["type"].value<std::string>()) {
    if (std::find(stage_types.begin(), stage_types.end(), *type) == stage_types.end())
      throw InputError(fmt::format("{}stage.type = \"{}\": accepted is {}", place(source, node.get("type")->source()),
                                   *type, fmt::join(stage_types, " | ")));
    out.type = *type;
  }
  FieldReader reader{source, stage_fields(out, "stage."), "stage.variables", {}};
  reader.table(node, "stage.");
  validate_values(reader.known, reader.where());

  if (const toml::node* list = node.get("variables")) {
    const std::string here = place(source, list->source());
    if (!list->is_array()) throw InputError(here + "stage.variables: needs a list of { key = ..., ... }");
    for (const toml::node& item : *list->as_array()) out.variables.push_back(read_variable(item, source));
  }
  if (!out.file.empty()) {
    if (!out.variables.empty())
      throw InputError(reader.where()("stage.file") + "stage.file: give either a file or variables, not both");
    out.variables = read_points((std::filesystem::path(source).parent_path() / out.file).string());
    out.file.clear();
  }

  for (const StageVariable& v : out.variables) {
    const std::string here = place(source, node.source());
    if (v.key.empty()) throw InputError(here + "stage.variables: each needs a key");
    if ((out.type == "points") == v.values.empty())
      throw InputError(fmt::format("{}stage \"{}\": {}: {}", here, out.name, v.key,
                                   out.type == "points" ? "points take a list of values"
                                   : out.type == "grid" ? "a grid takes from, to and count, not values"
                                                        : "a search takes from and to, not values"));
  }
  return out;
}

std::string write_stage(const StageConfig& stage) {
  StageConfig copy = stage;
  std::string out = "\n[[stage]]\n" + write_fields(stage_fields(copy, ""), false);
  if (stage.variables.empty()) return out;
  out += "variables = [\n";
  for (const StageVariable& v : stage.variables) {
    if (stage.type == "points")
      out += fmt::format("  {{ key = \"{}\", values = [{}] }},\n", v.key, fmt::join(v.values, ", "));
    else if (stage.type == "grid")
      out += fmt::format("  {{ key = \"{}\", from = {}, to = {}, count = {} }},\n", v.key, v.from, v.to, v.count);
    else
      out += fmt::format("  {{ key = \"{}\", from = {}, to = {}{} }},\n", v.key, v.from, v.to,
                         std::isnan(v.resolution) ? "" : fmt::format(", resolution = {}", v.resolution));
  }
  return out + "]\n";
}

void validate_stages(const Study& study, const Where& where) {
  StudyProbe probe(study);
  std::vector<std::string> names;
  for (std::size_t index = 0; index < study.stages.size(); ++index) {
    const StageConfig& stage = study.stages[index];
    const std::string here = where("stage") + "stage \"" + stage.name + "\": ";
    const auto unfit = [](char c) {
      return std::string_view(",\"/\\").find(c) != std::string_view::npos || static_cast<unsigned char>(c) < 0x20;
    };
    if (stage.name.empty() || std::any_of(stage.name.begin(), stage.name.end(), unfit))
      throw InputError(here + "name: needs letters, without comma, quote, slash, backslash or control character");
    if (std::find(names.begin(), names.end(), stage.name) != names.end()) throw InputError(here + "name: used twice");
    names.push_back(stage.name);
    if (!is_search(stage) && stage.variables.empty()) throw InputError(here + "variables: at least one is needed");
    if (stage.type == "replicate" && !stage.variables.empty())
      throw InputError(here + "variables: replicates are of designs that earlier stages have found; leave this out");
    validate_variables(stage, here);

    double nodes = 1;
    for (const StageVariable& v : stage.variables) {
      validate_numbers(stage, v, here);
      if (stage.type == "grid") nodes *= static_cast<double>(v.count);
      try {
        if (stage.type != "points") probe.set(v.key, v.from);
        if (stage.type != "points") probe.set(v.key, v.to);
        for (const double value : v.values) probe.set(v.key, value);
      } catch (const InputError& error) {
        throw InputError(here + error.what());
      }
      probe.reset();
      Study copy = probe.study();
      for (const Field& f : fields(copy))
        if (f.key == v.key && f.scope == Scope::warm_state && f.key.rfind("outlet.", 0) != 0)
          throw InputError(here + v.key + ": cannot vary in a stage, because all designs start from one warm drum");
    }
    if (is_search(stage)) {
      const std::size_t num_ranges = search_ranges(study, index).size();
      if (num_ranges == 0)
        throw InputError(here + (stage.type == "replicate"
                                     ? "nothing to replicate: no earlier stage varies anything"
                                     : "variables: give ranges; no earlier stage has any that could be taken over"));
      if (stage.type == "zoom") nodes = std::pow(static_cast<double>(stage.nodes), static_cast<double>(num_ranges));
    }
    if (nodes > 1e6) throw InputError(fmt::format("{}{:.3g} designs: accepted is up to a million", here, nodes));
  }
}

std::vector<StageVariable> search_ranges(const Study& study, std::size_t index) {
  std::vector<StageVariable> ranges;
  if (index < study.stages.size()) ranges = study.stages[index].variables;
  if (ranges.empty()) {
    for (std::size_t s = 0; s < std::min(index, study.stages.size()); ++s)
      for (const StageVariable& v : study.stages[s].variables) {
        if (is_measuring_key(v.key)) continue;
        double low = v.from, high = v.to;
        if (!v.values.empty()) {
          low = *std::min_element(v.values.begin(), v.values.end());
          high = *std::max_element(v.values.begin(), v.values.end());
        }
        const auto same = [&](const StageVariable& r) { return r.key == v.key; };
        const auto known = std::find_if(ranges.begin(), ranges.end(), same);
        if (known == ranges.end()) {
          ranges.push_back({v.key, low, high, 1, {}, v.resolution});
        } else {
          known->from = std::min(known->from, low);
          known->to = std::max(known->to, high);
          if (std::isnan(known->resolution)) known->resolution = v.resolution;
        }
      }
    std::erase_if(ranges, [](const StageVariable& r) { return r.from == r.to; });
  }
  for (StageVariable& r : ranges)
    if (std::isnan(r.resolution)) r.resolution = std::max(1e-9, round_down_to_125((r.to - r.from) / 200));
  return ranges;
}

}  // namespace drumsweep

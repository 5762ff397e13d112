#include "core/config/toml_reader.h"

#include <fmt/format.h>

#include <cmath>

#include "core/config/schema.h"
#include "core/config/toml_fields.h"

namespace drumsweep {
namespace {

StageConfig read_stage(const toml::table& node, const std::string& source) {
  StageConfig out;
  const auto text = [&](const toml::node& value, const std::string& key) {
    if (!value.is_string())
      throw InputError(place(source, value.source()) + "stage." + key + ": needs a text in quotes");
    return value.as_string()->get();
  };
  const auto refuse = [&](const toml::node& value, const std::string& key, const std::vector<std::string>& names) {
    const std::string near = did_you_mean(key, names);
    throw InputError(fmt::format(
        "{}unknown key stage.{}{}", place(source, value.source()), key,
        near.empty() ? "; known are " + fmt::format("{}", fmt::join(names, ", ")) : "; did you mean " + near + "?"));
  };
  for (const auto& [name, value] : node) {
    const std::string key(name.str());
    if (key == "name") {
      out.name = text(value, key);
    } else if (key == "type") {
      out.type = text(value, key);
      if (out.type != "grid" && out.type != "points")
        throw InputError(
            fmt::format("{}stage.type = \"{}\": accepted is grid | points", place(source, value.source()), out.type));
    } else if (key == "variables") {
      if (!value.is_array())
        throw InputError(place(source, value.source()) + "stage.variables: needs a list of { key = ..., ... }");
      for (const toml::node& item : *value.as_array()) {
        if (!item.is_table())
          throw InputError(place(source, item.source()) + "stage.variables: needs { key = \"outlet...\", ... }");
        StageVariable variable;
        for (const auto& [inner, v] : *item.as_table()) {
          const std::string word(inner.str());
          const std::string here = place(source, v.source());
          if (word == "key") {
            variable.key = text(v, "variables.key");
          } else if (word == "from") {
            variable.from = real_number(v, here, "stage.variables.from");
          } else if (word == "to") {
            variable.to = real_number(v, here, "stage.variables.to");
          } else if (word == "count") {
            if (!v.is_integer()) throw InputError(here + "stage.variables.count: needs a whole number");
            variable.count = v.as_integer()->get();
          } else if (word == "values") {
            if (!v.is_array()) throw InputError(here + "stage.variables.values: needs a list of numbers");
            for (const toml::node& number : *v.as_array())
              variable.values.push_back(real_number(number, place(source, number.source()), "stage.variables.values"));
          } else {
            refuse(v, "variables." + word,
                   {"variables.key", "variables.from", "variables.to", "variables.count", "variables.values"});
          }
        }
        out.variables.push_back(variable);
      }
    } else {
      refuse(value, key, {"name", "type", "variables"});
    }
  }
  for (const StageVariable& v : out.variables) {
    const bool grid = out.type == "grid";
    if (v.key.empty()) throw InputError(place(source, node.source()) + "stage.variables: each needs a key");
    if (grid != v.values.empty())
      throw InputError(
          fmt::format("{}stage \"{}\": {}: {}", place(source, node.source()), out.name, v.key,
                      grid ? "a grid takes from, to and count, not values" : "points take a list of values"));
  }
  return out;
}
}  // namespace

Study parse_study(const std::string& text, const std::string& source, const Study& base) {
  const toml::table root = parse_toml(text, source);
  Study study = base;
  FieldReader reader{source, fields(study), "stage", {}};
  reader.table(root, "");
  if (const toml::node* node = root.get("stage")) {
    const toml::array* stages = node->as_array();
    if (stages == nullptr)
      throw InputError(place(source, node->source()) + "stage: needs to be a list of tables, [[stage]]");
    for (const toml::node& item : *stages) {
      if (!item.is_table())
        throw InputError(place(source, item.source()) + "stage: needs to be a list of tables, [[stage]]");
      study.stages.push_back(read_stage(*item.as_table(), source));
    }
  }
  validate(study, reader.where());
  return study;
}

Study read_study(const std::string& path) { return parse_study(read_text(path), path); }

std::string write_study(const Study& study, bool comments) {
  Study copy = study;
  std::string out = write_fields(fields(copy), comments);
  for (const StageConfig& stage : study.stages) {
    out += fmt::format("\n[[stage]]\nname = \"{}\"\ntype = \"{}\"\nvariables = [\n", stage.name, stage.type);
    for (const StageVariable& v : stage.variables) {
      if (stage.type == "grid")
        out += fmt::format("  {{ key = \"{}\", from = {}, to = {}, count = {} }},\n", v.key, v.from, v.to, v.count);
      else
        out += fmt::format("  {{ key = \"{}\", values = [{}] }},\n", v.key, fmt::join(v.values, ", "));
    }
    out += "]\n";
  }
  return out;
}

}  // namespace drumsweep

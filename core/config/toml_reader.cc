#include "core/config/toml_reader.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <cmath>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "core/config/schema.h"

namespace drumsweep {
namespace {

std::string place(const std::string& source, const toml::source_region& region) {
  return fmt::format("{}:{}:{}: ", source, region.begin.line, region.begin.column);
}

/// Reads one TOML value into a number; integers are accepted where a real number is expected.
double real_number(const toml::node& node, const std::string& here, const std::string& key) {
  if (const auto* d = node.as_floating_point()) return d->get();
  if (const auto* i = node.as_integer()) return static_cast<double>(i->get());
  throw InputError(here + key + ": needs a number");
}

void assign(const Field& field, const toml::node& node, const std::string& here) {
  if (auto* const* d = std::get_if<double*>(&field.value)) {
    **d = real_number(node, here, field.key);
    if (!std::isfinite(**d))
      throw InputError(fmt::format("{}{} = {}: accepted is {}", here, field.key, **d, accepted(field)));
  } else if (auto* const* i = std::get_if<std::int64_t*>(&field.value)) {
    if (!node.is_integer())
      throw InputError(here + field.key + ": needs a whole number, accepted is " + accepted(field));
    **i = node.as_integer()->get();
  } else if (auto* const* b = std::get_if<bool*>(&field.value)) {
    if (!node.is_boolean()) throw InputError(here + field.key + ": needs true or false");
    **b = node.as_boolean()->get();
  } else {
    if (!node.is_string())
      throw InputError(here + field.key + ": needs a text in quotes, accepted is " + accepted(field));
    *std::get<std::string*>(field.value) = node.as_string()->get();
  }
}

struct Reader {
  const std::string& source;
  std::vector<Field> known;
  std::map<std::string, std::string> places;  ///< key -> "file:line:column: "

  /// Walks a table; `prefix` is "" or "drum.texture.".
  void table(const toml::table& node, const std::string& prefix) {
    for (const auto& [name, value] : node) {
      const std::string key = prefix + std::string(name.str());
      const std::string here = place(source, value.source());
      if (key == "stage") continue;
      const auto is = [&](const Field& f) { return f.key == key; };
      const auto inside = [&](const Field& f) { return f.key.rfind(key + ".", 0) == 0; };
      if (const auto field = std::find_if(known.begin(), known.end(), is); field != known.end()) {
        places[key] = here;
        assign(*field, value, here);
      } else if (std::any_of(known.begin(), known.end(), inside)) {
        if (!value.is_table()) throw InputError(here + key + ": needs to be a table, [" + key + "]");
        table(*value.as_table(), key + ".");
      } else {
        unknown(here, key);
      }
    }
  }

  [[noreturn]] void unknown(const std::string& here, const std::string& key) const {
    std::set<std::string> names{"stage"};
    for (const Field& f : known) {
      names.insert(f.key);
      for (std::size_t dot = f.key.find('.'); dot != std::string::npos; dot = f.key.find('.', dot + 1))
        names.insert(f.key.substr(0, dot));
    }
    const std::string near = did_you_mean(key, {names.begin(), names.end()});
    throw InputError(fmt::format("{}unknown key {}{}", here, key, near.empty() ? "" : "; did you mean " + near + "?"));
  }

  StageConfig stage(const toml::table& node) {
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
                variable.values.push_back(
                    real_number(number, place(source, number.source()), "stage.variables.values"));
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
};

}  // namespace

Study parse_study(const std::string& text, const std::string& source) {
  toml::table root;
  try {
    root = toml::parse(text, source);
  } catch (const toml::parse_error& error) {
    throw InputError(place(source, error.source()) + std::string(error.description()));
  }
  Study study;
  Reader reader{source, fields(study), {}};
  reader.table(root, "");
  if (const toml::node* node = root.get("stage")) {
    const toml::array* stages = node->as_array();
    if (stages == nullptr)
      throw InputError(place(source, node->source()) + "stage: needs to be a list of tables, [[stage]]");
    for (const toml::node& item : *stages) {
      if (!item.is_table())
        throw InputError(place(source, item.source()) + "stage: needs to be a list of tables, [[stage]]");
      study.stages.push_back(reader.stage(*item.as_table()));
    }
  }
  validate(study, [&](const std::string& key) {
    const auto found = reader.places.find(key);
    return found == reader.places.end() ? source + ": " : found->second;
  });
  return study;
}

Study read_study(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  if (!file || !(text << file.rdbuf())) throw InputError(path + ": cannot be read; is the path right?");
  return parse_study(text.str(), path);
}

std::string write_study(const Study& study, bool comments) {
  Study copy = study;
  std::string out, table;
  for (const Field& field : fields(copy)) {
    const std::size_t dot = field.key.rfind('.');
    const std::string here = dot == std::string::npos ? "" : field.key.substr(0, dot);
    if (here != table) out += fmt::format("\n[{}]\n", here);
    table = here;
    const auto* const* number = std::get_if<double*>(&field.value);
    const bool absent = number != nullptr && field.optional && std::isnan(**number);
    if (absent && !comments) continue;
    std::string line =
        fmt::format("{}{} = {}", absent ? "# " : "", field.key.substr(dot == std::string::npos ? 0 : dot + 1),
                    absent ? "..." : to_toml(field));
    if (comments)
      line = fmt::format("{:<42} # {}{}({})", line, field.help, field.help.empty() ? "" : " ", accepted(field));
    out += line + "\n";
  }
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

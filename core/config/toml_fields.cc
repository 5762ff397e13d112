#include "core/config/toml_fields.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <set>
#include <sstream>

namespace drumsweep {

std::string place(const std::string& source, const toml::source_region& region) {
  // What a flag says has no lines that anybody could look up.
  if (source.rfind("--", 0) == 0) return source + ": ";
  return fmt::format("{}:{}:{}: ", source, region.begin.line, region.begin.column);
}

double real_number(const toml::node& node, const std::string& here, const std::string& key) {
  if (const auto* d = node.as_floating_point()) return d->get();
  if (const auto* i = node.as_integer()) return static_cast<double>(i->get());
  throw InputError(here + key + ": needs a number");
}

namespace {

void assign(const Field& field, const toml::node& node, const std::string& here) {
  if (auto* const* d = std::get_if<double*>(&field.value)) {
    **d = real_number(node, here, field.key);
    if (!std::isfinite(**d))
      throw InputError(fmt::format("{}{} = {}: accepted is {}", here, field.key, **d, accepted(field)));
  } else if (auto* const* i = std::get_if<std::int64_t*>(&field.value)) {
    if (field.or_auto && node.is_string() && node.as_string()->get() == "auto") {
      **i = 0;
      return;
    }
    if (!node.is_integer())
      throw InputError(here + field.key + ": needs a whole number, accepted is " + accepted(field));
    **i = node.as_integer()->get();
    if (field.or_auto && **i == 0)
      throw InputError(fmt::format("{}{} = 0: accepted is {}", here, field.key, accepted(field)));
  } else if (auto* const* b = std::get_if<bool*>(&field.value)) {
    if (!node.is_boolean()) throw InputError(here + field.key + ": needs true or false");
    **b = node.as_boolean()->get();
  } else {
    if (!node.is_string())
      throw InputError(here + field.key + ": needs a text in quotes, accepted is " + accepted(field));
    *std::get<std::string*>(field.value) = node.as_string()->get();
  }
}

}  // namespace

toml::table parse_toml(const std::string& text, const std::string& source) {
  try {
    return toml::parse(text, source);
  } catch (const toml::parse_error& error) {
    throw InputError(place(source, error.source()) + std::string(error.description()));
  }
}

toml::table changes_as_toml(const std::vector<std::string>& changes, const std::string& source) {
  const auto is_toml = [](const std::string& line) {
    try {
      static_cast<void>(toml::parse(line));
      return true;
    } catch (const toml::parse_error&) {
      return false;
    }
  };
  std::string text;
  for (const std::string& change : changes) {
    const std::size_t equals = change.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == change.size() ||
        change.find('\n') != std::string::npos)
      throw InputError(fmt::format("{} {}: needs KEY=VALUE", source, change));
    const std::string value = change.substr(equals + 1);
    text += fmt::format("{} = {}\n", change.substr(0, equals), is_toml("a = " + value) ? value : toml_text(value));
  }
  return parse_toml(text, source);
}

std::string toml_text(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    if (static_cast<unsigned char>(c) < 0x20) {
      out += fmt::format("\\u{:04x}", c);
    } else {
      out += c;
    }
  }
  return out + '"';
}

std::string toml_number(double value) {
  std::string text = fmt::format("{}", value);
  if (std::isfinite(value) && text.find_first_of(".e") == std::string::npos) text += ".0";
  return text;
}

std::string read_text(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  if (!file || !(text << file.rdbuf())) throw InputError(path + ": cannot be read; is the path right?");
  return text.str();
}

void FieldReader::table(const toml::table& node, const std::string& prefix) {
  for (const auto& [name, value] : node) {
    const std::string key = prefix + std::string(name.str());
    const std::string here = place(source, value.source());
    if (key == list_name) continue;
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

void FieldReader::unknown(const std::string& here, const std::string& key) const {
  std::set<std::string> names;
  if (!list_name.empty()) names.insert(list_name);
  for (const Field& f : known) {
    names.insert(f.key);
    for (std::size_t dot = f.key.find('.'); dot != std::string::npos; dot = f.key.find('.', dot + 1))
      names.insert(f.key.substr(0, dot));
  }
  const std::string near = did_you_mean(key, {names.begin(), names.end()});
  throw InputError(fmt::format("{}unknown key {}{}", here, key, near.empty() ? "" : "; did you mean " + near + "?"));
}

Where FieldReader::where() const {
  return [this](const std::string& key) {
    const auto found = places.find(key);
    return found == places.end() ? source + ": " : found->second;
  };
}

std::string write_fields(const std::vector<Field>& list, bool comments) {
  std::string out, table;
  for (const Field& field : list) {
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
  return out;
}

}  // namespace drumsweep

#include "diagnosis/campaign/candidate.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "core/config/toml_fields.h"

namespace drumsweep {
namespace {

[[noreturn]] void fail(const std::string& source, const toml::node& node, const std::string& text) {
  throw InputError(place(source, node.source()) + text);
}

void only_keys(const toml::table& table, const std::string& source, const std::vector<std::string>& known) {
  for (const auto& [key, node] : table) {
    const std::string name(key.str());
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    const std::string near = did_you_mean(name, known);
    fail(source, node, fmt::format("unknown key {}{}", name, near.empty() ? "" : "; did you mean " + near + "?"));
  }
}

std::string text_at(const toml::table& table, const char* key, const std::string& source,
                    const char* otherwise = nullptr) {
  const toml::node* node = table.get(key);
  if (node == nullptr) {
    if (otherwise != nullptr) return otherwise;
    throw InputError(fmt::format("{}: {}: missing", place(source, table.source()), key));
  }
  if (!node->is_string()) fail(source, *node, fmt::format("{}: needs to be a text", key));
  return node->as_string()->get();
}

double number_at(const toml::table& table, const char* key, const std::string& source) {
  const toml::node* node = table.get(key);
  if (node == nullptr) throw InputError(fmt::format("{}{}: missing", place(source, table.source()), key));
  return real_number(*node, place(source, node->source()), key);
}

const toml::array* list_at(const toml::table& table, const char* key, const std::string& source) {
  const toml::node* node = table.get(key);
  if (node == nullptr) return nullptr;
  if (!node->is_array()) fail(source, *node, fmt::format("{}: needs to be a list", key));
  return node->as_array();
}

CandidateChange read_change(const toml::table& t, const std::string& source) {
  only_keys(t, source, {"key", "add", "scale", "below", "of"});
  CandidateChange c{KeyChange::How::add, text_at(t, "key", source), "", 1, {}};
  if (t.contains("add") + t.contains("scale") + t.contains("below") != 1)
    fail(source, t, "a change needs exactly one of add, scale and below");
  if (t.contains("scale")) c.how = KeyChange::How::scale;
  if (t.contains("below")) {
    c.how = KeyChange::How::below;
    c.of_key = text_at(t, "below", source);
  } else {
    c.factor = number_at(t, t.contains("scale") ? "scale" : "add", source);
  }
  if (const toml::array* types = list_at(t, "of", source))
    for (const toml::node& n : *types) {
      if (!n.is_string()) fail(source, n, "of: needs to be a list of condition types in quotes");
      c.types.push_back(n.as_string()->get());
    }
  return c;
}

CandidateObservation read_observation(const toml::table& t, const std::string& source) {
  only_keys(t, source, {"quantity", "condition", "add", "scale"});
  if (t.contains("add") + t.contains("scale") != 1)
    fail(source, t, "an observation needs exactly one of add and scale");
  CandidateObservation o{text_at(t, "quantity", source), text_at(t, "condition", source, ""), t.contains("scale"), 1};
  o.factor = number_at(t, o.scales ? "scale" : "add", source);
  return o;
}

}  // namespace

Candidate parse_candidate(const std::string& text, const std::string& source) {
  const toml::table t = parse_toml(text, source);
  only_keys(t, source, {"id", "about", "unit", "low", "high", "prior_scale", "curve", "change", "observe", "numerics"});
  Candidate c;
  c.source = source;
  c.effect.id = text_at(t, "id", source);
  c.effect.unit = text_at(t, "unit", source);
  c.effect.about = text_at(t, "about", source, "");
  c.effect.low = number_at(t, "low", source);
  c.effect.high = number_at(t, "high", source);
  c.effect.prior_scale = number_at(t, "prior_scale", source);
  if (t.contains("curve")) c.effect.curve = number_at(t, "curve", source);
  if (!(c.effect.curve > 0 && c.effect.curve <= 2))
    throw InputError(fmt::format("{}: curve = {}: accepted is above 0, to 2", source, c.effect.curve));
  if (!(c.effect.low <= 0 && c.effect.high >= 0 && c.effect.low < c.effect.high))
    throw InputError(
        fmt::format("{}: low = {}, high = {}: accepted is low <= 0 <= high, as strength 0 is the plain model", source,
                    c.effect.low, c.effect.high));
  if (!(c.effect.prior_scale > 0))
    throw InputError(fmt::format("{}: prior_scale = {}: accepted is above 0", source, c.effect.prior_scale));
  if (const toml::array* list = list_at(t, "change", source))
    for (const toml::node& n : *list) {
      if (!n.is_table()) fail(source, n, "change: needs to be a list of tables");
      c.changes.push_back(read_change(*n.as_table(), source));
    }
  if (const toml::array* list = list_at(t, "observe", source))
    for (const toml::node& n : *list) {
      if (!n.is_table()) fail(source, n, "observe: needs to be a list of tables");
      c.observations.push_back(read_observation(*n.as_table(), source));
    }
  if (const toml::node* n = t.get("numerics")) c.numerics = n->is_boolean() && n->as_boolean()->get();
  if (c.changes.empty() && c.observations.empty() && !c.numerics)
    throw InputError(source + ": a candidate needs change, observe or numerics = true");
  return c;
}

Candidate find_candidate(const std::string& name, const std::string& folder) {
  // A sensor of one quantity that reads too much or too little, as a share of the reading.
  if (name.rfind("sensor_bias:", 0) == 0) {
    const std::string quantity = name.substr(12);
    return parse_candidate(
        fmt::format("id = {}\nabout = \"the instrument for {} reads wrongly everywhere\"\nunit = \"1\"\n"
                    "low = -0.5\nhigh = 0.5\nprior_scale = 0.1\n"
                    "observe = [ {{ quantity = \"{}\", scale = 1.0 }} ]\n",
                    toml_text(name), quantity, quantity),
        "built in");
  }
  std::vector<std::string> ids;
  for (int i = 0; i < num_embedded_candidates; ++i) {
    ids.emplace_back(embedded_candidates[i].id);
    if (name == embedded_candidates[i].id)
      return parse_candidate(embedded_candidates[i].text, "built-in candidate " + name);
  }
  const std::string path = (std::filesystem::path(folder) / name).string();
  if (name.ends_with(".toml") && std::filesystem::exists(path)) return parse_candidate(read_text(path), path);
  const std::string near = did_you_mean(name, ids);
  throw InputError(
      fmt::format("candidates: \"{}\" is neither built in nor a file {}{}; built in are {}, and sensor_bias:QUANTITY",
                  name, path, near.empty() ? "" : "; did you mean " + near + "?", fmt::join(ids, ", ")));
}

std::vector<KeyChange> Candidate::apply(const Condition& condition, double phi) const {
  std::vector<KeyChange> out;
  for (const CandidateChange& c : changes) {
    if (!c.types.empty() && std::find(c.types.begin(), c.types.end(), condition.type) == c.types.end()) continue;
    out.push_back({c.how, c.key, c.factor * phi, c.of_key});
  }
  return out;
}

bool Candidate::acts_on_input_of(const Condition& condition) const {
  const std::vector<KeyChange> list = apply(condition, 1);
  return std::any_of(list.begin(), list.end(), [&](const KeyChange& c) { return condition.has(c.key); });
}

double Candidate::observe(const std::string& condition, const std::string& quantity, double value, double phi) const {
  if (phi == 0) return value;
  for (const CandidateObservation& o : observations) {
    if ((o.quantity != "*" && o.quantity != quantity) || (!o.condition.empty() && o.condition != condition)) continue;
    value = o.scales ? value * (1 + o.factor * phi) : value + o.factor * phi;
  }
  return value;
}

}  // namespace drumsweep

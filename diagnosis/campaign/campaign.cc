#include "diagnosis/campaign/campaign.h"

#include <fmt/format.h>

#include <filesystem>
#include <set>

#include "core/config/toml_fields.h"
#include "diagnosis/model/fit.h"

namespace drumsweep {
namespace {

struct Reader {
  const std::string& source;

  [[noreturn]] void fail(const toml::node& node, const std::string& text) const {
    throw InputError(place(source, node.source()) + text);
  }
  void only_keys(const toml::table& table, const std::vector<std::string>& known) const {
    for (const auto& [key, node] : table) {
      const std::string name(key.str());
      if (std::find(known.begin(), known.end(), name) != known.end()) continue;
      const std::string near = did_you_mean(name, known);
      fail(node, fmt::format("unknown key {}{}", name, near.empty() ? "" : "; did you mean " + near + "?"));
    }
  }
  const toml::node& need(const toml::table& table, const std::string& key) const {
    if (const toml::node* node = table.get(key)) return *node;
    throw InputError(fmt::format("{}{}: missing", place(source, table.source()), key));
  }
  std::string text(const toml::node& node, const std::string& key) const {
    if (!node.is_string()) fail(node, key + ": needs to be a text in quotes");
    return node.as_string()->get();
  }
  double number(const toml::node& node, const std::string& key) const {
    return real_number(node, place(source, node.source()), key);
  }
  std::int64_t count(const toml::node& node, const std::string& key, double low, double high) const {
    const double value = number(node, key);
    if (!(value >= low && value <= high) || value != std::floor(value))
      fail(node, fmt::format("{} = {}: accepted is whole number, {} to {}", key, value, low, high));
    return static_cast<std::int64_t>(value);
  }
  std::vector<const toml::table*> tables(const toml::table& root, const std::string& key) const {
    std::vector<const toml::table*> list;
    const toml::node* node = root.get(key);
    if (node == nullptr) return list;
    const toml::array* array = node->as_array();
    if (array == nullptr) fail(*node, fmt::format("{0}: needs to be a list of tables, [[{0}]]", key));
    for (const toml::node& item : *array) {
      if (!item.is_table()) fail(item, fmt::format("{0}: needs to be a list of tables, [[{0}]]", key));
      list.push_back(item.as_table());
    }
    return list;
  }
};

std::string inside(const std::string& folder, const std::string& name) {
  return (std::filesystem::path(folder) / name).lexically_normal().string();
}

Condition read_one(const Reader& in, const toml::table& t, const std::string& folder) {
  in.only_keys(t, {"id", "file", "set", "group", "held_out", "baseline", "cost"});
  const std::string id = in.text(in.need(t, "id"), "id");
  std::vector<KeyChange> inputs;
  if (const toml::node* set = t.get("set")) {
    if (!set->is_table()) in.fail(*set, "set: needs to be a table of keys and numbers");
    for (const auto& [key, node] : *set->as_table())
      inputs.push_back({KeyChange::How::set, std::string(key.str()), in.number(node, std::string(key.str()))});
  }
  Condition c = read_condition(id, inside(folder, in.text(in.need(t, "file"), "file")), inputs);
  if (const toml::node* group = t.get("group")) {
    c.group = in.text(*group, "group");
    const std::vector<std::string> known = {"bench", "drum", "outlet", "belt", "mass"};
    if (std::find(known.begin(), known.end(), c.group) == known.end())
      in.fail(*group, fmt::format("group = \"{}\": accepted is {}", c.group, fmt::join(known, " | ")));
  }
  if (const toml::node* baseline = t.get("baseline")) {
    if (!baseline->is_table()) in.fail(*baseline, "baseline: needs to be a table of quantities and numbers");
    for (const auto& [key, node] : *baseline->as_table())
      c.baseline.emplace_back(std::string(key.str()), in.number(node, std::string(key.str())));
  }
  if (const toml::node* cost = t.get("cost")) {
    c.cost = in.number(*cost, "cost");
    if (!(c.cost > 0)) in.fail(*cost, fmt::format("cost = {}: accepted is above 0", c.cost));
  }
  if (const toml::node* held = t.get("held_out")) {
    if (!held->is_boolean()) in.fail(*held, "held_out: needs to be true or false");
    c.held_out = held->as_boolean()->get();
  }
  return c;
}

CampaignParameter read_parameter(const Reader& in, const toml::table& t) {
  in.only_keys(t, {"id", "key", "keys", "mean", "sigma", "unit"});
  CampaignParameter p;
  p.prior.id = in.text(in.need(t, "id"), "id");
  p.prior.mean = in.number(in.need(t, "mean"), "mean");
  p.prior.sigma = in.number(in.need(t, "sigma"), "sigma");
  p.prior.unit = t.contains("unit") ? in.text(*t.get("unit"), "unit") : "1";
  if (!(p.prior.sigma > 0)) in.fail(*t.get("sigma"), fmt::format("sigma = {}: accepted is above 0", p.prior.sigma));
  if (t.contains("key")) p.keys.push_back(in.text(*t.get("key"), "key"));
  if (const toml::node* keys = t.get("keys")) {
    if (!keys->is_array()) in.fail(*keys, "keys: needs to be a list of keys");
    for (const toml::node& n : *keys->as_array()) p.keys.push_back(in.text(n, "keys"));
  }
  if (p.keys.empty()) in.fail(t, fmt::format("parameter {}: key: missing", p.prior.id));
  return p;
}

/// Everything the design can ask for must be possible, before anything is simulated.
void check_corners(const Campaign& c) {
  const auto num_parameters = static_cast<Eigen::Index>(c.parameters.size()),
             num_effects = static_cast<Eigen::Index>(c.candidates.size());
  const auto try_at = [&](const std::string& what, const Eigen::VectorXd& u, const Eigen::VectorXd& p) {
    for (const Condition& condition : c.conditions) try {
        condition.check(c.changes(condition, u, p));
      } catch (const InputError& error) {
        throw InputError(fmt::format("{}: {}: the campaign's design reaches what cannot be simulated: {}", c.path, what,
                                     error.what()));
      }
  };
  const Eigen::VectorXd u0 = Eigen::VectorXd::Zero(num_parameters), p0 = Eigen::VectorXd::Zero(num_effects);
  for (Eigen::Index j = 0; j < num_parameters; ++j)
    for (const double side : {-design_reach, design_reach}) {
      Eigen::VectorXd u = u0;
      u[j] = side;
      const FreeParameter& prior = c.parameters[static_cast<std::size_t>(j)].prior;
      try_at(fmt::format("parameter {} at {:.4g} {} ({:+.1f} sigma)", prior.id, prior.mean + side * prior.sigma,
                         prior.unit, side),
             u, p0);
    }
  for (Eigen::Index k = 0; k < num_effects; ++k) {
    const CandidateEffect& e = c.candidates[static_cast<std::size_t>(k)].effect;
    for (const double phi : {e.low, e.high}) {
      Eigen::VectorXd p = p0;
      p[k] = e.inner(phi);
      try_at(fmt::format("candidate {} at {} {}", e.id, phi, e.unit), u0, p);
    }
  }
}

template <class List, class Id>
void refuse_twice(const std::string& source, const char* what, const List& list, Id id) {
  std::set<std::string> seen;
  for (const auto& item : list)
    if (!seen.insert(id(item)).second)
      throw InputError(fmt::format("{}: {} {} is there twice", source, what, id(item)));
}

}  // namespace

std::size_t Campaign::index_of(const std::string& condition) const {
  for (std::size_t i = 0; i < conditions.size(); ++i)
    if (conditions[i].id == condition) return i;
  return conditions.size();
}

std::int64_t Campaign::num_coefficients() const {
  return num_features(static_cast<Eigen::Index>(parameters.size() + candidates.size()));
}

std::string Campaign::fingerprint() const {
  std::string out = fmt::format("seed {}\nnumerics_runs {}\n", seed, numerics_runs);
  for (const Condition& c : conditions) out += fmt::format("condition {}\n{}\n", c.id, c.text);
  for (const CampaignParameter& p : parameters)
    out += fmt::format("parameter {} {} {} {}\n", p.prior.id, fmt::join(p.keys, " "), p.prior.mean, p.prior.sigma);
  // Observations are read off anew whenever the data are looked at; ranges decide the design.
  for (const Candidate& c : candidates) {
    out += fmt::format("candidate {} {} {} {}", c.effect.id, c.effect.low, c.effect.high, c.effect.curve);
    for (const CandidateChange& ch : c.changes)
      out += fmt::format(" {} {} {} {} {}", static_cast<int>(ch.how), ch.key, ch.factor, ch.of_key,
                         fmt::join(ch.types, " "));
    out += '\n';
  }
  return out;
}

std::vector<KeyChange> Campaign::changes(const Condition& condition, const Eigen::VectorXd& u,
                                         const Eigen::VectorXd& p) const {
  std::vector<KeyChange> out;
  for (std::size_t j = 0; j < parameters.size(); ++j)
    for (const std::string& key : parameters[j].keys)
      out.push_back({KeyChange::How::set, key,
                     parameters[j].prior.mean + u[static_cast<Eigen::Index>(j)] * parameters[j].prior.sigma});
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    const std::vector<KeyChange> more =
        candidates[k].apply(condition, candidates[k].effect.strength(p[static_cast<Eigen::Index>(k)]));
    out.insert(out.end(), more.begin(), more.end());
  }
  return out;
}

Campaign read_campaign(const std::string& path) {
  const toml::table root = parse_toml(read_text(path), path);
  const Reader in{path};
  Campaign c;
  c.path = path;
  c.folder = std::filesystem::path(path).parent_path().string();
  in.only_keys(root, {"name", "seed", "runs", "second_wave", "numerics_runs", "bootstraps", "measured", "study",
                      "assumed_relative_sigma", "condition", "parameter", "candidates", "ranges"});
  if (const toml::node* n = root.get("name")) c.name = in.text(*n, "name");
  if (const toml::node* n = root.get("seed")) c.seed = in.count(*n, "seed", 0, 9007199254740992.0);
  if (const toml::node* n = root.get("runs")) c.runs = in.count(*n, "runs", 0, 1e6);
  if (const toml::node* n = root.get("second_wave")) c.second_wave = in.count(*n, "second_wave", 0, 9999);
  if (const toml::node* n = root.get("numerics_runs")) c.numerics_runs = in.count(*n, "numerics_runs", 0, 10000);
  if (const toml::node* n = root.get("bootstraps")) c.bootstraps = in.count(*n, "bootstraps", 99, 1e6);
  if (const toml::node* n = root.get("assumed_relative_sigma")) {
    c.assumed_relative_sigma = in.number(*n, "assumed_relative_sigma");
    if (!(c.assumed_relative_sigma > 0 && c.assumed_relative_sigma < 1))
      in.fail(*n, fmt::format("assumed_relative_sigma = {}: accepted is between 0 and 1", c.assumed_relative_sigma));
  }
  c.measured =
      inside(c.folder, root.contains("measured") ? in.text(*root.get("measured"), "measured") : "measured.csv");
  if (const toml::node* n = root.get("study")) c.study = inside(c.folder, in.text(*n, "study"));
  for (const toml::table* t : in.tables(root, "condition")) c.conditions.push_back(read_one(in, *t, c.folder));
  for (const toml::table* t : in.tables(root, "parameter")) c.parameters.push_back(read_parameter(in, *t));
  const toml::node& names = in.need(root, "candidates");
  if (!names.is_array()) in.fail(names, "candidates: needs to be a list of names");
  for (const toml::node& n : *names.as_array())
    c.candidates.push_back(find_candidate(in.text(n, "candidates"), c.folder));

  if (const toml::node* ranges = root.get("ranges")) {
    if (!ranges->is_table()) in.fail(*ranges, "ranges: needs to be a table, candidate = [low, high]");
    for (const auto& [key, node] : *ranges->as_table()) {
      const std::string id(key.str());
      const auto found =
          std::find_if(c.candidates.begin(), c.candidates.end(), [&](const Candidate& k) { return k.effect.id == id; });
      if (found == c.candidates.end()) in.fail(node, fmt::format("ranges: {} is not among the candidates", id));
      const toml::array* pair = node.as_array();
      if (pair == nullptr || pair->size() != 2) in.fail(node, fmt::format("ranges: {}: needs to be [low, high]", id));
      found->effect.low = in.number((*pair)[0], id);
      found->effect.high = in.number((*pair)[1], id);
      if (!(found->effect.low <= 0 && found->effect.high >= 0 && found->effect.low < found->effect.high))
        in.fail(node, fmt::format("ranges: {} = [{}, {}]: accepted is low <= 0 <= high", id, found->effect.low,
                                  found->effect.high));
      found->effect.prior_scale = std::min(found->effect.prior_scale, found->effect.scale());
    }
  }
  if (c.conditions.empty()) throw InputError(path + ": no [[condition]]: at least one is needed");
  if (c.candidates.empty()) in.fail(names, "candidates: at least one is needed");
  refuse_twice(path, "condition", c.conditions, [](const Condition& x) { return x.id; });
  refuse_twice(path, "parameter", c.parameters, [](const CampaignParameter& x) { return x.prior.id; });
  refuse_twice(path, "candidate", c.candidates, [](const Candidate& x) { return x.effect.id; });
  for (const CampaignParameter& p : c.parameters) {
    bool found = false;
    for (const Condition& condition : c.conditions)
      for (const std::string& key : p.keys) found = found || condition.has(key);
    if (!found)
      throw InputError(fmt::format("{}: parameter {}: no condition has the numeric key {}", path, p.prior.id,
                                   fmt::join(p.keys, " or ")));
  }
  for (const Candidate& k : c.candidates) {
    bool acts = k.changes.empty();
    for (const Condition& condition : c.conditions) acts = acts || k.acts_on_input_of(condition);
    if (!acts)
      throw InputError(
          fmt::format("{}: candidate {}: no condition has anything that it acts on, so no strength of it could be seen "
                      "(its detection limit is "
                      "infinite); leave it out or add a condition",
                      path, k.effect.id));
    if (k.numerics && c.numerics_runs == 0)
      throw InputError(fmt::format("{}: candidate {} needs numerics_runs above 0", path, k.effect.id));
  }
  check_corners(c);
  return c;
}

}  // namespace drumsweep

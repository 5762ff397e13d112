#include <fmt/format.h>

#include <map>
#include <optional>
#include <set>
#include <sstream>

#include "core/config/toml_fields.h"
#include "diagnosis/campaign/campaign.h"

namespace drumsweep {
namespace {

constexpr const char* header = "condition,quantity,position,value,sigma,unit,use";

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> cells(1);
  for (const char ch : line) {
    if (ch == ',')
      cells.emplace_back();
    else if (ch != '\r')
      cells.back() += ch;
  }
  for (std::string& cell : cells) {
    const std::size_t first = cell.find_first_not_of(' '), last = cell.find_last_not_of(' ');
    cell = first == std::string::npos ? "" : cell.substr(first, last - first + 1);
  }
  return cells;
}

double finite_number(const std::string& text, const std::string& here, const char* what) {
  std::size_t used = 0;
  double value = 0;
  try {
    value = std::stod(text, &used);
  } catch (const std::exception&) {
  }
  if (text.empty() || used != text.size() || !std::isfinite(value))
    throw InputError(fmt::format("{}{} = \"{}\": accepted is a finite number", here, what, text));
  return value;
}

/// Factor from one unit to another; nothing where they do not measure the same.
std::optional<double> conversion(const std::string& from, const std::string& to) {
  if (from == to) return 1.0;
  static const std::map<std::string, std::pair<std::string, double>> base = {{"m", {"m", 1}},
                                                                             {"cm", {"m", 0.01}},
                                                                             {"mm", {"m", 0.001}},
                                                                             {"um", {"m", 1e-6}},
                                                                             {"m/s", {"m/s", 1}},
                                                                             {"cm/s", {"m/s", 0.01}},
                                                                             {"mm/s", {"m/s", 0.001}},
                                                                             {"deg", {"deg", 1}},
                                                                             {"rad", {"deg", 57.29577951308232}},
                                                                             {"kg", {"kg", 1}},
                                                                             {"g", {"kg", 0.001}},
                                                                             {"t", {"kg", 1000}},
                                                                             {"kg/s", {"kg/s", 1}},
                                                                             {"g/s", {"kg/s", 0.001}},
                                                                             {"t/h", {"kg/s", 1 / 3.6}},
                                                                             {"kg/h", {"kg/s", 1 / 3600.0}},
                                                                             {"s", {"s", 1}},
                                                                             {"min", {"s", 60}},
                                                                             {"ms", {"s", 0.001}},
                                                                             {"1", {"1", 1}},
                                                                             {"%", {"1", 0.01}}};
  const auto a = base.find(from), b = base.find(to);
  if (a == base.end() || b == base.end() || a->second.first != b->second.first) return std::nullopt;
  return a->second.second / b->second.second;
}

}  // namespace

MeasuredData read_measured(const Campaign& campaign) {
  return parse_measured(read_text(campaign.measured), campaign.measured, campaign);
}

MeasuredData parse_measured(const std::string& text, const std::string& source, const Campaign& campaign) {
  MeasuredData out;
  std::istringstream stream(text);
  std::string line;
  bool header_seen = false;
  std::set<std::string> keys;
  std::map<std::string, std::set<Use>> uses;
  std::vector<std::string> conditions;
  for (const Condition& c : campaign.conditions) conditions.push_back(c.id);
  for (int number = 1; std::getline(stream, line); ++number) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (line.empty() || line.front() == '#') continue;
    const std::string here = fmt::format("{}:{}: ", source, number);
    if (!header_seen) {
      if (line != header) throw InputError(fmt::format("{}first line is \"{}\": needed is {}", here, line, header));
      header_seen = true;
      continue;
    }
    const std::vector<std::string> cells = split(line);
    if (cells.size() != 7) throw InputError(fmt::format("{}{} columns: needed are 7, {}", here, cells.size(), header));
    Datum d;
    d.condition = cells[0];
    d.quantity = cells[1];
    d.unit = cells[5];
    const std::size_t c = campaign.index_of(d.condition);
    if (c == campaign.conditions.size()) {
      const std::string near = did_you_mean(d.condition, conditions);
      throw InputError(fmt::format("{}condition = \"{}\": the campaign has no such one{}; it has {}", here, d.condition,
                                   near.empty() ? "" : "; did you mean " + near + "?", fmt::join(conditions, ", ")));
    }
    if (!cells[2].empty()) d.position = finite_number(cells[2], here, "position");
    if (cells[6] == "fit")
      d.use = Use::fit;
    else if (cells[6] == "holdout")
      d.use = Use::holdout;
    else if (cells[6] == "available")
      d.use = Use::available;
    else
      throw InputError(
          fmt::format("{}use = \"{}\": accepted is fit | holdout | available (not measured yet)", here, cells[6]));
    if (d.use != Use::available)
      d.value = finite_number(cells[3], here, "value");
    else if (!cells[3].empty())
      throw InputError(fmt::format("{}value = \"{}\": a measurement that is only available has none", here, cells[3]));
    if (cells[4] == "assumed") {
      if (std::isnan(campaign.assumed_relative_sigma) || std::isnan(d.value))
        throw InputError(here + "sigma = assumed: needs assumed_relative_sigma in the campaign file, and a value");
      d.sigma = campaign.assumed_relative_sigma * std::abs(d.value);
      ++out.num_assumed;
    } else {
      if (cells[4].empty())
        throw InputError(here +
                         "sigma: missing; needed is the standard error of the value, above 0 (or the word assumed, see "
                         "assumed_relative_sigma)");
      d.sigma = finite_number(cells[4], here, "sigma");
    }
    if (!(d.sigma > 0)) throw InputError(fmt::format("{}sigma = {}: accepted is above 0", here, d.sigma));
    if (!keys.insert(fmt::format("{}\n{}\n{}", d.condition, d.quantity, d.position)).second)
      throw InputError(fmt::format("{}{} is there twice; give the mean and its error", here, name_of(d)));
    if (d.use == Use::fit && campaign.conditions[c].held_out)
      throw InputError(
          fmt::format("{}use = fit: condition {} is held out in the campaign file; a held-out condition must not be "
                      "used for fitting",
                      here, d.condition));
    uses[d.condition].insert(d.use);
    if (uses[d.condition].count(Use::fit) + uses[d.condition].count(Use::holdout) > 1)
      throw InputError(
          fmt::format("{}use = {}: condition {} has rows with fit and with holdout; a held-out condition must not be "
                      "used for fitting",
                      here, cells[6], d.condition));
    out.data.push_back(d);
    out.line.push_back(number);
  }
  if (!header_seen) throw InputError(fmt::format("{}: is empty: needed is {}", source, header));
  std::size_t num_fit = 0;
  for (const Datum& d : out.data) num_fit += d.use == Use::fit ? 1 : 0;
  if (num_fit <= campaign.parameters.size())
    throw InputError(
        fmt::format("{}: {} rows with use = fit for {} free parameters: accepted is more data than free parameters",
                    source, num_fit, campaign.parameters.size()));
  return out;
}

double read_off(const std::vector<Observable>& list, const std::string& quantity, double position) {
  const Observable *below = nullptr, *above = nullptr;
  for (const Observable& o : list) {
    if (o.name != quantity) continue;
    if (std::isnan(position)) {
      if (std::isnan(o.position)) return o.value;
      continue;
    }
    if (o.position <= position && (below == nullptr || o.position > below->position)) below = &o;
    if (o.position >= position && (above == nullptr || o.position < above->position)) above = &o;
  }
  if (below == nullptr || above == nullptr) return std::nan("");
  if (above->position == below->position) return below->value;
  const double t = (position - below->position) / (above->position - below->position);
  return (1 - t) * below->value + t * above->value;
}

void match_measured(MeasuredData& measured, const std::string& source, const Campaign& campaign,
                    const std::vector<std::vector<Observable>>& offered) {
  for (std::size_t i = 0; i < measured.data.size(); ++i) {
    Datum& d = measured.data[i];
    const std::string here = fmt::format("{}:{}: ", source, measured.line[i]);
    const std::size_t c = campaign.index_of(d.condition);
    std::vector<std::string> names;
    const Observable* found = nullptr;
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const Observable& o : offered[c]) {
      if (names.empty() || names.back() != o.name) names.push_back(o.name);
      if (o.name != d.quantity) continue;
      found = &o;
      low = std::min(low, o.position);
      high = std::max(high, o.position);
    }
    if (found == nullptr) {
      const std::string near = did_you_mean(d.quantity, names);
      throw InputError(fmt::format("{}quantity = \"{}\": condition {} ({}) has no such one{}; it has {}", here,
                                   d.quantity, d.condition, campaign.conditions[c].type,
                                   near.empty() ? "" : "; did you mean " + near + "?", fmt::join(names, ", ")));
    }
    if (std::isnan(d.position) != std::isnan(found->position))
      throw InputError(fmt::format("{}position: {} {}", here, d.quantity,
                                   std::isnan(d.position)
                                       ? fmt::format("needs one, {} to {} {}", low, high, found->position_unit)
                                       : "has none: leave it empty"));
    d.position_unit = found->position_unit;
    if (!std::isnan(d.position)) {
      const double rounding = 1e-9 * (high - low);
      if (!(d.position >= low - rounding && d.position <= high + rounding))
        throw InputError(fmt::format("{}position = {}: {} is simulated from {:.6g} to {:.6g} {}", here, d.position,
                                     d.quantity, low, high, found->position_unit));
      d.position = std::clamp(d.position, low, high);
    }
    if (!std::isfinite(read_off(offered[c], d.quantity, d.position)))
      throw InputError(
          fmt::format("{}{}: this condition gives no number for it (too few balls, or too short)", here, name_of(d)));
    const std::optional<double> factor = conversion(d.unit, found->unit);
    if (!factor) throw InputError(fmt::format("{}unit = \"{}\": {} is in {}", here, d.unit, d.quantity, found->unit));
    d.value *= *factor;
    d.sigma *= *factor;
    d.unit = found->unit;
    d.group = group_of(campaign.conditions[c], d.quantity);
  }
}

Problem make_problem(const Campaign& campaign, const MeasuredData& measured) {
  Problem problem;
  problem.data = measured.data;
  for (const CampaignParameter& p : campaign.parameters) problem.parameters.push_back(p.prior);
  for (const Candidate& c : campaign.candidates) problem.effects.push_back(c.effect);
  return problem;
}

}  // namespace drumsweep

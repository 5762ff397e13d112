#include "diagnosis/report/steps.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>

#include "diagnosis/report/mass_balance.h"
#include "postproc/contour.h"

namespace drumsweep {
namespace {

using Index = Eigen::Index;

constexpr double largest_numerics = 0.3;
constexpr double open_balance = 0.05;  // a steady run of some hundred balls closes nearer than that

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

std::string number(double value, int digits = 3) {
  return std::isfinite(value) ? fmt::format("{:.{}g}", value, digits) : "";
}
StepCell z_cell(double z) { return {std::isfinite(z) ? fmt::format("{:+.1f}", z) : "", z}; }
std::string p_text(double p) { return std::isfinite(p) ? fmt::format("{:.2g}", p) : ""; }

std::string effect_name(const DiagnosisReport& r, Index k) { return spoken(r.problem.effects[at(k)].id); }

// --- 1. checks

void say_numerics(const DiagnosisReport& r, DiagnosisStep& step) {
  if (r.numerics.empty()) {
    step.lines.push_back("numerics were not checked (numerics_runs)");
    return;
  }
  StepTable table{"numerics",
                  "Changed by half the time step and 4 x iterations",
                  {{"condition, quantity"}, {"change", true}, {"error", true}, {"unit"}, {"in sigma", true}},
                  {},
                  "In sigma: change over the error of the measurement."};
  std::vector<const NumericsCheck*> coarse;
  std::size_t unsure = 0;
  for (const NumericsCheck& c : r.numerics) {
    if (std::abs(c.in_sigma) <= largest_numerics) continue;
    if (std::abs(c.difference) < 2 * c.error)
      ++unsure;
    else
      coarse.push_back(&c);
  }
  std::sort(coarse.begin(), coarse.end(), [](const NumericsCheck* a, const NumericsCheck* b) {
    return std::abs(a->in_sigma) > std::abs(b->in_sigma);
  });
  for (const NumericsCheck* c : coarse) {
    const Datum& datum = r.problem.data[c->datum];
    table.rows.push_back({{spoken_name(datum)},
                          {fmt::format("{:+.3g}", c->difference)},
                          {number(c->error, 2)},
                          {datum.unit},
                          {fmt::format("{:+.2f}", c->in_sigma)}});
  }
  if (!coarse.empty())
    step.lines.push_back(
        fmt::format("NUMERICAL ERROR: {} of {} data change by more than {} sigma with half the time step and 4 x "
                    "iterations; as long as they do, no cause that is found is sure",
                    coarse.size(), r.numerics.size(), largest_numerics));
  if (unsure > 0)
    step.lines.push_back(
        fmt::format("numerics: of {}{} data, {} pairs of runs do not say whether they change by more than {} sigma "
                    "(numerics_runs)",
                    unsure, coarse.empty() ? "" : " more", r.campaign.numerics_runs, largest_numerics));
  if (coarse.empty() && unsure == 0)
    step.lines.push_back(fmt::format(
        "numerics: half the time step and 4 x iterations change no datum by more than {} sigma", largest_numerics));
  if (!table.rows.empty()) step.tables.push_back(std::move(table));
}

DiagnosisStep checks(const DiagnosisReport& r) {
  DiagnosisStep step{"checks", "Checks", {}, {}};
  step.lines.push_back(fmt::format("units: {} data are in units of what is simulated, at places that are simulated",
                                   r.problem.data.size()));
  const std::vector<MassBalance> balances = mass_balances(r.campaign, r.problem, r.result.misfits);
  for (const MassBalance& b : balances)
    step.lines.push_back(
        fmt::format("conservation, {}: {} is {:.3g} +- {:.2g} as measured{}{}", b.condition, b.what, b.measured,
                    b.sigma, std::isfinite(b.simulated) ? fmt::format(" and {:.3g} as simulated", b.simulated) : "",
                    b.closes() ? ""
                               : ": THE MEASURED MASS BALANCE DOES NOT CLOSE, so one of these numbers is wrong before "
                                 "any simulation is asked"));
  for (const MassBalance& b : balances)
    if (std::abs(b.simulated - 1) > open_balance)
      step.lines.push_back(
          fmt::format("conservation, {}: the simulated balance does not close: it is not steady, or "
                      "loses balls",
                      b.condition));
  bool more = false;
  for (std::size_t i = 0; i < r.problem.data.size(); ++i) {
    const Datum& datum = r.problem.data[i];
    if (datum.quantity != "axial_velocity" || datum.use != Use::fit || r.result.misfits.empty() ||
        std::abs(r.result.misfits[i].z_before) < shown_z)
      continue;
    more = true;
    step.lines.push_back(fmt::format(
        "conservation, {}: at equal feed the simulated {:.3g} m/s instead of {:.3g} m/s mean a fill of {:.2f} times "
        "the machine's, whatever the friction",
        datum.condition, r.result.misfits[i].simulated_before, datum.value,
        datum.value / r.result.misfits[i].simulated_before));
  }
  if (balances.empty() && !more)
    step.lines.push_back(
        "conservation: no condition has measured numbers that would have to make a mass balance (holdup and residence "
        "time, outflow over feed, mean height of the bed ...)");
  say_numerics(r, step);
  step.lines.insert(step.lines.end(), r.second_wave.begin(), r.second_wave.end());
  return step;
}

// --- 2. what is wrong

StepTable group_table(const DiagnosisReport& r) {
  StepTable table{"groups",
                  "By group",
                  {{"group"}, {"data", true}, {"chi2", true}, {"p", true}, {""}},
                  {},
                  "chi2: squares of what is left after recalibration. p: probability of more by chance."};
  for (const GroupMisfit& g : r.result.groups)
    table.rows.push_back({{g.group},
                          {fmt::format("{}", g.num_data)},
                          {fmt::format("{:.1f}", g.chi2)},
                          {p_text(g.p)},
                          {misfits(g) ? "misfits" : ""}});
  return table;
}

StepTable parameter_table(const DiagnosisReport& r) {
  StepTable table{"parameters",
                  "Free parameters",
                  {{"parameter"}, {"bench", true}, {"its error", true}, {"recalibrated", true}, {"unit"}, {"z", true}},
                  {},
                  "Of the plain model. z: how far the data pull it from its bench value, in standard errors."};
  for (std::size_t j = 0; j < r.problem.parameters.size() && j < r.result.theta_z.size(); ++j) {
    const FreeParameter& p = r.problem.parameters[j];
    table.rows.push_back({{spoken(p.id)},
                          {number(p.mean, 4)},
                          {number(p.sigma, 2)},
                          {number(p.mean + p.sigma * r.result.plain.x[static_cast<Index>(j)], 4)},
                          {p.unit},
                          {z_cell(r.result.theta_z[j]).text}});
  }
  return table;
}

/// Condition by quantity; of a quantity with positions, the largest.
StepTable heat_table(const DiagnosisReport& r) {
  std::vector<std::string> conditions, quantities;
  std::map<std::pair<std::string, std::string>, double> worst;
  bool positions = false;
  const auto remember = [](std::vector<std::string>& list, const std::string& name) {
    if (std::find(list.begin(), list.end(), name) == list.end()) list.push_back(name);
  };
  for (std::size_t i = 0; i < r.result.misfits.size(); ++i) {
    const Datum& d = r.problem.data[i];
    if (!compared(d)) continue;
    remember(conditions, d.condition);
    remember(quantities, d.quantity);
    positions = positions || !std::isnan(d.position);
    const auto [cell, is_new] = worst.try_emplace({d.condition, d.quantity}, r.result.misfits[i].z_after);
    if (!is_new && std::abs(r.result.misfits[i].z_after) > std::abs(cell->second))
      cell->second = r.result.misfits[i].z_after;
  }
  StepTable table{"heat",
                  "z after recalibration, by condition and quantity",
                  {{"condition"}},
                  {},
                  fmt::format("z: measured - simulated in standard errors of the difference; positive where the "
                              "simulation is too low{}.",
                              positions ? "; of a quantity with positions, the largest" : "")};
  for (const std::string& q : quantities) table.columns.push_back({spoken(q), true});
  for (const std::string& c : conditions) {
    table.rows.push_back({{c}});
    for (const std::string& q : quantities) {
      const auto found = worst.find({c, q});
      table.rows.back().push_back(found == worst.end() ? StepCell{} : z_cell(found->second));
    }
  }
  return table;
}

StepTable data_table(const DiagnosisReport& r) {
  StepTable table{"data",
                  "All data",
                  {{"condition, quantity"},
                   {"measured", true},
                   {"simulated", true},
                   {"z", true},
                   {"recalibrated", true},
                   {"z", true}},
                  {},
                  "Simulated: the plain model at the bench's values, then with its parameters recalibrated."};
  const bool with_cause = !r.with_cause.empty();
  if (with_cause) {
    table.columns.push_back({"with the cause", true});
    table.note += fmt::format(" With the cause: {}{}.", describe(r, r.result.causes.front()),
                              r.result.causes.size() > 1 ? ", the best of the set" : "");
  }
  table.columns.insert(table.columns.end(), {{"unit"}, {"use"}});
  for (std::size_t i = 0; i < r.result.misfits.size(); ++i) {
    const Datum& d = r.problem.data[i];
    const DatumMisfit& m = r.result.misfits[i];
    if (!compared(d)) continue;
    table.rows.push_back({{spoken_name(d)},
                          {fmt::format("{:.4g} +- {:.2g}", d.value, d.sigma), std::nan(""), d.value},
                          {number(m.simulated_before, 4)},
                          z_cell(m.z_before),
                          {number(m.simulated_after, 4)},
                          z_cell(m.z_after)});
    std::vector<StepCell>& row = table.rows.back();
    if (with_cause) row.push_back({number(r.with_cause[i].value, 4)});
    row.insert(row.end(), {{d.unit}, {d.use == Use::fit ? "fit" : "held out"}});
  }
  return table;
}

DiagnosisStep what_is_wrong(const DiagnosisReport& r) {
  const Diagnosis& d = r.result;
  DiagnosisStep step{"wrong", "What is wrong", {}, {}};
  step.lines.push_back(
      fmt::format("p = {:.2g} (all data {:.2g}, towards a candidate {:.2g}); Q = {:.1f} of {} fitted data; all error "
                  "bars would have to be x {:.2f} for the model to pass",
                  d.p_value, d.p_omnibus, d.p_directed, d.q0, d.num_fitted_data, d.birge));
  for (const std::string& words : misfits_in_words(r)) step.lines.push_back(words);
  if (d.at_edge)
    step.lines.push_back(
        "a parameter lies at the edge of what the campaign covers: widen its sigma, or doubt its bench value");
  for (const StepTable& table : {heat_table(r), group_table(r), parameter_table(r), data_table(r)})
    if (!table.rows.empty()) step.tables.push_back(table);
  return step;
}

// --- 3. the cause

StepTable member_table(const DiagnosisReport& r) {
  StepTable table{
      "causes",
      r.result.causes.size() > 1 ? "The set of causes" : "The cause",
      {{"cause"}, {"Q", true}, {"weight", true}, {"held out: p", true}, {"held-out gain (nats)", true}, {""}},
      {},
      fmt::format("Strengths with 95 % intervals. Q: misfit, {:.1f} for the plain model. Weight: posterior "
                  "among adequate models.",
                  r.result.q0)};
  const auto add = [&](const Explanation& e, const char* state) {
    table.rows.push_back({{describe(r, e)},
                          {fmt::format("{:.1f}", e.q)},
                          {number(e.weight, 2)},
                          {p_text(e.held_out_p)},
                          {std::isfinite(e.held_out_nats) ? fmt::format("{:+.1f}", e.held_out_nats) : ""},
                          {state}});
  };
  for (const Explanation& e : r.result.causes) add(e, "named");
  for (const Explanation& e : r.result.refused) add(e, "refused");
  if (!r.result.refused.empty())
    table.note += " Refused: by the held-out conditions, or only possible at the end of its range.";
  return table;
}

StepTable advice_table(const DiagnosisReport& r) {
  StepTable table{"advice",
                  "What would separate them",
                  {{"measurement"}, {"predicted distance (sigma)", true}, {"tells them apart (%)", true}},
                  {},
                  "Distance: between the two nearest members of the set, once that was measured."};
  const bool costs = std::any_of(r.advice_cost.begin(), r.advice_cost.end(), [](double c) { return std::isfinite(c); });
  if (costs) {
    table.columns.push_back({"cost", true});
    table.columns.push_back({"gained per cost (sigma2)", true});
    table.note += " Best first by what it adds to the square of the distance, per cost.";
  }
  for (std::size_t i = 0; i < r.result.advice.size(); ++i) {
    const Advice& a = r.result.advice[i];
    table.rows.push_back(
        {{a.measurement}, {fmt::format("{:.1f}", a.distance)}, {fmt::format("{:.0f}", 100 * a.power)}});
    if (!costs) continue;
    table.rows.back().push_back({number(r.advice_cost[i])});
    table.rows.back().push_back({number(a.gained / r.advice_cost[i])});
  }
  return table;
}

StepTable candidate_table(const DiagnosisReport& r) {
  const Diagnosis& d = r.result;
  StepTable table{"candidates",
                  "What these data would have seen",
                  {{"candidate"},
                   {"fitted alone", true},
                   {"Q", true},
                   {"seen 9 times in 10"},
                   {"at its end (sigma)", true},
                   {"nearest rival"},
                   {"its distance (sigma)", true}},
                  {},
                  fmt::format("Q of the plain model: {:.1f}. At its end: how far it moves the data at the end of its "
                              "range. Nearest rival: how far it stays, after refitting, where the "
                              "candidate is 5 sigma strong, or at the end of its range.",
                              d.q0)};
  for (std::size_t k = 0; k < d.detection.size(); ++k) {
    const CandidateEffect& e = r.problem.effects[k];
    const std::optional<std::size_t> rival = nearest_rival(d, k);
    const ModelFit& alone = d.singles[k];
    table.rows.push_back(
        {{spoken(e.id)},
         {with_its_unit(e.strength(alone.x[alone.x.size() - 1]), e.unit)},
         {fmt::format("{:.1f}", alone.q)},
         {seen_from(e, d.detection[k])},
         {fmt::format("{:.1f}", d.detection[k].d_at_end)},
         {rival ? spoken(r.problem.effects[*rival].id) : ""},
         {rival ? fmt::format("{:.1f}", d.isolation(static_cast<Index>(k), static_cast<Index>(*rival))) : ""}});
  }
  return table;
}

StepTable isolation_table(const DiagnosisReport& r) {
  StepTable table{
      "isolation",
      "How far every rival stays (sigma)",
      {{"truth"}},
      {},
      "Distance of the best fit of the column's candidate alone where the row's is the truth, 5 sigma strong "
      "or at the end of its range. Below 4.2 a name alone would be wrong too often.",
      true};
  for (const CandidateEffect& e : r.problem.effects) table.columns.push_back({spoken(e.id), true});
  for (Index k = 0; k < r.result.isolation.rows(); ++k) {
    table.rows.push_back({{effect_name(r, k)}});
    for (Index j = 0; j < r.result.isolation.cols(); ++j)
      table.rows.back().push_back({j == k ? "" : fmt::format("{:.1f}", r.result.isolation(k, j))});
  }
  return table;
}

DiagnosisStep cause(const DiagnosisReport& r) {
  const Diagnosis& d = r.result;
  DiagnosisStep step{"cause", "The cause", {headline(r)}, {}};
  if (d.verdict == Verdict::none_of_these)
    for (std::size_t k = 0; k < d.pattern_cosine.size(); ++k)
      if (std::abs(d.pattern_cosine[k]) > 0.5)
        step.lines.push_back(fmt::format("the misfit resembles {} (cosine {:.2f}): a hint, not a name",
                                         spoken(r.problem.effects[k].id), d.pattern_cosine[k]));
  for (const Twins& t : d.twins)
    step.lines.push_back(fmt::format(
        "{} and {} {}", effect_name(r, t.a), effect_name(r, t.b),
        t.exact ? "cannot be told apart by these data at all: where one is named, both are meant"
                : fmt::format("are near twins: {:.1f} sigma apart where they would just be seen", t.distance)));
  if (const std::string next = next_measurement(r); !next.empty()) step.lines.push_back(next);
  for (const StepTable& table : {member_table(r), advice_table(r), candidate_table(r), isolation_table(r)})
    if (!table.rows.empty()) step.tables.push_back(table);
  return step;
}

// --- 4. to 6.

DiagnosisStep extension(const DiagnosisReport& r, const std::vector<std::pair<std::string, std::string>>& studies) {
  DiagnosisStep step{"extension", "The extension", {}, {}};
  for (std::size_t i = 0; i < studies.size(); ++i)
    step.lines.push_back(
        fmt::format("{}: {} with {}", studies[i].first, r.campaign.study, describe(r, r.result.causes[i])));
  if (!studies.empty())
    step.lines.push_back("each is a study that `drumsweep run` takes as it is");
  else
    step.lines.push_back(r.result.causes.empty() ? "none: no cause was found" : "none: the campaign names no study");
  return step;
}

DiagnosisStep gain(const DiagnosisReport& r) {
  DiagnosisStep step{"gain", "The gain, on held-out conditions", {}, {}};
  const HeldOutGain& g = r.result.gain;
  if (g.nats.empty()) {
    step.lines.push_back(r.result.causes.empty() ? "none: nothing was extended"
                                                 : "not known: no condition was held out");
    return step;
  }
  step.lines.push_back(gain_in_words(g));
  if (g.nats.size() < 6) step.lines.push_back("fewer than 6 held-out conditions hardly ever prove a gain");
  StepTable nats{"nats",
                 "Of each condition",
                 {{"condition"}, {"gain (nats)", true}},
                 {},
                 "log of the probability density of what was measured, extended over plain model."};
  for (std::size_t i = 0; i < g.nats.size(); ++i)
    nats.rows.push_back({{g.conditions[i]}, {fmt::format("{:+.2f}", g.nats[i])}});
  StepTable units{
      "units", "In units", {{"root mean square difference"}, {"plain", true}, {"extended", true}, {"unit"}}, {}, ""};
  for (const HeldOutGain::Quantity& q : g.quantities)
    units.rows.push_back({{spoken(q.quantity)}, {number(q.rms_before)}, {number(q.rms_after)}, {q.unit}});
  units.rows.push_back({{"z"}, {fmt::format("{:.2f}", g.rms_z_before)}, {fmt::format("{:.2f}", g.rms_z_after)}, {"1"}});
  units.rows.push_back({{"data within 90 % bands"},
                        {fmt::format("{:.0f}", 100 * g.coverage_before)},
                        {fmt::format("{:.0f}", 100 * g.coverage_after)},
                        {"%"}});
  step.tables = {nats, units};
  return step;
}

/// A length of metres in millimetres, with as many digits as its error gives sense to.
std::string millimetre_text(double value_m, double sigma_m) {
  if (!(sigma_m > 0)) return fmt::format("{:.3g}", 1000 * value_m);
  const int decimals = std::clamp(1 - static_cast<int>(std::floor(std::log10(1000 * sigma_m))), 0, 6);
  return fmt::format("{:.{}f} +- {:.{}f}", 1000 * value_m, decimals, 1000 * sigma_m, decimals);
}
std::string millimetre_text(const Regret& r) { return millimetre_text(r.f_m, r.sigma_m); }

DiagnosisStep what_it_changes(const DiagnosisReport& r, bool has_study) {
  DiagnosisStep step{"change", "What it changes", {}, {}};
  if (!r.change) {
    step.lines.push_back(has_study
                             ? "not known yet: run the study and extended.toml (`drumsweep run`) and give both folders "
                               "(`--before`, `--after`; `--after` again for each further member of the set)"
                             : "nothing: there is no extended study");
    return step;
  }
  const DesignChange& c = *r.change;
  const DesignChange::Member& best = c.members.front();
  step.lines.push_back(
      fmt::format("keeping the old design costs {} mm of f; the optimum has moved by {:.1f} of the joint "
                  "half width of "
                  "the 95 % regions{}",
                  millimetre_text(best.of_old), best.spread,
                  best.spread < 1 ? ", which is no change that these sweeps could tell" : ""));
  if (c.members.size() > 1) {
    const Regret& worst = *std::max_element(c.regret[c.safest].begin(), c.regret[c.safest].end(),
                                            [](const Regret& a, const Regret& b) { return a.f_m < b.f_m; });
    step.lines.push_back(fmt::format(
        "{}: the optimum of {} costs at most {} mm of f, whichever of the {} members is the truth; optima "
        "of two members lie up to {:.1f} of the joint half width apart{}",
        c.agree()
            ? "as far as these sweeps can tell, the members of the set agree on the decision, although the data cannot "
              "separate them"
            : "THE MEMBERS OF THE SET DO NOT AGREE on the decision",
        extended_name(c.safest), millimetre_text(worst), c.members.size(), c.apart,
        c.agree() ? "" : "; separate them first"));
  }
  if (c.members.size() < r.result.causes.size())
    step.lines.push_back(
        fmt::format("{} of {} members of the set were swept: whether all agree on the decision is not known",
                    c.members.size(), r.result.causes.size()));
  StepTable optima{"optima", "Optimum outlet", {{"study"}}, {}, "In brackets 95 % regions."};
  for (const std::string& name : c.variables) optima.columns.push_back({axis_label(name), true});
  optima.columns.push_back({"f (mm)", true});
  optima.columns.push_back({"old design costs (mm)", true});
  const auto add = [&](const std::string& name, const Optimum& o, const std::string& regret) {
    optima.rows.push_back({{name}});
    for (std::size_t k = 0; k < o.at.size(); ++k)
      optima.rows.back().push_back({fmt::format("{:.4g} [{:.4g}, {:.4g}]", o.at[k], o.low[k], o.high[k])});
    optima.rows.back().push_back({millimetre_text(o.f_m, o.sigma_m)});
    optima.rows.back().push_back({regret});
  };
  add("plain", c.before, "");
  for (std::size_t i = 0; i < c.members.size(); ++i)
    add(extended_name(i), c.members[i].after, millimetre_text(c.members[i].of_old));
  step.tables.push_back(std::move(optima));
  if (c.members.size() > 1) {
    StepTable regret{
        "regret", "What the optimum of one costs (mm of f) where another is the truth", {{"built"}}, {}, ""};
    for (std::size_t j = 0; j < c.members.size(); ++j) regret.columns.push_back({extended_name(j) + " true", true});
    for (std::size_t i = 0; i < c.members.size(); ++i) {
      regret.rows.push_back({{extended_name(i)}});
      for (const Regret& one : c.regret[i]) regret.rows.back().push_back({millimetre_text(one)});
    }
    step.tables.push_back(std::move(regret));
  }
  return step;
}

}  // namespace

bool compared(const Datum& d) { return d.use == Use::fit || d.use == Use::holdout; }
bool misfits(const GroupMisfit& group) { return group.p < 0.01; }

std::string spoken(const std::string& id) {
  std::string out;
  for (const char c : id) out += c == '_' ? std::string(" ") : c == ':' ? std::string(" of ") : std::string(1, c);
  return out;
}

std::string spoken_name(const Datum& d) {
  return fmt::format("{}, {}{}", d.condition, spoken(d.quantity),
                     std::isnan(d.position) ? "" : fmt::format(" at {:.4g} {}", d.position, d.position_unit));
}

std::string with_its_unit(double value, const std::string& unit) {
  return number(value) + (unit == "1" || unit.empty() ? "" : " " + unit);
}

std::string seen_from(const CandidateEffect& e, const Detection& limit) {
  if (limit.d_at_end < 1) return "nothing here sees it";
  const bool low = std::isfinite(limit.limit_low), high = std::isfinite(limit.limit_high);
  if (low && high)
    return fmt::format("below {} or above {}", with_its_unit(limit.limit_low, e.unit),
                       with_its_unit(limit.limit_high, e.unit));
  if (low) return "below " + with_its_unit(limit.limit_low, e.unit);
  if (high) return "above " + with_its_unit(limit.limit_high, e.unit);
  return "not in its range";
}

std::vector<DiagnosisStep> diagnosis_steps(const DiagnosisReport& r) {
  const auto studies = extended_studies(r);
  return {checks(r), what_is_wrong(r), cause(r), extension(r, studies), gain(r), what_it_changes(r, !studies.empty())};
}

}  // namespace drumsweep

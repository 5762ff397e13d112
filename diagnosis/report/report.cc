#include "diagnosis/report/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "core/config/toml_fields.h"
#include "core/io/durable_file.h"
#include "core/io/hdf5_image.h"
#include "core/scene/scene.h"
#include "diagnosis/campaign/second_wave.h"
#include "diagnosis/model/linear_algebra.h"
#include "diagnosis/report/steps.h"

namespace drumsweep {
namespace {

using Index = Eigen::Index;

/// All data as a fitted model has them.
std::vector<ExtendedValue> values_of(const Inquiry& inquiry, const ModelFit& fit) {
  const ModelEmulator model = inquiry.emulator_of(fit.effects);
  const Eigen::VectorXd mean = model.predict(fit.x), &scale = inquiry.emulator.scale();
  const Eigen::MatrixXd slope = transposed_product(model.coefficients, feature_slopes(fit.x)),
                        spread = congruence(slope, fit.spread);
  std::vector<ExtendedValue> list;
  for (Index i = 0; i < mean.size(); ++i)
    list.push_back({mean[i] * scale[i], std::sqrt(fit.v * (*model.noise)(i, i) + spread(i, i)) * scale[i]});
  return list;
}

/// What it costs to measure a condition once; a campaign, all that was fitted.
double cost_of(const Campaign& campaign, const Problem& problem, const std::string& measurement) {
  const std::size_t one = campaign.index_of(measurement);
  if (one < campaign.conditions.size()) return campaign.conditions[one].cost;
  std::set<std::string> fitted;
  for (const Datum& d : problem.data)
    if (d.use == Use::fit) fitted.insert(d.condition);
  double sum = 0;
  for (const std::string& id : fitted) sum += campaign.conditions[campaign.index_of(id)].cost;
  return sum;
}

/// Best first by what a measurement adds per cost, where the campaign says what all of them cost.
void rank_advice(DiagnosisReport& r) {
  std::vector<Advice>& list = r.result.advice;
  const auto cost = [&](const Advice& a) { return cost_of(r.campaign, r.problem, a.measurement); };
  if (std::all_of(list.begin(), list.end(), [&](const Advice& a) { return std::isfinite(cost(a)); }))
    std::stable_sort(list.begin(), list.end(),
                     [&](const Advice& a, const Advice& b) { return a.gained / cost(a) > b.gained / cost(b); });
  for (const Advice& a : list) r.advice_cost.push_back(cost(a));
}

}  // namespace

DiagnosisReport make_report(const Campaign& campaign, const MeasuredData& measured, const CampaignOutputs& outputs,
                            const DiagnosisOptions& options) {
  DiagnosisReport r;
  r.campaign = campaign;
  r.problem = make_problem(campaign, measured);
  r.num_runs = static_cast<std::size_t>(outputs.runs.outputs.rows());
  r.notes = outputs.left_out;
  CampaignOutputs scaled = outputs;
  put_on_baseline(campaign, r.problem, scaled, r.notes);
  const Emulator emulator(scaled.runs, scale_of(r.problem));
  r.second_wave = second_wave_notes(r.problem, emulator, scaled.local);
  r.budget = runs_by_budget_law(emulator);
  if (static_cast<std::int64_t>(r.num_runs) < r.budget)
    r.notes.push_back(fmt::format(
        "{} runs are fewer than the {} that the budget law asks for: {}; false alarms stay right", r.num_runs, r.budget,
        scaled.local.empty() ? "intervals are too narrow and true pairs may be refused"
                             : "the second wave makes up for it where it went, nowhere else"));
  if (measured.num_assumed > 0)
    r.notes.push_back(
        fmt::format("{} of {} data came without an error; {:.3g} % of their values stand for it. The p-value holds for "
                    "that assumption only, and no "
                    "cause is called established",
                    measured.num_assumed, measured.data.size(), 100 * campaign.assumed_relative_sigma));
  const Index pairs = outputs.numerics.rows();
  if (pairs > 1) {
    for (Index i = 0; i < outputs.numerics.cols(); ++i) {
      const Eigen::ArrayXd d = outputs.numerics.col(i).array();
      const double mean = d.mean(), error = std::sqrt((d - mean).square().sum() / static_cast<double>(pairs - 1) /
                                                      static_cast<double>(pairs));
      r.numerics.push_back(
          {static_cast<std::size_t>(i), mean, error, mean / r.problem.data[static_cast<std::size_t>(i)].sigma});
    }
  } else {
    r.notes.push_back("numerics were not checked (numerics_runs)");
  }
  r.result = diagnose(r.problem, emulator, options, scaled.local);
  if (measured.num_assumed > 0 && r.result.verdict == Verdict::established) r.result.verdict = Verdict::suspected;
  if (!r.result.causes.empty())
    r.with_cause = values_of(Inquiry(r.problem, emulator, options, scaled.local), r.result.causes.front().fit);
  rank_advice(r);
  return r;
}

std::string describe(const DiagnosisReport& r, const Explanation& cause) {
  std::vector<std::string> list;
  for (const NamedEffect& n : cause.effects) {
    const CandidateEffect& e = r.problem.effects[static_cast<std::size_t>(n.effect)];
    list.push_back(
        fmt::format("{} {} [{:.3g}, {:.3g}]", spoken(e.id), with_its_unit(n.strength, e.unit), n.low, n.high));
  }
  return fmt::format("{}", fmt::join(list, " and "));
}

std::string headline(const DiagnosisReport& r) {
  const Diagnosis& d = r.result;
  const std::string p = fmt::format("p = {:.2g}", d.p_value);
  switch (d.verdict) {
    case Verdict::nothing_wrong:
      return fmt::format("NOTHING WRONG: these data do not contradict the model ({})", p);
    case Verdict::established:
      return fmt::format("ESTABLISHED: {} ({})", describe(r, d.causes.front()), p);
    case Verdict::suspected:
      return fmt::format("SUSPECTED: {} ({})", describe(r, d.causes.front()), p);
    case Verdict::ambiguous: {
      std::vector<std::string> list;
      for (const Explanation& e : d.causes) list.push_back(describe(r, e));
      return fmt::format("AMBIGUOUS: something is wrong ({}), and these data cannot separate {}", p,
                         fmt::join(list, " | "));
    }
    case Verdict::none_of_these:
      break;
  }
  return fmt::format("NONE OF THESE: something is wrong ({}), and no candidate explains it", p);
}

std::vector<std::string> misfits_in_words(const DiagnosisReport& r) {
  std::vector<std::string> low, high;
  for (std::size_t i = 0; i < r.result.misfits.size(); ++i) {
    const Datum& d = r.problem.data[i];
    const DatumMisfit& m = r.result.misfits[i];
    if (d.use == Use::fit && std::abs(m.off_before) >= 2)
      (m.off_before > 0 ? low : high)
          .push_back(
              fmt::format("{} of {}{} ({:.4g} instead of {:.4g} {})", spoken(d.quantity), d.condition,
                          std::isnan(d.position) ? "" : fmt::format(" at {:.4g} {}", d.position, d.position_unit),
                          m.simulated_before, d.value, d.unit));
  }
  std::vector<std::string> parts;
  if (!low.empty()) parts.push_back(fmt::format("simulation too low: {}", fmt::join(low, ", ")));
  if (!high.empty()) parts.push_back(fmt::format("simulation too high: {}", fmt::join(high, ", ")));
  if (parts.empty()) parts.push_back("no single number is off by 2 sigma or more");
  return parts;
}

std::string next_measurement(const DiagnosisReport& r) {
  if (r.result.advice.empty()) return "";
  constexpr double worth_while = 0.5;  // power below which nobody should be sent to measure
  const Advice& a = r.result.advice.front();
  const std::string apart = fmt::format(
      "the nearest members of the set would then be {:.1f} sigma apart, so the truth would be told from its nearest "
      "rival with a probability of {:.0f} %",
      a.distance, 100 * a.power);
  const auto separates = [&](const Advice& one) { return one.power >= worth_while; };
  if (std::none_of(r.result.advice.begin(), r.result.advice.end(), separates))
    return fmt::format("nothing that the campaign offers would separate them; at best ({}) {}", a.measurement, apart);
  return fmt::format("measure next {}: {}", a.measurement, apart);
}

std::string gain_in_words(const HeldOutGain& g) {
  if (g.nats.empty()) return "not known, no condition was held out";
  if (!std::isfinite(g.low))
    return fmt::format("{:.2f} nats on the one held-out condition: not supported, as one has no interval", g.mean);
  return fmt::format(
      "{:.2f} nats a condition [{:.2f}, {:.2f}] over {} conditions: {}", g.mean, g.low, g.high, g.nats.size(),
      g.adopted ? "adopted, as the interval excludes zero" : "not supported, as the interval does not exclude zero");
}

std::optional<std::size_t> nearest_rival(const Diagnosis& d, std::size_t candidate) {
  std::optional<std::size_t> nearest;
  const auto row = static_cast<Index>(candidate);
  for (Index j = 0; j < d.isolation.cols(); ++j)
    if (j != row && (!nearest || d.isolation(row, j) < d.isolation(row, static_cast<Index>(*nearest))))
      nearest = static_cast<std::size_t>(j);
  return nearest;
}

std::vector<std::pair<std::string, std::string>> report_tables(const DiagnosisReport& r) {
  const Diagnosis& d = r.result;
  const auto number = [](double v) { return std::isfinite(v) ? fmt::format("{}", v) : std::string(); };
  const auto use = [](Use u) { return u == Use::fit ? "fit" : u == Use::holdout ? "holdout" : "available"; };
  std::string misfit =
      "condition,quantity,position,unit,group,use,measured,sigma,simulated,simulated_sigma,z,recalibrated,recalibrated_"
      "sigma,z_recalibrated,with_cause,with_cause_sigma,numerics\n";
  for (std::size_t i = 0; i < d.misfits.size(); ++i) {
    const Datum& t = r.problem.data[i];
    const DatumMisfit& m = d.misfits[i];
    const ExtendedValue extended = r.with_cause.empty() ? ExtendedValue{std::nan(""), std::nan("")} : r.with_cause[i];
    misfit += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", t.condition, t.quantity,
                          number(t.position), t.unit, t.group, use(t.use), number(t.value), number(t.sigma),
                          number(m.simulated_before), number(m.sigma_before), number(m.z_before),
                          number(m.simulated_after), number(m.sigma_after), number(m.z_after), number(extended.value),
                          number(extended.sigma), r.numerics.empty() ? "" : number(r.numerics[i].difference));
  }
  std::string candidates =
      "candidate,unit,fitted_alone,q_alone,q_plain,detection_low,detection_high,sigma_at_end,nearest_rival,nearest_"
      "distance\n";
  for (std::size_t k = 0; k < r.problem.effects.size(); ++k) {
    const CandidateEffect& e = r.problem.effects[k];
    const std::optional<std::size_t> nearest = nearest_rival(d, k);
    candidates += fmt::format("{},{},{},{},{},{},{},{},{},{}\n", e.id, e.unit,
                              number(e.strength(d.singles[k].x[d.singles[k].x.size() - 1])), number(d.singles[k].q),
                              number(d.q0), number(d.detection[k].limit_low), number(d.detection[k].limit_high),
                              number(d.detection[k].d_at_end), nearest ? r.problem.effects[*nearest].id : "",
                              nearest ? number(d.isolation(static_cast<Index>(k), static_cast<Index>(*nearest))) : "");
  }
  std::string isolation = "truth";
  for (const CandidateEffect& e : r.problem.effects) isolation += "," + e.id;
  for (Index k = 0; k < d.isolation.rows(); ++k) {
    isolation += "\n" + r.problem.effects[static_cast<std::size_t>(k)].id;
    for (Index j = 0; j < d.isolation.cols(); ++j) isolation += "," + (j == k ? "" : number(d.isolation(k, j)));
  }
  isolation += '\n';
  std::string gain = "condition,gain_nats\n";
  for (std::size_t i = 0; i < d.gain.nats.size(); ++i)
    gain += fmt::format("{},{}\n", d.gain.conditions[i], number(d.gain.nats[i]));
  return {{"misfit.csv", misfit}, {"candidates.csv", candidates}, {"isolation.csv", isolation}, {"gain.csv", gain}};
}

std::string report_hdf5(const DiagnosisReport& r) {
  const Diagnosis& d = r.result;
  Hdf5Writer out;
  out.attribute("program_version", std::string(DRUMSWEEP_VERSION));
  out.attribute("campaign", r.campaign.name);
  out.attribute("verdict", std::string(to_text(d.verdict)));
  out.attribute("headline", headline(r));
  out.attribute("p_value", d.p_value);
  out.attribute("birge", d.birge);
  out.attribute("num_runs", static_cast<std::int64_t>(r.num_runs));
  std::vector<std::string> names, units, ids;
  std::vector<double> table;
  for (std::size_t i = 0; i < d.misfits.size(); ++i) {
    const DatumMisfit& m = d.misfits[i];
    names.push_back(name_of(r.problem.data[i]));
    units.push_back(r.problem.data[i].unit);
    table.insert(table.end(), {r.problem.data[i].value, r.problem.data[i].sigma, m.simulated_before, m.z_before,
                               m.simulated_after, m.z_after});
  }
  out.texts("misfit/names", names, "data");
  out.texts("misfit/units", units, "of the values");
  out.dataset("misfit/values", table, 6, "in units", "measured, sigma, simulated, z, recalibrated, z");
  std::vector<double> singles, isolation;
  for (std::size_t k = 0; k < r.problem.effects.size(); ++k) {
    ids.push_back(r.problem.effects[k].id);
    singles.insert(singles.end(),
                   {r.problem.effects[k].strength(d.singles[k].x[d.singles[k].x.size() - 1]), d.singles[k].q,
                    d.detection[k].limit_low, d.detection[k].limit_high, d.detection[k].d_at_end});
    for (Index j = 0; j < d.isolation.cols(); ++j) isolation.push_back(d.isolation(static_cast<Index>(k), j));
  }
  out.texts("candidates/ids", ids, "candidate causes");
  out.dataset("candidates/values", singles, 5, "in the candidates' units",
              "fitted alone, Q, detection limits, sigma at the end of the range");
  out.dataset("candidates/isolation", isolation, ids.size(), "1",
              "distance (truth x rival) in sigma where the truth is seen with 5 sigma");
  std::vector<std::string> causes;
  for (const Explanation& e : d.causes) causes.push_back(describe(r, e));
  if (!causes.empty()) out.texts("causes", causes, "the set, best first, with 95 % intervals");
  if (!d.gain.nats.empty()) {
    out.texts("gain/conditions", d.gain.conditions, "held out");
    out.dataset("gain/nats", d.gain.nats, 1, "nat", "log predictive density, extended over plain");
    out.attribute("mean", d.gain.mean, "gain");
    out.attribute("low", d.gain.low, "gain");
    out.attribute("high", d.gain.high, "gain");
  }
  return out.seal("diagnosis", 1);
}

std::string extended_name(std::size_t member) {
  return member == 0 ? "extended.toml" : fmt::format("extended_{}.toml", member + 1);
}

std::vector<std::pair<std::string, std::string>> extended_studies(const DiagnosisReport& r) {
  std::vector<std::pair<std::string, std::string>> out;
  if (r.campaign.study.empty()) return out;
  for (const Explanation& cause : r.result.causes) {
    const auto num_effects = static_cast<Index>(r.problem.effects.size()),
               num_parameters = static_cast<Index>(r.problem.parameters.size());
    Eigen::VectorXd p = Eigen::VectorXd::Zero(num_effects);
    for (const NamedEffect& n : cause.effects)
      p[n.effect] = r.problem.effects[static_cast<std::size_t>(n.effect)].inner(n.strength);
    Condition study;
    study.path = r.campaign.study;
    study.text = read_text(study.path);
    study.is_scene = is_scene_file(study.path);
    study.type = "study";
    if (study.is_scene)
      throw InputError(fmt::format("{}: study = {}: is a scene, not a study", r.campaign.path, r.campaign.study));
    const std::string text = extended_text(study, r.campaign.changes(study, cause.fit.x.head(num_parameters), p));
    std::string head = fmt::format("# {} extended by drumsweep diagnose, campaign \"{}\".\n# {}: {}\n",
                                   r.campaign.study, r.campaign.name, to_text(r.result.verdict), describe(r, cause));
    for (const NamedEffect& n : cause.effects) {
      const Candidate& c = r.campaign.candidates[static_cast<std::size_t>(n.effect)];
      if (!c.acts_on_input_of(study))
        head += fmt::format("# {} acts on nothing in this study: no key was changed for it.\n", c.effect.id);
    }
    head += fmt::format("# Gain on held-out conditions, of the best of the set: {}.\n", gain_in_words(r.result.gain));
    out.emplace_back(extended_name(out.size()), head + text);
  }
  return out;
}

std::vector<std::string> write_report(const DiagnosisReport& r, const std::string& folder) {
  std::vector<std::pair<std::string, std::string>> files = report_tables(r);
  files.insert(
      files.begin(),
      {{"diagnosis.txt", report_text(r)}, {"diagnosis.html", report_html(r)}, {"diagnosis.h5", report_hdf5(r)}});
  const auto studies = extended_studies(r);
  files.insert(files.end(), studies.begin(), studies.end());
  // A set that has become smaller leaves no member of the old one behind.
  for (std::size_t member = 0; member < 99; ++member) std::filesystem::remove(folder + "/" + extended_name(member));
  std::vector<std::string> paths;
  for (const auto& [name, bytes] : files) {
    paths.push_back(folder + "/" + name);
    write_durably(paths.back(), bytes);
  }
  return paths;
}

}  // namespace drumsweep

#include "diagnosis/report/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "core/config/toml_fields.h"
#include "core/io/durable_file.h"
#include "core/io/hdf5_image.h"
#include "core/scene/scene.h"
#include "diagnosis/campaign/second_wave.h"

namespace drumsweep {
namespace {

using Index = Eigen::Index;

constexpr double largest_numerics = 0.3;

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
  for (const std::string& note : second_wave_notes(r.problem, emulator, scaled.local)) r.notes.push_back(note);
  r.budget = runs_by_budget_law(emulator);
  if (static_cast<std::int64_t>(r.num_runs) < r.budget)
    r.notes.push_back(fmt::format(
        "{} runs are below the budget law's {} (9 coefficients (sigma_s / sigma_m)^2): {}; false alarms stay "
        "right",
        r.num_runs, r.budget,
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
  return r;
}

std::string describe(const DiagnosisReport& r, const Explanation& cause) {
  std::vector<std::string> list;
  for (const NamedEffect& n : cause.effects) {
    const CandidateEffect& e = r.problem.effects[static_cast<std::size_t>(n.effect)];
    list.push_back(fmt::format("{} {:.3g}{} [{:.3g}, {:.3g}]", e.id, n.strength, e.unit == "1" ? "" : " " + e.unit,
                               n.low, n.high));
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

std::string misfits_in_words(const DiagnosisReport& r) {
  std::vector<std::string> low, high;
  for (std::size_t i = 0; i < r.result.misfits.size(); ++i) {
    const Datum& d = r.problem.data[i];
    const DatumMisfit& m = r.result.misfits[i];
    if (d.use == Use::fit && std::abs(m.off_before) >= 2)
      (m.off_before > 0 ? low : high)
          .push_back(fmt::format("{} ({:.3g} instead of {:.3g} {})", name_of(d), m.simulated_before, d.value, d.unit));
  }
  std::vector<std::string> parts;
  if (!low.empty()) parts.push_back(fmt::format("simulation too low: {}", fmt::join(low, ", ")));
  if (!high.empty()) parts.push_back(fmt::format("simulation too high: {}", fmt::join(high, ", ")));
  return parts.empty() ? "no single number is off by 2 sigma or more" : fmt::format("{}", fmt::join(parts, "; "));
}

std::string next_measurement(const DiagnosisReport& r) {
  if (r.result.advice.empty()) return "";
  const Advice& a = r.result.advice.front();
  return fmt::format(
      "{}: its nearest members would then be {:.1f} sigma apart, so the truth would be told from the nearest rival "
      "with a "
      "probability of {:.0f} %",
      a.measurement, a.distance, 100 * a.power);
}

std::string report_text(const DiagnosisReport& r) {
  const Diagnosis& d = r.result;
  std::string out = fmt::format("{}\n{}\n\n", r.campaign.name, headline(r));
  for (const std::string& note : r.notes) out += fmt::format("note: {}\n", note);

  out += "\n1. Checks\n";
  std::size_t coarse = 0, unsure = 0;
  for (const NumericsCheck& c : r.numerics) {
    if (std::abs(c.in_sigma) <= largest_numerics) continue;
    if (std::abs(c.difference) < 2 * c.error) {
      ++unsure;
      continue;
    }
    ++coarse;
    out += fmt::format(
        "  NUMERICAL ERROR {}: half the time step and 4 x iterations change it by {:.3g} +- {:.2g} {}, {:.2f} sigma "
        "(accepted is 0.3)\n",
        name_of(r.problem.data[c.datum]), c.difference, c.error, r.problem.data[c.datum].unit, c.in_sigma);
  }
  if (unsure > 0)
    out += fmt::format(
        "  numerics: of {} more data {} pairs of runs do not say whether they change by more than {} sigma "
        "(numerics_runs)\n",
        unsure, r.campaign.numerics_runs, largest_numerics);
  if (!r.numerics.empty() && coarse + unsure == 0)
    out += fmt::format("  numerics: half the time step and 4 x iterations change no datum by more than {} sigma\n",
                       largest_numerics);
  for (std::size_t i = 0; i < r.problem.data.size(); ++i) {
    const Datum& datum = r.problem.data[i];
    if (datum.quantity != "axial_velocity" || datum.use != Use::fit || d.misfits.empty() ||
        std::abs(d.misfits[i].z_before) < 2)
      continue;
    out += fmt::format(
        "  conservation, {}: at equal feed the simulated {:.3g} m/s instead of {:.3g} m/s mean a fill of {:.2f} times "
        "the machine's, whatever "
        "the friction\n",
        datum.condition, d.misfits[i].simulated_before, datum.value, datum.value / d.misfits[i].simulated_before);
  }

  out += fmt::format(
      "\n2. What is wrong\n  p = {:.2g} (all data {:.2g}, towards a candidate {:.2g}); Q = {:.1f} of {} fitted data; "
      "all error bars would have to "
      "be x {:.2f} for the model to pass\n",
      d.p_value, d.p_omnibus, d.p_directed, d.q0, d.num_fitted_data, d.birge);
  out += "  " + misfits_in_words(r) + "\n";
  for (const GroupMisfit& g : d.groups)
    out += fmt::format("  {:<8} {:>3} data, chi2 {:>8.1f}, p = {:.2g}{}\n", g.group, g.num_data, g.chi2, g.p,
                       g.p < 0.01 ? "  <- misfits" : "");
  for (std::size_t j = 0; j < r.problem.parameters.size() && !d.theta_z.empty(); ++j) {
    const FreeParameter& p = r.problem.parameters[j];
    out += fmt::format("  {} recalibrated to {:.4g} (bench {:.4g} +- {:.2g} {}), z = {:.1f}\n", p.id,
                       p.mean + p.sigma * d.plain.x[static_cast<Index>(j)], p.mean, p.sigma, p.unit, d.theta_z[j]);
  }
  if (d.at_edge)
    out += "  a parameter lies at the edge of what the campaign covers: widen its sigma, or doubt its bench value\n";
  out += fmt::format("  {:<44}{:>12}{:>11}{:>12}{:>8}{:>12}{:>8}\n", "", "measured", "sigma", "simulated", "z",
                     "recalibr.", "z");
  for (std::size_t i = 0; i < d.misfits.size(); ++i) {
    const Datum& datum = r.problem.data[i];
    const DatumMisfit& m = d.misfits[i];
    if (datum.use == Use::available || datum.use == Use::ignored) continue;
    out +=
        fmt::format("  {:<44}{:>12.4g}{:>11.2g}{:>12.4g}{:>8.1f}{:>12.4g}{:>8.1f}  {}{}{}\n", name_of(datum),
                    datum.value, datum.sigma, m.simulated_before, m.z_before, m.simulated_after, m.z_after, datum.unit,
                    std::abs(m.z_before) < 2 ? ""
                    : m.z_before > 0         ? ", simulation too low"
                                             : ", simulation too high",
                    datum.use == Use::holdout ? " (held out)" : "");
  }

  out += "\n3. The cause\n  " + headline(r) + "\n";
  for (const Explanation& e : d.causes) {
    out += fmt::format("  - {}: Q {:.1f} (plain model {:.1f}), weight {:.2f}", describe(r, e), e.q, d.q0, e.weight);
    if (!std::isnan(e.held_out_p))
      out += fmt::format("; held-out conditions: p = {:.2g}, {:+.1f} nats", e.held_out_p, e.held_out_nats);
    out += '\n';
  }
  for (const Explanation& e : d.refused)
    out += fmt::format(
        "  refused by the held-out conditions, or only possible at the end of its range: {} (p = {:.2g}, {:+.1f} "
        "nats)\n",
        describe(r, e), e.held_out_p, e.held_out_nats);
  if (d.verdict == Verdict::none_of_these)
    for (std::size_t k = 0; k < d.pattern_cosine.size(); ++k)
      if (std::abs(d.pattern_cosine[k]) > 0.5)
        out += fmt::format("  the misfit resembles {} (cosine {:.2f}); a hint, not a name\n", r.problem.effects[k].id,
                           d.pattern_cosine[k]);
  for (const Twins& t : d.twins)
    out += fmt::format(
        "  {} and {} {}\n", r.problem.effects[static_cast<std::size_t>(t.a)].id,
        r.problem.effects[static_cast<std::size_t>(t.b)].id,
        t.exact ? "cannot be told apart by these data at all: one is named, both are meant"
                : fmt::format("are near twins: {:.1f} sigma apart where they would just be seen", t.distance));
  if (const std::string next = next_measurement(r); !next.empty()) out += "  measure next " + next + "\n";
  for (const Advice& a : d.advice)
    out += fmt::format("    {:<40} {:>6.1f} sigma, {:>3.0f} %\n", a.measurement, a.distance, 100 * a.power);
  if (!d.detection.empty()) out += "  what these data would have seen (9 times in 10):\n";
  for (std::size_t k = 0; k < d.detection.size(); ++k) {
    const CandidateEffect& e = r.problem.effects[k];
    const Detection& limit = d.detection[k];
    std::string text;
    if (limit.d_at_end < 1)
      text = fmt::format("nothing here sees it: {:.2f} sigma at the end of its range", limit.d_at_end);
    else if (std::isnan(limit.limit_low) && std::isnan(limit.limit_high))
      text = fmt::format("not within its range ({:.1f} sigma at its end)", limit.d_at_end);
    else if (std::isnan(limit.limit_low))
      text = fmt::format("above {:.3g} {}", limit.limit_high, e.unit);
    else if (std::isnan(limit.limit_high))
      text = fmt::format("below {:.3g} {}", limit.limit_low, e.unit);
    else
      text = fmt::format("below {:.3g} or above {:.3g} {}", limit.limit_low, limit.limit_high, e.unit);
    out += fmt::format("    {:<30} {}\n", e.id, text);
  }

  out += "\n4. The extension\n";
  const auto studies = extended_studies(r);
  for (const auto& [name, text] : studies) out += fmt::format("  {}\n", name);
  if (studies.empty())
    out += d.causes.empty() ? "  none: no cause was found\n" : "  none: the campaign names no study\n";

  out += "\n5. The gain, on held-out conditions\n";
  const HeldOutGain& g = d.gain;
  if (g.nats.empty()) {
    out += d.causes.empty() ? "  none: nothing was extended\n" : "  not known: no condition was held out\n";
  } else {
    out += fmt::format("  {:.2f} nats a condition [{:.2f}, {:.2f}] over {} conditions: {}\n", g.mean, g.low, g.high,
                       g.nats.size(), g.adopted ? "adopted" : "not supported (the interval does not exclude zero)");
    if (g.nats.size() < 6) out += "  fewer than 6 held-out conditions hardly ever prove a gain\n";
    for (std::size_t i = 0; i < g.nats.size(); ++i)
      out += fmt::format("    {:<30} {:+.2f}\n", g.conditions[i], g.nats[i]);
    out += fmt::format("  root mean square z {:.2f} -> {:.2f}; 90 % bands hold {:.0f} % -> {:.0f} %\n", g.rms_z_before,
                       g.rms_z_after, 100 * g.coverage_before, 100 * g.coverage_after);
    for (const HeldOutGain::Quantity& q : g.quantities)
      out += fmt::format("    {:<30} {:.3g} -> {:.3g} {} (root mean square difference)\n", q.quantity, q.rms_before,
                         q.rms_after, q.unit);
  }
  out += "\n6. What it changes\n";
  if (r.change)
    out += describe(*r.change);
  else if (studies.empty())
    out += "  nothing: there is no extended study\n";
  else
    out +=
        "  not known yet: run the study and extended.toml (`drumsweep run`) and give both folders (--before, "
        "--after)\n";
  return out;
}

std::vector<std::pair<std::string, std::string>> report_tables(const DiagnosisReport& r) {
  const Diagnosis& d = r.result;
  const auto number = [](double v) { return std::isfinite(v) ? fmt::format("{}", v) : std::string(); };
  const auto use = [](Use u) { return u == Use::fit ? "fit" : u == Use::holdout ? "holdout" : "available"; };
  std::string misfit =
      "condition,quantity,position,unit,group,use,measured,sigma,simulated,simulated_sigma,z,recalibrated,recalibrated_"
      "sigma,z_recalibrated,numerics\n";
  for (std::size_t i = 0; i < d.misfits.size(); ++i) {
    const Datum& t = r.problem.data[i];
    const DatumMisfit& m = d.misfits[i];
    misfit += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", t.condition, t.quantity, number(t.position),
                          t.unit, t.group, use(t.use), number(t.value), number(t.sigma), number(m.simulated_before),
                          number(m.sigma_before), number(m.z_before), number(m.simulated_after), number(m.sigma_after),
                          number(m.z_after), r.numerics.empty() ? "" : number(r.numerics[i].difference));
  }
  std::string candidates =
      "candidate,unit,fitted_alone,q_alone,q_plain,detection_low,detection_high,sigma_at_end,nearest_rival,nearest_"
      "distance\n";
  for (std::size_t k = 0; k < r.problem.effects.size(); ++k) {
    const CandidateEffect& e = r.problem.effects[k];
    Index nearest = -1;
    for (Index j = 0; j < d.isolation.cols(); ++j)
      if (j != static_cast<Index>(k) &&
          (nearest < 0 || d.isolation(static_cast<Index>(k), j) < d.isolation(static_cast<Index>(k), nearest)))
        nearest = j;
    candidates += fmt::format(
        "{},{},{},{},{},{},{},{},{},{}\n", e.id, e.unit, number(e.strength(d.singles[k].x[d.singles[k].x.size() - 1])),
        number(d.singles[k].q), number(d.q0), number(d.detection[k].limit_low), number(d.detection[k].limit_high),
        number(d.detection[k].d_at_end), nearest < 0 ? "" : r.problem.effects[static_cast<std::size_t>(nearest)].id,
        nearest < 0 ? "" : number(d.isolation(static_cast<Index>(k), nearest)));
  }
  std::string gain = "condition,gain_nats\n";
  for (std::size_t i = 0; i < d.gain.nats.size(); ++i)
    gain += fmt::format("{},{}\n", d.gain.conditions[i], number(d.gain.nats[i]));
  return {{"misfit.csv", misfit}, {"candidates.csv", candidates}, {"gain.csv", gain}};
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

std::vector<std::pair<std::string, std::string>> extended_studies(const DiagnosisReport& r) {
  std::vector<std::pair<std::string, std::string>> out;
  if (r.campaign.study.empty()) return out;
  std::size_t number = 0;
  for (const Explanation& cause : r.result.causes) {
    ++number;
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
    head += fmt::format("# Gain on held-out conditions: {:.2f} nats a condition [{:.2f}, {:.2f}], {}.\n",
                        r.result.gain.mean, r.result.gain.low, r.result.gain.high,
                        r.result.gain.adopted ? "adopted" : "not supported");
    out.emplace_back(number == 1 ? "extended.toml" : fmt::format("extended_{}.toml", number), head + text);
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
  for (int number = 1; number < 100; ++number)
    std::filesystem::remove(number == 1 ? folder + "/extended.toml"
                                        : fmt::format("{}/extended_{}.toml", folder, number));
  std::vector<std::string> paths;
  for (const auto& [name, bytes] : files) {
    paths.push_back(folder + "/" + name);
    write_durably(paths.back(), bytes);
  }
  return paths;
}

}  // namespace drumsweep

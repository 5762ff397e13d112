/// The answer: header, the optimum with its evidence, the bed it makes.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "postproc/report/chart.h"
#include "postproc/report/html.h"
#include "sweep/report/sections.h"
#include "sweep/report/wording.h"

namespace drumsweep {
namespace {

constexpr double stop_limit = 0.1;  // S1: all |a_n| <= a_0 / 10

std::string stop_words(const Answer& a) {
  if (!a.max_an_over_a0) return "";
  const bool passed = *a.max_an_over_a0 <= stop_limit;
  return fmt::format(
      " The paper’s stop test, every Fourier mode of the bed at most a tenth of the mean, is "
      "<b class=\"{}\">{}</b> there (largest {}).",
      passed ? "pass" : "fail", passed ? "passed" : "not passed", plain(*a.max_an_over_a0, 3));
}

std::string lead_html(const ReportData& data) {
  const Answer& a = data.answer;
  if (a.kind == Answer::Kind::none) return "No design has a result yet, so there is nothing to compare.";
  const std::string place = escaped(place_text(a.at)), f = millimetres(a.f_m, a.sigma_m);
  const std::string so_far = data.status.finished ? "" : " so far";
  switch (a.kind) {
    case Answer::Kind::confirmed:
      return fmt::format("The most even bed{} is that of {}: <b>f = {}</b>, confirmed by {}.{}", so_far, place, f,
                         counted(static_cast<std::size_t>(a.num_runs), "fresh run"), stop_words(a));
    case Answer::Kind::fit:
      return fmt::format(
          "The most even bed{} is expected at {}: <b>f = {}</b>, from a fit through {}; no fresh runs have confirmed "
          "it.",
          so_far, place, f, counted(static_cast<std::size_t>(a.num_runs), "run"));
    default:
      return fmt::format("The most even bed of a single run{} is that of {}: <b>f = {}</b>{}.{}", so_far, place, f,
                         a.untrusted ? ", <b class=\"fail\">which is not to be trusted</b>" : "", stop_words(a));
  }
}

std::string banner_html(const ReportData& data) {
  const SweepStatus& s = data.status;
  const std::size_t ended = s.rows.size();
  std::string text;
  if (!s.finished) {
    text += fmt::format("<b>This sweep is not finished.</b> {} of {} known designs have ended", ended, s.total);
    const bool more = std::any_of(s.stages.begin(), s.stages.end(), [](const StageStatus& i) { return !i.complete; });
    if (more) text += ", and searches will ask for more";
    text += s.active ? "; a run is going on."
                     : "; no run is going on. The command at the end of this page goes on with it.";
    text += " Everything below may change.";
  }
  const std::size_t impossible = static_cast<std::size_t>(std::count_if(
      data.plan.designs.begin(), data.plan.designs.end(), [](const auto& d) { return !d.impossible.empty(); }));
  if (s.state.failed > impossible)
    text += fmt::format("{}{} failed; see <a href=\"#trouble\">below</a>.", text.empty() ? "" : " ",
                        counted(s.state.failed - impossible, "design"));
  if (s.state.untrusted > 0)
    text += fmt::format("{}{} should not be trusted; see <a href=\"#trouble\">below</a>.", text.empty() ? "" : " ",
                        counted(s.state.untrusted, "result"));
  return text.empty() ? "" : fmt::format("<p class=\"banner\" role=\"status\">{}</p>\n", text);
}

std::string stat(const std::string& name, const std::string& value, const std::string& note) {
  return fmt::format("<div><dt>{}</dt><dd>{}<small>{}</small></dd></div>\n", name, value, note);
}

std::string range_text(const ReportData& data, std::size_t i) {
  const Quantity q = quantity_of(data.answer.at[i].first);
  return fmt::format("{} to {}", with_unit(data.answer.region_95[i].first, q.unit, 3),
                     with_unit(data.answer.region_95[i].second, q.unit, 3));
}

/// An optimum at the end of what was searched is not one: said, so that somebody looks beyond.
std::string end_of_range(const std::optional<Findings>& findings, std::size_t variable) {
  return findings ? at_end_of_range(*findings, variable) : "";
}

/// Height of the bed across the belt with its error, and the two windows.
std::string profile_chart(const DetailedDesign& d) {
  const Profile& profile = d.evaluation.belt;
  const std::vector<double> sigma = standard_error(d.evaluation.belt_blocks);
  std::vector<ChartPoint> mean, low, high;
  std::vector<double> heights = {0};
  for (std::size_t i = 0; i < profile.height_m.size(); ++i) {
    const double y = profile.centre_m(i), h = 1000 * profile.height_m[i], e = 1000 * sigma[i];
    mean.push_back({y, h, 0, fmt::format("{} m across the belt\n{:.2f} ± {:.2f} mm", plain(y, 3), h, e)});
    low.push_back({y, h - e, 0, ""});
    high.push_back({y, h + e, 0, ""});
    heights.push_back(h + e);
  }
  Chart chart("Height of the bed across the belt", {"place across the belt (m)", 0, d.study.belt.width_m},
              axis_over("mean height (mm)", heights, true));
  const double begin = d.evaluation.footprint.y_begin_m;
  const double end =
      begin + d.evaluation.footprint.cell_m * static_cast<double>(d.evaluation.footprint.height_m.size());
  chart.stripe(begin, end, "under the outlet", true);
  chart.band(low, high, "a");
  chart.line(mean, "a");
  chart.points(mean, "a", "circle", 2.2);
  chart.rule(1000 * d.evaluation.objective.mean_height_m, "mean of the belt", "dash", Chart::RuleText::left_above);
  return figure(chart.svg(),
                "Height of the bed across the belt, mean over the recorded turns; the band is one standard "
                "error from blocks of one slot’s passage.");
}

std::string spectrum_chart(const DetailedDesign& d) {
  const bool on_footprint = d.study.objective.window == "footprint";
  const std::vector<double>& a = on_footprint ? d.evaluation.footprint_amplitudes_m : d.evaluation.belt_amplitudes_m;
  if (a.size() < 2 || !(a[0] > 0)) return "";
  std::vector<ChartPoint> modes;
  std::vector<double> values = {1.2 * stop_limit};
  for (std::size_t n = 1; n < a.size(); ++n) {
    modes.push_back(
        {static_cast<double>(n), a[n] / a[0], 0, fmt::format("mode {}: |aₙ| / a₀ = {}", n, plain(a[n] / a[0], 3))});
    values.push_back(a[n] / a[0]);
  }
  Chart chart("Fourier modes of the bed's profile",
              {"mode number n", 0.2, static_cast<double>(a.size()) - 0.2, {}, true},
              axis_over("|aₙ| / a₀", values, true));
  for (const ChartPoint& m : modes) chart.bar(m.x - 0.32, m.x + 0.32, 0, m.y, m.y > stop_limit ? "b" : "a", m.tip);
  // In the key: beside the line it would lie on the bars.
  chart.rule(stop_limit, "", "limit");
  chart.legend("stop test: a₀ / 10", "limit", "line");
  return figure(chart.svg(), fmt::format("Fourier modes of that profile over its mean ({}); the paper asks for all of "
                                         "them below the line.",
                                         on_footprint ? "on the outlet’s footprint" : "on the whole belt"));
}

}  // namespace

std::string header_html(const ReportData& data) {
  const SweepStatus& s = data.status;
  std::string strip;
  if (data.answer.kind != Answer::Kind::none) {
    strip += stat("Unevenness <i>f</i>", millimetres(data.answer.f_m, data.answer.sigma_m), "± one standard error");
    for (std::size_t i = 0; i < data.answer.at.size() && i < 3; ++i) {
      const Quantity q = quantity_of(data.answer.at[i].first);
      if (q.name == "replicate" || q.name == "turns") continue;
      strip += stat(escaped(q.name), escaped(with_unit(data.answer.at[i].second, q.unit)),
                    data.answer.region_95.empty() ? "" : escaped("95 %: " + range_text(data, i)));
    }
  }
  std::string states = fmt::format("{} done", s.state.done);
  if (s.state.untrusted > 0) states += fmt::format(", {} untrusted", s.state.untrusted);
  if (s.state.failed > 0) states += fmt::format(", {} failed", s.state.failed);
  strip += stat("Designs", fmt::format("{} of {}", s.rows.size(), s.total), states);
  strip += stat("Cost", core_time(s.cpu_s), counted(s.timeline.size(), "run"));
  return fmt::format("<h1>{}</h1>\n{}<p class=\"lead\">{}</p>\n<dl class=\"strip\">\n{}</dl>", escaped(data.study.name),
                     banner_html(data), lead_html(data), strip);
}

std::string answer_html(ReportData& data) {
  const Answer& a = data.answer;
  if (a.kind == Answer::Kind::none) return "<p>There is no optimum before a design has a result.</p>\n";
  std::vector<std::pair<std::string, std::string>> facts;
  for (std::size_t i = 0; i < a.at.size(); ++i) {
    const Quantity q = quantity_of(a.at[i].first);
    facts.emplace_back(
        q.name, escaped(with_unit(a.at[i].second, q.unit)) +
                    (a.region_95.empty() ? ""
                                         : escaped(fmt::format("; the optimum lies in {} with 95 %{}",
                                                               range_text(data, i), end_of_range(data.findings, i)))));
  }
  facts.emplace_back("f there", millimetres(a.f_m, a.sigma_m));
  if (data.findings) {
    const Findings& f = *data.findings;
    if (f.optimum && a.kind == Answer::Kind::confirmed)
      facts.emplace_back("f of the fit", millimetres(f.optimum->f_m, f.optimum->sigma_m) +
                                             ", at its own lowest point; the fresh runs were not known when the design "
                                             "was chosen");
    if (const auto& c = f.confirmation) {
      facts.emplace_back("fresh runs",
                         fmt::format("{}, with random numbers that no earlier choice has seen", c->num_runs));
      if (c->below_tolerance)
        facts.emplace_back(
            "asked for",
            fmt::format("f below {}: <b class=\"{}\">{}</b>", millimetres(data.study.refine.tolerance_f_m, 0),
                        *c->below_tolerance ? "pass" : "fail", *c->below_tolerance ? "reached" : "not reached"));
    }
    facts.emplace_back("fitted surface", escaped(f.gate.reason));
  }
  if (a.max_an_over_a0)
    facts.emplace_back("largest mode over the mean",
                       fmt::format("{} (stop test: at most {})", plain(*a.max_an_over_a0, 3), stop_limit));
  std::string html = fact_table(facts);
  if (a.kind == Answer::Kind::single_run)
    html +=
        "<p>The lowest of many noisy values is lower than the truth: repeat it with a stage of type "
        "<code>replicate</code> before it is built.</p>\n";
  if (!data.best)
    return html +
           fmt::format("<p>The bed there cannot be shown: {}.</p>\n",
                       data.unreadable.empty()
                           ? "no design near it has landings"
                           : fmt::format("the landings of design <code>{}</code>, the nearest, cannot be read; see "
                                         "<a href=\"#trouble\">below</a>",
                                         escaped(data.unreadable.front().first)));
  const Objective& o = data.best->evaluation.objective;
  html += fmt::format(
      "<h3>Its bed</h3>\n<p>Design <code>{}</code>{}: {} on the whole belt, {} under the outlet alone; mean height {}, "
      "{} balls landed{}.</p>\n",
      escaped(data.best->row.design_id),
      a.kind == Answer::Kind::single_run ? "" : ", one run at or next to the optimum",
      millimetres(o.f_belt_m, o.sigma_f_belt_m), millimetres(o.f_footprint_m, o.sigma_f_footprint_m),
      millimetres(o.mean_height_m, 0), o.landed,
      o.spilled > 0 ? fmt::format(", {} fell past the belt’s open edge", o.spilled) : "");
  html += "<div class=\"figures best\">\n<div class=\"pair\">\n" + profile_chart(*data.best) +
          spectrum_chart(*data.best) + "</div>\n" +
          sample_html(*data.best, "best-", "Where its balls landed, and the bed they made.", true, data) + "</div>\n";
  return html;
}

}  // namespace drumsweep

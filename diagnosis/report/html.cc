/// The page: one file, nothing fetched, light and dark, fit for paper.
#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "diagnosis/report/report.h"

namespace drumsweep {
namespace {

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

/// A name that may go on in the next line after an underscore.
std::string breakable(const std::string& name) {
  std::string out;
  for (const char c : name) out += c == '_' ? std::string("_<wbr>") : std::string(1, c);
  return out;
}

constexpr const char* style = R"css(
:root{color-scheme:light dark;--ink:#1a1f24;--paper:#fff;--soft:#5b6670;--line:#d5dbe0;--low:33,102,172;--high:178,60,20;--panel:#f4f6f8}
@media (prefers-color-scheme:dark){:root{--ink:#e6eaee;--paper:#14181c;--soft:#9aa6b1;--line:#39424b;--low:96,165,235;--high:235,130,80;--panel:#1d2329}}
*{box-sizing:border-box}
body{margin:0 auto;max-width:64rem;padding:1.5rem 1rem 3rem;font:16px/1.5 system-ui,sans-serif;color:var(--ink);background:var(--paper)}
h1{font-size:1.5rem;margin:0 0 .25rem;line-height:1.25}h2{font-size:1.15rem;margin:2.2rem 0 .6rem;border-bottom:1px solid var(--line);padding-bottom:.2rem}
.verdict{background:var(--panel);border-left:.35rem solid rgb(var(--high));padding:.8rem 1rem;margin:1rem 0;font-size:1.05rem}
.verdict.fine{border-color:rgb(var(--low))}
.soft,small{color:var(--soft)}
.wide{overflow-x:auto;margin:.8rem 0}
table{border-collapse:collapse;width:100%;font-size:.88rem;font-variant-numeric:tabular-nums}
th,td{padding:.25rem .55rem;text-align:right;border-bottom:1px solid var(--line);white-space:nowrap}
th{font-weight:600;vertical-align:bottom;white-space:normal}th:first-child,td:first-child,.text{text-align:left}
td.z{min-width:4.2rem}
svg{display:block;width:100%;height:auto;max-width:44rem}svg text{fill:var(--ink);font:12px system-ui,sans-serif}
@media print{:root{--ink:#000;--paper:#fff;--soft:#444;--line:#bbb;--panel:#f4f4f4;--low:33,102,172;--high:178,60,20}body{max-width:none;padding:0;font-size:10pt}h2{break-after:avoid}tr,svg{break-inside:avoid}td{-webkit-print-color-adjust:exact;print-color-adjust:exact}}
)css";

/// A z value; its cell is shaded from 2 sigma on, and an arrow says which way the simulation is off, so that colour is not needed.
std::string z_cell(double z) {
  if (std::isnan(z)) return "<td class=\"z\"></td>";
  const double strength = std::clamp((std::abs(z) - 1) / 6, 0.0, 0.75);
  return fmt::format("<td class=\"z\" style=\"background:rgba(var(--{}),{:.2f})\">{}{:+.1f}</td>",
                     z > 0 ? "low" : "high", std::abs(z) < 2 ? 0.0 : strength,
                     std::abs(z) < 2 ? ""
                     : z > 0         ? "▼ "
                                     : "▲ ",
                     z);
}

std::string misfit_table(const DiagnosisReport& r) {
  std::string out =
      "<div class=\"wide\"><table><thead><tr><th>condition, "
      "quantity</th><th>measured</th><th>simulated</th><th>z</th><th>recalibrated</th>"
      "<th>z</th><th class=\"text\">unit</th><th class=\"text\">group</th></tr></thead><tbody>\n";
  for (std::size_t i = 0; i < r.result.misfits.size(); ++i) {
    const Datum& d = r.problem.data[i];
    const DatumMisfit& m = r.result.misfits[i];
    if (d.use != Use::fit && d.use != Use::holdout) continue;
    out += fmt::format(
        "<tr><td>{}{}</td><td>{:.4g} ± {:.2g}</td><td>{:.4g}</td>{}<td>{:.4g}</td>{}<td class=\"text\">{}</td><td "
        "class=\"text\">{}</td></tr>\n",
        escaped(name_of(d)), d.use == Use::holdout ? " <small>(held out)</small>" : "", d.value, d.sigma,
        m.simulated_before, z_cell(m.z_before), m.simulated_after, z_cell(m.z_after), escaped(d.unit),
        escaped(d.group));
  }
  return out +
         "</tbody></table></div>\n<p class=\"soft\">z: measured − simulated in standard errors of the difference. ▼ "
         "the simulation is too low, ▲ too high; "
         "shaded from 2 on.</p>\n";
}

/// Condition by quantity, z after recalibration.
std::string heat_map(const DiagnosisReport& r) {
  std::vector<std::string> conditions, quantities;
  std::map<std::pair<std::string, std::string>, double> worst;
  for (std::size_t i = 0; i < r.result.misfits.size(); ++i) {
    const Datum& d = r.problem.data[i];
    if (d.use != Use::fit && d.use != Use::holdout) continue;
    if (std::find(conditions.begin(), conditions.end(), d.condition) == conditions.end())
      conditions.push_back(d.condition);
    if (std::find(quantities.begin(), quantities.end(), d.quantity) == quantities.end())
      quantities.push_back(d.quantity);
    double& z = worst[{d.condition, d.quantity}];
    if (std::abs(r.result.misfits[i].z_after) > std::abs(z)) z = r.result.misfits[i].z_after;
  }
  std::string out = "<div class=\"wide\"><table><thead><tr><th>z after recalibration</th>";
  for (const std::string& q : quantities) out += fmt::format("<th>{}</th>", breakable(escaped(q)));
  out += "</tr></thead><tbody>\n";
  for (const std::string& c : conditions) {
    out += fmt::format("<tr><td>{}</td>", escaped(c));
    for (const std::string& q : quantities) {
      const auto found = worst.find({c, q});
      out += z_cell(found == worst.end() ? std::nan("") : found->second);
    }
    out += "</tr>\n";
  }
  return out + "</tbody></table></div>\n<p class=\"soft\">Of a quantity with positions, the largest.</p>\n";
}

/// Gains of the held-out conditions as bars, with mean and interval.
std::string gain_figure(const HeldOutGain& g) {
  const double width = 700, left = 210, right = 20, row = 22, top = 12;
  double low = std::min(0.0, std::isnan(g.low) ? 0.0 : g.low), high = std::max(0.0, std::isnan(g.high) ? 0.0 : g.high);
  for (const double n : g.nats) {
    low = std::min(low, n);
    high = std::max(high, n);
  }
  if (!(high > low)) return "";
  const auto x = [&](double v) { return left + (v - low) / (high - low) * (width - left - right - 60); };
  const double height = top + row * static_cast<double>(g.nats.size() + 1) + 24;
  std::string out = fmt::format(
      "<svg viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"gain of each held-out condition\">\n", width, height);
  double y = top;
  for (std::size_t i = 0; i < g.nats.size(); ++i, y += row)
    out += fmt::format(
        "<text x=\"{}\" y=\"{}\" text-anchor=\"end\">{}</text><rect x=\"{:.1f}\" y=\"{}\" width=\"{:.1f}\" "
        "height=\"12\" fill=\"rgba(var(--low),.65)\"/>"
        "<text x=\"{:.1f}\" y=\"{}\">{:+.2f}</text>\n",
        left - 10, y + 12, escaped(g.conditions[i]), std::min(x(0), x(g.nats[i])), y + 2, std::abs(x(g.nats[i]) - x(0)),
        std::max(x(0), x(g.nats[i])) + 6, y + 12, g.nats[i]);
  if (!std::isnan(g.low))
    out += fmt::format(
        "<text x=\"{0}\" y=\"{1}\" text-anchor=\"end\" font-weight=\"bold\">mean, 95 %</text><path d=\"M{2:.1f} "
        "{3}H{4:.1f}M{2:.1f} {5}v10M{4:.1f} {5}v10\" "
        "stroke=\"currentColor\" stroke-width=\"1.5\" fill=\"none\"/><circle cx=\"{6:.1f}\" cy=\"{3}\" r=\"4\" "
        "fill=\"currentColor\"/>\n",
        left - 10, y + 12, x(g.low), y + 8, x(g.high), y + 3, x(g.mean));
  out += fmt::format(
      "<path d=\"M{0:.1f} {1}V{2}\" stroke=\"currentColor\" stroke-width=\"1\"/><text x=\"{0:.1f}\" y=\"{3}\" "
      "text-anchor=\"middle\">0 nats</text></svg>\n",
      x(0), top - 4, height - 20, height - 6);
  return out;
}

std::string candidate_table(const DiagnosisReport& r) {
  std::string out =
      "<div class=\"wide\"><table><thead><tr><th>candidate</th><th>fitted alone</th><th>Q</th><th>seen from</th><th>at "
      "the end of its range</th>"
      "<th class=\"text\">nearest rival</th></tr></thead><tbody>\n";
  const Diagnosis& d = r.result;
  for (std::size_t k = 0; k < r.problem.effects.size() && k < d.detection.size(); ++k) {
    const CandidateEffect& e = r.problem.effects[k];
    const Detection& limit = d.detection[k];
    const auto row = static_cast<Eigen::Index>(k);
    Eigen::Index nearest = -1;
    for (Eigen::Index j = 0; j < d.isolation.cols(); ++j)
      if (j != row && (nearest < 0 || d.isolation(row, j) < d.isolation(row, nearest))) nearest = j;
    const std::string unit = e.unit == "1" ? "" : " " + escaped(e.unit);
    std::string seen = "not in its range";
    if (!std::isnan(limit.limit_high)) seen = fmt::format("{:.3g}{}", limit.limit_high, unit);
    if (!std::isnan(limit.limit_low))
      seen = std::isnan(limit.limit_high) ? fmt::format("{:.3g}{}", limit.limit_low, unit)
                                          : fmt::format("{:.3g} or {}", limit.limit_low, seen);
    if (limit.d_at_end < 1) seen = "nothing here sees it";
    out += fmt::format(
        "<tr><td title=\"{}\">{}</td><td>{:.3g}{}</td><td>{:.1f}</td><td>{}</td><td>{:.1f} σ</td><td "
        "class=\"text\">{}</td></tr>\n",
        escaped(e.about), escaped(e.id), e.strength(d.singles[k].x[d.singles[k].x.size() - 1]), unit, d.singles[k].q,
        seen, limit.d_at_end,
        nearest < 0 ? ""
                    : fmt::format("{}, {:.1f} σ", escaped(r.problem.effects[static_cast<std::size_t>(nearest)].id),
                                  d.isolation(row, nearest)));
  }
  return out + fmt::format(
                   "</tbody></table></div>\n<p class=\"soft\">Q of the plain model: {:.1f}. Seen from: the strength "
                   "that is found in 9 of 10 campaigns like this one. "
                   "Nearest rival: how far it stays, after refitting, where the candidate is 5 σ strong.</p>\n",
                   d.q0);
}

}  // namespace

std::string report_html(const DiagnosisReport& r) {
  const Diagnosis& d = r.result;
  std::string out = fmt::format(
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
      "content=\"width=device-width,initial-scale=1\">"
      "<title>{0}: diagnosis</title><style>{1}</style></head><body>\n<h1>{0}</h1>\n<p class=\"soft\">What the "
      "simulation gets wrong, why, and what is gained. "
      "{2} simulated runs, {3} fitted data.</p>\n<p class=\"verdict{4}\">{5}</p>\n",
      escaped(r.campaign.name), style, r.num_runs, d.num_fitted_data,
      d.verdict == Verdict::nothing_wrong ? " fine" : "", escaped(headline(r)));
  if (const std::string next = next_measurement(r); !next.empty())
    out += fmt::format("<p><strong>Measure next</strong> {}.</p>\n", escaped(next));
  for (const std::string& note : r.notes) out += fmt::format("<p class=\"soft\">{}</p>\n", escaped(note));

  // The six steps: those with numbers in columns as tables, the others as the text has them.
  const std::string text = report_text(r);
  const auto section = [&](const std::string& begin, const std::string& end) {
    const std::size_t from = text.find("\n" + begin), to = end.empty() ? text.size() : text.find("\n" + end);
    const std::size_t body = text.find('\n', from + 1) + 1;
    std::string lines;
    std::string list = text.substr(body, to == std::string::npos || to < body ? std::string::npos : to - body);
    for (std::size_t at = 0; at < list.size();) {
      const std::size_t stop = std::min(list.find('\n', at), list.size());
      const std::string line = list.substr(at, stop - at);
      at = stop + 1;
      if (line.find_first_not_of(' ') != std::string::npos) lines += "<p>" + escaped(line) + "</p>\n";
    }
    return lines;
  };
  out += "<h2>1. Checks</h2>\n" + section("1. Checks", "2. What is wrong");
  out += "<h2>2. What is wrong</h2>\n";
  out += fmt::format(
      "<p>p = {:.2g} (all data {:.2g}, towards a candidate {:.2g}). All error bars would have to be × {:.2f} for the "
      "model to pass.</p>\n",
      d.p_value, d.p_omnibus, d.p_directed, d.birge);
  out += "<p>" + escaped(misfits_in_words(r)) + ".</p>\n";
  out +=
      "<div class=\"wide\"><table><thead><tr><th>group</th><th>data</th><th>chi²</th><th>p</th></tr></thead><tbody>\n";
  for (const GroupMisfit& g : d.groups)
    out += fmt::format("<tr><td>{}</td><td>{}</td><td>{:.1f}</td><td>{:.2g}{}</td></tr>\n", escaped(g.group),
                       g.num_data, g.chi2, g.p, g.p < 0.01 ? " misfits" : "");
  out += "</tbody></table></div>\n" + heat_map(r) + misfit_table(r);
  out += "<h2>3. The cause</h2>\n";
  for (const Explanation& e : d.causes) {
    out +=
        fmt::format("<p>{}: Q {:.1f} instead of {:.1f}, weight {:.2f}", escaped(describe(r, e)), e.q, d.q0, e.weight);
    if (!std::isnan(e.held_out_p))
      out += fmt::format("; held-out conditions: p = {:.2g}, {:+.1f} nats", e.held_out_p, e.held_out_nats);
    out += ".</p>\n";
  }
  for (const Explanation& e : d.refused)
    out += fmt::format(
        "<p>Refused by the held-out conditions, or only possible at the end of its range: {} (p = {:.2g}, {:+.1f} "
        "nats).</p>\n",
        escaped(describe(r, e)), e.held_out_p, e.held_out_nats);
  for (const Twins& t : d.twins)
    out +=
        fmt::format("<p>{} and {} {}.</p>\n", escaped(r.problem.effects[static_cast<std::size_t>(t.a)].id),
                    escaped(r.problem.effects[static_cast<std::size_t>(t.b)].id),
                    t.exact ? "cannot be told apart by these data"
                            : fmt::format("are near twins, {:.1f} σ apart where they would just be seen", t.distance));
  if (d.verdict == Verdict::none_of_these)
    for (std::size_t k = 0; k < d.pattern_cosine.size(); ++k)
      if (std::abs(d.pattern_cosine[k]) > 0.5)
        out += fmt::format("<p>The misfit resembles {} (cosine {:.2f}): a hint, not a name.</p>\n",
                           escaped(r.problem.effects[k].id), d.pattern_cosine[k]);
  if (!d.advice.empty()) {
    out +=
        "<div class=\"wide\"><table><thead><tr><th>measurement</th><th>predicted "
        "distance</th><th>power</th></tr></thead><tbody>\n";
    for (const Advice& a : d.advice)
      out += fmt::format("<tr><td>{}</td><td>{:.1f} σ</td><td>{:.0f} %</td></tr>\n", escaped(a.measurement), a.distance,
                         100 * a.power);
    out += "</tbody></table></div>\n";
  }
  out += candidate_table(r);
  out += "<h2>4. The extension</h2>\n" + section("4. The extension", "5. The gain");
  out += "<h2>5. The gain</h2>\n";
  if (d.gain.nats.empty()) {
    out += section("5. The gain", "6. What it changes");
  } else {
    const HeldOutGain& g = d.gain;
    out += fmt::format("<p>{:.2f} nats a held-out condition [{:.2f}, {:.2f}]: {}.</p>\n", g.mean, g.low, g.high,
                       g.adopted ? "adopted" : "not supported, as the interval does not exclude zero");
    out += gain_figure(g);
    out +=
        "<div class=\"wide\"><table><thead><tr><th>root mean square difference</th><th>plain</th><th>extended</th><th "
        "class=\"text\">unit</th></tr></thead><tbody>\n";
    for (const HeldOutGain::Quantity& q : g.quantities)
      out += fmt::format("<tr><td>{}</td><td>{:.3g}</td><td>{:.3g}</td><td class=\"text\">{}</td></tr>\n",
                         escaped(q.quantity), q.rms_before, q.rms_after, escaped(q.unit));
    out += fmt::format(
        "<tr><td>z</td><td>{:.2f}</td><td>{:.2f}</td><td class=\"text\">1</td></tr><tr><td>within 90 % "
        "bands</td><td>{:.0f}</td><td>{:.0f}</td><td class=\"text\">%</td></tr></tbody></table></div>\n",
        g.rms_z_before, g.rms_z_after, 100 * g.coverage_before, 100 * g.coverage_after);
  }
  out += "<h2>6. What it changes</h2>\n" + section("6. What it changes", "");
  return out + "</body></html>\n";
}

}  // namespace drumsweep

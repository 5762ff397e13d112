/// The page of a diagnosis: the verdict, then what diagnosis.txt says step by step, with figures. Made of the same parts as
/// the sweep's report (postproc/report).
#include "postproc/report/html.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <functional>
#include <regex>

#include "diagnosis/report/steps.h"
#include "postproc/report/chart.h"

namespace drumsweep {
namespace {

/// The signs that a plain terminal lacks; numbers keep their units.
std::string typeset(std::string text) {
  static const std::pair<std::regex, const char*> rules[] = {
      {std::regex("\\+-"), "±"},
      {std::regex("\\bsigma2\\b"), "σ²"},
      {std::regex("\\bsigma\\b"), "σ"},
      {std::regex("\\bchi2\\b"), "χ²"},
      {std::regex(" x "), " × "},
      {std::regex(" \\| "), "; or "},
      {std::regex("\\bp = "), "p\u00a0=\u00a0"},
      {std::regex(" - "), " − "},
      {std::regex("(^|[ \\[(])-(\\d)"), "$1−$2"},
      {std::regex("\\b(kg|m|s)-1\\b"), "$1⁻¹"},
      {std::regex("\\b(kg|m|s)-2\\b"), "$1⁻²"},
      {std::regex("\\b(kg|m|s)-3\\b"), "$1⁻³"},
      {std::regex("\\b(m|rad)/s2\\b"), "$1/s²"},
      {std::regex("(\\d) (m|N|%|σ)(?=[ ,;:).]|$)"), "$1\u00a0$2"},
  };
  for (const auto& [pattern, sign] : rules) text = std::regex_replace(text, pattern, sign);
  return text;
}
std::string in_print(const std::string& text) {
  static const std::regex code("`([^`]*)`");
  return std::regex_replace(escaped(typeset(text)), code, "<code>$1</code>");
}

/// With a capital, unless it begins with a symbol or a file's name, and a full stop.
std::string sentence(std::string line) {
  const bool symbol = line.compare(0, 4, "p = ") == 0 || line.rfind("extended", 0) == 0;
  if (!line.empty() && !symbol) line[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(line[0])));
  return in_print(line) + ".";
}

std::string lines_html(const std::vector<std::string>& lines) {
  if (lines.size() == 1) return fmt::format("<p>{}</p>\n", sentence(lines[0]));
  std::string items;
  for (const std::string& line : lines) items += fmt::format("<li>{}</li>\n", sentence(line));
  return items.empty() ? "" : fmt::format("<ul class=\"says\">\n{}</ul>\n", items);
}

/// Shaded from 2 on; an arrow says which way the simulation is off, so that colour is not needed.
std::string cell_html(const StepCell& cell) {
  const double size = std::abs(cell.z);
  if (!(size >= shown_z)) return in_print(cell.text);
  return fmt::format("<span class=\"z {} s{}\">{} {}</span>", cell.z > 0 ? "low" : "high",
                     size < 3   ? 1
                     : size < 5 ? 2
                                : 3,
                     cell.z > 0 ? "▼" : "▲", in_print(cell.text));
}

std::string sort_key(const StepCell& cell) {
  const double value = std::isfinite(cell.sort) ? cell.sort : cell.z;
  return std::isfinite(value) ? fmt::format("{}", value) : "";
}

std::string table_html(const StepTable& table) {
  constexpr std::size_t long_text = 60, most_on_paper = 100;
  HtmlTable html;
  for (const StepColumn& column : table.columns) html.columns.push_back({typeset(column.title), column.number, false});
  for (const std::vector<StepCell>& row : table.rows) {
    html.rows.emplace_back();
    for (std::size_t j = 0; j < row.size(); ++j) {
      html.rows.back().push_back({cell_html(row[j]), sort_key(row[j])});
      html.columns[j].wraps = html.columns[j].wraps || row[j].text.size() > long_text;
    }
  }
  html.sortable = table.id == "data" || table.id == "numerics";
  html.most_printed = most_on_paper;
  html.dense = table.columns.size() > 8;
  std::string body = html_of(html);
  if (!table.note.empty()) {
    std::string note = table.note;
    if (table.id == "heat") note += " ▼ the simulation is too low, ▲ too high; shaded from 2 on.";
    body += fmt::format("<p class=\"note\">{}</p>\n", in_print(note));
  }
  const std::string title = in_print(table.title);
  if (table.detail)
    return fmt::format("<details class=\"only-screen\"><summary>{}</summary>\n{}</details>\n", title, body);
  return fmt::format("<h3>{}</h3>\n{}", title, body);
}

/// Names from top to bottom.
std::vector<std::string> upwards(std::vector<std::string> names) {
  std::reverse(names.begin(), names.end());
  return names;
}
double row_of(std::size_t i, std::size_t num) { return static_cast<double>(num - 1 - i); }

// --- measured against simulated

struct MarkedSeries {
  std::string name, css, shape;
  double aside;  ///< of the middle of its row
  std::function<ExtendedValue(std::size_t)> value;
};

std::vector<MarkedSeries> series_of(const DiagnosisReport& r) {
  const std::vector<DatumMisfit>& m = r.result.misfits;
  std::vector<MarkedSeries> list = {{"measured", "best", "circle", 0.27,
                                     [&r](std::size_t i) {
                                       return ExtendedValue{r.problem.data[i].value, r.problem.data[i].sigma};
                                     }},
                                    {"simulated, parameters as the bench has them", "b open", "square", 0.09,
                                     [&m](std::size_t i) {
                                       return ExtendedValue{m[i].simulated_before, m[i].sigma_before};
                                     }},
                                    {"recalibrated", "d", "cross", -0.09, [&m](std::size_t i) {
                                       return ExtendedValue{m[i].simulated_after, m[i].sigma_after};
                                     }}};
  if (!r.with_cause.empty())
    list.push_back({"with the cause", "a", "diamond", -0.27, [&r](std::size_t i) { return r.with_cause[i]; }});
  return list;
}

std::string tip_of(const MarkedSeries& s, const Datum& d, const ExtendedValue& v) {
  return typeset(fmt::format("{}\n{}: {:.4g} +- {:.2g} {}", spoken_name(d), s.name, v.value, v.sigma, d.unit));
}

std::string label_of(const Datum& d) {
  return d.unit == "1" ? spoken(d.quantity) : typeset(fmt::format("{} ({})", spoken(d.quantity), d.unit));
}

/// One number a condition: a row each, held-out ones below a line.
std::string rows_chart(const DiagnosisReport& r, const std::vector<MarkedSeries>& series,
                       std::vector<std::size_t> data) {
  std::stable_partition(data.begin(), data.end(), [&](std::size_t i) { return r.problem.data[i].use == Use::fit; });
  std::vector<std::string> names;
  std::vector<double> values;
  std::size_t num_fit = 0;
  for (const std::size_t i : data) {
    names.push_back(r.problem.data[i].condition);
    num_fit += r.problem.data[i].use == Use::fit ? 1 : 0;
    for (const MarkedSeries& s : series)
      for (const double sign : {-1.0, 1.0}) values.push_back(s.value(i).value + sign * s.value(i).sigma);
  }
  const std::size_t num = data.size();
  const std::string label = label_of(r.problem.data[data[0]]);
  Chart chart(label + ", measured and simulated", axis_over(label, values),
              {"", -0.6, static_cast<double>(num) - 0.4, upwards(names)}, 480, 82 + 42 * static_cast<double>(num));
  if (num_fit > 0 && num_fit < num) chart.rule(row_of(num_fit, num) + 0.5, "", "dash");
  for (const MarkedSeries& s : series) {
    std::vector<ChartPoint> points;
    for (std::size_t k = 0; k < num; ++k) {
      const ExtendedValue v = s.value(data[k]);
      const double y = row_of(k, num) + s.aside;
      chart.whisker(v.value - v.sigma, v.value + v.sigma, y, s.css);
      points.push_back({v.value, y, 0, tip_of(s, r.problem.data[data[k]], v)});
    }
    chart.points(points, s.css, s.shape, 3.6);
  }
  return figure(chart.svg(), "");
}

/// A quantity along its positions in one condition: the values, and z below.
std::string profile_charts(const DiagnosisReport& r, const std::vector<MarkedSeries>& series,
                           std::vector<std::size_t> data) {
  std::sort(data.begin(), data.end(),
            [&](std::size_t a, std::size_t b) { return r.problem.data[a].position < r.problem.data[b].position; });
  const Datum& first = r.problem.data[data[0]];
  std::vector<double> places, values, zs = {-shown_z, shown_z};
  for (const std::size_t i : data) {
    places.push_back(r.problem.data[i].position);
    zs.insert(zs.end(), {r.result.misfits[i].z_before, r.result.misfits[i].z_after});
    for (const MarkedSeries& s : series)
      for (const double sign : {-1.0, 1.0}) values.push_back(s.value(i).value + sign * s.value(i).sigma);
  }
  const ChartAxis x = axis_over(fmt::format("position ({})", first.position_unit), places);
  Chart profile(fmt::format("{} of {} along its positions", spoken(first.quantity), first.condition), x,
                axis_over(label_of(first), values));
  Chart misfit(fmt::format("z of the {} of {}", spoken(first.quantity), first.condition), x,
               axis_over("z: measured − simulated, in σ", zs), 480, 210);
  for (const double limit : {shown_z, -shown_z}) misfit.rule(limit, "", "dash");
  // What was measured lies above the lines.
  for (auto s = series.rbegin(); s != series.rend(); ++s) {
    std::vector<ChartPoint> points;
    for (const std::size_t i : data) {
      const ExtendedValue v = s->value(i);
      points.push_back({r.problem.data[i].position, v.value, v.sigma, tip_of(*s, r.problem.data[i], v)});
    }
    const bool measured = s->name == "measured";
    if (!measured) profile.line(points, s->css);
    profile.points(points, s->css, s->shape, measured ? 4.2 : 3.2);
  }
  for (const MarkedSeries& s : {series[1], series[2]}) {
    std::vector<ChartPoint> points;
    for (const std::size_t i : data) {
      const double z = s.name == "recalibrated" ? r.result.misfits[i].z_after : r.result.misfits[i].z_before;
      points.push_back({r.problem.data[i].position, z, 0,
                        fmt::format("{}\n{}: z = {:+.1f}", spoken_name(r.problem.data[i]), s.name, z)});
    }
    misfit.line(points, s.css);
    misfit.points(points, s.css, s.shape);
  }
  return figure(profile.svg() + misfit.svg(),
                in_print(fmt::format(
                    "{}, {}{}. Where z lies above the dashed lines the simulation is too low, below them too high.",
                    first.condition, spoken(first.quantity), first.use == Use::holdout ? " (held out)" : "")));
}

std::string compared_charts(const DiagnosisReport& r) {
  if (r.result.misfits.empty()) return "";
  const std::vector<MarkedSeries> series = series_of(r);
  // Numbers by quantity, profiles by condition and quantity, in the order of the data.
  std::vector<std::pair<std::string, std::vector<std::size_t>>> rows, profiles;
  const auto add = [](auto& list, const std::string& key, std::size_t i) {
    for (auto& [name, data] : list)
      if (name == key) return data.push_back(i);
    list.push_back({key, {i}});
  };
  for (std::size_t i = 0; i < r.problem.data.size(); ++i) {
    const Datum& d = r.problem.data[i];
    if (!compared(d)) continue;
    std::isnan(d.position) ? add(rows, d.quantity + "\n" + d.unit, i)
                           : add(profiles, d.condition + "\n" + d.quantity, i);
  }
  std::vector<LegendEntry> legend;
  for (const MarkedSeries& s : series) legend.push_back({s.name, s.css, s.shape});
  if (!r.problem.with_use(Use::holdout).empty()) legend.push_back({"below it, held-out conditions", "dash", "line"});
  std::string charts;
  const auto add_group = [&](const auto& list, const auto& draw) {
    if (list.empty()) return;
    charts += "<div class=\"figures\">\n";
    for (const auto& [name, data] : list) charts += draw(r, series, data);
    charts += "</div>\n";
  };
  add_group(rows, rows_chart);
  add_group(profiles, profile_charts);
  return fmt::format(
      "<h3>Measured and simulated</h3>\n<p class=\"note\">Bars are one standard error; for simulated numbers it holds "
      "what is not known of the parameters, and the emulator’s own.</p>\n{}{}",
      legend_html(legend), charts);
}

// --- what would have been seen

std::string detection_chart(const DiagnosisReport& r) {
  const std::size_t num = r.result.detection.size();
  if (num == 0) return "";
  std::vector<std::string> names;
  double low = 0;
  for (std::size_t k = 0; k < num; ++k) {
    names.push_back(spoken(r.problem.effects[k].id));
    low = std::min(low, 100 * r.problem.effects[k].low / r.problem.effects[k].scale());
  }
  Chart chart("Strengths of each candidate that these data would have shown",
              {"strength (% of the largest that is thought possible)", low < 0 ? 1.04 * low : 0, 104},
              {"", -0.7, static_cast<double>(num) - 0.3, upwards(names)}, 720, 88 + 32 * static_cast<double>(num));
  bool any_named = false;
  for (std::size_t k = 0; k < num; ++k) {
    const CandidateEffect& e = r.problem.effects[k];
    const Detection& limit = r.result.detection[k];
    const double y = row_of(k, num), scale = 100 / e.scale();
    const std::string tip = typeset(fmt::format("{}: seen {}\n{:.1f} sigma at the end of its range, {} to {}", names[k],
                                                seen_from(e, limit), limit.d_at_end, with_its_unit(e.low, e.unit),
                                                with_its_unit(e.high, e.unit)));
    if (std::isnan(limit.limit_high) && std::isnan(limit.limit_low))
      chart.note(0, y, seen_from(e, limit));
    else
      chart.whisker(scale * e.low, scale * e.high, y, "grey");
    if (std::isfinite(limit.limit_high))
      chart.bar(scale * limit.limit_high, scale * e.high, y - 0.3, y + 0.3, "c", tip);
    if (std::isfinite(limit.limit_low)) chart.bar(scale * e.low, scale * limit.limit_low, y - 0.3, y + 0.3, "c", tip);
    if (r.result.causes.empty()) continue;
    for (const NamedEffect& n : r.result.causes.front().effects) {
      if (static_cast<std::size_t>(n.effect) != k) continue;
      any_named = true;
      chart.whisker(scale * n.low, scale * n.high, y, "best");
      chart.points({{scale * n.strength, y, 0,
                     typeset(fmt::format("{} fitted: {} [{:.3g}, {:.3g}]", names[k], with_its_unit(n.strength, e.unit),
                                         n.low, n.high))}},
                   "best", "diamond", 4);
    }
  }
  chart.legend("seen in 9 of 10 campaigns like this one", "c", "bar");
  chart.legend("possible", "grey", "line");
  if (any_named) chart.legend("fitted, with its 95 % interval", "best", "diamond");
  return figure(chart.svg(),
                "What these data would have shown: a cause weaker than its bar could be there all the same.", true);
}

// --- the gain

std::string gain_chart(const HeldOutGain& g) {
  const std::size_t num = g.nats.size() + 1;
  std::vector<std::string> names = g.conditions;
  const bool has_interval = std::isfinite(g.low);
  names.emplace_back(has_interval ? "mean, 95 %" : "mean");
  std::vector<double> values = g.nats;
  for (const double v : {0.0, g.low, g.high, g.mean}) values.push_back(v);
  ChartAxis x = axis_over("gain (nats of log predictive density)", values);
  // Room for the numbers at the ends of the bars.
  const double room = 0.08 * (x.high - x.low);
  x.low -= *std::min_element(g.nats.begin(), g.nats.end()) < 0 ? room : 0;
  x.high += room;
  Chart chart("Gain of each held-out condition", x, {"", -0.7, static_cast<double>(num) - 0.3, upwards(names)}, 720,
              88 + 26 * static_cast<double>(num));
  for (std::size_t i = 0; i < g.nats.size(); ++i) {
    const double y = row_of(i, num), n = g.nats[i];
    chart.bar(std::min(0.0, n), std::max(0.0, n), y - 0.3, y + 0.3, n < 0 ? "b" : "a",
              typeset(fmt::format("{}: {:+.2f} nats", g.conditions[i], n)));
    chart.note(n, y, typeset(fmt::format("{:+.1f}", n)), n < 0 ? Chart::NoteSide::left : Chart::NoteSide::right);
  }
  chart.upright(0, "", "grey");
  if (has_interval) chart.whisker(g.low, g.high, 0, "best");
  chart.points({{g.mean, 0, 0, typeset(gain_in_words(g))}}, "best", "diamond", 4.5);
  return figure(
      chart.svg(),
      "What the extension adds on conditions that no choice has looked at. It is adopted where the interval of "
      "the mean excludes zero.",
      true);
}

// --- the page

std::string stat(const std::string& name, const std::string& value, const std::string& note) {
  return fmt::format("<div><dt>{}</dt><dd>{}<small>{}</small></dd></div>\n", name, in_print(value), in_print(note));
}

std::string header_html(const DiagnosisReport& r) {
  const Diagnosis& d = r.result;
  const std::string words = headline(r);
  const std::size_t colon = words.find(':');
  std::string p = stat("p-value", fmt::format("{:.2g}", d.p_value),
                       fmt::format("all data {:.2g}, towards a candidate {:.2g}", d.p_omnibus, d.p_directed));
  for (const GroupMisfit& g : d.groups)
    p += stat("p, " + escaped(g.group), fmt::format("{:.2g}", g.p),
              fmt::format("{} data{}", g.num_data, misfits(g) ? ": misfits" : ""));
  std::string strip = stat("Error bars", fmt::format(" x {:.2f}", d.birge), "for the plain model to pass");
  if (!d.gain.nats.empty())
    strip += stat("Gain, held out", fmt::format("{:.1f} nats", d.gain.mean),
                  std::isfinite(d.gain.low) ? fmt::format("95 %: {:.1f} to {:.1f}; {}", d.gain.low, d.gain.high,
                                                          d.gain.adopted ? "adopted" : "not supported")
                                            : "one condition: not supported");
  strip += stat("Simulated", fmt::format("{} runs", r.num_runs), fmt::format("{} fitted data", d.num_fitted_data));
  std::string html = fmt::format("<h1>{}</h1>\n<p class=\"lead\"><b>{}</b>{}.</p>\n", escaped(r.campaign.name),
                                 escaped(words.substr(0, colon)), in_print(words.substr(colon)));
  if (const std::string next = next_measurement(r); !next.empty()) html += fmt::format("<p>{}</p>\n", sentence(next));
  if (!r.notes.empty()) html += fmt::format("<div class=\"banner\">{}</div>\n", lines_html(r.notes));
  return html + fmt::format("<dl class=\"strip\">\n{}</dl>\n<dl class=\"strip more\">\n{}</dl>", p, strip);
}

std::string step_html(const DiagnosisReport& r, const DiagnosisStep& step) {
  std::string html = lines_html(step.lines);
  if (step.id == "gain" && !r.result.gain.nats.empty()) html += gain_chart(r.result.gain);
  for (const StepTable& table : step.tables) {
    if (table.id == "nats") continue;  // the figure has its numbers
    if (table.id == "data") html += compared_charts(r);
    html += table_html(table);
    if (table.id == "candidates") html += detection_chart(r);
  }
  if (step.id == "extension")
    for (const auto& [name, text] : extended_studies(r))
      html += fmt::format("<details class=\"only-screen\"><summary>{}</summary>\n<pre>{}</pre></details>\n", name,
                          escaped(text));
  return html;
}

}  // namespace

std::string report_html(const DiagnosisReport& r) {
  Page page;
  page.title = r.campaign.name + " – diagnosis";
  page.header = header_html(r);
  int number = 0;
  for (const DiagnosisStep& step : diagnosis_steps(r))
    page.sections.push_back({step.id, fmt::format("{}. {}", ++number, step.title), step_html(r, step)});
  page.footer = fmt::format(
      "Written by drumsweep {} from {} and {}. Errors are one standard error unless they say otherwise; all digits are "
      "in the CSV files beside this page.",
      DRUMSWEEP_VERSION, escaped(r.campaign.path), escaped(r.campaign.measured));
  return html_of(page);
}

}  // namespace drumsweep

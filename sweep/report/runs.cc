/// What the runs say: their order, their noise, what is wrong with some, how well they were solved, the table.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "postproc/contour.h"
#include "postproc/report/chart.h"
#include "postproc/report/html.h"
#include "sweep/report/sections.h"
#include "sweep/report/wording.h"

namespace drumsweep {
namespace {

/// Rows in the order in which they were simulated.
std::vector<std::size_t> in_order(const ReportData& data) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < data.table.rows.size(); ++i)
    if (data.run_number[i] > 0) order.push_back(i);
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return data.run_number[a] < data.run_number[b]; });
  return order;
}

/// Shades the runs of each stage, as far as they follow each other.
void add_stages(Chart& chart, const ReportData& data, const std::vector<std::size_t>& order) {
  constexpr std::size_t most_stripes = 40;
  struct Stripe {
    std::string stage;
    double begin, end;
  };
  std::vector<Stripe> stripes;
  for (const std::size_t i : order) {
    const auto run = static_cast<double>(data.run_number[i]);
    const std::string& stage = data.table.rows[i].stage;
    if (stripes.empty() || stripes.back().stage != stage) stripes.push_back({stage, run - 0.5, run + 0.5});
    stripes.back().end = run + 0.5;
  }
  if (stripes.size() < 2 || stripes.size() > most_stripes) return;
  for (std::size_t k = 0; k < stripes.size(); ++k)
    chart.stripe(stripes[k].begin, stripes[k].end, stripes[k].stage, k % 2 == 0);
}

ChartAxis run_axis(const ReportData& data) {
  std::size_t most = 1;
  for (const std::size_t number : data.run_number) most = std::max(most, number);
  return {"run, in the order in which they were begun", 0.0, static_cast<double>(most) + 1, {}, true};
}

std::string path_chart(const ReportData& data, const std::vector<std::size_t>& order) {
  std::vector<ChartPoint> done, untrusted, failed, best;
  std::vector<double> values;
  double lowest = ResultRow::none;
  for (const std::size_t i : order) {
    const ResultRow& row = data.table.rows[i];
    const auto run = static_cast<double>(data.run_number[i]);
    if (row.state == "failed") {
      failed.push_back({run, 0, 0, run_tip(data, i)});
      continue;
    }
    (row.state == "done" ? done : untrusted).push_back({run, 1000 * row.f_m, 1000 * row.sigma_f_m, run_tip(data, i)});
    values.push_back(1000 * (row.f_m + row.sigma_f_m));
    if (row.state == "done" && !(lowest <= row.f_m)) lowest = row.f_m;
    best.push_back({run, 1000 * lowest, 0, ""});
  }
  const double tolerance = data.study.refine.tolerance_f_m;
  if (tolerance > 0) values.push_back(1000 * tolerance);
  Chart chart("f of every run in the order of the search", run_axis(data), axis_over("f (mm)", values, true), 900, 320);
  add_stages(chart, data, order);
  if (!best.empty()) best.push_back({run_axis(data).high, best.back().y, 0, ""});
  chart.line(best, "best", true);
  chart.points(done, "a", many_runs(data) ? "dot" : "circle", 3.4);
  chart.points(untrusted, "b open", "diamond", 3.4);
  chart.points(failed, "bad", "cross", 3.5);
  if (tolerance > 0) chart.rule(1000 * tolerance, "asked for", "limit", Chart::RuleText::left_below);
  chart.legend("a run with its standard error", "a", "circle");
  if (!untrusted.empty()) chart.legend("untrusted", "b open", "diamond");
  if (!failed.empty()) chart.legend("failed", "bad", "cross");
  chart.legend("lowest trusted f so far", "best", "line");
  return figure(
      chart.svg(),
      "The search. The lowest single run is not the optimum: it is low by luck too, which is what the fit and "
      "fresh runs are for.",
      true);
}

/// Rows that are the same design with other random numbers.
struct Group {
  std::vector<std::size_t> rows;
  double mean = 0, scatter = 0, own = 0;
};

std::vector<Group> replicate_groups(const ReportData& data) {
  std::map<std::string, Group> groups;
  for (std::size_t i = 0; i < data.table.rows.size(); ++i) {
    const ResultRow& row = data.table.rows[i];
    if (row.state != "done") continue;
    std::string place;
    for (std::size_t v = 0; v < row.variables.size(); ++v)
      if (data.table.variable_names[v] != "replicate") place += fmt::format("{},", row.variables[v]);
    groups[place].rows.push_back(i);
  }
  std::vector<Group> list;
  for (auto& [place, g] : groups) {
    if (g.rows.size() < 2) continue;
    const auto n = static_cast<double>(g.rows.size());
    for (const std::size_t i : g.rows) g.mean += data.table.rows[i].f_m / n;
    for (const std::size_t i : g.rows) {
      const ResultRow& row = data.table.rows[i];
      g.scatter += (row.f_m - g.mean) * (row.f_m - g.mean) / (n - 1);
      g.own += row.sigma_f_m * row.sigma_f_m / n;
    }
    g.scatter = std::sqrt(g.scatter);
    g.own = std::sqrt(g.own);
    list.push_back(g);
  }
  std::sort(list.begin(), list.end(), [](const Group& a, const Group& b) { return a.mean < b.mean; });
  return list;
}

std::string range_of(const std::vector<double>& values, double scale, const std::string& unit) {
  if (!std::isfinite(quantile(values, 0.5))) return "–";
  return fmt::format("{} (5 to 95 %: {} to {}){}", plain(scale * quantile(values, 0.5), 3),
                     plain(scale * quantile(values, 0.05), 3), plain(scale * quantile(values, 0.95), 3),
                     unit.empty() ? "" : " " + unit);
}

std::vector<double> column(const ReportData& data, double ResultRow::*member) {
  std::vector<double> values;
  for (const ResultRow& row : data.table.rows)
    if (row.state != "failed") values.push_back(row.*member);
  return values;
}

}  // namespace

std::string search_html(const ReportData& data) {
  const std::vector<std::size_t> order = in_order(data);
  std::string html = order.empty() ? "<p>No design has been simulated yet.</p>\n" : path_chart(data, order);
  std::string notes;
  for (const StageSummary& stage : data.plan.stages)
    for (const std::string& note : stage.notes)
      notes += fmt::format("<li><b>{}</b>: {}</li>\n", escaped(stage.name), escaped(note));
  if (!notes.empty())
    html += fmt::format("<details{}><summary>What the stages decided, and why</summary>\n<ul>\n{}</ul></details>\n",
                        notes.size() < 4000 ? " open" : " class=\"only-screen\"", notes);
  return html;
}

std::string noise_html(const ReportData& data) {
  const std::vector<double> sigma = column(data, &ResultRow::sigma_f_m);
  if (!std::isfinite(quantile(sigma, 0.5))) return "<p>No design has a value yet.</p>\n";
  std::string html =
      fmt::format("<p>Each run states its own standard error, from blocks of one slot’s passage (jackknife): {}.",
                  range_of(sigma, 1000, "mm"));
  const std::vector<Group> groups = replicate_groups(data);
  if (data.findings && std::isfinite(data.findings->shared_noise_gain))
    html += fmt::format(
        " Designs share random numbers: the difference of neighbouring designs has {} times less variance "
        "than with separate ones.",
        plain(data.findings->shared_noise_gain, 2));
  html += "</p>\n";
  if (groups.empty())
    return html +
           "<p>No design was simulated twice, so whether runs scatter as much as they say is not known. On the quick "
           "drum replicates scatter 1.5 times as much.</p>\n";

  double scatter = 0, own = 0, dof = 0;
  for (const Group& g : groups) {
    const auto free = static_cast<double>(g.rows.size() - 1);
    scatter += free * g.scatter * g.scatter;
    own += free * g.own * g.own;
    dof += free;
  }
  html += fmt::format(
      "<p>{} simulated again with other feed places and outlet texture. Over all, such runs scatter "
      "<b>{} times</b> as much as they say themselves ({} degrees of freedom).</p>\n",
      groups.size() == 1 ? "One design was" : fmt::format("{} designs were", groups.size()),
      plain(std::sqrt(scatter / own), 2), dof);
  constexpr std::size_t most_groups = 30;
  const std::size_t shown = std::min(most_groups, groups.size());
  HtmlTable table{{{"design"},
                   {"runs", true},
                   {"mean f (mm)", true},
                   {"scatter of runs (mm)", true},
                   {"their own error (mm)", true}},
                  {},
                  false,
                  0};
  std::vector<ChartPoint> runs, means;
  std::vector<double> values;
  for (std::size_t k = 0; k < shown; ++k) {
    const Group& g = groups[k];
    std::vector<std::pair<std::string, double>> at = place_of_row(data, data.table.rows[g.rows[0]]);
    std::erase_if(at, [](const auto& v) { return v.first == "replicate"; });
    table.rows.push_back({{escaped(place_text(at)), ""},
                          {fmt::format("{}", g.rows.size()), ""},
                          {number_text(1000 * g.mean, 4), ""},
                          {number_text(1000 * g.scatter, 2), ""},
                          {number_text(1000 * g.own, 2), ""}});
    for (std::size_t r = 0; r < g.rows.size(); ++r) {
      const std::size_t i = g.rows[r];
      const ResultRow& row = data.table.rows[i];
      // Side by side, so that errors do not cover each other.
      const double aside = 0.5 * (static_cast<double>(r) + 0.5) / static_cast<double>(g.rows.size()) - 0.25;
      runs.push_back({static_cast<double>(k + 1) + aside, 1000 * row.f_m, 1000 * row.sigma_f_m, run_tip(data, i)});
      values.push_back(1000 * (row.f_m + row.sigma_f_m));
      values.push_back(1000 * (row.f_m - row.sigma_f_m));
    }
    means.push_back({static_cast<double>(k + 1) - 0.36, 1000 * g.mean, 0, ""});
    means.push_back({static_cast<double>(k + 1) + 0.36, 1000 * g.mean, 0, ""});
    means.push_back({ResultRow::none, ResultRow::none, 0, ""});
  }
  Chart chart("Runs of the same design",
              {"design, in the order of the table", 0.4, static_cast<double>(shown) + 0.6, {}, true},
              axis_over("f (mm)", values), 900, 280);
  chart.line(means, "best");
  chart.points(runs, "a");
  chart.legend("a run with its own error", "a", "circle");
  chart.legend("mean", "best", "line");
  html += figure(chart.svg(),
                 shown < groups.size() ? fmt::format("The {} with the lowest f of {}.", shown, groups.size())
                                       : "Runs of the same design with other random numbers.",
                 true);
  return html + html_of(table);
}

std::string trouble_html(const ReportData& data) {
  std::map<std::string, std::vector<const ResultRow*>> reasons;
  for (const ResultRow& row : data.table.rows)
    if (row.state != "done")
      reasons[row.state + ": " + (row.reason.empty() ? "no reason stored" : row.reason)].push_back(&row);
  std::string damaged;
  for (const auto& [id, why] : data.unreadable)
    damaged += fmt::format(
        "<p class=\"banner\">The landings of design <code>{}</code> cannot be read: {}. The next run of the study "
        "simulates it again.</p>\n",
        escaped(id), escaped(why));
  if (reasons.empty()) return damaged + "<p>None: every design that has ended has a result to be trusted.</p>\n";
  HtmlTable table{{{"what", false, true}, {"designs", true}, {"which", false, true}}, {}, false, 0};
  constexpr std::size_t most_named = 8, most_reasons = 100;
  for (const auto& [reason, rows] : reasons) {
    if (table.rows.size() == most_reasons) break;
    std::string which;
    for (std::size_t i = 0; i < rows.size() && i < most_named; ++i)
      which += fmt::format("{}<code>{}</code> ({})", i == 0 ? "" : "; ", escaped(rows[i]->design_id),
                           escaped(place_text(place_of_row(data, *rows[i]))));
    if (rows.size() > most_named)
      which += fmt::format("; and {} more, in the table of all designs", rows.size() - most_named);
    table.rows.push_back({{escaped(reason), ""}, {fmt::format("{}", rows.size()), ""}, {which, ""}});
  }
  std::string html =
      damaged +
      "<p>Neither fit nor search sees a value of these; <code>drumsweep why OUT ID</code> tells the story of "
      "each.</p>\n" +
      html_of(table);
  if (table.rows.size() < reasons.size())
    html +=
        fmt::format("<p>{} further reasons are in the table of all designs.</p>\n", reasons.size() - table.rows.size());
  return html;
}

std::string solver_html(const ReportData& data) {
  const std::vector<std::size_t> order = in_order(data);
  std::vector<ChartPoint> points;
  std::vector<double> values;
  for (const std::size_t i : order) {
    const ResultRow& row = data.table.rows[i];
    if (!std::isfinite(row.residual)) continue;
    points.push_back({static_cast<double>(data.run_number[i]), 1000 * row.residual, 0,
                      fmt::format("{}\n{} mm/s, 95 % of overlaps below {} %", row.design_id,
                                  plain(1000 * row.residual, 3), plain(100 * row.overlap_95, 3))});
    values.push_back(1000 * row.residual);
  }
  if (points.empty()) return "<p>No design has been simulated yet.</p>\n";
  const double limit = data.study.solver.residual_limit_m_s;
  const double largest = *std::max_element(values.begin(), values.end());
  if (1000 * limit < 4 * largest) values.push_back(1000 * limit);
  Chart chart("Mean residual of every run", run_axis(data), axis_over("mean residual (mm/s)", values, true), 900, 240);
  chart.points(points, "a", many_runs(data) ? "dot" : "circle");
  chart.rule(1000 * limit, "limit of trust", "limit");
  std::size_t lost = 0;
  for (const ResultRow& row : data.table.rows)
    lost += static_cast<std::size_t>(std::max<std::int64_t>(0, row.lost_balls));
  std::vector<std::pair<std::string, std::string>> facts = {
      {"mean residual", range_of(column(data, &ResultRow::residual), 1000, "mm/s") +
                            fmt::format("; a run above {} mm/s is untrusted", plain(1000 * limit))},
      {"overlap", range_of(column(data, &ResultRow::overlap_95), 100, "% of a diameter") +
                      "; 95 % of the pressed contacts overlap less"},
      {"force balance", range_of(column(data, &ResultRow::force_balance_m_s), 1000, "mm/s") + "; largest of a ball"},
      {"iterations", range_of(column(data, &ResultRow::iterations), 1, "")},
      {"lost balls", fmt::format("{}", lost)}};
  return "<p>Medians over the runs. The residual is what the contact problem’s solution misses its conditions by, as a "
         "velocity.</p>\n" +
         fact_table(facts) + figure(chart.svg(), "Mean residual of each run, over its recorded turns.", true);
}

std::string designs_html(const ReportData& data) {
  constexpr std::size_t most_on_paper = 100;
  HtmlTable table{{{"design"}, {"stage"}, {"run", true}, {"state"}}, {}, true, most_on_paper};
  for (const std::string& name : data.table.variable_names) table.columns.push_back({axis_label(name), true});
  for (const char* title : {"f (mm)", "σ (mm)", "f, footprint (mm)", "largest mode / mean", "mean height (mm)",
                            "landed", "residual (mm/s)"})
    table.columns.push_back({title, true});
  table.columns.push_back({"reason", false, true});

  // Lowest f first; without a value last.
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < data.table.rows.size(); ++i) order.push_back(i);
  const auto rank = [&](std::size_t i) {
    const ResultRow& row = data.table.rows[i];
    return std::make_pair(row.state == "done"        ? 0
                          : row.state == "untrusted" ? 1
                                                     : 2,
                          std::isfinite(row.f_m) ? row.f_m : 0.0);
  };
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return rank(a) < rank(b); });
  const auto number = [](double value, double scale, int digits) {
    return HtmlCell{number_text(scale * value, digits), ""};
  };
  for (const std::size_t i : order) {
    const ResultRow& row = data.table.rows[i];
    std::vector<HtmlCell> cells = {
        {fmt::format("<code>{}</code>", escaped(row.design_id)), ""},
        {escaped(row.stage), ""},
        data.run_number[i] > 0 ? HtmlCell{fmt::format("{}", data.run_number[i]), ""} : HtmlCell{"–", ""},
        {row.state, ""}};
    for (const double value : row.variables) cells.push_back({plain(value, 6), ""});
    cells.push_back(number(row.f_m, 1000, 4));
    cells.push_back(number(row.sigma_f_m, 1000, 2));
    cells.push_back(number(row.f_footprint_m, 1000, 4));
    cells.push_back(number(row.max_an_over_a0, 1, 3));
    cells.push_back(number(row.mean_height_m, 1000, 4));
    cells.push_back({row.state == "failed" ? "–" : fmt::format("{}", row.landed), ""});
    cells.push_back(number(row.residual, 1000, 3));
    cells.push_back({escaped(row.reason), ""});
    table.rows.push_back(std::move(cells));
  }
  if (table.rows.empty()) return "<p>No design has ended yet.</p>\n";
  std::string html = fmt::format(
      "<p class=\"only-screen\">{} have ended, the lowest f first; a click on a column’s name sorts by it. All digits "
      "are in "
      "<code>results.csv</code>.</p>\n",
      counted(table.rows.size(), "design"));
  if (table.rows.size() > most_on_paper)
    html += fmt::format("<p class=\"only-paper\">On paper the first {} of {}; all are in results.csv.</p>\n",
                        most_on_paper, table.rows.size());
  return html + html_of(table);
}

}  // namespace drumsweep

/// f over the design variables and the paper's sample designs.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>

#include "core/config/schema.h"
#include "postproc/contour.h"
#include "postproc/report/chart.h"
#include "postproc/report/html.h"
#include "postproc/sample_figure.h"
#include "sweep/plan/contour_fit.h"
#include "sweep/report/sections.h"
#include "sweep/report/wording.h"

namespace drumsweep {
namespace {

constexpr std::size_t most_maps = 6, most_landings = 1500;

/// Variables that differ between rows.
std::vector<std::size_t> varying(const ResultTable& table) {
  std::vector<std::size_t> list;
  for (std::size_t v = 0; v < table.variable_names.size(); ++v)
    if (std::any_of(table.rows.begin(), table.rows.end(),
                    [&](const ResultRow& row) { return row.variables[v] != table.rows.front().variables[v]; }))
      list.push_back(v);
  return list;
}

/// What to show of a table: a plane each, the other variables held where the best design is.
std::vector<ContourOptions> planes_of(const ReportData& data, const ResultTable& table) {
  ContourOptions options;
  options.title = "";
  options.value = "f_m";
  if (data.study.refine.tolerance_f_m > 0) options.tolerance_m = data.study.refine.tolerance_f_m;
  const std::vector<std::size_t> vary = varying(table);
  if (vary.size() <= 2) return {options};
  std::vector<ContourOptions> planes;
  for (std::size_t i = 0; i < vary.size(); ++i)
    for (std::size_t j = i + 1; j < vary.size() && planes.size() < most_maps; ++j) {
      ContourOptions plane = options;
      plane.x_variable = table.variable_names[vary[i]];
      plane.y_variable = table.variable_names[vary[j]];
      for (const std::size_t k : vary) {
        if (k == vary[i] || k == vary[j]) continue;
        // The detailed design is a row of the table with replicates; names are the same.
        const auto& names = data.table.variable_names;
        const auto at = std::find(names.begin(), names.end(), table.variable_names[k]) - names.begin();
        const double value =
            data.best ? data.best->row.variables.at(static_cast<std::size_t>(at)) : table.rows.front().variables[k];
        plane.slice.emplace_back(table.variable_names[k], value);
      }
      planes.push_back(std::move(plane));
    }
  return planes;
}

std::string held_words(const ContourOptions& options) {
  std::string text;
  for (const auto& [name, value] : options.slice)
    text += fmt::format("{}{}", text.empty() ? ", at " : ", ", value_text(name, value));
  return text;
}

/// One figure, or why there is none.
std::string map_html(ReportData& data, const ResultTable& table, const ContourOptions& options, const std::string& id,
                     const std::string& caption) {
  try {
    return figure(fmt::format("<div class=\"box map\">{}</div>",
                              contour_for_page(table, options, {id, "f over the design variables"})),
                  caption, true);
  } catch (const std::exception& error) {
    const std::string why = fmt::format("no figure of f{}: {}", held_words(options), error.what());
    data.notes.push_back(why);
    return fmt::format("<p class=\"note\">There is {}.</p>\n", escaped(why));
  }
}

/// Every run over one variable: what the maps cannot say, with values to be pointed at.
std::string scatter_chart(const ReportData& data, std::size_t v) {
  std::vector<ChartPoint> done, untrusted;
  std::vector<double> xs, fs;
  for (std::size_t i = 0; i < data.table.rows.size(); ++i) {
    const ResultRow& row = data.table.rows[i];
    if (!row.has_value()) continue;
    const ChartPoint point{row.variables[v], 1000 * row.f_m, 1000 * row.sigma_f_m, run_tip(data, i)};
    (row.state == "done" ? done : untrusted).push_back(point);
    xs.push_back(point.x);
    fs.push_back(point.y + point.error);
  }
  const std::string label = axis_label(data.table.variable_names[v]);
  Chart chart(fmt::format("f of every run over the {}", label), axis_over(label, xs), axis_over("f (mm)", fs, true));
  chart.points(done, "a", many_runs(data) ? "dot" : "circle", 3);
  chart.points(untrusted, "b open", "diamond", 3);
  for (std::size_t i = 0; i < data.answer.at.size(); ++i)
    if (data.answer.at[i].first == data.table.variable_names[v]) {
      chart.upright(data.answer.at[i].second, data.answer.kind == Answer::Kind::single_run ? "lowest" : "optimum",
                    "dash");
      if (!data.answer.region_95.empty()) {
        const auto [low, high] = data.answer.region_95[i];
        chart.stripe(low, high, "95 %", true);
      }
    }
  return figure(chart.svg(), fmt::format("Every run over the {}{}.", escaped(label),
                                         data.answer.region_95.empty() ? "" : "; shaded: holds the optimum with 95 %"));
}

}  // namespace

std::vector<std::pair<std::string, double>> place_of_row(const ReportData& data, const ResultRow& row) {
  std::vector<std::pair<std::string, double>> at;
  for (std::size_t i = 0; i < row.variables.size(); ++i)
    at.emplace_back(data.table.variable_names[i], row.variables[i]);
  return at;
}

bool many_runs(const ReportData& data) { return data.table.rows.size() > 500; }

std::string run_tip(const ReportData& data, std::size_t i) {
  const ResultRow& row = data.table.rows[i];
  std::string f = row.state == "failed" ? "failed" : "f = " + millimetres(row.f_m, row.sigma_f_m);
  if (row.state == "untrusted") f += " (untrusted)";
  if (!many_runs(data))
    return fmt::format("{} · run {} · stage {}\n{}\n{}", row.design_id, data.run_number[i], row.stage,
                       place_text(place_of_row(data, row)), f);
  std::string values;
  for (const auto& [name, value] : place_of_row(data, row)) values += with_unit(value, quantity_of(name).unit) + ", ";
  return fmt::format("{}: {}{}", row.design_id, values, f);
}

std::string contours_html(ReportData& data) {
  const auto valued = std::ranges::count_if(data.table.rows, &ResultRow::has_value);
  if (valued < 2) return "<p>There are too few designs with a value for a figure.</p>\n";
  const ResultTable means = with_means_of_replicates(data.table);
  std::string html;
  try {
    const StudyFit fit = fit_of_study(data.study, data.plan, data.table, "f_m", data.study.stages.size());
    const std::vector<ContourOptions> planes = planes_of(data, means);
    std::size_t number = 0;
    for (ContourOptions options : planes) {
      options.fit = contour_fit(fit, means, options);
      const bool fitted = options.fit && options.fit->usable;
      html += map_html(data, means, options, fmt::format("map{}-", ++number),
                       fmt::format("f from all stages{}{}.", escaped(held_words(options)),
                                   fitted ? "; the surface is the fit through all runs" : ""));
    }

    // Each stage by itself, where there are several that sample.
    std::vector<std::size_t> stages;
    for (std::size_t s = 0; s < data.study.stages.size(); ++s)
      if (data.study.stages[s].type != "replicate" &&
          std::count_if(data.table.rows.begin(), data.table.rows.end(), [&](const ResultRow& row) {
            return row.has_value() && row.stage == data.study.stages[s].name;
          }) > 2)
        stages.push_back(s);
    if (stages.size() > 1 && planes.size() == 1) {
      html += "<h3>Each stage</h3>\n";
      for (const std::size_t s : stages) {
        if (++number > most_maps) break;
        const StageConfig& stage = data.study.stages[s];
        const bool grid = stage.type == "grid" || stage.type == "points" || stage.type == "zoom";
        ContourOptions options = planes.front();
        options.stage = stage.name;
        if (!grid) options.fit = contour_fit(fit, means, options);
        html += map_html(data, means, options, fmt::format("map{}-", number),
                         fmt::format("Stage “{}” ({}){}.", escaped(stage.name), escaped(stage.type),
                                     grid ? ": between its own designs" : ": its designs on the fit through all runs"));
      }
    }
  } catch (const std::exception& error) {
    data.notes.push_back(fmt::format("no figure of f over the variables: {}", error.what()));
    html +=
        fmt::format("<p class=\"note\">There is no figure of f over the variables: {}.</p>\n", escaped(error.what()));
  }
  std::string scatter;
  const std::vector<std::size_t> all = varying(data.table);
  for (const std::size_t v : all)
    if (data.table.variable_names[v] != "replicate" && data.table.variable_names[v] != "turns")
      scatter += scatter_chart(data, v);
  return html + "<h3>Every run over each variable</h3>\n<div class=\"figures\">\n" + scatter + "</div>\n";
}

std::string sample_html(const DetailedDesign& d, const std::string& id, const std::string& caption, bool maps_only,
                        ReportData& data) {
  try {
    DesignSample sample = design_sample(d.recording.landings, d.recording.begin_s, d.recording.turns, d.study);
    return figure(fmt::format("<div class=\"box sample\">{}</div>",
                              sample_for_page(sample, {id, "a design seen from its landings"},
                                              {.most_landings = most_landings, .maps_only = maps_only})),
                  caption);
  } catch (const std::exception& error) {
    data.notes.push_back(fmt::format("design {} is not drawn: {}", d.row.design_id, error.what()));
    return fmt::format("<p class=\"note\">Design {} is not drawn: {}.</p>\n", escaped(d.row.design_id),
                       escaped(error.what()));
  }
}

std::string samples_html(ReportData& data) {
  if (data.samples.empty()) return "";
  std::string html;
  std::size_t number = 0;
  // sample_html() may add a note to the data, so not by reference into it.
  for (std::size_t i = 0; i < data.samples.size(); ++i) {
    const auto& [name, detail] = data.samples[i];
    html += sample_html(
        detail, fmt::format("sample{}-", ++number),
        fmt::format("<b>{}</b>: {}; f = {}.", escaped(name), escaped(place_text(place_of_row(data, detail.row))),
                    millimetres(detail.row.f_m, detail.row.sigma_f_m)),
        false, data);
  }
  return "<p>The designs nearest to the points of the paper’s Table 1 (within 0.01 of its angle and 3 mm of its base "
         "width), as in its Figure 9.</p>\n"
         "<div class=\"figures\">\n" +
         html + "</div>\n";
}

}  // namespace drumsweep

#include "postproc/contour.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <map>
#include <set>
#include <stdexcept>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "core/config/schema.h"
#include "core/io/durable_file.h"
#include "postproc/child_process.h"
#include "postproc/contour_figure.h"
#include "postproc/contour_lines.h"

namespace drumsweep {
namespace {

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

bool chosen(const ResultRow& row, const ContourOptions& options) {
  return options.stage.empty() || row.stage == options.stage;
}

}  // namespace

ContourAxes contour_axes(const ResultTable& table, const ContourOptions& options) {
  const std::vector<std::string>& names = table.variable_names;
  if (names.empty()) throw InputError("contour: the table has no design variable");

  // Which variables take more than one value?
  std::vector<std::size_t> varying;
  std::vector<std::string> varying_names;
  for (std::size_t v = 0; v < names.size(); ++v) {
    std::vector<double> values;
    for (const ResultRow& row : table.rows)
      if (chosen(row, options) && std::isfinite(row.variables.at(v))) values.push_back(row.variables[v]);
    if (distinct_values(std::move(values)).size() < 2) continue;
    varying.push_back(v);
    varying_names.push_back(names[v]);
  }
  const auto varies = [&](std::size_t v) { return std::find(varying.begin(), varying.end(), v) != varying.end(); };
  const auto position = [&](const std::string& name) {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end())
      throw InputError(fmt::format("contour: no variable '{}', the table has {}", name, joined(names)));
    return static_cast<std::size_t>(found - names.begin());
  };

  // Asked for, else the first that vary, else the first that are there.
  std::vector<std::size_t> order;
  for (const std::string* name : {&options.x_variable, &options.y_variable})
    if (!name->empty()) order.push_back(position(*name));
  if (order.size() == 2 && order[0] == order[1])
    throw InputError(fmt::format("contour: '{}' is asked for on both axes", options.x_variable));
  const bool only_y_given = options.x_variable.empty() && !options.y_variable.empty();
  std::vector<std::size_t> candidates = varying;
  for (std::size_t v = 0; v < names.size(); ++v) candidates.push_back(v);
  for (std::size_t v : candidates) {
    if (order.size() < 2 && std::find(order.begin(), order.end(), v) == order.end()) order.push_back(v);
  }
  if (only_y_given && order.size() == 2) std::swap(order[0], order[1]);

  ContourAxes axes;
  axes.x = order[0];
  if (order.size() > 1) axes.y = order[1];
  for (std::size_t v : varying)
    if (v != axes.x && v != axes.y)
      throw InputError(
          fmt::format("contour: {} variables vary ({}), a contour shows two: choose a stage in which only "
                      "two vary",
                      varying.size(), joined(varying_names)));
  axes.plane = axes.y && varies(axes.x) && varies(*axes.y);
  // A curve is drawn over the variable that varies.
  if (!axes.plane && axes.y && varies(*axes.y)) std::swap(axes.x, *axes.y);
  return axes;
}

std::string contour_csv(const ResultTable& table, const ContourOptions& options) {
  const ContourAxes axes = contour_axes(table, options);
  const auto y_of = [&](const ResultRow& row) { return axes.y ? row.variables[*axes.y] : 0.0; };
  std::vector<const ResultRow*> rows;
  for (const ResultRow& row : table.rows)
    if (chosen(row, options)) rows.push_back(&row);
  std::sort(rows.begin(), rows.end(), [&](const ResultRow* a, const ResultRow* b) {
    // NaN last, or the order would not be one.
    const auto key = [&](const ResultRow& row) {
      const double x = row.variables[axes.x], y = y_of(row);
      return std::make_tuple(std::string_view(row.stage), std::isnan(x), std::isnan(x) ? 0.0 : x, std::isnan(y),
                             std::isnan(y) ? 0.0 : y, std::string_view(row.design_id));
    };
    return key(*a) < key(*b);
  });

  std::string csv = "stage," + csv_text(table.variable_names[axes.x]);
  if (axes.y) csv += "," + csv_text(table.variable_names[*axes.y]);
  csv += ",f_m,sigma_f_m,f_footprint_m,state\n";
  for (const ResultRow* row : rows) {
    csv += csv_text(row->stage) + ',' + csv_number(row->variables[axes.x]);
    if (axes.y) csv += ',' + csv_number(row->variables[*axes.y]);
    csv += fmt::format(",{},{},{},{}\n", csv_number(row->f_m), csv_number(row->sigma_f_m),
                       csv_number(row->f_footprint_m), csv_text(row->state));
  }
  return csv;
}

std::string contour_matrix_csv(const ResultTable& table, const ContourOptions& options) {
  // One stage.
  std::vector<std::string> stages;
  for (const ResultRow& row : table.rows)
    if (chosen(row, options) && std::find(stages.begin(), stages.end(), row.stage) == stages.end())
      stages.push_back(row.stage);
  if (stages.empty())
    throw InputError(options.stage.empty() ? std::string("contour: the table has no rows")
                                           : fmt::format("contour: no design in stage '{}'", options.stage));
  if (stages.size() > 1)
    throw InputError(fmt::format("contour: a matrix shows one stage, choose one of {}", joined(stages)));

  // Its grid.
  const ContourAxes axes = contour_axes(table, options);
  std::vector<double> x, y;
  const auto y_of = [&](const ResultRow& row) { return axes.y ? row.variables[*axes.y] : 0.0; };
  for (const ResultRow& row : table.rows) {
    if (row.stage != stages[0] || !std::isfinite(row.variables[axes.x]) || !std::isfinite(y_of(row))) continue;
    x.push_back(row.variables[axes.x]);
    y.push_back(y_of(row));
  }
  x = distinct_values(std::move(x));
  y = distinct_values(std::move(y));
  std::map<std::pair<std::size_t, std::size_t>, double> cells;  // (row, column)
  for (const ResultRow& row : table.rows) {
    if (row.stage != stages[0] || !std::isfinite(row.variables[axes.x]) || !std::isfinite(y_of(row))) continue;
    cells.try_emplace({nearest_index(y, y_of(row)), nearest_index(x, row.variables[axes.x])},
                      figure_value(row, options));
  }
  if (cells.size() != x.size() * y.size())
    throw InputError(
        fmt::format("contour: stage '{}' has {} of the {} x {} combinations of its values, a matrix needs "
                    "all of them; the long table has no such need",
                    stages[0], cells.size(), x.size(), y.size()));

  const std::string y_name = axes.y ? table.variable_names[*axes.y] : "";
  std::string csv = csv_text(y_name + "\\" + table.variable_names[axes.x]);
  for (double value : x) csv += ',' + csv_number(value);
  csv += '\n';
  for (std::size_t j = 0; j < y.size(); ++j) {
    if (axes.y) csv += csv_number(y[j]);
    for (std::size_t i = 0; i < x.size(); ++i) csv += ',' + csv_number(cells.at({j, i}));
    csv += '\n';
  }
  return csv;
}

std::string axis_label(const std::string& variable_name) {
  // Longest ending first, so that rad_s is not taken for s.
  static constexpr std::array<std::pair<std::string_view, std::string_view>, 19> units = {{
      {"_N_m15", "N/m^1.5"}, {"_kg_m3", "kg/m³"}, {"_rad_s", "rad/s"}, {"_kg_s", "kg/s"}, {"_1_m2", "1/m²"},
      {"_turns", "turns"},   {"_m_s", "m/s"},     {"_deg", "deg"},     {"_rad", "rad"},   {"_kPa", "kPa"},
      {"_MPa", "MPa"},       {"_t_h", "t/h"},     {"_mm", "mm"},       {"_Pa", "Pa"},     {"_kg", "kg"},
      {"_ms", "ms"},         {"_m", "m"},         {"_s", "s"},         {"_N", "N"},
  }};
  // Without the table's name.
  const std::size_t dot = variable_name.rfind('.');
  std::string words = dot == std::string::npos ? variable_name : variable_name.substr(dot + 1);
  std::string unit;
  for (const auto& [ending, symbol] : units) {
    if (words.size() <= ending.size() || !words.ends_with(ending)) continue;
    words.resize(words.size() - ending.size());
    unit = fmt::format(" ({})", symbol);
    break;
  }
  std::replace(words.begin(), words.end(), '_', ' ');
  return words + unit;
}

ResultTable with_shared_designs(const ResultTable& table, const ContourOptions& options) {
  const ContourAxes axes = contour_axes(table, options);
  if (!axes.y) return table;
  using Place = std::pair<double, double>;
  const auto place = [&](const ResultRow& row) { return Place(row.variables[axes.x], row.variables[*axes.y]); };
  std::vector<std::string> stages;
  std::map<std::string, std::set<double>> x, y;
  std::map<std::string, std::set<Place>> has;
  for (const ResultRow& row : table.rows) {
    if (std::find(stages.begin(), stages.end(), row.stage) == stages.end()) stages.push_back(row.stage);
    x[row.stage].insert(place(row).first);
    y[row.stage].insert(place(row).second);
    has[row.stage].insert(place(row));
  }
  ResultTable out{table.variable_names, {}};
  for (const std::string& stage : stages) {
    // Only a grid can miss a node; scattered designs have as many values of x and of y as there are of them.
    const bool grid = has[stage].size() >= 2 * std::max(x[stage].size(), y[stage].size());
    for (const ResultRow& row : table.rows) {
      const Place at = place(row);
      const bool fills = grid && row.stage != stage && x[stage].count(at.first) != 0 &&
                         y[stage].count(at.second) != 0 && has[stage].insert(at).second;
      if (row.stage != stage && !fills) continue;
      out.rows.push_back(row);
      out.rows.back().stage = stage;
    }
  }
  return out;
}

void write_contour(const ResultTable& plain_table, const ContourOptions& options, const std::filesystem::path& path) {
  const std::string ending = path.extension().string();
  if (ending == ".csv" && !options.matrix) return write_durably(path, contour_csv(plain_table, options));
  const ResultTable table = with_shared_designs(plain_table, options);
  if (ending == ".csv") {
    write_durably(path, contour_matrix_csv(table, options));
  } else if (ending == ".gp") {
    std::filesystem::path data = path, picture = path;
    data.replace_extension(".dat");
    picture.replace_extension(".png");
    const FigureSource source = contour_figure(table, options, data.filename().string(), picture.filename().string());
    write_durably(data, source.data);
    write_durably(path, source.script);
  } else if (ending == ".png" || ending == ".svg") {
    // Drawn in a folder of its own, so that a failed run leaves nothing behind.
    const ScratchFolder scratch;
    const std::string picture = "figure" + ending;
    const FigureSource source = contour_figure(table, options, "figure.dat", picture);
    write_durably(scratch.path / "figure.dat", source.data);
    write_durably(scratch.path / "figure.gp", source.script);
    // -d: without the user's start-up file.
    run_program(scratch.path, {"gnuplot", "-d", "figure.gp"},
                "install gnuplot, or write the figure as .gp and draw it elsewhere");
    const std::string drawn = read_whole_file(scratch.path / picture);
    if (drawn.empty()) throw std::runtime_error("gnuplot ended without an error but drew nothing");
    write_durably(path, drawn);
  } else {
    throw InputError(fmt::format("{}: unknown ending '{}', accepted: .csv, .gp, .png, .svg", path.string(), ending));
  }
}

}  // namespace drumsweep

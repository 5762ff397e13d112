#include "postproc/contour.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "core/config/schema.h"
#include "core/io/durable_file.h"
#include "postproc/contour_content.h"
#include "postproc/contour_figure.h"
#include "postproc/contour_lines.h"

namespace drumsweep {
namespace {

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

/// Position of a variable; the part before the dot may be left out or given. @throws InputError
std::size_t variable_position(const ResultTable& table, const std::string& name) {
  const std::vector<std::string>& names = table.variable_names;
  for (std::size_t v = 0; v < names.size(); ++v)
    if (names[v] == name || name.ends_with("." + names[v]) || names[v].ends_with("." + name)) return v;
  throw InputError(fmt::format("contour: no variable '{}', the table has {}", name, joined(names)));
}

/// Values of one variable in the stage, ascending.
std::vector<double> values_of(const ResultTable& table, std::size_t variable, const std::string& stage) {
  std::vector<double> values;
  for (const ResultRow& row : table.rows)
    if ((stage.empty() || row.stage == stage) && std::isfinite(row.variables.at(variable)))
      values.push_back(row.variables[variable]);
  return distinct_values(std::move(values));
}

/// "base_width_m (0.02, 0.035, 0.05)", or its range where there are many values.
std::string with_values(const std::string& name, const std::vector<double>& values) {
  if (values.empty()) return name;
  if (values.size() > 8)
    return fmt::format("{} ({:.6g} to {:.6g}, {} values)", name, values.front(), values.back(), values.size());
  return fmt::format("{} ({:.6g})", name, fmt::join(values, ", "));
}

/// Where the slice holds the variables; NaN elsewhere. @throws InputError
std::vector<double> slice_values(const ResultTable& table, const ContourOptions& options) {
  std::vector<double> fixed(table.variable_names.size(), std::nan(""));
  for (const auto& [name, value] : options.slice) {
    const std::size_t v = variable_position(table, name);
    const std::string& known = table.variable_names[v];
    for (const std::string* axis : {&options.x_variable, &options.y_variable})
      if (!axis->empty() && variable_position(table, *axis) == v)
        throw InputError(fmt::format("contour: '{}' is an axis and held by a slice; choose one", known));
    if (std::isfinite(fixed[v])) throw InputError(fmt::format("contour: two slices hold '{}'", known));
    const std::vector<double> values = values_of(table, v, options.stage);
    if (values.empty()) throw InputError(fmt::format("contour: no design has a value of '{}'", known));
    const double slack = 1e-9 * (values.back() - values.front());
    if (!(value >= values.front() - slack && value <= values.back() + slack))
      throw InputError(fmt::format("contour: slice {} = {}: accepted: {:.6g} to {:.6g}; the designs have {}", known,
                                   value, values.front(), values.back(), with_values(known, values)));
    fixed[v] = value;
  }
  return fixed;
}

bool in_slice(const ResultRow& row, const std::vector<double>& fixed) {
  for (std::size_t v = 0; v < fixed.size(); ++v)
    if (std::isfinite(fixed[v]) && !(std::abs(row.variables[v] - fixed[v]) <= 1e-9 * std::abs(fixed[v]))) return false;
  return true;
}

}  // namespace

bool is_chosen(const ResultRow& row, const ContourOptions& options, const ContourAxes& axes) {
  return (options.stage.empty() || row.stage == options.stage) && in_slice(row, axes.fixed);
}

ContourAxes contour_axes(const ResultTable& table, const ContourOptions& options) {
  const std::vector<std::string>& names = table.variable_names;
  if (names.empty()) throw InputError("contour: the table has no design variable");
  const std::vector<double> slice = slice_values(table, options);

  // The rows of the slice. Where it lies between the designs only a fit knows anything, and it is looked at over what
  // the others span.
  std::vector<const ResultRow*> rows, all;
  for (const ResultRow& row : table.rows) {
    if (!options.stage.empty() && row.stage != options.stage) continue;
    all.push_back(&row);
    if (in_slice(row, slice)) rows.push_back(&row);
  }
  if (rows.empty() && !all.empty()) {
    if (!options.fit || !options.fit->usable) {
      std::string values;
      for (std::size_t v = 0; v < names.size(); ++v)
        if (std::isfinite(slice[v]))
          values += (values.empty() ? "" : "; ") + with_values(names[v], values_of(table, v, options.stage));
      throw InputError(fmt::format("contour: no design lies in the slice{}; the designs have {}",
                                   options.fit ? ", and there is no fit to trust" : "", values));
    }
    rows = all;
  }

  // Which variables take more than one value?
  std::vector<std::size_t> varying;
  std::vector<std::vector<double>> values(names.size());
  for (std::size_t v = 0; v < names.size(); ++v) {
    for (const ResultRow* row : rows)
      if (std::isfinite(row->variables.at(v))) values[v].push_back(row->variables[v]);
    values[v] = distinct_values(std::move(values[v]));
    if (values[v].size() > 1 && !std::isfinite(slice[v])) varying.push_back(v);
  }
  const auto varies = [&](std::size_t v) { return std::find(varying.begin(), varying.end(), v) != varying.end(); };

  // Asked for, else the first that vary, else the first that are there.
  std::vector<std::size_t> order;
  for (const std::string* name : {&options.x_variable, &options.y_variable})
    if (!name->empty()) order.push_back(variable_position(table, *name));
  if (order.size() == 2 && order[0] == order[1])
    throw InputError(fmt::format("contour: '{}' is asked for on both axes", options.x_variable));
  const bool only_y_given = options.x_variable.empty() && !options.y_variable.empty();
  std::vector<std::size_t> candidates = varying;
  for (std::size_t v = 0; v < names.size(); ++v)
    if (!std::isfinite(slice[v])) candidates.push_back(v);
  for (std::size_t v : candidates) {
    if (order.size() < 2 && std::find(order.begin(), order.end(), v) == order.end()) order.push_back(v);
  }
  if (order.empty()) throw InputError("contour: slices hold every variable; one at least is to be an axis");
  if (only_y_given && order.size() == 2) std::swap(order[0], order[1]);

  ContourAxes axes;
  axes.x = order[0];
  if (order.size() > 1) axes.y = order[1];
  std::string too_many, example;
  for (std::size_t v : varying) {
    too_many += (too_many.empty() ? "" : ", ") + with_values(names[v], values[v]);
    if (v != axes.x && v != axes.y) example += fmt::format(" --slice {}={}", names[v], values[v][values[v].size() / 2]);
  }
  if (!example.empty())
    throw InputError(
        fmt::format("contour: {} variables vary: {}. A contour shows two: choose a stage in which only two "
                    "vary, or axes by --x and --y and hold the rest, as in{}",
                    varying.size(), too_many, example));
  axes.plane = axes.y && varies(axes.x) && varies(*axes.y);
  // A curve is drawn over the variable that varies.
  if (!axes.plane && axes.y && varies(*axes.y)) std::swap(axes.x, *axes.y);
  axes.fixed = slice;
  for (std::size_t v = 0; v < names.size(); ++v)
    if (v != axes.x && !(axes.plane && v == axes.y) && !std::isfinite(slice[v]) && values[v].size() == 1)
      axes.fixed[v] = values[v].front();
  return axes;
}

std::string contour_csv(const ResultTable& table, const ContourOptions& options) {
  const ContourAxes axes = contour_axes(table, options);
  const auto y_of = [&](const ResultRow& row) { return axes.y ? row.variables[*axes.y] : 0.0; };
  std::vector<const ResultRow*> rows;
  for (const ResultRow& row : table.rows)
    if (is_chosen(row, options, axes)) rows.push_back(&row);
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
  const ContourAxes axes = contour_axes(table, options);
  std::vector<std::string> stages;
  std::vector<const ResultRow*> rows;
  for (const ResultRow& row : table.rows) {
    if (!is_chosen(row, options, axes)) continue;
    rows.push_back(&row);
    if (std::find(stages.begin(), stages.end(), row.stage) == stages.end()) stages.push_back(row.stage);
  }
  if (stages.empty())
    throw InputError(options.stage.empty() ? std::string("contour: the table has no rows")
                                           : fmt::format("contour: no design in stage '{}'", options.stage));
  if (stages.size() > 1)
    throw InputError(fmt::format("contour: a matrix shows one stage, choose one of {}", joined(stages)));

  // Its grid.
  std::vector<double> x, y;
  const auto y_of = [&](const ResultRow& row) { return axes.y ? row.variables[*axes.y] : 0.0; };
  std::erase_if(
      rows, [&](const ResultRow* row) { return !std::isfinite(row->variables[axes.x]) || !std::isfinite(y_of(*row)); });
  for (const ResultRow* row : rows) {
    x.push_back(row->variables[axes.x]);
    y.push_back(y_of(*row));
  }
  x = distinct_values(std::move(x));
  y = distinct_values(std::move(y));
  std::map<std::pair<std::size_t, std::size_t>, double> cells;  // (row, column)
  for (const ResultRow* row : rows)
    cells.try_emplace({nearest_index(y, y_of(*row)), nearest_index(x, row->variables[axes.x])},
                      figure_value(*row, options));
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

std::string value_text(const std::string& variable_name, double value) {
  const std::string label = axis_label(variable_name);
  const std::size_t unit = label.rfind(" (");
  std::string text = fmt::format("{} {:.4g}", label.substr(0, unit), value);
  if (unit != std::string::npos) text += " " + label.substr(unit + 2, label.size() - unit - 3);
  return text;
}

ResultTable with_shared_designs(const ResultTable& table, const ContourOptions& options) {
  const ContourAxes axes = contour_axes(table, options);
  if (!axes.y) return table;
  using Place = std::pair<double, double>;
  const auto place = [&](const ResultRow& row) { return Place(row.variables[axes.x], row.variables[*axes.y]); };
  std::vector<std::string> stages;
  std::map<std::string, std::set<double>> x, y;
  std::map<std::string, std::set<Place>> has;
  const auto held = [&](const ResultRow& row) { return in_slice(row, axes.fixed); };
  for (const ResultRow& row : table.rows) {
    if (!held(row)) continue;
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
      if (!held(row)) continue;
      const Place at = place(row);
      const bool fills = grid && row.stage != stage && x[stage].count(at.first) != 0 &&
                         y[stage].count(at.second) != 0 && has[stage].insert(at).second;
      if (row.stage != stage && !fills) continue;
      out.rows.push_back(row);
      out.rows.back().stage = stage;
    }
  }
  for (const ResultRow& row : table.rows)
    if (!held(row)) out.rows.push_back(row);
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
    const FigureFiles figure = contour_figure(table, options, data.filename().string(), picture.filename().string());
    write_durably(data, figure.data.begin()->second);
    write_durably(path, figure.script);
  } else if (ending == ".png" || ending == ".svg") {
    const std::string picture = "figure" + ending;
    write_durably(path, draw(contour_figure(table, options, "figure.dat", picture), picture));
  } else {
    throw InputError(fmt::format("{}: unknown ending '{}', accepted: .csv, .gp, .png, .svg", path.string(), ending));
  }
}

std::string contour_for_page(const ResultTable& table, const ContourOptions& options, const PageFigure& page) {
  const FigureFiles figure =
      contour_figure(with_shared_designs(table, options), options, "figure.dat", "figure.svg", ContourGround::page);
  return for_page(draw(figure, "figure.svg"), page);
}

}  // namespace drumsweep

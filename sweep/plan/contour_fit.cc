#include "sweep/plan/contour_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <unordered_map>

#include "core/config/schema.h"

namespace drumsweep {
namespace {

constexpr std::size_t mesh_size = 121;

std::vector<double> evenly(double low, double high) {
  std::vector<double> values;
  for (std::size_t i = 0; i < mesh_size; ++i)
    values.push_back(low + (high - low) * static_cast<double>(i) / static_cast<double>(mesh_size - 1));
  return values;
}

/// How the variables of the table follow from those of the box.
struct PlaneInBox {
  std::optional<std::size_t> x, y;  ///< axes of the box
  Point held;                       ///< (num_axes) values of the others
  std::string outside;              ///< why the fit knows nothing of this plane; empty: it does
};

PlaneInBox plane_in_box(const StudyFit& fit, const ResultTable& table, const ContourAxes& axes) {
  PlaneInBox out;
  out.held.assign(fit.box.size(), std::numeric_limits<double>::quiet_NaN());
  for (std::size_t v = 0; v < table.variable_names.size(); ++v) {
    const auto column = std::find(fit.columns.begin(), fit.columns.end(), table.variable_names[v]);
    if (column == fit.columns.end()) continue;
    const std::string& key = fit.keys[static_cast<std::size_t>(column - fit.columns.begin())];
    const auto axis = std::find_if(fit.box.begin(), fit.box.end(), [&](const DesignAxis& a) { return a.key == key; });
    const std::size_t in_box = static_cast<std::size_t>(axis - fit.box.begin());
    const bool is_x = v == axes.x, is_y = axes.plane && v == *axes.y;
    if (axis == fit.box.end()) {
      const double own = get_number(fit.study, key);
      if (is_x || is_y)
        out.outside = fmt::format("no stage searches {}", *column);
      else if (std::isfinite(axes.fixed[v]) && axes.fixed[v] != own)
        out.outside = fmt::format("the fit is for {} = {:.6g}", *column, own);
      continue;
    }
    if (is_x) out.x = in_box;
    if (is_y) out.y = in_box;
    if (is_x || is_y) continue;
    const double value = axes.fixed[v];
    out.held[in_box] = value;
    if (!(value >= axis->low && value <= axis->high))
      out.outside = fmt::format("the fit is for {} from {:.6g} to {:.6g}", *column, axis->low, axis->high);
  }
  if (out.outside.empty() && (!out.x || (axes.plane && !out.y))) out.outside = "the fit is over other variables";
  return out;
}

ContourFit::Optimum optimum_of(const StudyFit& fit) {
  ContourFit::Optimum out;
  for (const DesignAxis& axis : fit.box) {
    const auto key = std::find(fit.keys.begin(), fit.keys.end(), axis.key);
    out.variables.push_back(key == fit.keys.end() ? axis.key
                                                  : fit.columns[static_cast<std::size_t>(key - fit.keys.begin())]);
  }
  out.at = fit.optimum->at;
  out.low = fit.optimum->low;
  out.high = fit.optimum->high;
  out.f_m = fit.optimum->f_m;
  out.sigma_m = fit.optimum->sigma_m;
  out.draws = fit.optimum->argmins;
  return out;
}

void put_on_mesh(const StudyFit& fit, const PlaneInBox& plane, ContourFit& out) {
  const FittedSurface& surface = *fit.fit.surface;
  out.x = evenly(fit.box[*plane.x].low, fit.box[*plane.x].high);
  out.y = plane.y ? evenly(fit.box[*plane.y].low, fit.box[*plane.y].high) : std::vector<double>{0.0};
  // A line of the mesh at a time, so that the covariances with all rows stay small.
  for (const double y : out.y) {
    std::vector<Site> line;
    for (const double x : out.x) {
      Point at = plane.held;
      at[*plane.x] = x;
      if (plane.y) at[*plane.y] = y;
      line.push_back({std::move(at), std::nullopt});
    }
    const Eigen::VectorXd mean = surface.mean(line);
    Eigen::VectorXd variance;
    if (!plane.y) variance = surface.variance(line);
    for (std::size_t i = 0; i < line.size(); ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      out.value_m.push_back(mean[k]);
      if (!plane.y) out.sigma_m.push_back(std::sqrt(std::max(0.0, variance[k])));
    }
  }
}

}  // namespace

StudyFit fit_of_study(const Study& study, const Plan& plan, const ResultTable& table, const std::string& value,
                      std::size_t num_stages) {
  StudyFit out;
  out.study = study;
  out.keys = plan.keys;
  out.columns = plan.columns;
  out.box = search_box(study, num_stages);
  if (out.box.empty()) return out;
  std::unordered_map<std::string, ResultRow> rows;
  for (ResultRow row : table.rows) {
    if (value == "f_footprint_m") {
      // Nothing landed under the outlet: even, but no bed.
      if (row.f_footprint_m == 0) row.state = "untrusted";
      row.f_m = row.f_footprint_m;
      row.sigma_f_m = row.sigma_f_footprint_m;
    }
    rows.emplace(row.design_id, std::move(row));
  }
  const RowOf row_of = [&](const PlannedDesign& design) {
    const auto found = rows.find(design.id);
    return found == rows.end() ? nullptr : &found->second;
  };
  std::set<Point> points;
  for (const Measurement& row : measurements_in(out.box, study, plan, num_stages, row_of)) points.insert(row.at);
  out.num_points = points.size();
  out.fit = fit_rows(out.box, study, plan, num_stages, row_of);
  if (out.fit.surface && out.fit.gate.fit_is_usable()) out.optimum = optimum(*out.fit.surface, study.seed);
  return out;
}

std::optional<ContourFit> contour_fit(const StudyFit& fit, const ResultTable& table, ContourOptions options) {
  if (fit.box.empty()) return std::nullopt;
  ContourFit out;
  out.verdict = fit.fit.gate.reason;
  out.num_fitted = fit.fit.points.size();
  out.num_designs = fit.num_points;
  out.usable = fit.fit.surface && fit.fit.gate.fit_is_usable();
  // Whether there is a fit decides which slices can be looked at.
  options.fit = out;
  const ContourAxes axes = contour_axes(table, options);
  if (!out.usable) return out;
  const PlaneInBox plane = plane_in_box(fit, table, axes);
  if (!plane.outside.empty()) {
    out.usable = false;
    out.verdict = plane.outside;
    return out;
  }
  put_on_mesh(fit, plane, out);
  out.optimum = optimum_of(fit);
  return out;
}

}  // namespace drumsweep

#include "postproc/contour_content.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "core/config/schema.h"

namespace drumsweep {
namespace {

constexpr int raster_size = 301;
constexpr double hatch_spacing = 0.014;  ///< of the box of the designs

/// The plane divided by the ranges of its variables.
struct UnitPlane {
  PlanePoint low, high;
  static double width(double from, double to) { return to > from ? to - from : 1.0; }
  PlanePoint unit(PlanePoint p) const {
    return {(p.x - low.x) / width(low.x, high.x), (p.y - low.y) / width(low.y, high.y)};
  }
  PlanePoint back(PlanePoint u) const {
    return {low.x + u.x * width(low.x, high.x), low.y + u.y * width(low.y, high.y)};
  }
};

/// A design with or without a value, in the slice or outside.
struct Place {
  PlaneSite site;  ///< in the unit plane
  bool failed = false;
};

void widen(PlanePoint& low, PlanePoint& high, PlanePoint p) {
  low = {std::min(low.x, p.x), std::min(low.y, p.y)};
  high = {std::max(high.x, p.x), std::max(high.y, p.y)};
}

/// Everything about rows: stages, failed ones, those outside the slice, and the sites of all of them.
class Gatherer {
 public:
  Gatherer(const ResultTable& table, const ContourOptions& options, const ContourAxes& axes)
      : table_(table), options_(options), axes_(axes) {
    const double infinite = std::numeric_limits<double>::infinity();
    content_.low = {infinite, infinite};
    content_.high = {-infinite, -infinite};
    content_.low_mm = infinite;
    content_.high_mm = -infinite;
  }

  ContourContent content() {
    for (const ResultRow& row : table_.rows)
      if (options_.stage.empty() || row.stage == options_.stage) add(row);
    if (content_.low_mm > content_.high_mm && (content_.elsewhere.empty() || usable_fit() == nullptr))
      throw InputError("contour: no design has a value yet, there is nothing to draw");
    order_stages();
    unit_ = {content_.low, content_.high};
    place_rows();
    make_hull();
    if (axes_.plane)
      make_map();
    else
      make_curve();
    make_region();
    if (content_.low_mm > content_.high_mm) content_.low_mm = content_.high_mm = 0.0;
    return std::move(content_);
  }

 private:
  PlanePoint at(const ResultRow& row) const {
    return {row.variables[axes_.x], axes_.plane ? row.variables[*axes_.y] : 0.0};
  }

  void add(const ResultRow& row) {
    const PlanePoint p = at(row);
    if (!std::isfinite(p.x) || !std::isfinite(p.y)) return;
    widen(content_.low, content_.high, p);
    rows_.push_back(&row);
    if (!is_chosen(row, options_, axes_)) return content_.elsewhere.push_back(p);

    const double f_mm = 1e3 * figure_value(row, options_);
    const bool has_value = std::isfinite(f_mm);
    auto stage = std::find_if(content_.stages.begin(), content_.stages.end(),
                              [&](const ContourStage& known) { return known.name == row.stage; });
    if (stage == content_.stages.end()) stage = content_.stages.insert(stage, ContourStage{row.stage, {}, {}});
    samples_[row.stage].push_back({p, has_value ? f_mm : std::nan("")});
    if (!has_value) return content_.failed.push_back(p);
    const double sigma_mm = 1e3 * (options_.value == "f_footprint_m" ? row.sigma_f_footprint_m : row.sigma_f_m);
    const ContourDesign design{p, f_mm, std::isfinite(sigma_mm) ? sigma_mm : 0.0, is_trusted(row)};
    content_.low_mm = std::min(content_.low_mm, f_mm);
    content_.high_mm = std::max(content_.high_mm, f_mm);
    if (design.trusted && (!content_.best || f_mm < content_.best->f_mm)) content_.best = design;
    stage->designs.push_back(design);
  }

  /// As for f itself (sweep/store/results.h): 0 means that nothing landed in the window.
  bool is_trusted(const ResultRow& row) const {
    return row.state == "done" && (options_.value != "f_footprint_m" || row.f_footprint_m > 0);
  }

  /// Coarse stages first; scattered designs (a refinement) have no map and go on top of everything.
  void order_stages() {
    for (ContourStage& stage : content_.stages) {
      stage.surface = grid_surface(samples_[stage.name]);
      // Steps of a search share a coordinate here and there; that makes no grid of them.
      const std::size_t nodes = stage.surface.x.size() * stage.surface.y.size();
      if (2 * samples_[stage.name].size() < nodes) stage.surface = {};
    }
    std::erase_if(content_.stages, [](const ContourStage& stage) { return stage.designs.empty(); });
    std::stable_sort(content_.stages.begin(), content_.stages.end(), [](const ContourStage& a, const ContourStage& b) {
      const auto key = [](const ContourStage& stage) {
        const bool map = stage.surface.has_area();
        return std::make_pair(map ? 0 : 1, map ? -stage.surface.cell_area() : 0.0);
      };
      return key(a) < key(b);
    });
  }

  /// Sites of all rows: how far each is from the plane, in ranges of the other variables.
  void place_rows() {
    const std::size_t num_variables = table_.variable_names.size();
    std::vector<double> low(num_variables, std::numeric_limits<double>::infinity()), high(num_variables, -low[0]);
    for (const ResultRow* row : rows_)
      for (std::size_t v = 0; v < num_variables; ++v)
        if (std::isfinite(row->variables[v])) {
          low[v] = std::min(low[v], row->variables[v]);
          high[v] = std::max(high[v], row->variables[v]);
        }
    for (const ResultRow* row : rows_) {
      Place place{{unit_.unit(at(*row)), 0.0}, !std::isfinite(figure_value(*row, options_))};
      for (std::size_t v = 0; v < num_variables; ++v) {
        if (!std::isfinite(axes_.fixed[v]) || !std::isfinite(row->variables[v]) || !(high[v] > low[v])) continue;
        const double away = (row->variables[v] - axes_.fixed[v]) / (high[v] - low[v]);
        place.site.off_plane_squared += away * away;
      }
      places_.push_back(place);
    }
    // A place that has a value in one stage and failed in another has a value.
    for (Place& place : places_) {
      if (!place.failed) continue;
      for (const Place& other : places_)
        if (!other.failed && other.site.at.x == place.site.at.x && other.site.at.y == place.site.at.y &&
            other.site.off_plane_squared == place.site.off_plane_squared)
          place.failed = false;
    }
    for (const Place& place : places_) sites_.push_back(place.site);
  }

  void make_hull() {
    std::vector<PlanePoint> points;
    if (content_.elsewhere.empty()) {
      for (const PlaneSite& site : sites_) points.push_back(site.at);
    } else {
      // x, y, then what the slice holds.
      std::vector<std::vector<double>> all;
      std::vector<double> fixed = {std::nan(""), std::nan("")};
      for (const double value : axes_.fixed)
        if (std::isfinite(value)) fixed.push_back(value);
      for (std::size_t i = 0; i < rows_.size(); ++i) {
        all.push_back({sites_[i].at.x, sites_[i].at.y});
        for (std::size_t v = 0; v < axes_.fixed.size(); ++v)
          if (std::isfinite(axes_.fixed[v])) all.back().push_back(rows_[i]->variables[v]);
      }
      for (const std::vector<double>& p : cut_of_hull(std::move(all), fixed)) points.push_back({p[0], p[1]});
    }
    unit_hull_ = convex_hull(std::move(points));
    for (const PlanePoint& corner : unit_hull_) content_.hull.push_back(unit_.back(corner));
  }

  const ContourFit* usable_fit() const { return options_.fit && options_.fit->usable ? &*options_.fit : nullptr; }

  bool in_failed_cell(PlanePoint unit) const { return any_failed() && places_[nearest_site(sites_, unit)].failed; }
  bool any_failed() const {
    return std::any_of(places_.begin(), places_.end(), [](const Place& place) { return place.failed; });
  }

  void make_map() {
    std::vector<GridSurface> surfaces;
    for (const ContourStage& stage : content_.stages) surfaces.push_back(stage.surface);
    const bool interpolates =
        content_.elsewhere.empty() || usable_fit() == nullptr;  // off the designs' own planes only a fit knows anything
    const ContourFit* fit = usable_fit();
    GridSurface of_fit;
    if (fit != nullptr) of_fit = {fit->x, fit->y, fit->value_m};

    Raster raster{raster_size, content_.low, content_.high, {}, {}};
    const int fit_owner = static_cast<int>(surfaces.size());
    bool any = false;
    for (int j = 0; j < raster.size; ++j)
      for (int i = 0; i < raster.size; ++i) {
        const PlanePoint p{raster.x(i), raster.y(j)}, unit = unit_.unit(p);
        double value = std::nan("");
        int owner = -1;
        if (inside(unit_hull_, unit) && !in_failed_cell(unit)) {
          if (interpolates)
            for (std::size_t s = 0; s < surfaces.size(); ++s)
              if (const double found = surfaces[s].at(p.x, p.y); std::isfinite(found)) {
                value = found;
                owner = static_cast<int>(s);
              }
          if (fit != nullptr)
            if (const double found = 1e3 * of_fit.at(p.x, p.y); std::isfinite(found)) {
              value = found;
              owner = fit_owner;
            }
        }
        if (owner >= 0) {
          any = true;
          (owner == fit_owner ? content_.fit_is_drawn : content_.interpolation_is_drawn) = true;
          content_.low_mm = std::min(content_.low_mm, value);
          content_.high_mm = std::max(content_.high_mm, value);
        }
        raster.value.push_back(value);
        raster.owner.push_back(owner);
      }
    if (any) content_.raster = std::move(raster);
    make_hatching(surfaces);
  }

  /// Cells of failed designs, and what they leave blank of a grid's cells.
  void make_hatching(const std::vector<GridSurface>& surfaces) {
    std::vector<Polygon> blank;
    for (std::size_t i = 0; i < places_.size(); ++i)
      if (places_[i].failed) blank.push_back(nearest_region(sites_, i, unit_hull_));
    if (usable_fit() == nullptr)
      for (const GridSurface& surface : surfaces) add_blank_cells(surface, blank);
    for (const Segment& line : hatching(blank, hatch_spacing)) add_without_colour(line);
  }

  void add_blank_cells(const GridSurface& surface, std::vector<Polygon>& blank) const {
    for (std::size_t j = 0; j + 1 < surface.y.size(); ++j)
      for (std::size_t i = 0; i + 1 < surface.x.size(); ++i) {
        Polygon cell;
        bool failed_corner = false;
        for (const auto& [dx, dy] : {std::pair<std::size_t, std::size_t>{0, 0}, {1, 0}, {1, 1}, {0, 1}}) {
          const PlanePoint corner = unit_.unit({surface.x[i + dx], surface.y[j + dy]});
          cell.push_back(corner);
          if (std::isfinite(surface.value[(j + dy) * surface.x.size() + i + dx])) continue;
          for (const Place& place : places_)
            failed_corner = failed_corner || (place.failed && std::abs(place.site.at.x - corner.x) < 1e-9 &&
                                              std::abs(place.site.at.y - corner.y) < 1e-9);
        }
        if (failed_corner) blank.push_back(std::move(cell));
      }
  }

  /// The pieces of a line that lie where nothing is coloured.
  void add_without_colour(const Segment& line) {
    const int steps = 1 + static_cast<int>(std::hypot(line.second.x - line.first.x, line.second.y - line.first.y) *
                                           (raster_size - 1));
    std::vector<PlanePoint> piece;
    const auto flush = [&] {
      if (piece.size() > 1) content_.hatching.push_back({piece.front(), piece.back()});
      piece.clear();
    };
    for (int k = 0; k <= steps; ++k) {
      const double share = static_cast<double>(k) / steps;
      const PlanePoint unit{line.first.x + share * (line.second.x - line.first.x),
                            line.first.y + share * (line.second.y - line.first.y)};
      const bool coloured = content_.raster.size > 0 && std::isfinite(colour_near(unit));
      if (coloured)
        flush();
      else
        piece.push_back(unit_.back(unit));
    }
    flush();
  }

  double colour_near(PlanePoint unit) const {
    const auto node = [](double share) {
      return static_cast<std::size_t>(std::clamp(std::lround(share * (raster_size - 1)), 0L, raster_size - 1L));
    };
    return content_.raster.value[node(unit.y) * raster_size + node(unit.x)];
  }

  void make_curve() {
    // Cells of failed designs are what is nearest to them.
    std::vector<std::pair<double, bool>> all;
    for (const Place& place : places_)
      if (place.site.off_plane_squared == 0) all.emplace_back(place.site.at.x, place.failed);
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.first == b.first; }),
              all.end());
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (!all[i].second) continue;
      const double from = i == 0 ? all[i].first : 0.5 * (all[i].first + all[i - 1].first);
      const double to = i + 1 == all.size() ? all[i].first : 0.5 * (all[i].first + all[i + 1].first);
      content_.failed_ranges.emplace_back(unit_.back({from, 0}).x, unit_.back({to, 0}).x);
    }
    const ContourFit* fit = usable_fit();
    if (fit == nullptr || unit_hull_.empty()) return;
    bool open = false;
    for (std::size_t k = 0; k < fit->x.size(); ++k) {
      const PlanePoint unit{unit_.unit({fit->x[k], 0}).x, unit_hull_.front().y};
      const bool drawn = std::isfinite(fit->value_m[k]) && inside(unit_hull_, unit) && !in_failed_cell(unit);
      if (drawn && !open) content_.fit_curve.emplace_back();
      open = drawn;
      if (!drawn) continue;
      content_.fit_curve.back().push_back({fit->x[k], 1e3 * fit->value_m[k], 1e3 * fit->sigma_m[k]});
      content_.fit_is_drawn = true;
    }
  }

  /// The draws of the optimum, projected; 95 % of them.
  void make_region() {
    const ContourFit* fit = usable_fit();
    if (fit == nullptr || !fit->optimum) return;
    const std::vector<std::string>& names = fit->optimum->variables;
    const auto position = [&](std::size_t variable) {
      return static_cast<std::size_t>(std::find(names.begin(), names.end(), table_.variable_names[variable]) -
                                      names.begin());
    };
    const std::size_t x = position(axes_.x), y = axes_.plane ? position(*axes_.y) : names.size();
    if (x == names.size() || (axes_.plane && y == names.size())) return;
    std::vector<PlanePoint> draws;
    for (const std::vector<double>& draw : fit->optimum->draws)
      draws.push_back(unit_.unit({draw[x], axes_.plane ? draw[y] : content_.low.y}));
    for (const PlanePoint& corner : hull_of_most(draws, 0.95)) content_.region.push_back(unit_.back(corner));
  }

  const ResultTable& table_;
  const ContourOptions& options_;
  const ContourAxes& axes_;
  ContourContent content_;
  std::map<std::string, std::vector<PlaneSample>> samples_;
  std::vector<const ResultRow*> rows_;
  std::vector<Place> places_;     ///< (rows_)
  std::vector<PlaneSite> sites_;  ///< (rows_)
  UnitPlane unit_;
  Polygon unit_hull_;
};

}  // namespace

double figure_value(const ResultRow& row, const ContourOptions& options) {
  if (row.state != "done" && row.state != "untrusted") return ResultRow::none;
  return options.value == "f_footprint_m" ? row.f_footprint_m : row.f_m;
}

ContourContent contour_content(const ResultTable& table, const ContourOptions& options, const ContourAxes& axes) {
  return Gatherer(table, options, axes).content();
}

}  // namespace drumsweep

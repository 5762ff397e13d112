#include "postproc/contour_lines.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

namespace drumsweep {
namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

/// Value at (u, v) in the unit square from its corners (0,0), (1,0), (0,1), (1,1).
double in_cell(std::array<double, 4> corner, double u, double v) {
  int missing = 0;
  std::size_t which = 3;
  for (std::size_t c = 0; c < 4; ++c) {
    if (std::isfinite(corner[c])) continue;
    ++missing;
    which = c;
  }
  if (missing > 1) return nothing;
  if (missing == 0) return (1 - v) * ((1 - u) * corner[0] + u * corner[1]) + v * ((1 - u) * corner[2] + u * corner[3]);

  // Three corners: mirror the cell so that (1,1) is the missing one; its triangle is linear.
  if (which % 2 == 0) {
    std::swap(corner[0], corner[1]);
    std::swap(corner[2], corner[3]);
    u = 1 - u;
  }
  if (which < 2) {
    std::swap(corner[0], corner[2]);
    std::swap(corner[1], corner[3]);
    v = 1 - v;
  }
  if (u + v > 1.0 + 1e-9) return nothing;
  return corner[0] + u * (corner[1] - corner[0]) + v * (corner[2] - corner[0]);
}

/// Cells [i, i + 1] of a sorted axis that hold the value: none, one, or two when it is on a line of the grid.
std::vector<std::size_t> cells_with(const std::vector<double>& axis, double value) {
  std::vector<std::size_t> cells;
  if (axis.size() < 2) return cells;
  const double slack = 1e-9 * (axis.back() - axis.front());
  for (std::size_t i = 0; i + 1 < axis.size(); ++i)
    if (value >= axis[i] - slack && value <= axis[i + 1] + slack) cells.push_back(i);
  return cells;
}

}  // namespace

double GridSurface::at(double at_x, double at_y) const {
  const std::vector<std::size_t> columns = cells_with(x, at_x), rows = cells_with(y, at_y);
  for (std::size_t j : rows) {
    for (std::size_t i : columns) {
      const double* low = &value[j * x.size() + i];
      const double* high = low + x.size();
      const double u = (at_x - x[i]) / (x[i + 1] - x[i]), v = (at_y - y[j]) / (y[j + 1] - y[j]);
      const double found = in_cell({low[0], low[1], high[0], high[1]}, u, v);
      if (std::isfinite(found)) return found;
    }
  }
  return nothing;
}

double GridSurface::cell_area() const {
  if (x.size() < 2 || y.size() < 2) return 0.0;
  return (x.back() - x.front()) * (y.back() - y.front()) / static_cast<double>((x.size() - 1) * (y.size() - 1));
}

bool GridSurface::has_area() const {
  for (std::size_t j = 0; j + 1 < y.size(); ++j) {
    for (std::size_t i = 0; i + 1 < x.size(); ++i) {
      int finite = 0;
      for (std::size_t node :
           {j * x.size() + i, j * x.size() + i + 1, (j + 1) * x.size() + i, (j + 1) * x.size() + i + 1})
        finite += std::isfinite(value[node]) ? 1 : 0;
      if (finite >= 3) return true;
    }
  }
  return false;
}

std::vector<double> distinct_values(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  if (values.empty()) return values;
  const double slack = 1e-9 * (values.back() - values.front());
  std::vector<double> distinct = {values.front()};
  for (double value : values)
    if (value - distinct.back() > slack) distinct.push_back(value);
  return distinct;
}

std::size_t nearest_index(std::span<const double> sorted, double value) {
  std::size_t best = 0;
  for (std::size_t i = 1; i < sorted.size(); ++i)
    if (std::abs(sorted[i] - value) < std::abs(sorted[best] - value)) best = i;
  return best;
}

GridSurface grid_surface(std::span<const PlaneSample> samples) {
  std::vector<double> x, y;
  for (const PlaneSample& sample : samples) {
    x.push_back(sample.at.x);
    y.push_back(sample.at.y);
  }
  GridSurface surface{distinct_values(std::move(x)), distinct_values(std::move(y)), {}};
  surface.value.assign(surface.x.size() * surface.y.size(), nothing);
  for (const PlaneSample& sample : samples) {
    double& node =
        surface.value[nearest_index(surface.y, sample.at.y) * surface.x.size() + nearest_index(surface.x, sample.at.x)];
    if (std::isnan(node)) node = sample.value;
  }
  return surface;
}

Raster rasterize(std::span<const GridSurface> surfaces, int size) {
  const double infinite = std::numeric_limits<double>::infinity();
  Raster raster{size, {infinite, infinite}, {-infinite, -infinite}, {}, {}};
  std::vector<int> with_area;
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    if (!surfaces[s].has_area()) continue;
    with_area.push_back(static_cast<int>(s));
    raster.low = {std::min(raster.low.x, surfaces[s].x.front()), std::min(raster.low.y, surfaces[s].y.front())};
    raster.high = {std::max(raster.high.x, surfaces[s].x.back()), std::max(raster.high.y, surfaces[s].y.back())};
  }
  for (int j = 0; j < size; ++j) {
    for (int i = 0; i < size; ++i) {
      double value = nothing;
      int owner = -1;
      for (int s : with_area) {
        const double found = surfaces[static_cast<std::size_t>(s)].at(raster.x(i), raster.y(j));
        if (!std::isfinite(found)) continue;
        value = found;
        owner = s;
      }
      raster.value.push_back(value);
      raster.owner.push_back(owner);
    }
  }
  return raster;
}

std::vector<std::vector<PlanePoint>> level_lines(const Raster& raster, double level) {
  // Edges of the raster are numbered: from node k to its right 2 k, upwards 2 k + 1. Each edge joins at most two
  // pieces.
  const std::size_t size = static_cast<std::size_t>(raster.size);
  constexpr std::size_t none = std::numeric_limits<std::size_t>::max();
  std::vector<std::array<std::size_t, 2>> next(2 * size * size, {none, none});
  const auto join = [&](std::size_t a, std::size_t b) {
    next[a][next[a][0] == none ? 0 : 1] = b;
    next[b][next[b][0] == none ? 0 : 1] = a;
  };

  for (std::size_t j = 0; j + 1 < size; ++j) {
    for (std::size_t i = 0; i + 1 < size; ++i) {
      // Corners anticlockwise from below left; edge e goes from corner e to corner e + 1.
      const std::size_t k = j * size + i;
      const std::array<std::size_t, 4> node = {k, k + 1, k + size + 1, k + size};
      const std::array<std::size_t, 4> edge = {2 * k, 2 * (k + 1) + 1, 2 * (k + size), 2 * k + 1};
      bool same_owner = raster.owner[k] >= 0;
      for (std::size_t n : node) same_owner = same_owner && raster.owner[n] == raster.owner[k];
      if (!same_owner) continue;

      std::array<bool, 4> above{};
      for (std::size_t c = 0; c < 4; ++c) above[c] = raster.value[node[c]] >= level;
      std::vector<std::size_t> crossed;
      for (std::size_t e = 0; e < 4; ++e)
        if (above[e] != above[(e + 1) % 4]) crossed.push_back(edge[e]);
      if (crossed.size() == 2) join(crossed[0], crossed[1]);
      if (crossed.size() == 4) {
        // Saddle: the mean decides which pair of corners is connected.
        double mean = 0.0;
        for (std::size_t n : node) mean += 0.25 * raster.value[n];
        const bool cut_off_first_corner = above[0] != (mean >= level);
        join(crossed[0], crossed[cut_off_first_corner ? 3 : 1]);
        join(crossed[2], crossed[cut_off_first_corner ? 1 : 3]);
      }
    }
  }

  // Place of the crossing on an edge.
  const auto place = [&](std::size_t edge) {
    const std::size_t k = edge / 2, i = k % size, j = k / size;
    const bool upwards = edge % 2 == 1;
    const double from = raster.value[k], to = raster.value[upwards ? k + size : k + 1];
    const double share = (level - from) / (to - from);
    return PlanePoint{raster.x(static_cast<double>(i) + (upwards ? 0.0 : share)),
                      raster.y(static_cast<double>(j) + (upwards ? share : 0.0))};
  };

  // Walk the open lines from their ends, then the closed ones.
  std::vector<std::vector<PlanePoint>> lines;
  std::vector<bool> visited(next.size(), false);
  for (const bool closed : {false, true}) {
    for (std::size_t start = 0; start < next.size(); ++start) {
      if (visited[start] || next[start][0] == none || (!closed && next[start][1] != none)) continue;
      std::vector<PlanePoint> line;
      for (std::size_t edge = start; edge != none;) {
        visited[edge] = true;
        line.push_back(place(edge));
        std::size_t following = none;
        for (std::size_t candidate : next[edge])
          if (following == none && candidate != none && !visited[candidate]) following = candidate;
        edge = following;
      }
      if (closed) line.push_back(line.front());
      lines.push_back(std::move(line));
    }
  }
  return lines;
}

}  // namespace drumsweep

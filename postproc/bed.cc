#include "postproc/bed.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "core/config/schema.h"

namespace drumsweep {

BedGrid bed_grid(const BeltConfig& belt, const ObjectiveConfig& objective, double ball_diameter_m, double duration_s,
                 std::int64_t num_blocks) {
  const double cell = objective.cell_diameters * ball_diameter_m;
  const double strip = std::abs(belt.speed_m_s) * duration_s;
  if (!(belt.width_m > 0.0) || !std::isfinite(belt.width_m))
    throw InputError(fmt::format("belt.width_m = {}: a bed needs a width above 0 m", belt.width_m));
  if (!(cell > 0.0) || !std::isfinite(cell))
    throw InputError(fmt::format("objective.cell_diameters = {} with balls of {} m: a bed cell needs a size above 0 m",
                                 objective.cell_diameters, ball_diameter_m));
  if (!(strip > 0.0) || !std::isfinite(strip))
    throw InputError(fmt::format("belt.speed_m_s = {} over {} s: a bed needs a belt that moves for a time above 0 s",
                                 belt.speed_m_s, duration_s));

  // More cells than this is a slip in the input (a cell of a micrometre), and would not fit the memory.
  constexpr double max_cells = 1e8;
  const double half_across = std::max(1.0, std::round(belt.width_m / (2.0 * cell)));
  const double blocks = static_cast<double>(std::max<std::int64_t>(1, num_blocks));
  const double rows_per_block = std::max(1.0, std::round(strip / (cell * blocks)));
  if (2.0 * half_across * rows_per_block * blocks > max_cells)
    throw InputError(fmt::format("objective.cell_diameters = {}: cells of {} m on a strip of {} m x {} m are too many",
                                 objective.cell_diameters, cell, strip, belt.width_m));

  BedGrid grid;
  grid.num_across = 2 * static_cast<int>(half_across);
  grid.num_along = static_cast<int>(rows_per_block * blocks);
  grid.cell_across_m = belt.width_m / grid.num_across;
  grid.cell_along_m = strip / grid.num_along;
  return grid;
}

double place_on_strip(const Landing& landing, double t_begin, const BeltConfig& belt, double strip_m) {
  const double place = std::fmod(landing.x - belt.speed_m_s * (landing.time - t_begin), strip_m);
  return place < 0.0 ? place + strip_m : place;
}

Bed build_bed(std::span<const Landing> landings, double t_begin, double duration_s, const BeltConfig& belt,
              const ObjectiveConfig& objective, const BedGrid& grid) {
  Bed bed;
  bed.grid = grid;
  bed.height_m.assign(static_cast<std::size_t>(grid.num_along) * static_cast<std::size_t>(grid.num_across), 0.0);

  const double strip = grid.cell_along_m * grid.num_along;
  const double filled_area = objective.packing * grid.cell_along_m * grid.cell_across_m;
  const bool open_edge = belt.edge == "open";
  for (const Landing& landing : landings) {
    if (!std::isfinite(landing.time) || !std::isfinite(landing.x) || !std::isfinite(landing.y) ||
        !std::isfinite(landing.radius))
      throw std::invalid_argument(
          fmt::format("landing of ball {} is not finite: t = {} s, x = {} m, y = {} m, r = {} m", landing.ball_id,
                      landing.time, landing.x, landing.y, landing.radius));
    if (landing.time < t_begin || landing.time >= t_begin + duration_s) continue;
    if (open_edge && (landing.y < 0.0 || landing.y > belt.width_m)) {
      ++bed.spilled;
      continue;
    }

    // Rounding may put the wrapped place on the strip's end.
    const double place = place_on_strip(landing, t_begin, belt, strip);
    const int along = std::min(grid.num_along - 1, static_cast<int>(place / grid.cell_along_m));

    // Across: clamp before the conversion, so that a ball far outside cannot overflow.
    const double column = std::clamp(landing.y / grid.cell_across_m, 0.0, grid.num_across - 1.0);
    const int across = static_cast<int>(column);

    const double radius = landing.radius;
    const double volume = 4.0 / 3.0 * std::numbers::pi * radius * radius * radius;
    bed.height_m[bed.index(along, across)] += volume / filled_area;
    ++bed.landed;
  }
  return bed;
}

namespace {

/// Height that goes from one cell to the next in a pass, given their difference.
inline double slide(double difference, double limit, double threshold) {
  // A fifth: five cells in a cross share alike, so that no pass turns a peak into a pit.
  constexpr double share = 0.2;
  const double steep = std::abs(difference);
  const double moved = steep > threshold ? share * (steep - limit) : 0.0;
  return std::copysign(moved, difference);
}

}  // namespace

// Why this scheme: all pairs slide at once, each by a share c = 1/5 of its excess over the limit. There is no order of
// visits, hence no bias: mirror images slide to mirror images, bit for bit. (A pass that updates pair by pair needs
// half the passes, but its heaps lean with the order of visits.) Why it ends: let E = sum h^2 / 2. Moving q along the
// pairs changes E by -sum q d + |B^T q|^2 / 2, and |B^T q|^2 is at most 8 sum q^2 on a grid of four neighbours. With q
// <= c d this is at most -(1 - 4 c) sum q d < 0, and a pair that slides has q and d above a fixed amount, so E >= 0
// allows finitely many passes. Heights stay within bounds as each new height is a weighted mean of the cell and its
// neighbours (4 c < 1).
void topple(Bed& bed, double friction_angle_deg) {
  if (!(friction_angle_deg < 90.0) || bed.height_m.empty()) return;
  const double slope = std::tan(friction_angle_deg * std::numbers::pi / 180.0);
  const double limit_along = slope * bed.grid.cell_along_m;
  const double limit_across = slope * bed.grid.cell_across_m;
  // The absolute part stays above the rounding of the heights, or a bed at friction angle 0 would never be done.
  const double tiny = std::max(1e-9, 1e-12 * *std::max_element(bed.height_m.begin(), bed.height_m.end()));
  const double threshold_along = limit_along * (1.0 + 1e-6) + tiny;
  const double threshold_across = limit_across * (1.0 + 1e-6) + tiny;

  const std::size_t rows = static_cast<std::size_t>(bed.grid.num_along);
  const std::size_t columns = static_cast<std::size_t>(bed.grid.num_across);
  std::vector<double>& height = bed.height_m;
  std::vector<double> along(rows * columns, 0.0);         // from (i, j) to (i + 1, j), (num_along x num_across) [m]
  std::vector<double> across(rows * (columns + 1), 0.0);  // from (i, j - 1) to (i, j), with both walls [m]
  for (;;) {
    // What slides, from the heights at the start of the pass.
    bool moving = false;
    for (std::size_t i = 0; i < rows; ++i) {
      const double* here = &height[i * columns];
      const double* next = &height[(i + 1 == rows ? 0 : i + 1) * columns];
      double* to_next = &along[i * columns];
      double* to_right = &across[i * (columns + 1) + 1];
      for (std::size_t j = 0; j < columns; ++j) {
        to_next[j] = slide(here[j] - next[j], limit_along, threshold_along);
        moving |= to_next[j] != 0.0;
      }
      for (std::size_t j = 0; j + 1 < columns; ++j) {
        to_right[j] = slide(here[j] - here[j + 1], limit_across, threshold_across);
        moving |= to_right[j] != 0.0;
      }
    }
    if (!moving) return;

    // Move it. Differences of opposite sides first: that keeps the sum the same for mirror images.
    for (std::size_t i = 0; i < rows; ++i) {
      double* here = &height[i * columns];
      const double* from_previous = &along[(i == 0 ? rows - 1 : i - 1) * columns];
      const double* to_next = &along[i * columns];
      const double* from_left = &across[i * (columns + 1)];
      const double* to_right = from_left + 1;
      for (std::size_t j = 0; j < columns; ++j)
        here[j] += (from_previous[j] - to_next[j]) + (from_left[j] - to_right[j]);
    }
  }
}

}  // namespace drumsweep

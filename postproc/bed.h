/// The bed of balls on the moving belt (S1, section 2): landings binned in the frame of the
/// belt, then toppled to the friction angle. A bed covers whole turns of the drum and is periodic along the belt: the
/// flow is stationary, so nothing is lost and nothing slumps at the strip's ends.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/config/study.h"
#include "core/state/landing.h"

namespace drumsweep {

/// Cells of the strip of belt that passes in the window. All cells are alike, so heights add up like volumes.
struct BedGrid {
  int num_along = 0, num_across = 0;
  double cell_along_m = 0.0, cell_across_m = 0.0;
};

struct Bed {
  BedGrid grid;
  std::vector<double> height_m;  ///< (num_along x num_across), across fastest [m]
  std::int64_t landed = 0;       ///< balls of the window that lie on the belt
  std::int64_t spilled = 0;      ///< balls of the window that fell past an open edge

  std::size_t index(int along, int across) const {
    return static_cast<std::size_t>(along) * static_cast<std::size_t>(grid.num_across) +
           static_cast<std::size_t>(across);
  }
};

/// Cells of objective.cell_diameters ball diameters, adjusted so that they divide the strip exactly: an even number
/// across (2 N modes), a multiple of num_blocks along (blocks for the error estimate are whole rows).
/// @param duration_s  length of the window [s], whole turns for a strip that closes on itself
/// @throws InputError when the belt stands still or a length is not positive: there is no strip then.
BedGrid bed_grid(const BeltConfig& belt, const ObjectiveConfig& objective, double ball_diameter_m, double duration_s,
                 std::int64_t num_blocks);

/// Where the belt was struck along the strip, in its own frame: x - v (t - t_begin), wrapped into [0, strip].
double place_on_strip(const Landing& landing, double t_begin, const BeltConfig& belt, double strip_m);

/// Puts the landings with t in [t_begin, t_begin + duration) on the belt, see place_on_strip(); each ball
/// raises its cell by V_ball / (packing * cell area). Edge "skirt" keeps what lands past an edge in the edge cell,
/// "open" counts it as spilled. Heights are summed in the order given: pass landings in canonical order.
/// @throws std::invalid_argument naming the ball when a landing is not finite.
Bed build_bed(std::span<const Landing> landings, double t_begin, double duration_s, const BeltConfig& belt,
              const ObjectiveConfig& objective, const BedGrid& grid);

/// Cellular automaton of S1: topples slopes between a cell and its four neighbours (periodic along, closed walls
/// across) until none exceeds tan(angle) * (1 + 1e-6) plus 1 nm per cell. Volume is conserved to rounding, heights stay
/// between the lowest and the highest at the start, a bed without steep slopes is left bit for bit as it is, and the
/// result has the symmetries of the bed exactly. Cost: O(cells) a pass, about (width of the widest slide in cells)^2
/// passes times ten.
void topple(Bed& bed, double friction_angle_deg);

}  // namespace drumsweep

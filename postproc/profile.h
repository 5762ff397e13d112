/// Height of the bed across the belt, averaged along it (S1, section 2).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/config/study.h"
#include "postproc/bed.h"

namespace drumsweep {

/// Mean height of num_across cells; cell i covers [y_begin + i * cell, y_begin + (i + 1) * cell].
struct Profile {
  double cell_m = 0.0;
  double y_begin_m = 0.0;        ///< from the belt's edge
  std::vector<double> height_m;  ///< (num_cells) [m]

  double centre_m(std::size_t cell) const { return y_begin_m + (static_cast<double>(cell) + 0.5) * cell_m; }
};

/// h(y): mean over the whole strip.
Profile mean_profile(const Bed& bed);

/// The same over each of num_blocks equal pieces of the strip, in the order along the belt.
/// @pre num_blocks divides bed.grid.num_along
std::vector<Profile> block_profiles(const Bed& bed, std::int64_t num_blocks);

/// Standard error of the mean profile from its blocks, s / sqrt(K), shape (num_cells) [m]; NaN for a single block.
std::vector<double> standard_error(std::span<const Profile> blocks);

/// The cells whose centres lie under the outlet, [outlet_begin, outlet_begin + length * cos(inclination)]: an even
/// number, the last is dropped if need be. What lies past the belt's edge is not there.
/// @throws InputError when fewer than two cells lie under the outlet.
Profile footprint(const Profile& belt_profile, const BeltConfig& belt, double outlet_length_m, double inclination_deg);

}  // namespace drumsweep

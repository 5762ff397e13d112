#include "postproc/profile.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "core/config/schema.h"

namespace drumsweep {
namespace {

/// Mean over rows [begin, end).
Profile mean_of_rows(const Bed& bed, int begin, int end) {
  Profile profile{bed.grid.cell_across_m, 0.0, {}};
  profile.height_m.assign(static_cast<std::size_t>(bed.grid.num_across), 0.0);
  for (int i = begin; i < end; ++i)
    for (int j = 0; j < bed.grid.num_across; ++j)
      profile.height_m[static_cast<std::size_t>(j)] += bed.height_m[bed.index(i, j)];
  for (double& height : profile.height_m) height /= end - begin;
  return profile;
}

}  // namespace

Profile mean_profile(const Bed& bed) { return mean_of_rows(bed, 0, bed.grid.num_along); }

std::vector<Profile> block_profiles(const Bed& bed, std::int64_t num_blocks) {
  if (num_blocks < 1 || bed.grid.num_along % num_blocks != 0)
    throw std::invalid_argument(
        fmt::format("{} rows of the bed do not make {} equal blocks", bed.grid.num_along, num_blocks));
  const int rows = static_cast<int>(bed.grid.num_along / num_blocks);
  std::vector<Profile> blocks;
  for (int begin = 0; begin < bed.grid.num_along; begin += rows)
    blocks.push_back(mean_of_rows(bed, begin, begin + rows));
  return blocks;
}

std::vector<double> standard_error(std::span<const Profile> blocks) {
  if (blocks.empty()) return {};
  const double count = static_cast<double>(blocks.size());
  std::vector<double> sigma(blocks.front().height_m.size(), std::nan(""));
  if (blocks.size() < 2) return sigma;
  for (std::size_t j = 0; j < sigma.size(); ++j) {
    double mean = 0.0, squares = 0.0;
    for (const Profile& block : blocks) mean += block.height_m[j] / count;
    for (const Profile& block : blocks) squares += (block.height_m[j] - mean) * (block.height_m[j] - mean);
    sigma[j] = std::sqrt(squares / ((count - 1.0) * count));
  }
  return sigma;
}

Profile footprint(const Profile& belt_profile, const BeltConfig& belt, double outlet_length_m, double inclination_deg) {
  const double begin = belt.outlet_begin_m;
  const double end = begin + outlet_length_m * std::cos(inclination_deg * std::numbers::pi / 180.0);
  Profile inside{belt_profile.cell_m, 0.0, {}};
  for (std::size_t j = 0; j < belt_profile.height_m.size(); ++j) {
    const double centre = belt_profile.centre_m(j);
    if (centre < begin || centre > end) continue;
    if (inside.height_m.empty()) inside.y_begin_m = belt_profile.y_begin_m + static_cast<double>(j) * inside.cell_m;
    inside.height_m.push_back(belt_profile.height_m[j]);
  }
  if (inside.height_m.size() % 2 == 1) inside.height_m.pop_back();
  if (inside.height_m.empty())
    throw InputError(fmt::format(
        "belt.outlet_begin_m = {}: the outlet's footprint [{}, {}] m covers fewer than two bed cells of {} m "
        "on a belt of {} m",
        begin, begin, end, belt_profile.cell_m, belt.width_m));
  return inside;
}

}  // namespace drumsweep

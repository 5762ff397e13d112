#include "postproc/objective.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/config/schema.h"
#include "postproc/spectrum.h"

namespace drumsweep {
namespace {

double weight(std::size_t n, const std::string& weights) {
  const int steps = static_cast<int>(n) - 1;
  if (weights == "uniform") return 1.0;
  return std::ldexp(1.0, weights == "growing" ? steps : -steps);
}

double unevenness_of(std::span<const double> moduli, std::size_t num_cells, const ObjectiveConfig& objective) {
  std::size_t num_modes = num_cells / 2;
  if (objective.modes > 0) num_modes = std::min(num_modes, static_cast<std::size_t>(objective.modes));
  if (num_modes == 0) return 0.0;
  double sum = 0.0;
  for (std::size_t n = 1; n <= num_modes; ++n) sum += weight(n, objective.weights) * (moduli[n] + moduli[n]);
  const double divisor = static_cast<double>(objective.normalization == "samples" ? 2 * num_modes : num_modes);
  return sum / divisor;
}

/// Jackknife error of f, from the profiles of the blocks (see the header).
double jackknife_sigma(std::span<const Profile> blocks, const ObjectiveConfig& objective) {
  const std::size_t num_cells = blocks.front().height_m.size();
  const double count = static_cast<double>(blocks.size());

  // f without block i.
  std::vector<double> without(blocks.size());
  std::vector<double> height(num_cells);
  for (std::size_t left_out = 0; left_out < blocks.size(); ++left_out) {
    std::fill(height.begin(), height.end(), 0.0);
    for (std::size_t k = 0; k < blocks.size(); ++k) {
      if (k == left_out) continue;
      for (std::size_t j = 0; j < num_cells; ++j) height[j] += blocks[k].height_m[j] / (count - 1.0);
    }
    without[left_out] = unevenness(height, objective);
  }

  double mean = 0.0, squares = 0.0;
  for (double f : without) mean += f / count;
  for (double f : without) squares += (f - mean) * (f - mean);
  return std::sqrt((count - 1.0) / count * squares);
}

}  // namespace

double unevenness(std::span<const double> height_m, const ObjectiveConfig& objective) {
  return unevenness_of(amplitudes(height_m), height_m.size(), objective);
}

double largest_mode_ratio(std::span<const double> amplitudes_m) {
  if (amplitudes_m.size() < 2 || !(amplitudes_m[0] > 0.0)) return 0.0;
  return *std::max_element(amplitudes_m.begin() + 1, amplitudes_m.end()) / amplitudes_m[0];
}

double duration_of_turns(double turns, const DrumConfig& drum) {
  const double duration = turns * 2.0 * std::numbers::pi / std::abs(drum.angular_velocity_rad_s);
  if (!(duration > 0.0) || !std::isfinite(duration))
    throw InputError(fmt::format("{} turns at drum.angular_velocity_rad_s = {}: the window needs a duration above 0 s",
                                 turns, drum.angular_velocity_rad_s));
  return duration;
}

Evaluation evaluate_in_detail(std::span<const Landing> landings, double t_begin, double turns, const Study& study) {
  const double duration = duration_of_turns(turns, study.drum);
  Evaluation result;
  result.num_blocks = std::max<std::int64_t>(2, std::llround(turns * static_cast<double>(study.outlet.num_slots)));

  // Landings to bed.
  const BedGrid grid = bed_grid(study.belt, study.objective, study.material.diameter_m, duration, result.num_blocks);
  result.bed = build_bed(landings, t_begin, duration, study.belt, study.objective, grid);
  topple(result.bed, study.objective.friction_angle_deg);

  // Bed to profiles, of the whole strip and of each block, in both windows.
  const auto under_outlet = [&](const Profile& profile) {
    return footprint(profile, study.belt, study.outlet.length_m, study.drum.inclination_deg);
  };
  result.belt = mean_profile(result.bed);
  result.belt_blocks = block_profiles(result.bed, result.num_blocks);
  result.footprint = under_outlet(result.belt);
  std::vector<Profile> footprint_blocks;
  for (const Profile& block : result.belt_blocks) footprint_blocks.push_back(under_outlet(block));

  // Profiles to numbers.
  result.belt_amplitudes_m = amplitudes(result.belt.height_m);
  result.footprint_amplitudes_m = amplitudes(result.footprint.height_m);
  Objective& objective = result.objective;
  objective.f_belt_m = unevenness_of(result.belt_amplitudes_m, result.belt.height_m.size(), study.objective);
  objective.f_footprint_m =
      unevenness_of(result.footprint_amplitudes_m, result.footprint.height_m.size(), study.objective);
  objective.sigma_f_belt_m = jackknife_sigma(result.belt_blocks, study.objective);
  objective.sigma_f_footprint_m = jackknife_sigma(footprint_blocks, study.objective);

  const bool on_footprint = study.objective.window == "footprint";
  objective.f_m = on_footprint ? objective.f_footprint_m : objective.f_belt_m;
  objective.sigma_f_m = on_footprint ? objective.sigma_f_footprint_m : objective.sigma_f_belt_m;
  objective.max_an_over_a0 =
      largest_mode_ratio(on_footprint ? result.footprint_amplitudes_m : result.belt_amplitudes_m);
  for (double height : result.belt.height_m) objective.mean_height_m += height;
  objective.mean_height_m /= static_cast<double>(result.belt.height_m.size());
  objective.landed = result.bed.landed;
  objective.spilled = result.bed.spilled;
  return result;
}

Objective evaluate(std::span<const Landing> landings, double t_begin, double turns, const Study& study) {
  return evaluate_in_detail(landings, t_begin, turns, study).objective;
}

}  // namespace drumsweep

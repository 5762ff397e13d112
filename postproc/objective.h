/// Unevenness f of the bed (S1, section 2) and its statistical error.
///
///   f = (1/N) sum_{n=1..N} w_n (|a_-n| + |a_n|),   2 N cells in the window,  w_n = 2^-(n-1)
///
/// Departures, each an option: S1 prints w_n = 2^(|n|-1) and calls it decaying ("growing"); "samples" divides by 2 N,
/// which would cap f at half of what S1 reports for its point III; the window may be the belt or the outlet's
/// footprint; with objective.modes = M only n <= M count, and N is M.
///
/// Toppling caps f: all balls on one line score 6.7 to 6.9 mean heights at lab values (70 mm), not the 8 of one cell.
///
/// f is a sum of moduli, so it is biased upwards by counting noise: an even bed of finitely many balls scores above 0.
/// At lab values and two turns that floor is about 0.5 mm if the balls land independently; it falls with 1/sqrt(turns).
/// sigma does not contain the bias.
///
/// sigma: delete-one jackknife (Efron and Stein, Ann. Statist. 9, 586, 1981) over K blocks along the belt,
///   sigma^2 = (K-1)/K sum_i (f_(i) - mean f_(.))^2,   f_(i) from the profile without block i.
/// Blocks are one slot's passage long (1/num_slots of a turn), at least two, so each sees the same part of the cycle.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/config/study.h"
#include "core/state/landing.h"
#include "postproc/bed.h"
#include "postproc/profile.h"

namespace drumsweep {

struct Objective {
  double f_m = 0.0, sigma_f_m = 0.0;                      ///< in the window of objective.window
  double f_belt_m = 0.0, sigma_f_belt_m = 0.0;            ///< whole belt
  double f_footprint_m = 0.0, sigma_f_footprint_m = 0.0;  ///< under the outlet
  double max_an_over_a0 = 0.0;  ///< largest |a_n| / |a_0|, n >= 1, configured window; S1 stops at 1/10
  double mean_height_m = 0.0;   ///< whole belt
  std::int64_t landed = 0;      ///< balls on the belt in the window of time
  std::int64_t spilled = 0;     ///< balls past an open edge in the window of time
};

/// Everything between the landings and f.
struct Evaluation {
  Objective objective;
  std::int64_t num_blocks = 0;
  Bed bed;                                ///< toppled
  Profile belt, footprint;                ///< mean profiles of both windows
  std::vector<Profile> belt_blocks;       ///< (num_blocks), see standard_error()
  std::vector<double> belt_amplitudes_m;  ///< |a_n|, n = 0 ... N
  std::vector<double> footprint_amplitudes_m;
};

/// f of 2 N heights; 0 for fewer than two.
double unevenness(std::span<const double> height_m, const ObjectiveConfig& objective);

/// Largest |a_n| / |a_0| over n >= 1; 0 when a_0 is.
double largest_mode_ratio(std::span<const double> amplitudes_m);

/// Duration of that many turns of the drum [s]. @throws InputError when the drum stands still or turns <= 0.
double duration_of_turns(double turns, const DrumConfig& drum);

/// f of the landings with t in [t_begin, t_begin + turns). No landing at all gives zeros, never NaN.
/// The result is a function of the landings (in their order) and of drum, outlet, belt, material.diameter_m and
/// objective.
Objective evaluate(std::span<const Landing> landings, double t_begin, double turns, const Study& study);

/// The same with the bed, the profiles and the spectra.
Evaluation evaluate_in_detail(std::span<const Landing> landings, double t_begin, double turns, const Study& study);

}  // namespace drumsweep

/// Spectrum of a profile. The only file that knows FFTW.
#pragma once

#include <span>
#include <vector>

namespace drumsweep {

/// Moduli |a_n|, n = 0 ... size / 2, of the unnormalised transform a_n = sum_k h_k exp(-2 pi i n k / size), in the unit
/// of the values; a_-n has the same modulus. Empty in, empty out.
/// May be called from any thread: FFTW's planner is one for the whole process, so planning is behind a lock.
/// The plan is estimated, never measured, and uses no vector instructions: the bits do not depend on the machine's mood
/// nor on its vector width.
std::vector<double> amplitudes(std::span<const double> values);

}  // namespace drumsweep

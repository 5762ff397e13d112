/// Which vector instructions the program is compiled for. It takes the best that the machine has when it runs; results are the same
/// bits with all of them: vectors are sixteen lanes of one pack in any case, there is no fused multiply-add, and square roots and
/// divisions are exact.
#pragma once

// SSSE3 and the AVX-512 of Ice Lake bring nothing here; what stays is scalar (the judge), SSE4, AVX2 and AVX-512.
#ifndef DRUMSWEEP_SANITIZE
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#else
// The kernels are templates; two widths are enough for the sanitizers, and building all of them takes minutes.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3 | HWY_AVX3_DL)
#endif

#include <cstddef>
#include <string>
#include <vector>

namespace drumsweep {

/// Contacts are solved this many at a time, on any machine.
inline constexpr std::size_t pack_width = 16;

/// Name of the instructions in use and their lanes: "AVX3, 16 lanes".
std::string simd_target();

/// Names of those that this machine can run, widest first; the last is scalar.
std::vector<std::string> simd_targets();

/// For tests: use these from now on, in all threads; "" returns to the best. @throws std::invalid_argument for an unknown name
void use_simd_target(const std::string& name);

}  // namespace drumsweep

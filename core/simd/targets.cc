#include "core/simd/targets.h"

#include <hwy/targets.h>

#include <algorithm>
#include <stdexcept>

namespace drumsweep {
namespace {

struct Target {
  std::int64_t bit;
  const char* name;
  int lanes;
};
constexpr Target targets[] = {
    {HWY_AVX3, "AVX-512", 16}, {HWY_AVX2, "AVX2", 8}, {HWY_SSE4, "SSE4", 4}, {HWY_SCALAR, "scalar", 1}};

bool runs_here(const Target& t) { return t.bit == HWY_SCALAR || (hwy::SupportedTargets() & t.bit) != 0; }

}  // namespace

std::string simd_target() {
  for (const Target& t : targets)
    if (runs_here(t)) return std::string(t.name) + ", " + std::to_string(t.lanes) + " lanes";
  return "";
}

std::vector<std::string> simd_targets() {
  std::vector<std::string> out;
  for (const Target& t : targets)
    if (runs_here(t)) out.emplace_back(t.name);
  return out;
}

void use_simd_target(const std::string& name) {
  std::int64_t bits = 0;  // all
  for (const Target& t : targets)
    if (name == t.name) bits = t.bit;
  if (bits == 0 && !name.empty()) throw std::invalid_argument("no vector target " + name);
  hwy::SetSupportedTargetsForTest(bits);
  hwy::GetChosenTarget().DeInit();
}

}  // namespace drumsweep

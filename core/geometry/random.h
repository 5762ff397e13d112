/// Counter-based random numbers: Philox 4x32-10 (Salmon et al., SC 2011). A draw depends on (seed, purpose, index) and
/// on nothing else, so it is the same for any rank, thread, restart or order of evaluation.
#pragma once

#include <array>
#include <cstdint>

namespace drumsweep {

/// What a stream is for; a new purpose takes a new number and leaves the others as they are.
enum class Purpose : std::uint32_t {
  texture_drum = 1,
  texture_outlet = 2,
  feed = 3,
  fill = 4,
  ball_size = 5,
  space_filling = 6,
  posterior_draw = 7,
  fit_parameters = 8,
  campaign = 20,
  bootstrap = 21,
  adversary = 22
};

inline std::array<std::uint32_t, 4> philox(std::array<std::uint32_t, 4> counter, std::array<std::uint32_t, 2> key) {
  for (int round = 0; round < 10; ++round) {
    const std::uint64_t p0 = std::uint64_t{0xD2511F53} * counter[0], p1 = std::uint64_t{0xCD9E8D57} * counter[2];
    counter = {static_cast<std::uint32_t>(p1 >> 32) ^ counter[1] ^ key[0], static_cast<std::uint32_t>(p1),
               static_cast<std::uint32_t>(p0 >> 32) ^ counter[3] ^ key[1], static_cast<std::uint32_t>(p0)};
    key = {key[0] + 0x9E3779B9u, key[1] + 0xBB67AE85u};
  }
  return counter;
}

/// Four numbers uniform in [0, 1).
inline std::array<double, 4> uniform4(std::int64_t seed, Purpose purpose, std::uint64_t index, std::uint32_t draw = 0) {
  const auto s = static_cast<std::uint64_t>(seed);
  const auto bits = philox({static_cast<std::uint32_t>(index), static_cast<std::uint32_t>(index >> 32), draw,
                            static_cast<std::uint32_t>(purpose)},
                           {static_cast<std::uint32_t>(s), static_cast<std::uint32_t>(s >> 32)});
  return {bits[0] * 0x1p-32, bits[1] * 0x1p-32, bits[2] * 0x1p-32, bits[3] * 0x1p-32};
}

/// Seed of a replicate: the same drum simulated once more with other random numbers. Replicate 0 has the seed itself.
inline std::int64_t replicate_seed(std::int64_t seed, double replicate) {
  if (replicate == 0) return seed;
  // SplitMix64 (Steele, Lea, Flood 2014) of both, so that seeds and replicates do not meet; kept below 2^53 like seeds.
  std::uint64_t z = static_cast<std::uint64_t>(seed) + 0x9E3779B97F4A7C15u * static_cast<std::uint64_t>(replicate);
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
  return static_cast<std::int64_t>((z ^ (z >> 31)) >> 11);
}

}  // namespace drumsweep

// Parts of the engine by themselves, and what the machine's memory allows: `build/release/tests/micro_bench`.
//
// Solve/N/TARGET: one iteration over a synthetic packing of N balls with 2.4 contacts each; ns per contact is the reciprocal of
// items_per_second. A contact moves 52 bytes of row and impulse in and 16 out, and two bodies of 32 bytes in and out, which stay in the
// caches; Triad is the same traffic without arithmetic.
#include <benchmark/benchmark.h>

#include <cmath>

#include "core/geometry/random.h"
#include "core/simd/targets.h"
#include "core/solver/packer.h"
#include "core/solver/projected_gauss_seidel.h"

namespace drumsweep {
namespace {

double draw(std::uint64_t i, std::uint32_t k = 0) { return uniform4(1, Purpose::fill, i, k)[0]; }

struct Synthetic {
  ContactProblem problem;
  std::vector<BodyVelocity> velocity;
  std::size_t num_contacts = 0;
};

using Pair = std::array<std::uint32_t, 2>;

/// Neighbours on a lattice of 14 x 14 balls a layer, some left out.
std::vector<Pair> contacts_from(std::uint32_t begin, std::uint32_t end, std::uint32_t last) {
  std::vector<Pair> out;
  for (std::uint32_t i = begin; i < end; ++i)
    for (const std::uint32_t step : {1u, 14u, 15u, 182u, 196u, 211u})
      if (i + step < last && draw(i, step) < 0.4) out.push_back({i, i + step});
  return out;
}

Synthetic packing(std::uint32_t num) {
  constexpr std::uint32_t slab = 600;
  Synthetic out;
  const auto f = [](double x) { return static_cast<float>(x); };
  for (std::uint32_t i = 0; i < num; ++i)
    out.velocity.push_back(
        {{f(draw(i) - 0.5), f(draw(i, 1) - 0.5), f(draw(i, 2) - 0.5)}, 760, {f(draw(i, 3) - 0.5), 0, 0}, 0.005f});
  const std::uint32_t num_slabs = (num + slab - 1) / slab;
  out.velocity.resize(num + num_slabs, {{0, 0, 0}, 0, {0, 0, 0}, 1});
  out.problem.blocks.resize(num_slabs);
  out.problem.phases.resize(2);
  Packer packer;
  for (std::uint32_t s = 0; s < num_slabs; ++s) {
    out.problem.phases[s % 2].push_back(s);
    const std::uint32_t begin = s * slab, end = std::min(num, begin + slab), last = std::min(num, end + slab);
    const std::vector<Pair> contacts = contacts_from(begin, end, last);
    packer.begin(begin, last);
    for (const Pair& p : contacts) packer.add(p[0], p[1]);
    ContactPacks& packs = out.problem.blocks[s].pairs;
    for (const Packer::Lanes& lanes : packer.finish()) {
      ContactPack row{};
      for (std::size_t lane = 0; lane < pack_width; ++lane) {
        row.a[lane] = row.b[lane] = num + s;
        row.arm[lane] = 1;
        row.bias[lane] = no_row;
        if (lanes[lane] == Packer::none) continue;
        const auto& [a, b] = contacts[lanes[lane]];
        row.a[lane] = b;
        row.b[lane] = a;
        const double x = draw(a, b) - 0.5, y = draw(b, a) - 0.5, z = 0.7, length = std::sqrt(x * x + y * y + z * z);
        row.normal[0][lane] = f(x / length);
        row.normal[1][lane] = f(y / length);
        row.normal[2][lane] = f(z / length);
        row.bias[lane] = f(0.02 * draw(a, b + 7));
        row.regularization[lane] = 50;
        row.friction[lane] = 0.7f;
      }
      packs.active.push_back(static_cast<std::uint32_t>(packs.rows.size()));
      packs.rows.push_back(row);
    }
    packs.impulse.resize(packs.rows.size());
    out.num_contacts += contacts.size();
  }
  return out;
}

void solve_packing(benchmark::State& state, const std::string& target) {
  use_simd_target(target);
  Synthetic s = packing(static_cast<std::uint32_t>(state.range(0)));
  for (auto _ : state) solve(s.problem, 1, 1, s.velocity);
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(s.num_contacts));
  use_simd_target("");
}

void pack(benchmark::State& state) {
  const std::vector<Pair> contacts = contacts_from(0, 600, 1200);
  Packer packer;
  for (auto _ : state) {
    packer.begin(0, 1200);
    for (const Pair& p : contacts) packer.add(p[0], p[1]);
    benchmark::DoNotOptimize(packer.finish().size());
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(contacts.size()));
}
BENCHMARK(pack)->Name("Pack");

/// a = b + s c over three arrays of this many kilobytes together.
void triad(benchmark::State& state) {
  const auto num = static_cast<std::size_t>(state.range(0)) * 1024 / 12;
  std::vector<float> a(num), b(num, 1.0f), c(num, 2.0f);
  for (auto _ : state) {
    for (std::size_t i = 0; i < num; ++i) a[i] = b[i] + 3.0f * c[i];
    benchmark::ClobberMemory();
  }
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(12 * num));
}
BENCHMARK(triad)->Name("Triad")->Arg(600)->Arg(12000)->Arg(120000);

}  // namespace
}  // namespace drumsweep

int main(int argc, char** argv) {
  for (const std::string& target : drumsweep::simd_targets())
    benchmark::RegisterBenchmark(("Solve/" + target).c_str(), drumsweep::solve_packing, target)->Arg(35000)->Arg(80000);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
}

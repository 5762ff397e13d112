#include "core/solver/residual.h"

#include <algorithm>
#include <array>

#include "core/parallel/parallel_for.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/solver/residual.cc"
#include <hwy/foreach_target.h>

#include "core/effects/rotation_resistance-inl.h"

#ifndef DRUMSWEEP_RESIDUAL_ONCE
#define DRUMSWEEP_RESIDUAL_ONCE
namespace drumsweep {
struct ResidualSum {
  double max = 0, sum = 0;
  std::size_t num = 0;
};
}  // namespace drumsweep
#endif

HWY_BEFORE_NAMESPACE();
namespace drumsweep {
namespace HWY_NAMESPACE {

HWY_INLINE FloatV Squared(FloatV x) { return hn::Mul(x, x); }

template <bool wall>
void AddPacks(const ContactPacks& packs, const BodyVelocity* velocity, ResidualSum& total) {
  const FloatTag d;
  const FloatV one = hn::Set(d, 1.0f), zero = hn::Zero(d), tiny = hn::Set(d, 1e-30f);
  for (const std::uint32_t p : packs.active) {
    const ContactPack& row = packs.rows.data()[p];
    const ImpulsePack& impulse = packs.impulse.data()[p];
    HWY_ALIGN float errors[pack_width];
    for (std::size_t lane = 0; lane < pack_width; lane += simd_lanes) {
      const BodiesV a = LoadBodies(velocity, row.a + lane), b = LoadOther<wall>(packs, p, lane, velocity);
      const Vector3V n = Load3(row.normal, lane);
      const FloatV arm = hn::Load(d, row.arm + lane), w = hn::Add(a.inverse_mass, b.inverse_mass);
      const Vector3V u = SlidingVelocity(a, b, n * arm);
      const FloatV u_n = Dot(n, u);

      const FloatV lambda = hn::Load(d, impulse.normal + lane), sigma = hn::Load(d, row.regularization + lane);
      const FloatV diagonal = hn::Max(hn::Add(w, sigma), tiny);
      const FloatV f_n = hn::Sub(hn::Add(u_n, hn::Mul(sigma, lambda)), hn::Load(d, row.bias + lane));
      const FloatV projected = hn::Max(hn::Sub(lambda, hn::Div(f_n, diagonal)), zero);
      const FloatV e_n = hn::Mul(hn::Sub(lambda, projected), diagonal);

      const FloatV tangent_diagonal = TangentDiagonal(arm, w);
      const Vector3V t = Load3(impulse.tangent, lane);
      const Vector3V clipped =
          Clip(t - (u - n * u_n) * hn::Div(one, tangent_diagonal), hn::Mul(hn::Load(d, row.friction + lane), lambda));
      const Vector3V e_t = (t - clipped) * tangent_diagonal;
      FloatV squared = hn::Add(Squared(e_n), Dot(e_t, e_t));

      if (!packs.turn.empty()) {
        const RotationArmsV arms = RotationArms<wall>(a, b);
        const Vector3V q = Load3(packs.turn.data()[p].of, lane);
        const Vector3V wanted = StoppingTurn<wall>(packs, p, lane, a, b, arms, n, lambda, q);
        const Vector3V e_r = (q - wanted) * hn::Div(one, arms.inverse);
        squared = hn::Add(squared, Dot(e_r, e_r));
      }
      hn::Store(hn::Sqrt(squared), d, errors + lane);
    }
    // In the order of lanes, whatever the vectors.
    for (std::size_t lane = 0; lane < pack_width; ++lane) {
      if (row.bias[lane] == no_row) continue;
      const auto e = static_cast<double>(errors[lane]);
      total.max = e > total.max ? e : total.max;
      total.sum += e;
      ++total.num;
    }
  }
}

void AddBlock(const ContactBlock& block, const BodyVelocity* velocity, ResidualSum& total) {
  AddPacks<false>(block.pairs, velocity, total);
  AddPacks<true>(block.walls, velocity, total);
}

}  // namespace HWY_NAMESPACE
}  // namespace drumsweep
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace drumsweep {

HWY_EXPORT(AddBlock);

Residual natural_map_residual(const ContactProblem& problem, int threads, std::span<const BodyVelocity> velocity) {
  // Block after block, so that the sum does not depend on threads.
  std::vector<ResidualSum> sums(problem.blocks.size());
  for (const auto& phase : problem.phases)
    parallel_for(threads, phase.size(), [&](std::size_t i) {
      HWY_DYNAMIC_DISPATCH(AddBlock)(problem.blocks[phase[i]], velocity.data(), sums[phase[i]]);
    });
  Residual out;
  for (const ResidualSum& s : sums) {
    out.max = std::max(out.max, s.max);
    out.mean += s.sum;
    out.num_rows += s.num;
  }
  if (out.num_rows > 0) out.mean /= static_cast<double>(out.num_rows);
  return out;
}

}  // namespace drumsweep
#endif

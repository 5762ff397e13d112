#include "core/solver/projected_gauss_seidel.h"

#include <algorithm>

#include "core/parallel/parallel_for.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/solver/projected_gauss_seidel.cc"
#include <hwy/foreach_target.h>

#include "core/effects/rotation_resistance-inl.h"

HWY_BEFORE_NAMESPACE();
namespace drumsweep {
namespace HWY_NAMESPACE {

/// Impulse p on a, -p on b, with the tangential part t.
HWY_INLINE void Push(BodiesV& a, BodiesV& b, Vector3V arm_n, Vector3V p, Vector3V t, bool with_b) {
  const Vector3V turn = Cross(arm_n, t) * hn::Set(FloatTag(), 2.5f);
  a.linear = a.linear + p * a.inverse_mass;
  a.surface = a.surface - turn * a.inverse_mass;
  if (!with_b) return;
  b.linear = b.linear - p * b.inverse_mass;
  b.surface = b.surface - turn * b.inverse_mass;
}

/// Torque impulse q over the contact's arm on a, -q on b.
HWY_INLINE void Twist(BodiesV& a, BodiesV& b, const RotationArmsV& arms, Vector3V q, bool with_b) {
  const FloatV k = hn::Set(FloatTag(), 2.5f);
  a.surface = a.surface + q * hn::Mul(hn::Mul(k, arms.a), a.inverse_mass);
  if (with_b) b.surface = b.surface - q * hn::Mul(hn::Mul(k, arms.b), b.inverse_mass);
}

template <bool wall, bool turning, bool apply_only>
HWY_INLINE void VisitPack(ContactPacks& packs, std::size_t p, BodyVelocity* HWY_RESTRICT velocity) {
  const FloatTag d;
  const ContactPack& row = packs.rows.data()[p];
  ImpulsePack& impulse = packs.impulse.data()[p];
  for (std::size_t lane = 0; lane < pack_width; lane += simd_lanes) {
    BodiesV a = LoadBodies(velocity, row.a + lane), b = LoadOther<wall>(packs, p, lane, velocity);
    const Vector3V n = Load3(row.normal, lane), old_t = Load3(impulse.tangent, lane);
    const FloatV arm = hn::Load(d, row.arm + lane), old_n = hn::Load(d, impulse.normal + lane);
    const Vector3V arm_n = n * arm;
    FloatV new_n = old_n;

    if constexpr (apply_only) {
      const FloatV pull = packs.pull.empty() ? hn::Zero(d) : hn::Load(d, packs.pull.data()[p].of + lane);
      Push(a, b, arm_n, n * hn::Sub(old_n, pull) + old_t, old_t, !wall);
    } else {
      const FloatV w = hn::Add(a.inverse_mass, b.inverse_mass), sigma = hn::Load(d, row.regularization + lane);
      const Vector3V u = SlidingVelocity(a, b, arm_n);
      const FloatV u_n = Dot(n, u);

      // Normal impulse: solve the row, clip at zero.
      const FloatV miss = hn::Sub(hn::Sub(hn::Load(d, row.bias + lane), u_n), hn::Mul(sigma, old_n));
      const FloatV wanted = hn::Add(old_n, hn::Div(miss, hn::Max(hn::Add(w, sigma), hn::Set(d, 1e-30f))));
      new_n = hn::IfThenElseZero(hn::Gt(wanted, hn::Zero(d)), wanted);

      // Friction: stop the tangential motion, clip to the disc.
      const FloatV inverse_tangent = hn::Div(hn::Set(d, 1.0f), TangentDiagonal(arm, w));
      const Vector3V new_t =
          Clip(old_t - (u - n * u_n) * inverse_tangent, hn::Mul(hn::Load(d, row.friction + lane), new_n));

      const Vector3V dt = new_t - old_t;
      Push(a, b, arm_n, n * hn::Sub(new_n, old_n) + dt, dt, !wall);
      Store3(new_t, impulse.tangent, lane);
      hn::Store(new_n, d, impulse.normal + lane);
    }

    // Rolling and twisting resistance under the normal impulse: stop the relative rotation, clip to the limits.
    if constexpr (turning) {
      Pack3& turn = packs.turn.data()[p];
      const RotationArmsV arms = RotationArms<wall>(a, b);
      const Vector3V old_q = Load3(turn.of, lane);
      if constexpr (apply_only) {
        Twist(a, b, arms, old_q, !wall);
      } else {
        const Vector3V new_q = StoppingTurn<wall>(packs, p, lane, a, b, arms, n, new_n, old_q);
        Twist(a, b, arms, new_q - old_q, !wall);
        Store3(new_q, turn.of, lane);
      }
    }

    StoreBodies(a, velocity, row.a + lane);
    if constexpr (!wall) StoreBodies(b, velocity, row.b + lane);
  }
}

template <bool turning, bool apply_only>
HWY_INLINE void VisitBlock(ContactBlock& block, BodyVelocity* velocity) {
  for (const std::uint32_t p : block.pairs.active) VisitPack<false, turning, apply_only>(block.pairs, p, velocity);
  for (const std::uint32_t p : block.walls.active) VisitPack<true, turning, apply_only>(block.walls, p, velocity);
}

void IterateBlock(ContactBlock& block, bool turning, BodyVelocity* velocity) {
  turning ? VisitBlock<true, false>(block, velocity) : VisitBlock<false, false>(block, velocity);
}

void ApplyBlock(ContactBlock& block, bool turning, BodyVelocity* velocity) {
  turning ? VisitBlock<true, true>(block, velocity) : VisitBlock<false, true>(block, velocity);
}

}  // namespace HWY_NAMESPACE
}  // namespace drumsweep
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace drumsweep {

HWY_EXPORT(IterateBlock);
HWY_EXPORT(ApplyBlock);

namespace {

// About as many as a shared cache holds: 600 balls with their contacts are 0.1 MB.
constexpr std::size_t cached_slabs = 100;

bool is_empty(const ContactBlock& block) { return block.pairs.active.empty() && block.walls.active.empty(); }

}  // namespace

void apply_impulses(const ContactProblem& problem, int threads, std::span<BodyVelocity> velocity) {
  const auto apply = HWY_DYNAMIC_DISPATCH(ApplyBlock);
  for (const auto& phase : problem.phases)
    parallel_for(threads, phase.size(), [&](std::size_t i) {
      // Reads only: the visit that changes nothing shares its code with the one that does.
      apply(const_cast<ContactBlock&>(problem.blocks[phase[i]]), problem.rotation_resisted, velocity.data());
    });
}

void solve(ContactProblem& problem, int iterations, int threads, std::span<BodyVelocity> velocity) {
  const auto iterate = HWY_DYNAMIC_DISPATCH(IterateBlock);
  const auto visit = [&](std::size_t block) {
    iterate(problem.blocks[block], problem.rotation_resisted, velocity.data());
  };
  if (problem.num_slabs > cached_slabs && is_empty(problem.blocks[problem.num_slabs])) {
    // In a wave: half-iteration t of slab s comes after t - 1 of s - 1, s and s + 1, and with s + 3 t for a clock all that falls on one
    // tick is apart. The order that matters is that of the phases below, so the bits are too; but a slab is visited again while it is
    // still in the cache.
    const std::size_t halves = 2 * static_cast<std::size_t>(iterations), slabs = problem.num_slabs;
    for (std::size_t tick = 0; tick < slabs + 3 * halves; ++tick) {
      const std::size_t first = tick < slabs ? 0 : (tick - slabs) / 3 + 1, past = std::min(halves, tick / 3 + 1);
      parallel_for(threads, past > first ? past - first : 0, [&](std::size_t i) {
        const std::size_t t = first + i, s = tick - 3 * t;
        if (s % 2 == t % 2) visit(s);
      });
    }
    return;
  }
  for (int iteration = 0; iteration < iterations; ++iteration)
    for (const auto& phase : problem.phases)
      parallel_for(threads, phase.size(), [&](std::size_t i) { visit(phase[i]); });
}

}  // namespace drumsweep
#endif

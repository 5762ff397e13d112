#include "core/step/contact_rows.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/step/contact_rows.cc"
#include <hwy/foreach_target.h>

#include "core/contact/contact_law-inl.h"
#include "core/solver/contact_row-inl.h"

HWY_BEFORE_NAMESPACE();
namespace drumsweep {
namespace HWY_NAMESPACE {

#if HWY_TARGET == HWY_SCALAR

HWY_INLINE Vector3V Apart(const RowInput& in, const std::uint32_t* a, const std::uint32_t* b) {
  double apart[3];
  for (int k = 0; k < 3; ++k) apart[k] = in.position[3 * a[0] + k] - in.position[3 * b[0] + k];
  if (in.period > 0) apart[1] -= in.period * __builtin_rint(apart[1] / in.period);
  const FloatTag d;
  return {hn::Set(d, static_cast<float>(apart[0])), hn::Set(d, static_cast<float>(apart[1])),
          hn::Set(d, static_cast<float>(apart[2]))};
}

#else

using DoubleTag = hn::Repartition<double, FloatTag>;
struct Vector3D {
  hn::Vec<DoubleTag> x, y, z;
};

/// Block b holds the two doubles at base + 3 * index[2 b].
template <class D>
HWY_INLINE hn::Vec<D> LoadDoubles(D d, const double* HWY_RESTRICT base, const std::uint32_t* HWY_RESTRICT index) {
  if constexpr (hn::MaxLanes(D()) == 2) {
    return hn::LoadU(d, base + 3 * std::size_t{index[0]});
  } else {
    const hn::Half<D> half;
    return hn::Combine(d, LoadDoubles(half, base, index + hn::MaxLanes(D()) / 2), LoadDoubles(half, base, index));
  }
}

HWY_INLINE Vector3D LoadPlaces(const double* base, const std::uint32_t* index) {
  const DoubleTag d;
  const auto xy0 = LoadDoubles(d, base, index), xy1 = LoadDoubles(d, base, index + 1),
             yz0 = LoadDoubles(d, base + 1, index), yz1 = LoadDoubles(d, base + 1, index + 1);
  return {hn::InterleaveLower(d, xy0, xy1), hn::InterleaveUpper(d, xy0, xy1), hn::InterleaveUpper(d, yz0, yz1)};
}

/// a - b by the shortest way: subtracted in double, kept in float.
HWY_INLINE Vector3V Apart(const RowInput& in, const std::uint32_t* a, const std::uint32_t* b) {
  const DoubleTag d;
  const FloatTag f;
  const hn::Rebind<float, DoubleTag> half;
  constexpr std::size_t lanes = hn::MaxLanes(DoubleTag());
  Vector3D apart[2];
  for (std::size_t k = 0; k < 2; ++k) {
    const Vector3D p = LoadPlaces(in.position, a + k * lanes), q = LoadPlaces(in.position, b + k * lanes);
    apart[k] = {hn::Sub(p.x, q.x), hn::Sub(p.y, q.y), hn::Sub(p.z, q.z)};
    if (in.period > 0) {
      const auto period = hn::Set(d, in.period);
      apart[k].y = hn::Sub(apart[k].y, hn::Mul(period, hn::Round(hn::Div(apart[k].y, period))));
    }
  }
  const auto joined = [&](auto low, auto high)
                          HWY_ATTR { return hn::Combine(f, hn::DemoteTo(half, high), hn::DemoteTo(half, low)); };
  return {joined(apart[0].x, apart[1].x), joined(apart[0].y, apart[1].y), joined(apart[0].z, apart[1].z)};
}

#endif

/// k of a contact with this reduced radius.
HWY_INLINE RealV Stiffness(const Surface& surface, FloatV reduced_radius) {
  const RealV k(surface.law.stiffness);
  return surface.sizes_differ ? k * square_root(RealV(reduced_radius) * RealV(1 / surface.reference)) : k;
}

/// An approach that Newton's law of impact governs: fast, and touching within the step.
HWY_INLINE MaskV IsImpact(const Surface& surface, FloatV overlap, FloatV separating, double h) {
  const FloatTag d;
  const MaskV fast = hn::Lt(separating, hn::Set(d, static_cast<float>(-surface.law.impact_speed)));
  const FloatV then = hn::Sub(overlap, hn::Mul(separating, hn::Set(d, static_cast<float>(h))));
  return hn::And(fast, hn::Ge(then, hn::Zero(d)));
}

template <bool wall>
bool MakeRows(const RowInput& in, const Surface& surface, std::size_t begin, std::size_t end, ContactPacks& packs) {
  const FloatTag d;
  const hn::RebindToUnsigned<FloatTag> u;
  const FloatV zero = hn::Zero(d), one = hn::Set(d, 1.0f), h = hn::Set(d, static_cast<float>(in.time_step)),
               margin = hn::Set(d, static_cast<float>(in.margin));
  const auto last = hn::Set(u, in.num_balls > 0 ? in.num_balls - 1 : 0);
  const bool cohesive = !packs.pull.empty(), turning = !packs.turn.empty();
  bool impacts = false;

  for (std::size_t p = begin; p < end; ++p) {
    ContactPack& row = packs.rows.data()[p];
    ImpulsePack& impulse = packs.impulse.data()[p];
    bool used = false;
    for (std::size_t lane = 0; lane < pack_width; lane += simd_lanes) {
      const BodiesV a = LoadBodies(in.velocity, row.a + lane), b = LoadOther<wall>(packs, p, lane, in.velocity);
      Vector3V n;
      FloatV overlap, arm = one, reduced = a.radius;
      MaskV exists;
      if constexpr (wall) {
        n = Load3(row.normal, lane);
        overlap = hn::Load(d, row.overlap + lane);
        exists = hn::Gt(a.inverse_mass, zero);
      } else {
        // Idle lanes name a body that has no place.
        HWY_ALIGN std::uint32_t place_a[pack_width], place_b[pack_width];
        hn::Store(hn::Min(hn::Load(u, row.a + lane), last), u, place_a);
        hn::Store(hn::Min(hn::Load(u, row.b + lane), last), u, place_b);
        const Vector3V apart = Apart(in, place_a, place_b);
        const FloatV distance = hn::Sqrt(Dot(apart, apart)), touching = hn::Add(a.radius, b.radius);
        // Centres in one point have no direction; the neighbours push such a pair apart.
        exists = hn::And(hn::Gt(distance, zero), hn::Gt(hn::Add(a.inverse_mass, b.inverse_mass), zero));
        n = Select(exists, apart * hn::Div(one, hn::IfThenElse(exists, distance, one)), {zero, zero, zero});
        overlap = hn::Sub(touching, distance);
        arm = hn::Div(distance, touching);
        reduced = hn::Div(hn::Mul(a.radius, b.radius), touching);
        Store3(n, row.normal, lane);
        hn::Store(overlap, d, row.overlap + lane);
        hn::Store(arm, d, row.arm + lane);
      }

      // A row is needed where the pair presses, is within the margin, or would close its gap within the step.
      const Vector3V closing = a.linear - b.linear;
      const FloatV separating = Dot(n, closing), gap = hn::Neg(overlap);
      const MaskV needed =
          hn::And(exists, hn::Or(hn::Le(gap, margin), hn::Le(hn::Add(gap, hn::Mul(separating, h)), zero)));
      const auto law =
          NormalRowFrom(surface.law, Stiffness(surface, reduced), RealV(overlap), RealV(separating), in.time_step);
      hn::Store(hn::IfThenElse(needed, law.bias.v, hn::Set(d, no_row)), d, row.bias + lane);
      hn::Store(law.regularization.v, d, row.regularization + lane);
      used = used || !hn::AllFalse(d, needed);
      if (surface.restitution > 0)
        impacts = impacts || !hn::AllFalse(d, hn::And(needed, IsImpact(surface, overlap, separating, in.time_step)));

      // Sliding speed, which becomes the friction below; or the friction.
      FloatV friction = hn::Set(d, static_cast<float>(surface.friction));
      if (surface.friction_speed.on) {
        const Vector3V slide = closing + Cross(n, a.surface + b.surface), across = slide - n * Dot(n, slide);
        friction = hn::Sqrt(Dot(across, across));
      }
      hn::Store(friction, d, row.friction + lane);

      // Warm start, turned into the tangent plane.
      const MaskV kept = in.warm_start ? needed : hn::MaskFromVec(zero);
      const FloatV old_n = hn::Load(d, impulse.normal + lane);
      const Vector3V old_t = Load3(impulse.tangent, lane), none{zero, zero, zero};
      hn::Store(hn::IfThenElseZero(kept, old_n), d, impulse.normal + lane);
      Store3(Select(kept, old_t - n * Dot(n, old_t), none), impulse.tangent, lane);
      if (turning) {
        const MaskV pressed = hn::And(kept, hn::Gt(old_n, zero));
        Store3(Select(pressed, Load3(packs.turn.data()[p].of, lane), none), packs.turn.data()[p].of, lane);
      }

      // Pull of moisture over the step, see effects/cohesion.h.
      if (cohesive) {
        const double range = surface.cohesion.range > 0 ? surface.cohesion.range : 1;
        const RealV scale = surface.sizes_differ ? RealV(reduced) * RealV(1 / surface.reference) : RealV(1.0);
        const RealV thinned = RealV(1.0) - RealV(hn::Max(gap, zero)) * RealV(1 / range);
        const MaskV reaches = hn::And(
            exists, hn::Or(hn::Le(gap, zero), hn::Lt(gap, hn::Set(d, static_cast<float>(surface.cohesion.range)))));
        const FloatV pull =
            hn::IfThenElseZero(reaches, (scale * thinned * RealV(surface.cohesion.force * in.time_step)).v);
        hn::Store(pull, d, packs.pull.data()[p].of + lane);
        used = used || !hn::AllFalse(d, hn::Gt(pull, zero));
      }
    }
    if (surface.friction_speed.on)
      for (float& f : row.friction)
        f = static_cast<float>(friction_at(surface.friction_speed, surface.friction, static_cast<double>(f)));
    if (used) packs.active.push_back(static_cast<std::uint32_t>(p));
  }
  return impacts;
}

bool MakePairRows(const RowInput& in, const Surface& surface, ContactPacks& packs) {
  return MakeRows<false>(in, surface, 0, packs.rows.size(), packs);
}
bool MakeWallRows(const RowInput& in, const Surface& surface, std::size_t begin, std::size_t end, ContactPacks& packs) {
  return MakeRows<true>(in, surface, begin, end, packs);
}

void MakeImpactRows(const RowInput& in, const Surface& surface, std::size_t begin, std::size_t end, bool wall,
                    ContactPacks& packs) {
  const FloatTag d;
  for (std::size_t p = begin; p < end; ++p) {
    ContactPack& row = packs.rows.data()[p];
    for (std::size_t lane = 0; lane < pack_width; lane += simd_lanes) {
      const FloatV bias = hn::Load(d, row.bias + lane), overlap = hn::Load(d, row.overlap + lane), zero = hn::Zero(d);
      const BodiesV b =
          wall ? LoadOther<true>(packs, p, lane, in.velocity) : LoadOther<false>(packs, p, lane, in.velocity);
      const Vector3V closing = LoadBodies(in.velocity, row.a + lane).linear - b.linear;
      const FloatV separating = Dot(Load3(row.normal, lane), closing);
      const FloatV rebound = hn::Mul(hn::Set(d, static_cast<float>(-surface.restitution)), separating);
      const FloatV gap = hn::Min(zero, hn::Mul(overlap, hn::Set(d, static_cast<float>(1 / in.time_step))));
      FloatV wanted = gap;
      if (surface.restitution > 0)
        wanted = hn::IfThenElse(IsImpact(surface, overlap, separating, in.time_step), rebound, gap);
      hn::Store(hn::IfThenElse(hn::Gt(bias, hn::Set(d, 0.5f * no_row)), wanted, bias), d, row.bias + lane);
      hn::Store(zero, d, row.regularization + lane);
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace drumsweep
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace drumsweep {

HWY_EXPORT(MakePairRows);
HWY_EXPORT(MakeWallRows);
HWY_EXPORT(MakeImpactRows);

bool make_pair_rows(const RowInput& in, const Surface& surface, ContactPacks& pairs) {
  pairs.active.clear();
  return HWY_DYNAMIC_DISPATCH(MakePairRows)(in, surface, pairs);
}

bool make_wall_rows(const RowInput& in, const Surface& surface, std::size_t begin, std::size_t end,
                    ContactPacks& walls) {
  return HWY_DYNAMIC_DISPATCH(MakeWallRows)(in, surface, begin, end, walls);
}

void make_impact_rows(const RowInput& in, const Surface& surface, std::size_t begin, std::size_t end, bool wall,
                      ContactPacks& packs) {
  HWY_DYNAMIC_DISPATCH(MakeImpactRows)(in, surface, begin, end, wall, packs);
}

}  // namespace drumsweep
#endif

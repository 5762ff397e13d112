/// One vector of contact rows and the bodies at them: what solver and residual share. Included once per vector target.
#if defined(DRUMSWEEP_CONTACT_ROW_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef DRUMSWEEP_CONTACT_ROW_INL_H
#undef DRUMSWEEP_CONTACT_ROW_INL_H
#else
#define DRUMSWEEP_CONTACT_ROW_INL_H
#endif

#include "core/simd/rows-inl.h"
#include "core/solver/contact_problem.h"

HWY_BEFORE_NAMESPACE();
namespace drumsweep {
namespace HWY_NAMESPACE {

constexpr std::size_t body_stride = sizeof(BodyVelocity) / sizeof(float);

/// Velocities of the bodies in the lanes. Inverse mass 0: a wall.
struct BodiesV {
  Vector3V linear;
  FloatV inverse_mass;
  Vector3V surface;
  FloatV radius;
};

HWY_INLINE BodiesV LoadBodies(const BodyVelocity* bodies, const std::uint32_t* index) {
  const float* base = bodies->linear;
  const Vector4V v = LoadRows(base, body_stride, index), s = LoadRows(base + 4, body_stride, index);
  return {{v.x, v.y, v.z}, v.w, {s.x, s.y, s.z}, s.w};
}

HWY_INLINE void StoreBodies(const BodiesV& b, BodyVelocity* bodies, const std::uint32_t* index) {
  float* base = bodies->linear;
  StoreRows({b.linear.x, b.linear.y, b.linear.z, b.inverse_mass}, base, body_stride, index);
  StoreRows({b.surface.x, b.surface.y, b.surface.z, b.radius}, base + 4, body_stride, index);
}

HWY_INLINE BodiesV WallBodies(Vector3V velocity) {
  const FloatV zero = hn::Zero(FloatTag());
  return {velocity, zero, {zero, zero, zero}, zero};
}

/// The other side of these contacts: balls, or pieces of wall.
template <bool wall>
HWY_INLINE BodiesV LoadOther(const ContactPacks& packs, std::size_t p, std::size_t lane, const BodyVelocity* bodies) {
  if constexpr (wall)
    return WallBodies(Load3(packs.wall_velocity.data()[p].of, lane));
  else
    return LoadBodies(bodies, packs.rows.data()[p].b + lane);
}

/// Relative velocity of the two surfaces at the contact; arm_n = c n.
HWY_INLINE Vector3V SlidingVelocity(const BodiesV& a, const BodiesV& b, Vector3V arm_n) {
  return a.linear - b.linear + Cross(arm_n, a.surface + b.surface);
}

/// Diagonal of the tangential rows [1/kg]: (1 + 5/2 c^2) (1/m_a + 1/m_b), never 0.
HWY_INLINE FloatV TangentDiagonal(FloatV arm, FloatV inverse_masses) {
  const FloatTag d;
  const FloatV lever = hn::Add(hn::Set(d, 1.0f), hn::Mul(hn::Set(d, 2.5f), hn::Mul(arm, arm)));
  return hn::Max(hn::Mul(lever, inverse_masses), hn::Set(d, 1e-30f));
}

/// v scaled down to this length where it is longer.
HWY_INLINE Vector3V Clip(Vector3V v, FloatV limit) {
  const FloatV squared = Dot(v, v);
  const MaskV longer = hn::Gt(squared, hn::Mul(limit, limit));
  const FloatV scale = hn::IfThenElse(longer, hn::Div(limit, hn::Sqrt(squared)), hn::Set(FloatTag(), 1.0f));
  return v * scale;
}

}  // namespace HWY_NAMESPACE
}  // namespace drumsweep
HWY_AFTER_NAMESPACE();

#endif

/// Rolling and twisting resistance: a torque between two touching balls, or a ball and a wall, against their relative angular
/// velocity w = omega_a - omega_b (S0). Across the normal n it is at most mu_r R lambda_n (rolling), along n at most mu_t R lambda_n
/// (twisting); below these limits nothing turns. It does not depend on speed: a ball rests on an incline iff tan(theta) <= mu_r and
/// else rolls with (5/7) g (sin - mu_r cos).
///
/// Written with q = torque impulse / R [N s] and the speed R w [m/s], so that it has the shape of a friction row: R is the ball's
/// radius at a wall and 2 Ra Rb / (Ra + Rb) between balls. With S = radius * omega a unit q changes S_a by (5/2) c_a / m_a, c_a = R / Ra.
/// Included once per vector target.
#if defined(DRUMSWEEP_ROTATION_RESISTANCE_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef DRUMSWEEP_ROTATION_RESISTANCE_INL_H
#undef DRUMSWEEP_ROTATION_RESISTANCE_INL_H
#else
#define DRUMSWEEP_ROTATION_RESISTANCE_INL_H
#endif

#include "core/solver/contact_row-inl.h"

HWY_BEFORE_NAMESPACE();
namespace drumsweep {
namespace HWY_NAMESPACE {

/// Lever arms of the rotation row, over the radii: R / R_a and R / R_b with R = 2 R_a R_b / (R_a + R_b); 1 and 0 at a wall.
struct RotationArmsV {
  FloatV a, b, inverse;  ///< inverse: 1 / (5/2 (a^2/m_a + b^2/m_b)) [kg]
};
template <bool wall>
HWY_INLINE RotationArmsV RotationArms(const BodiesV& a, const BodiesV& b) {
  const FloatTag d;
  RotationArmsV out;
  if constexpr (wall) {
    out.a = hn::Set(d, 1.0f);
    out.b = hn::Zero(d);
  } else {
    const FloatV scale = hn::Div(hn::Set(d, 2.0f), hn::Add(a.radius, b.radius));
    out.a = hn::Mul(scale, b.radius);
    out.b = hn::Mul(scale, a.radius);
  }
  const FloatV w =
      hn::Add(hn::Mul(hn::Mul(out.a, out.a), a.inverse_mass), hn::Mul(hn::Mul(out.b, out.b), b.inverse_mass));
  out.inverse = hn::Div(hn::Set(d, 1.0f), hn::Max(hn::Mul(hn::Set(d, 2.5f), w), hn::Set(d, 1e-30f)));
  return out;
}

/// The torque impulse that stops the relative rotation, q being there already, within its limits across n and along it.
template <bool wall>
HWY_INLINE Vector3V StoppingTurn(const ContactPacks& packs, std::size_t p, std::size_t lane, const BodiesV& a,
                                 const BodiesV& b, const RotationArmsV& arms, Vector3V n, FloatV pressed, Vector3V q) {
  const FloatTag d;
  Vector3V rate = a.surface * arms.a;
  if constexpr (wall)
    rate = rate - Load3(packs.wall_turn.data()[p].of, lane);
  else
    rate = rate - b.surface * arms.b;
  const Vector3V wanted = q - rate * arms.inverse;
  const RotationLimits& limits = packs.limits.data()[p];
  const FloatV along = Dot(n, wanted), most_along = hn::Mul(hn::Set(d, limits.twisting), pressed);
  const Vector3V across = Clip(wanted - n * along, hn::Mul(hn::Set(d, limits.rolling), pressed));
  return across + n * hn::Max(hn::Min(along, most_along), hn::Neg(most_along));
}

}  // namespace HWY_NAMESPACE
}  // namespace drumsweep
HWY_AFTER_NAMESPACE();

#endif

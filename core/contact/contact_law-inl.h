/// The formula of contact_law.h, for one contact or for one in each lane of a vector. Included once per vector target.
#if defined(DRUMSWEEP_CONTACT_LAW_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef DRUMSWEEP_CONTACT_LAW_INL_H
#undef DRUMSWEEP_CONTACT_LAW_INL_H
#else
#define DRUMSWEEP_CONTACT_LAW_INL_H
#endif

#include <algorithm>
#include <cmath>

#include "core/contact/contact_law.h"
#include "core/simd/rows-inl.h"

HWY_BEFORE_NAMESPACE();
namespace drumsweep {
namespace HWY_NAMESPACE {

HWY_INLINE double square_root(double x) { return std::sqrt(x); }
HWY_INLINE double select(bool condition, double yes, double no) { return condition ? yes : no; }

/// @tparam Real  double, or one number per lane of a vector with the same operators and functions
/// @param stiffness  k, in place of the law's [N/m^1.5]
/// @param overlap  g > 0 pressed, < 0 open [m]
/// @param separating_speed  n.u at the beginning of the step [m/s]
/// @param h  time step [s]
template <class Real>
HWY_INLINE NormalRowOf<Real> NormalRowFrom(const ContactLaw& law, Real stiffness, Real overlap, Real separating_speed,
                                           double h) {
  constexpr double alpha = 1.25;
  const double tau = std::max(law.damping / alpha, law.stabilization * h), upsilon = 1 / (1 + 4 * tau / h);
  const Real first(std::max(law.first_overlap, 1e-30)), none(0.0);

  const Real gap_bias = (overlap - Real(2 * law.first_overlap)) * Real(1 / h);
  const Real push_out = Real(4 / (alpha * h) * upsilon) * overlap;
  const Real root = square_root(select(overlap < first, first, overlap));
  const Real softness = Real(4 * upsilon / (h * h * alpha)) / (stiffness * root);
  const auto impact = separating_speed < Real(-law.impact_speed);
  return {select(overlap < first, gap_bias, select(impact, push_out, push_out + Real(upsilon) * separating_speed)),
          select(overlap < first, none, select(impact, none, softness))};
}

}  // namespace HWY_NAMESPACE
}  // namespace drumsweep
HWY_AFTER_NAMESPACE();

#endif

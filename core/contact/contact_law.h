/// From Hertz' law f = k (g^1.5 + c g^0.5 dg/dt) to one row of the step's complementarity problem (SPOOK-type stepper;
/// Wang 2013, Servin et al.; physics: S0 with its misprints corrected, as derived here).
///
/// Potential (k/alpha') of gbar = g^alpha, alpha = 5/4, gives a row in gbar; divided by its Jacobian alpha g^(alpha-1):
///     n.u(i+1) + Sigma lambda = 4/(alpha h) Upsilon g + Upsilon n.u(i),      lambda >= 0, complementary
///     Sigma = 4 / (h^2 k_row (1 + 4 tau/h)),  Upsilon = 1 / (1 + 4 tau/h),   k_row = alpha k sqrt(g)
///     tau = max(c/alpha, n_s h)
/// At rest it gives lambda = h k g^1.5 exactly, for every h. n_s = 2 keeps a stiff, weakly damped contact from gaining
/// energy.
/// Impact (approach faster than a threshold): n.u(i+1) >= 4/(alpha h) Upsilon g, no regularization: zero restitution, and the overlap
/// there is relaxes as in any contact. (S1 sets the right side to 0. A ball sliding along a curved wall "impacts" in every step by
/// v^2 h/R, and with 0 it is never pushed back: at h = 10 ms such balls crept through the drum's wall.)
/// Open pair at gap delta: n.u(i+1) >= -(delta + 2 first_overlap)/h: it may close the gap within the step and press a
/// little, no more. Hertz' law takes over from first_overlap on: below it the linearised stiffness alpha k sqrt(g) is next
/// to nothing and a ball that just touches would fall through the step freely; with first_overlap = 0 it would stay at
/// gap 0 and never sink at all.
#pragma once

namespace drumsweep {

struct ContactLaw {
  double stiffness = 0;      ///< k [N/m^1.5]
  double damping = 0;        ///< c [s]
  double impact_speed = 0;   ///< [m/s]
  double stabilization = 2;  ///< n_s, time steps
  double first_overlap = 0;  ///< overlap at which Hertz' law begins; small against that of a ball at rest [m]
};

/// Row n.u + regularization * lambda = bias, with lambda in N s.
template <class Real>
struct NormalRowOf {
  Real bias;            ///< [m/s]
  Real regularization;  ///< [1/kg]
};
using NormalRow = NormalRowOf<double>;

/// The row in double; that of sixteen contacts at a time has the same source, contact_law-inl.h.
/// @param overlap  g > 0 pressed, < 0 open [m]
/// @param separating_speed  n.u at the beginning of the step [m/s]
/// @param h  time step [s]
NormalRow normal_row(const ContactLaw& law, double overlap, double separating_speed, double h);

}  // namespace drumsweep

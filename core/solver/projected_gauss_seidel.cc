#include "core/solver/projected_gauss_seidel.h"

#include <cmath>

namespace drumsweep {
namespace {

using Mask4 = std::int32_t __attribute__((vector_size(16)));
constexpr Mask4 space = {-1, -1, -1, 0};

Float4 only_space(Float4 a) { return (Float4)((Mask4)a & space); }

Float4 cross(Float4 a, Float4 b) {
  const Float4 c = a * __builtin_shufflevector(b, b, 1, 2, 0, 3) - __builtin_shufflevector(a, a, 1, 2, 0, 3) * b;
  return __builtin_shufflevector(c, c, 1, 2, 0, 3);
}

float dot(Float4 a, Float4 b) {
  const Float4 p = a * b;
  return (p[0] + p[1]) + p[2];
}

/// Impulse p = normal n + tangent t on a, -p on b. Fourth lanes of n and t are 0; arm_n = c n.
[[gnu::always_inline]] inline void push(BodyVelocity& a, BodyVelocity& b, Float4 n, Float4 arm_n, float normal,
                                        Float4 t) {
  const Float4 p = n * normal + t;
  const Float4 turn = cross(arm_n, t) * 2.5f;
  const float inverse_a = a.linear[3], inverse_b = b.linear[3];
  a.linear += p * inverse_a;
  b.linear -= p * inverse_b;
  a.surface -= turn * inverse_a;
  b.surface -= turn * inverse_b;
}

/// Torque impulse q over the contact's arm on a, -q on b.
[[gnu::always_inline]] inline void twist(BodyVelocity& a, BodyVelocity& b, const RotationRow& row, Float4 q) {
  a.surface += q * (2.5f * row.a * a.linear[3]);
  b.surface -= q * (2.5f * row.b * b.linear[3]);
}

/// Rolling and twisting resistance under the normal impulse `pressed`: stop the relative rotation, clip each part to its limit.
[[gnu::always_inline]] inline void resist_rotation(const RotationRow& row, Float4 n, float pressed, BodyVelocity& a,
                                                   BodyVelocity& b, TurnImpulse& turn) {
  const Float4 rate = a.surface * row.a - b.surface * row.b - row.wall_turn;
  const Float4 wanted = turn - rate * row.inverse;
  float along = dot(n, wanted);
  Float4 across = wanted - n * along;
  const float most_along = row.twisting * pressed, most_across = row.rolling * pressed, squared = dot(across, across);
  along = along > most_along ? most_along : (along < -most_along ? -most_along : along);
  if (squared > most_across * most_across) across *= most_across / std::sqrt(squared);
  const Float4 now = across + n * along;
  twist(a, b, row, now - turn);
  turn = now;
}

}  // namespace

void apply_impulses(const ContactProblem& problem, std::span<const Impulse> impulse, std::span<const TurnImpulse> turn,
                    std::span<BodyVelocity> velocity) {
  for (std::size_t i = 0; i < problem.rows.size(); ++i) {
    const ContactRow& row = problem.rows[i];
    if (impulse[i][3] == 0) continue;
    const Float4 n = only_space(row.normal);
    push(velocity[row.a], velocity[row.b], n, n * row.arm, impulse[i][3], only_space(impulse[i]));
  }
  for (std::size_t i = 0; i < problem.rotation.size(); ++i)
    twist(velocity[problem.rows[i].a], velocity[problem.rows[i].b], problem.rotation[i], turn[i]);
}

namespace {

template <bool with_rotation>
void iterate(const ContactProblem& problem, int iterations, std::span<Impulse> impulse, std::span<TurnImpulse> turn,
             std::span<BodyVelocity> velocity) {
  for (int iteration = 0; iteration < iterations; ++iteration) {
    for (std::size_t i = 0; i < problem.rows.size(); ++i) {
      const ContactRow& row = problem.rows[i];
      BodyVelocity &a = velocity[row.a], &b = velocity[row.b];

      // Relative velocity of the two surfaces at the contact.
      const Float4 n = only_space(row.normal), arm_n = n * row.arm;
      const Float4 u = a.linear - b.linear + cross(arm_n, a.surface + b.surface);
      const float u_n = dot(n, u);

      // Normal impulse: solve the row, clip at zero.
      const float old_n = impulse[i][3];
      const float wanted = old_n + (row.normal[3] - u_n - row.regularization * old_n) * row.inverse_normal;
      const float new_n = wanted > 0 ? wanted : 0;

      // Friction: stop the tangential motion, clip to the disc.
      const Float4 old_t = only_space(impulse[i]);
      Float4 new_t = only_space(old_t - (u - n * u_n) * row.inverse_tangent);
      const float limit = row.friction * new_n, squared = dot(new_t, new_t);
      if (squared > limit * limit) new_t *= limit / std::sqrt(squared);

      push(a, b, n, arm_n, new_n - old_n, new_t - old_t);
      impulse[i] = new_t;
      impulse[i][3] = new_n;

      if constexpr (with_rotation) resist_rotation(problem.rotation[i], n, new_n, a, b, turn[i]);
    }
  }
}

}  // namespace

void solve(const ContactProblem& problem, int iterations, std::span<Impulse> impulse, std::span<TurnImpulse> turn,
           std::span<BodyVelocity> velocity) {
  if (problem.rotation.empty())
    iterate<false>(problem, iterations, impulse, turn, velocity);
  else
    iterate<true>(problem, iterations, impulse, turn, velocity);
}

}  // namespace drumsweep

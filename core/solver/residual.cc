#include "core/solver/residual.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace drumsweep {
namespace {

Eigen::Vector3d vector(Float4 a) { return {a[0], a[1], a[2]}; }

}  // namespace

Residual natural_map_residual(const ContactProblem& problem, std::span<const Impulse> impulse,
                              std::span<const TurnImpulse> turn, std::span<const BodyVelocity> velocity) {
  Residual out;
  for (std::size_t i = 0; i < problem.rows.size(); ++i) {
    const ContactRow& row = problem.rows[i];
    const BodyVelocity &a = velocity[row.a], &b = velocity[row.b];
    const Eigen::Vector3d n = vector(row.normal);
    const Eigen::Vector3d u = vector(a.linear) - vector(b.linear) +
                              static_cast<double>(row.arm) * n.cross(vector(a.surface) + vector(b.surface));

    const double r_n = row.inverse_normal, lambda_n = impulse[i][3];
    const double f_n = n.dot(u) + row.regularization * lambda_n - row.normal[3];
    const double e_n = (lambda_n - std::max(0.0, lambda_n - r_n * f_n)) / r_n;

    const double r_t = row.inverse_tangent, limit = row.friction * lambda_n;
    const Eigen::Vector3d lambda_t = vector(impulse[i]);
    Eigen::Vector3d t = lambda_t - r_t * (u - n * n.dot(u));
    if (t.norm() > limit) t *= limit / t.norm();
    const double e_t = (lambda_t - t).norm() / r_t;

    double e_r = 0;
    if (!problem.rotation.empty()) {
      const RotationRow& rotation = problem.rotation[i];
      const double r_r = rotation.inverse, rolling = rotation.rolling * lambda_n,
                   twisting = rotation.twisting * lambda_n;
      const Eigen::Vector3d rate =
          rotation.a * vector(a.surface) - rotation.b * vector(b.surface) - vector(rotation.wall_turn);
      const Eigen::Vector3d q = vector(turn[i]), wanted = q - r_r * rate;
      Eigen::Vector3d across = wanted - n * n.dot(wanted);
      if (across.norm() > rolling) across *= rolling / across.norm();
      e_r = (q - across - n * std::clamp(n.dot(wanted), -twisting, twisting)).norm() / r_r;
    }

    const double e = std::sqrt(e_n * e_n + e_t * e_t + e_r * e_r);
    out.max = std::max(out.max, e);
    out.mean += e;
  }
  if (!problem.rows.empty()) out.mean /= static_cast<double>(problem.rows.size());
  return out;
}

}  // namespace drumsweep

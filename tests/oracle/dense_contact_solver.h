/// Slow and obvious: the contact problem with full 6-vectors of velocity, explicit Jacobians and a tangent frame, torques as torques, in
/// double, iterated until it stands still. Judge of the fast solver.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <vector>

namespace drumsweep::oracle {

struct Sphere {
  double mass, radius;
  Eigen::Vector3d velocity, spin;
};

struct Contact {
  int a, b;  ///< b = -1: a fixed wall moving with wall_velocity
  Eigen::Vector3d normal, wall_velocity;
  double bias, regularization, friction;
  double rolling = 0, twisting = 0;  ///< of the arm times the normal impulse
  Eigen::Vector3d wall_spin = Eigen::Vector3d::Zero();
  double arm = 1;  ///< lever arms over the radii
};

/// @return impulses (contacts x 3) in the room, on a; spheres are changed in place
inline std::vector<Eigen::Vector3d> solve(std::vector<Sphere>& spheres, const std::vector<Contact>& contacts,
                                          int iterations) {
  const Eigen::Index n = 6 * static_cast<Eigen::Index>(spheres.size()),
                     m = 6 * static_cast<Eigen::Index>(contacts.size());
  Eigen::VectorXd v(n), offset = Eigen::VectorXd::Zero(m), lambda = Eigen::VectorXd::Zero(m);
  Eigen::MatrixXd inverse_mass = Eigen::MatrixXd::Zero(n, n), G = Eigen::MatrixXd::Zero(m, n);
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    const Eigen::Index k = 6 * static_cast<Eigen::Index>(i);
    v.segment<3>(k) = spheres[i].velocity;
    v.segment<3>(k + 3) = spheres[i].spin;
    const double inertia = 0.4 * spheres[i].mass * spheres[i].radius * spheres[i].radius;
    for (Eigen::Index c = 0; c < 3; ++c) {
      inverse_mass(k + c, k + c) = 1 / spheres[i].mass;
      inverse_mass(k + 3 + c, k + 3 + c) = 1 / inertia;
    }
  }
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    Eigen::Matrix3d frame;
    frame.row(0) = contacts[c].normal;
    frame.row(1) = contacts[c].normal.unitOrthogonal();
    frame.row(2) = contacts[c].normal.cross(contacts[c].normal.unitOrthogonal());
    const Eigen::Index r = 6 * static_cast<Eigen::Index>(c);
    // Velocity of the contact point: v + omega x arm, arm = -R n on a and +R n on b.
    const auto put = [&](int body, double sign, const Eigen::Vector3d& arm) {
      const Eigen::Index k = 6 * static_cast<Eigen::Index>(body);
      G.block<3, 3>(r, k) = sign * frame;
      for (Eigen::Index row = 0; row < 3; ++row)
        G.block<1, 3>(r + row, k + 3) = sign * arm.cross(frame.row(row).transpose()).transpose();
      G.block<3, 3>(r + 3, k + 3) = sign * frame;  // relative rotation
    };
    put(contacts[c].a, 1,
        -contacts[c].arm * spheres[static_cast<std::size_t>(contacts[c].a)].radius * contacts[c].normal);
    if (contacts[c].b >= 0)
      put(contacts[c].b, -1,
          contacts[c].arm * spheres[static_cast<std::size_t>(contacts[c].b)].radius * contacts[c].normal);
    else
      offset.segment<6>(r) << -(frame * contacts[c].wall_velocity), -(frame * contacts[c].wall_spin);
  }
  const Eigen::MatrixXd delassus = G * inverse_mass * G.transpose();
  const Eigen::VectorXd free = G * v + offset;
  for (int iteration = 0; iteration < iterations; ++iteration)
    for (std::size_t c = 0; c < contacts.size(); ++c) {
      const Eigen::Index r = 6 * static_cast<Eigen::Index>(c);
      const Eigen::Vector3d u = free.segment<3>(r) + delassus.middleRows<3>(r) * lambda;
      const double old = lambda[r];
      lambda[r] = std::max(0.0, old - (u[0] + contacts[c].regularization * old - contacts[c].bias) /
                                          (delassus(r, r) + contacts[c].regularization));
      const Eigen::Vector3d after = free.segment<3>(r) + delassus.middleRows<3>(r) * lambda;
      Eigen::Vector2d t = lambda.segment<2>(r + 1) - after.tail<2>() / delassus(r + 1, r + 1);
      const double limit = contacts[c].friction * lambda[r];
      if (t.norm() > limit) t *= limit / t.norm();
      lambda.segment<2>(r + 1) = t;

      // Torque impulses about the normal and across it.
      const double radius_a = spheres[static_cast<std::size_t>(contacts[c].a)].radius;
      const double radius_b = contacts[c].b >= 0 ? spheres[static_cast<std::size_t>(contacts[c].b)].radius : 0;
      const double arm = radius_b > 0 ? 2 * radius_a * radius_b / (radius_a + radius_b) : radius_a;
      const Eigen::Vector3d rate = free.segment<3>(r + 3) + delassus.middleRows<3>(r + 3) * lambda;
      const double twist = contacts[c].twisting * arm * lambda[r], roll = contacts[c].rolling * arm * lambda[r];
      Eigen::Vector3d torque = lambda.segment<3>(r + 3) - rate / delassus(r + 3, r + 3);
      torque[0] = std::clamp(torque[0], -twist, twist);
      if (torque.tail<2>().norm() > roll) torque.tail<2>() *= roll / torque.tail<2>().norm();
      lambda.segment<3>(r + 3) = torque;
    }
  v += inverse_mass * G.transpose() * lambda;
  std::vector<Eigen::Vector3d> out;
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    const Eigen::Vector3d t = contacts[c].normal.unitOrthogonal();
    const Eigen::Index r = 6 * static_cast<Eigen::Index>(c);
    out.push_back(lambda[r] * contacts[c].normal + lambda[r + 1] * t + lambda[r + 2] * contacts[c].normal.cross(t));
  }
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    spheres[i].velocity = v.segment<3>(6 * static_cast<Eigen::Index>(i));
    spheres[i].spin = v.segment<3>(6 * static_cast<Eigen::Index>(i) + 3);
  }
  return out;
}

}  // namespace drumsweep::oracle

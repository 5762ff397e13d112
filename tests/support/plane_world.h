/// Balls on a plane through the engine's contact law and solver, with nothing of the drum: for closed forms.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "core/contact/contact_law.h"
#include "core/solver/projected_gauss_seidel.h"
#include "support/packed_problem.h"

namespace drumsweep {

struct PlaneBall {
  Eigen::Vector3d position, velocity, spin;
};

/// One ball above the plane z = 0.
struct PlaneWorld {
  ContactLaw law{25000, 0.02, 0.05, 2, 6.4e-6};
  double radius = 0.005, mass = 0.001309, friction = 0.7, margin = 0.001;
  Eigen::Vector3d gravity{0, 0, -9.81};
  int iterations = 5;
  PlaneBall ball;
  ImpulsePack impulse{};

  void step(double h) {
    const double gap = ball.position[2] - radius;
    const bool touching = gap <= margin || gap + ball.velocity[2] * h <= 0;
    const NormalRow row = normal_row(law, -gap, ball.velocity[2], h);
    ball.velocity += h * gravity;
    if (touching) {
      ContactProblem problem =
          one_by_one({{0, -1, {0, 0, 1}, {0, 0, 0}, row.bias, row.regularization, friction}}, 1, false);
      impulse_of(problem, 0) = impulse;
      const auto f = [](double x) { return static_cast<float>(x); };
      const Eigen::Vector3d s = ball.spin * radius;
      std::vector<BodyVelocity> v{{{f(ball.velocity[0]), f(ball.velocity[1]), f(ball.velocity[2])},
                                   f(1 / mass),
                                   {f(s[0]), f(s[1]), f(s[2])},
                                   f(radius)},
                                  {{0, 0, 0}, 0, {0, 0, 0}, 1}};
      apply_impulses(problem, 1, v);
      solve(problem, iterations, 1, v);
      impulse = impulse_of(problem, 0);
      ball.velocity = {v[0].linear[0], v[0].linear[1], v[0].linear[2]};
      ball.spin = Eigen::Vector3d(v[0].surface[0], v[0].surface[1], v[0].surface[2]) / radius;
    } else {
      impulse = ImpulsePack{};
    }
    ball.position += h * ball.velocity;
  }
};

}  // namespace drumsweep

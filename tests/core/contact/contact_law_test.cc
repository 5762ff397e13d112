#include "core/contact/contact_law.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/plane_world.h"

namespace drumsweep {
namespace {

PlaneWorld resting() {
  PlaneWorld w;
  w.ball.position = {0, 0, w.radius};
  w.ball.velocity = w.ball.spin = Eigen::Vector3d::Zero();
  return w;
}

TEST(ContactLaw, resting_ball_sinks_by_the_hertz_overlap_for_every_time_step) {
  // Lighter and heavier than its own weight, so that the law and not the first overlap decides.
  for (const double load : {0.2, 1.0, 30.0})
    for (const double h : {1e-4, 1e-3, 2e-3, 5e-3, 1e-2}) {
      PlaneWorld w = resting();
      w.gravity *= load;
      for (int i = 0; i < static_cast<int>(4.0 / h); ++i) w.step(h);
      const double expected = std::pow(w.mass * 9.81 * load / w.law.stiffness, 2.0 / 3);
      EXPECT_NEAR(w.radius - w.ball.position[2], expected, 1e-3 * expected) << "h = " << h << ", load " << load;
    }
}

TEST(ContactLaw, impact_has_zero_restitution_and_lands_without_overlap) {
  PlaneWorld w = resting();
  w.ball.position[2] = w.radius + 0.0123;
  w.ball.velocity[2] = -1.0;
  double lowest = 1;
  for (int i = 0; i < 100; ++i) {
    w.step(0.01);
    lowest = std::min(lowest, w.ball.position[2]);
    EXPECT_LT(w.ball.velocity[2], 0.02);  // never thrown back
  }
  // Without a speculative row the ball would be a whole diameter deep before any row acts.
  EXPECT_GT(lowest, w.radius - 0.02 * w.radius);
}

TEST(ContactLaw, energy_never_grows_in_a_stiff_weakly_damped_contact) {
  for (const double stiffness : {2.5e4, 1e7, 1e9})
    for (const double overlap : {1e-6, 1e-4, 2e-3}) {
      PlaneWorld w = resting();
      w.law.stiffness = stiffness;
      w.law.damping = 0;
      w.ball.position[2] = w.radius - overlap;
      const double stored = 0.4 * stiffness * std::pow(overlap, 2.5);  // Hertz: 2/5 k g^(5/2)
      double fastest = 0;
      for (int i = 0; i < 200; ++i) {
        w.step(0.005);
        fastest = std::max(fastest, w.ball.velocity[2]);
      }
      EXPECT_LE(0.5 * w.mass * fastest * fastest, stored + w.mass * 9.81 * overlap) << stiffness << " " << overlap;
    }
}

TEST(ContactLaw, sliding_ball_decelerates_with_friction_and_ends_rolling_at_five_sevenths) {
  for (const double h : {1e-4, 1e-3}) {
    PlaneWorld w = resting();
    w.friction = 0.3;
    for (int i = 0; i < static_cast<int>(1.0 / h); ++i) w.step(h);
    const double u0 = 1.0;
    w.ball.velocity = {u0, 0, 0};
    for (int i = 0; i < static_cast<int>(std::lround(0.05 / h)); ++i) w.step(h);
    EXPECT_NEAR(w.ball.velocity[0], u0 - 0.3 * 9.81 * 0.05, 1e-3 * u0) << h;
    for (int i = 0; i < static_cast<int>(0.5 / h); ++i) w.step(h);
    EXPECT_NEAR(w.ball.velocity[0], 5 * u0 / 7, 1e-3 * u0) << h;
    EXPECT_NEAR(w.ball.spin[1] * w.radius, 5 * u0 / 7, 1e-3 * u0) << h;
  }
}

TEST(ContactLaw, friction_is_the_same_in_every_direction) {
  double along_axis = 0;
  for (const double angle : {0.0, 0.3, 0.785398, 1.2}) {
    PlaneWorld w = resting();
    w.friction = 0.3;
    for (int i = 0; i < 1000; ++i) w.step(1e-3);
    w.ball.velocity = {std::cos(angle), std::sin(angle), 0};
    for (int i = 0; i < 50; ++i) w.step(1e-3);
    const double speed = w.ball.velocity.head<2>().norm();
    if (angle == 0) along_axis = speed;
    EXPECT_NEAR(speed, along_axis, 1e-5);
  }
}

TEST(ContactLaw, free_flight_is_exact) {
  PlaneWorld w = resting();
  w.ball.position[2] = 100;
  const double h = 1e-3;
  for (int i = 0; i < 1000; ++i) w.step(h);
  // Semi-implicit Euler: z = z0 - g h^2 n (n + 1) / 2.
  EXPECT_NEAR(w.ball.position[2], 100 - 9.81 * h * h * 1000 * 1001 / 2, 1e-9);
}

}  // namespace
}  // namespace drumsweep

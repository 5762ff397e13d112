#include "core/step/smooth_step.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/state/arrays.h"
#include "core/step/assemble.h"
#include "core/step/step_report.h"

namespace drumsweep {
namespace {

/// Two touching bodies, seen from a; b may be a wall (its terms are then 0).
struct Touch {
  Eigen::Vector3d normal;  ///< from b to a
  double overlap;
  Eigen::Vector3d velocity;  ///< of a relative to b, of the centres or of centre and wall [m/s]
  Eigen::Vector3d surface;   ///< lever arms times angular velocities, summed [m/s]
  Eigen::Vector3d rotation;  ///< omega_a - omega_b [rad/s]
  double arm, effective_mass, reduced_radius;
};

/// Force on a at the contact, and torque over the arm. In: their histories (tangential, turning); out: the new ones.
struct Force {
  double normal = 0;
  Eigen::Vector3d tangent = Eigen::Vector3d::Zero(), turn = Eigen::Vector3d::Zero();
};

Eigen::Vector3d clipped(const Eigen::Vector3d& v, double limit) {
  const double length = v.norm();
  return length > limit ? Eigen::Vector3d(v * (limit / length)) : v;
}

/// The old tangential force turned into the new tangent plane with its length kept.
Eigen::Vector3d turned(const Eigen::Vector3d& old, const Eigen::Vector3d& normal) {
  const Eigen::Vector3d flat = old - normal * normal.dot(old);
  const double length = flat.norm();
  return length > 0 ? Eigen::Vector3d(flat * (old.norm() / length)) : flat;
}

struct Law {
  const Surface& surface;
  double poisson_ratio, h;
  bool with_turn;

  void evaluate(const Touch& t, Force& f, Eigen::Vector3d& total, Eigen::Vector3d& moment) const {
    const double k = surface.stiffness(t.reduced_radius), g = t.overlap, root = std::sqrt(g), m = t.effective_mass;
    const double slope = 1.5 * k * root, e = surface.restitution;  // S
    // Dashpots act on the speed as it decays in the step, m v' = -c v, and take at most a quarter of it: a ball has up to a dozen
    // contacts, which would else throw it back together.
    const auto in_step = [&](double c, double mass) { return std::min(-std::expm1(-h * c / mass), 0.25) * mass / h; };
    double damping = k * surface.law.damping * root, part = 0;
    if (e > 0) {
      const double log = std::log(e), beta = -log / std::sqrt(log * log + std::numbers::pi * std::numbers::pi);
      part = 2 * std::sqrt(5.0 / 6) * beta;
      damping = part * std::sqrt(slope * m);
    }
    const double approach = -t.normal.dot(t.velocity);
    f.normal = k * g * root + in_step(damping, m) * approach;
    if (e == 0) f.normal = std::max(0.0, f.normal);
    const double pressed = std::max(0.0, f.normal);

    // Tangential spring with history.
    const Eigen::Vector3d u = t.velocity + t.normal.cross(t.surface), u_t = u - t.normal * t.normal.dot(u);
    const double stiffness = slope * 2 * (1 - poisson_ratio) / (2 - poisson_ratio), m_t = m / 3.5;
    // Without restitution the tangential spring is damped critically, as the contact is meant to lose all.
    const double damping_t = (e > 0 ? part : 2.0) * std::sqrt(stiffness * m_t);
    const double friction = friction_at(surface.friction_speed, surface.friction, u_t.norm());
    const Eigen::Vector3d spring = turned(f.tangent, t.normal) - stiffness * h * u_t;
    f.tangent = clipped(spring, friction * pressed);
    const Eigen::Vector3d tangential = clipped(f.tangent - in_step(damping_t, m_t) * u_t, friction * pressed);
    total = t.normal * f.normal + tangential;
    moment = Eigen::Vector3d::Zero();
    if (!with_turn) return;

    // Springs on the relative rotation, in terms of arm times rate.
    const Eigen::Vector3d rate = t.arm * t.rotation;
    const double m_r = m / 2.5, damping_r = 2 * std::sqrt(stiffness * m_r);
    const auto limited = [&](const Eigen::Vector3d& q) {
      const double along = t.normal.dot(q), most = surface.twisting * pressed;
      return Eigen::Vector3d(clipped(q - t.normal * along, surface.rolling * pressed) +
                             t.normal * std::clamp(along, -most, most));
    };
    f.turn = limited(f.turn - stiffness * h * rate);
    moment = t.arm * limited(f.turn - in_step(damping_r, m_r) * rate);
  }
};

Eigen::Vector3d vector(const float (&v)[3]) { return {v[0], v[1], v[2]}; }
Eigen::Vector3d vector(const Turn& v) { return {v[0], v[1], v[2]}; }
Turn turn_of(const Eigen::Vector3d& v) {
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

}  // namespace

void list_smooth_contacts(const World& world, const Assembly& found, BallState& state, SmoothScratch& out) {
  const PairList& list = found.pairs;
  const auto take = [&](const BallPair& pair) {
    const std::uint32_t old = list.old_place(pair);
    append(state.pairs, old == PairList::none ? PairImpulse{pair[0], pair[1], {0, 0, 0}, 0} : list.old[old]);
    if (world.rotation_resisted) append(state.pair_turns, old == PairList::none ? Turn{} : list.old_turns[old]);
  };
  for (std::size_t s = 0; s < list.num_slabs; ++s)
    for (const auto* pairs : {&list.slabs[s].near, &list.slabs[s].far})
      for (const BallPair& pair : *pairs) take(pair);
  for (const BallPair& pair : list.apart) take(pair);

  sort_wall_impulses(state.walls, state.wall_turns);
  out.candidates.balls.clear();
  out.candidates.triangles.clear();
  for (std::uint32_t w = 0; w < world.walls.size(); ++w)
    for (std::size_t s = 0; s < list.num_slabs; ++s) {
      const WallCandidates& from = found.walls[s].candidates;
      for (const NearWall& near : from.balls) {
        if (near.wall != w) continue;
        const auto begin = static_cast<std::uint32_t>(out.candidates.triangles.size());
        for (std::uint32_t t = near.begin; t < near.end; ++t) append(out.candidates.triangles, from.triangles[t]);
        append(out.candidates.balls,
               NearWall{near.ball, w, begin, static_cast<std::uint32_t>(out.candidates.triangles.size())});
      }
    }
  out.candidates.reached_after.assign(out.candidates.triangles.size(), 0.0f);
}

void apply_smooth_forces(const World& world, std::span<const double> inverse_mass, std::span<const Pose> poses,
                         BallState& state, SmoothScratch& out) {
  Balls& balls = state.balls;
  const double h = world.time_step, nu = world.physics.material.poisson_ratio;
  const bool turns = world.rotation_resisted;
  out.force.assign(balls.size(), Eigen::Vector3d::Zero());
  out.torque.assign(balls.size(), Eigen::Vector3d::Zero());
  out.overlaps.clear();
  if (turns) state.pair_turns.resize(state.pairs.size());

  const Law between{world.balls, nu, h, turns};
  for (std::size_t k = 0; k < state.pairs.size(); ++k) {
    PairImpulse& pair = state.pairs[k];
    const double radius_a = balls.radius[pair.a], radius_b = balls.radius[pair.b], touching = radius_a + radius_b;
    const Eigen::Vector3d apart = world.apart(balls.position[pair.a], balls.position[pair.b]);
    const double distance = apart.norm(), inverse = inverse_mass[pair.a] + inverse_mass[pair.b];
    const double range = world.cohesive ? world.balls.cohesion.range : 0;
    if (distance > touching + range || distance == 0 || inverse == 0) {
      pair.normal = 0;
      continue;
    }
    // Lever arms that meet in one point, see solver/contact_problem.h.
    const double reduced = radius_a * radius_b / touching, arm = distance / touching;
    Eigen::Vector3d total = Eigen::Vector3d::Zero(), moment = total;
    const Eigen::Vector3d normal = apart / distance;
    if (distance < touching) {
      const Touch touch{normal,
                        touching - distance,
                        balls.velocity[pair.a] - balls.velocity[pair.b],
                        arm * (radius_a * balls.spin[pair.a] + radius_b * balls.spin[pair.b]),
                        balls.spin[pair.a] - balls.spin[pair.b],
                        2 * reduced,
                        1 / inverse,
                        reduced};
      Force force;
      if (pair.normal > 0) {
        force.tangent = vector(pair.tangent);
        if (turns) force.turn = vector(state.pair_turns[k]);
      }
      between.evaluate(touch, force, total, moment);
      const Turn t = turn_of(force.tangent);
      // Marked as touching even where damping pulls.
      pair = {pair.a, pair.b, {t[0], t[1], t[2]}, std::max(static_cast<float>(force.normal), 1e-30f)};
      if (turns) state.pair_turns[k] = turn_of(force.turn);
      append(out.overlaps, static_cast<float>(touch.overlap));
    } else {
      pair.normal = 0;
    }
    const Eigen::Vector3d lever = arm * total.cross(normal);  // (-R n) x f
    if (world.cohesive) total -= normal * attraction(world.balls.cohesion_at(reduced), distance - touching);
    out.force[pair.a] += total;
    out.force[pair.b] -= total;
    out.torque[pair.a] += radius_a * lever + moment;
    out.torque[pair.b] += radius_b * lever - moment;
  }

  out.walls.clear();
  out.wall_turns.clear();
  WallMemory memory(state.walls);
  for (NearWall& near : out.candidates.balls) {
    const Wall& wall = world.walls[near.wall];
    const Pose& pose = poses[near.wall];
    const Law law{wall.surface, nu, h, turns};
    const Eigen::Vector3d& place = balls.position[near.ball];
    const double radius = balls.radius[near.ball], range = world.cohesive ? wall.surface.cohesion.range : 0;
    contacts_of(world, balls, near, out.candidates, pose, radius + range, out.contacts);
    memory.turn_to(near.wall, near.ball);
    for (const WallContact& contact : out.contacts) {
      const Eigen::Vector3d normal = pose.rotation * contact.normal;
      Eigen::Vector3d total = Eigen::Vector3d::Zero(), moment = total;
      if (contact.distance < radius) {
        const Eigen::Vector3f direction = contact.normal.cast<float>();
        Force force;
        if (const std::ptrdiff_t from = memory.take(direction); from >= 0) {
          const auto o = static_cast<std::size_t>(from);
          force.tangent = pose.rotation * vector(state.walls[o].tangent);
          if (turns && o < state.wall_turns.size()) force.turn = vector(state.wall_turns[o]);
        }
        const Touch touch{normal,
                          radius - contact.distance,
                          balls.velocity[near.ball] - pose.wall_velocity(place - normal * contact.distance),
                          radius * balls.spin[near.ball],
                          balls.spin[near.ball] - pose.angular_velocity,
                          radius,
                          1 / inverse_mass[near.ball],
                          radius};
        law.evaluate(touch, force, total, moment);
        const Turn t = turn_of(pose.rotation.transpose() * force.tangent);
        append(out.walls, WallImpulse{near.ball,
                                      near.wall,
                                      {direction[0], direction[1], direction[2]},
                                      {t[0], t[1], t[2]},
                                      static_cast<float>(force.normal)});
        if (turns) append(out.wall_turns, turn_of(force.turn));
        append(out.overlaps, static_cast<float>(touch.overlap));
      }
      out.torque[near.ball] += radius * total.cross(normal) + moment;
      if (world.cohesive) total -= normal * attraction(wall.surface.cohesion_at(radius), contact.distance - radius);
      out.force[near.ball] += total;
    }
  }
  state.walls.swap(out.walls);
  state.wall_turns.swap(out.wall_turns);

  for (std::size_t i = 0; i < balls.size(); ++i) {
    balls.velocity[i] += h * inverse_mass[i] * out.force[i];
    balls.spin[i] += h * inverse_mass[i] * 2.5 / (balls.radius[i] * balls.radius[i]) * out.torque[i];
  }
}

void move_freely(double h, Balls& balls) {
  for (std::size_t i = 0; i < balls.size(); ++i) balls.position[i] += h * balls.velocity[i];
}

}  // namespace drumsweep

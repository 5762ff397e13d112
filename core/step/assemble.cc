#include "core/step/assemble.h"

#include <algorithm>
#include <cmath>

#include "core/effects/rotation_resistance.h"
#include "core/solver/projected_gauss_seidel.h"
#include "core/state/arrays.h"

namespace drumsweep {
namespace {

// A wall contact takes over the impulse of an old one whose normal was this near.
constexpr float carried_direction = 0.8f;

Float4 float4(const Eigen::Vector3d& v, double fourth) {
  return Float4{static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2]),
                static_cast<float>(fourth)};
}

Float4 only_space(Float4 a) { return Float4{a[0], a[1], a[2], 0}; }

Float4 float4(const Turn& t) { return Float4{t[0], t[1], t[2], 0}; }

/// @param arm  distance of the centres over the sum of the radii
ContactRow make_row(const Eigen::Vector3d& normal, const NormalRow& row, double arm, double inverse_mass,
                    double friction, std::size_t a, std::size_t b, std::size_t surface) {
  return {float4(normal, row.bias),
          static_cast<float>(row.regularization),
          static_cast<float>(1 / (inverse_mass + row.regularization)),
          static_cast<float>(1 / ((1 + 2.5 * arm * arm) * inverse_mass)),
          static_cast<float>(friction),
          static_cast<std::uint32_t>(a),
          static_cast<std::uint32_t>(b),
          static_cast<float>(arm),
          static_cast<std::uint32_t>(surface)};
}

/// Impulse turned into the tangent plane of the new normal.
Impulse flattened(const Eigen::Vector3d& tangent, double normal_impulse, const Eigen::Vector3d& normal) {
  return float4(tangent - normal * normal.dot(tangent), normal_impulse);
}

/// The surface's law for a contact with this reduced radius.
ContactLaw law_of(const Surface& surface, double reduced_radius) {
  ContactLaw law = surface.law;
  law.stiffness = surface.stiffness(reduced_radius);
  return law;
}

/// An approach that Newton's law of impact governs: fast, and touching within the step.
bool is_impact(const Surface& surface, double overlap, double separating, double h) {
  return surface.restitution > 0 && separating < -surface.law.impact_speed && overlap - separating * h >= 0;
}

double friction_of(const Surface& surface, const Eigen::Vector3d& normal, const Eigen::Vector3d& relative,
                   const Eigen::Vector3d& turning) {
  if (!surface.friction_speed.on) return surface.friction;
  const Eigen::Vector3d u = relative + normal.cross(turning);
  return friction_at(surface.friction_speed, surface.friction, (u - normal * normal.dot(u)).norm());
}

}  // namespace

void find_wall_candidates(const World& world, const Balls& balls, std::span<const double> inverse_mass,
                          std::span<const Pose> poses, WallCandidates& out) {
  out.balls.clear();
  out.triangles.clear();
  // A ball's centre moves along a segment in the wall's frame; what it can touch lies within `beyond` and its radius of
  // that segment.
  const double horizon = world.physics.solver.outer_step_s,
               beyond = world.search.margin + world.search.extra_speed * horizon;
  for (std::size_t w = 0; w < world.walls.size(); ++w) {
    const Wall& wall = world.walls[w];
    const Pose& pose = poses[w];
    for (std::size_t i = 0; i < balls.size(); ++i) {
      if (inverse_mass[i] == 0) continue;
      const Eigen::Vector3d from = pose.to_body(balls.position[i]);
      Eigen::Vector3d moved = (balls.velocity[i] - pose.wall_velocity(balls.position[i])) * horizon;
      moved += world.gravity_vector * (horizon * horizon);
      const Eigen::Vector3d way = pose.rotation.transpose() * moved;
      const Eigen::Vector3d to = from + way;
      const auto begin = static_cast<std::uint32_t>(out.triangles.size());
      const Eigen::Vector3f p = from.cast<float>(), d = way.cast<float>();
      // What rebounds may go anywhere as far as it is fast.
      const double turned = world.restitutive ? way.norm() : 0;
      const float reach = static_cast<float>(balls.radius[i] + beyond + turned),
                  per_length = 1 / std::max(d.squaredNorm(), 1e-20f);
      const auto keep_if_near = [&](std::int32_t t) {
        const Eigen::Vector4f& sphere = wall.bounds[static_cast<std::size_t>(t)];
        const Eigen::Vector3f away = sphere.head<3>() - p;
        const float along = std::clamp(away.dot(d) * per_length, 0.0f, 1.0f), within = sphere[3] + reach;
        if ((away - along * d).squaredNorm() <= within * within) append(out.triangles, t);
      };
      if (turned == 0 && wall.grid.cell_of(from) == wall.grid.cell_of(to)) {
        for (const std::int32_t t : wall.grid.near(from)) keep_if_near(t);
      } else {
        const Eigen::Array3d around = Eigen::Array3d::Constant(turned);
        wall.grid.near(from.cwiseMin(to).array() - around, from.cwiseMax(to).array() + around, keep_if_near);
        std::sort(out.triangles.begin() + begin, out.triangles.end());
        out.triangles.erase(std::unique(out.triangles.begin() + begin, out.triangles.end()), out.triangles.end());
      }
      const auto end = static_cast<std::uint32_t>(out.triangles.size());
      if (end > begin) append(out.balls, {static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(w), begin, end});
    }
  }
}

void assemble_rows(const World& world, const BallState& state, std::span<const double> inverse_mass,
                   const WallCandidates& candidates, std::span<const Pose> poses, Assembly& out) {
  const Balls& balls = state.balls;
  const double h = world.time_step, margin = world.margin(), range = world.search.margin;
  const bool warm = world.physics.solver.warm_start;
  out.problem.rows.clear();
  out.problem.rotation.clear();
  out.overlap.clear();
  out.impulse.clear();
  out.turn.clear();
  out.pair_of.clear();
  out.walls.clear();
  out.velocity.clear();
  out.velocity.resize(balls.size());
  out.impacts = false;
  out.attracted.assign(world.cohesive ? balls.size() : 0, Eigen::Vector3f::Zero());

  // A row is needed where the pair presses, is within the margin, or would close its gap within the step.
  const auto needs_row = [&](double gap, double separating) { return gap <= margin || gap + separating * h <= 0; };

  // Ball against ball.
  const Surface& between = world.balls;
  for (std::size_t k = 0; k < state.pairs.size(); ++k) {
    const PairImpulse& pair = state.pairs[k];
    const Eigen::Vector3d apart = world.apart(balls.position[pair.a], balls.position[pair.b]);
    const double radius_a = balls.radius[pair.a], radius_b = balls.radius[pair.b];
    const double touching = radius_a + radius_b, squared = apart.squaredNorm();
    const Eigen::Vector3d closing = balls.velocity[pair.a] - balls.velocity[pair.b];
    const double cut = touching + range;
    if (squared > cut * cut && apart.dot(closing) >= 0) continue;
    const double distance = std::sqrt(squared);
    if (distance == 0) continue;  // no direction; the neighbours push such a pair apart
    const Eigen::Vector3d normal = apart / distance;
    const double separating = normal.dot(closing), gap = distance - touching;
    const double reduced = radius_a * radius_b / touching;
    if (world.cohesive) {
      const Eigen::Vector3f p = (normal * (attraction(between.cohesion_at(reduced), gap) * h)).cast<float>();
      out.attracted[pair.a] -= p;
      out.attracted[pair.b] += p;
    }
    if (!needs_row(gap, separating)) continue;
    const double both = inverse_mass[pair.a] + inverse_mass[pair.b];
    if (both == 0) continue;
    out.impacts = out.impacts || is_impact(between, -gap, separating, h);
    const double friction =
        friction_of(between, normal, closing, radius_a * balls.spin[pair.a] + radius_b * balls.spin[pair.b]);
    append(out.problem.rows, make_row(normal, normal_row(law_of(between, reduced), -gap, separating, h),
                                      distance / touching, both, friction, pair.a, pair.b, 0));
    append(out.pair_of, static_cast<std::uint32_t>(k));
    append(out.overlap, static_cast<float>(-gap));
    append(out.impulse,
           warm && pair.normal > 0
               ? flattened(Eigen::Vector3d(pair.tangent[0], pair.tangent[1], pair.tangent[2]), pair.normal, normal)
               : Impulse{});
    if (world.rotation_resisted) {
      append(out.problem.rotation, rotation_row(radius_a, radius_b, inverse_mass[pair.a], inverse_mass[pair.b],
                                                between.rolling, between.twisting, Float4{}));
      append(out.turn,
             warm && pair.normal > 0 && k < state.pair_turns.size() ? float4(state.pair_turns[k]) : TurnImpulse{});
    }
  }

  // Ball against wall: found in the wall's frame, solved in the room. Old impulses are sorted by wall and ball, as the
  // candidates are.
  std::size_t old = 0;
  for (const NearWall& near : candidates.balls) {
    const Wall& wall = world.walls[near.wall];
    const Pose& pose = poses[near.wall];
    const Surface& surface = wall.surface;
    const Eigen::Vector3d& place = balls.position[near.ball];
    const Eigen::Vector3d relative = balls.velocity[near.ball] - pose.wall_velocity(place);
    const double radius = balls.radius[near.ball];
    wall_contacts(wall.mesh, {candidates.triangles.data() + near.begin, near.end - near.begin}, pose.to_body(place),
                  radius + std::max(range, relative.norm() * h),
                  wall.one_sided && balls.exit[near.ball] == static_cast<std::uint8_t>(Exit::inside), out.contacts);
    const auto is_before = [&](const WallImpulse& w) {
      return w.wall != near.wall ? w.wall < near.wall : w.ball < near.ball;
    };
    while (old < state.walls.size() && is_before(state.walls[old])) ++old;
    std::uint32_t taken = 0;
    for (const WallContact& contact : out.contacts) {
      const Eigen::Vector3d normal = pose.rotation * contact.normal;
      const Eigen::Vector3d wall_velocity = pose.wall_velocity(place - normal * contact.distance);
      const Eigen::Vector3d closing = balls.velocity[near.ball] - wall_velocity;
      const double gap = contact.distance - radius, separating = normal.dot(closing);
      if (world.cohesive)
        out.attracted[near.ball] -= (normal * (attraction(surface.cohesion_at(radius), gap) * h)).cast<float>();
      if (!needs_row(gap, separating)) continue;

      out.impacts = out.impacts || is_impact(surface, -gap, separating, h);
      const double friction = friction_of(surface, normal, closing, radius * balls.spin[near.ball]);
      append(out.problem.rows,
             make_row(normal, normal_row(law_of(surface, radius), -gap, separating, h), 1, inverse_mass[near.ball],
                      friction, near.ball, out.velocity.size(), near.wall + 1));
      append(out.velocity, BodyVelocity{float4(wall_velocity, 0), Float4{}});
      append(out.overlap, static_cast<float>(-gap));
      const Eigen::Vector3f direction = contact.normal.cast<float>();
      WallImpulse kept{near.ball, near.wall, {direction[0], direction[1], direction[2]}, {0, 0, 0}, 0};

      // Warm start from the old contact of this ball with the nearest direction, each used once.
      Impulse start{};
      TurnImpulse start_turn{};
      float best = carried_direction;
      std::size_t from = state.walls.size();
      for (std::size_t o = old;
           warm && o < state.walls.size() && state.walls[o].ball == near.ball && state.walls[o].wall == near.wall;
           ++o) {
        const WallImpulse& w = state.walls[o];
        const float alike =
            direction[0] * w.direction[0] + direction[1] * w.direction[1] + direction[2] * w.direction[2];
        if (alike > best && (taken >> (o - old) & 1u) == 0) {
          best = alike;
          from = o;
        }
      }
      if (from < state.walls.size()) {
        const WallImpulse& w = state.walls[from];
        taken |= 1u << (from - old);
        start = flattened(pose.rotation * Eigen::Vector3d(w.tangent[0], w.tangent[1], w.tangent[2]), w.normal, normal);
        if (from < state.wall_turns.size()) start_turn = float4(state.wall_turns[from]);
      }
      append(out.impulse, start);
      append(out.walls, kept);
      if (world.rotation_resisted) {
        append(out.problem.rotation, rotation_row(radius, 0, inverse_mass[near.ball], 0, surface.rolling,
                                                  surface.twisting, float4(radius * pose.angular_velocity, 0)));
        append(out.turn, start_turn);
      }
    }
  }
}

namespace {

/// Newton's law with friction may add energy where impacts are coupled (Kane and Levinson 1985). The impulses of each group of balls
/// that is joined by them are scaled down until the group gains no more than moving walls do work on it: with velocities
/// v + s dv the gain is b s + c s^2, the work w s, so s = (w - b) / c. Cones of friction and momentum are kept.
void limit_energy(const Balls& balls, Assembly& a) {
  const std::size_t num = balls.size();
  std::vector<std::uint32_t>& group = a.impact_group;
  group.resize(num);
  for (std::uint32_t i = 0; i < num; ++i) group[i] = i;
  const auto root = [&](std::uint32_t i) {
    while (group[i] != i) i = group[i] = group[group[i]];
    return i;
  };
  const std::vector<ContactRow>& rows = a.impact_problem.rows;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    if (a.impact_impulse[r][3] == 0 || rows[r].b >= num) continue;
    const std::uint32_t one = root(rows[r].a), two = root(rows[r].b);
    group[std::max(one, two)] = std::min(one, two);
  }

  // Of each group, at its root: b, c and w.
  std::vector<std::array<double, 3>>& gain = a.impact_gain;
  gain.assign(num, {0, 0, 0});
  const auto before = [&](std::size_t i) {
    return BodyVelocity{float4(balls.velocity[i], a.velocity[i].linear[3]), float4(balls.spin[i] * balls.radius[i], 0)};
  };
  for (std::uint32_t i = 0; i < num; ++i) {
    const double inverse_mass = a.velocity[i].linear[3];
    if (inverse_mass == 0) continue;
    const BodyVelocity old = before(i);
    std::array<double, 3>& sum = gain[root(i)];
    for (int k = 0; k < 3; ++k) {
      const double v = old.linear[k], dv = a.velocity[i].linear[k] - old.linear[k], spin = old.surface[k],
                   turned = a.velocity[i].surface[k] - old.surface[k];
      sum[0] += (v * dv + 0.4 * spin * turned) / inverse_mass;
      sum[1] += 0.5 * (dv * dv + 0.4 * turned * turned) / inverse_mass;
    }
  }
  for (std::size_t r = 0; r < rows.size(); ++r) {
    if (a.impact_impulse[r][3] == 0 || rows[r].b < num) continue;
    const Float4 p = only_space(rows[r].normal) * a.impact_impulse[r][3] + only_space(a.impact_impulse[r]),
                 work = p * a.velocity[rows[r].b].linear;
    double sum = (work[0] + work[1]) + work[2];
    if (!a.impact_turn.empty()) {
      // Torque times the wall's angular velocity: turn impulse is over the arm, wall_turn has the arm in it.
      const Float4 turn = a.impact_turn[r] * a.impact_problem.rotation[r].wall_turn;
      sum += (turn[0] + turn[1]) + turn[2];
    }
    gain[root(rows[r].a)][2] += sum;
  }
  for (std::uint32_t i = 0; i < num; ++i) {
    const auto& [b, c, w] = gain[root(i)];
    if (!(b + c > w) || c == 0) continue;
    const auto scale = static_cast<float>(std::max(0.0, (w - b) / c));
    const BodyVelocity old = before(i);
    const float inverse_mass = old.linear[3];
    a.velocity[i].linear = old.linear + (a.velocity[i].linear - old.linear) * scale;
    a.velocity[i].surface = old.surface + (a.velocity[i].surface - old.surface) * scale;
    a.velocity[i].linear[3] = inverse_mass;
  }
}

}  // namespace

void resolve_impacts(const World& world, int iterations, std::span<const double> inverse_mass, Assembly& assembly,
                     BallState& state) {
  const double h = world.time_step;
  Balls& balls = state.balls;
  load_velocities(balls, inverse_mass, assembly);
  const auto separating = [&](const ContactRow& row) {
    const Float4 u = assembly.velocity[row.a].linear - assembly.velocity[row.b].linear, p = u * row.normal;
    return static_cast<double>((p[0] + p[1]) + p[2]);
  };
  // 1/m_a + 1/m_b
  const auto pair_mass = [](const ContactRow& row) {
    return 1 / ((1 + 2.5f * row.arm * row.arm) * row.inverse_tangent);
  };

  // Rigid rows: -e u- where it collides, no approach where it touches, the gap elsewhere.
  assembly.impact_problem.rows = assembly.problem.rows;
  assembly.impact_problem.rotation = assembly.problem.rotation;
  assembly.impact_impulse.assign(assembly.problem.rows.size(), Impulse{});
  assembly.impact_turn.assign(assembly.problem.rotation.size(), TurnImpulse{});
  for (std::size_t i = 0; i < assembly.impact_problem.rows.size(); ++i) {
    ContactRow& row = assembly.impact_problem.rows[i];
    const double overlap = assembly.overlap[i];
    const Surface& surface = world.surface(row.surface);
    const double u = separating(row);
    if (is_impact(surface, overlap, u, h))
      row.normal[3] = static_cast<float>(-surface.restitution * u);
    else
      row.normal[3] = static_cast<float>(std::min(0.0, overlap / h));
    row.regularization = 0;
    row.inverse_normal = 1 / pair_mass(row);
  }
  solve(assembly.impact_problem, iterations, assembly.impact_impulse, assembly.impact_turn, assembly.velocity);
  limit_energy(balls, assembly);
  store_velocities(assembly, balls);
}

void load_velocities(const Balls& balls, std::span<const double> inverse_mass, Assembly& assembly) {
  for (std::size_t i = 0; i < balls.size(); ++i)
    assembly.velocity[i] = {float4(balls.velocity[i], inverse_mass[i]), float4(balls.spin[i] * balls.radius[i], 0)};
}

void store_velocities(const Assembly& assembly, Balls& balls) {
  // The solver works in float on velocities rounded from the state's; only its changes are added back.
  for (std::size_t i = 0; i < balls.size(); ++i) {
    const BodyVelocity& after = assembly.velocity[i];
    for (int k = 0; k < 3; ++k) {
      balls.velocity[i][k] +=
          static_cast<double>(after.linear[k]) - static_cast<double>(static_cast<float>(balls.velocity[i][k]));
      balls.spin[i][k] += (static_cast<double>(after.surface[k]) -
                           static_cast<double>(static_cast<float>(balls.spin[i][k] * balls.radius[i]))) /
                          balls.radius[i];
    }
  }
}

void store_impulses(std::span<const Pose> poses, const Assembly& assembly, BallState& state) {
  for (PairImpulse& pair : state.pairs) pair.normal = 0;
  const std::size_t num_pairs = assembly.pair_of.size();
  for (std::size_t r = 0; r < num_pairs; ++r) {
    PairImpulse& pair = state.pairs[assembly.pair_of[r]];
    const Impulse& p = assembly.impulse[r];
    pair = {pair.a, pair.b, {p[0], p[1], p[2]}, p[3]};
  }
  state.walls = assembly.walls;
  for (std::size_t w = 0; w < state.walls.size(); ++w) {
    const Impulse& p = assembly.impulse[num_pairs + w];
    const Eigen::Matrix3d to_body = poses[state.walls[w].wall].rotation.transpose();
    const Eigen::Vector3f tangent = (to_body * Eigen::Vector3d(p[0], p[1], p[2])).cast<float>();
    for (int k = 0; k < 3; ++k) state.walls[w].tangent[k] = tangent[k];
    state.walls[w].normal = p[3];
  }

  // Turns of pairs without a row are forgotten with their impulses: they are not read while normal is 0.
  if (assembly.turn.empty()) {
    state.pair_turns.clear();
    state.wall_turns.clear();
    return;
  }
  const auto turn = [](const TurnImpulse& q) { return Turn{q[0], q[1], q[2]}; };
  state.pair_turns.resize(state.pairs.size());
  for (std::size_t r = 0; r < num_pairs; ++r) state.pair_turns[assembly.pair_of[r]] = turn(assembly.turn[r]);
  state.wall_turns.resize(state.walls.size());
  for (std::size_t w = 0; w < state.walls.size(); ++w) state.wall_turns[w] = turn(assembly.turn[num_pairs + w]);
}

}  // namespace drumsweep

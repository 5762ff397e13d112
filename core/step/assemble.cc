#include "core/step/assemble.h"

#include <algorithm>
#include <cmath>

#include "core/state/arrays.h"

namespace drumsweep {
namespace {

constexpr float carried_direction =
    0.8f;  // a wall contact takes over the impulse of an old one whose normal was this near

Float4 float4(const Eigen::Vector3d& v, double fourth) {
  return Float4{static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2]),
                static_cast<float>(fourth)};
}

ContactRow make_row(const Eigen::Vector3d& normal, const NormalRow& row, double overlap, double inverse_mass,
                    double friction, std::size_t a, std::size_t b) {
  return {float4(normal, row.bias),
          static_cast<float>(row.regularization),
          static_cast<float>(1 / (inverse_mass + row.regularization)),
          static_cast<float>(1 / (3.5 * inverse_mass)),
          static_cast<float>(friction),
          static_cast<std::uint32_t>(a),
          static_cast<std::uint32_t>(b),
          static_cast<float>(overlap),
          0};
}

/// Impulse turned into the tangent plane of the new normal.
Impulse flattened(const Eigen::Vector3d& tangent, double normal_impulse, const Eigen::Vector3d& normal) {
  return float4(tangent - normal * normal.dot(tangent), normal_impulse);
}

}  // namespace

void find_wall_candidates(const DrumModel& model, const Balls& balls, const Pose& pose, WallCandidates& out) {
  out.balls.clear();
  out.triangles.clear();
  // A ball's centre moves along a segment in the drum's frame; what it can touch lies within `beyond` and its radius of
  // that segment.
  const double horizon = model.study.solver.outer_step_s, beyond = model.margin() + model.search.extra_speed * horizon;
  for (std::size_t i = 0; i < balls.size(); ++i) {
    const Eigen::Vector3d from = pose.to_body(balls.position[i]);
    Eigen::Vector3d moved = (balls.velocity[i] - pose.wall_velocity(balls.position[i])) * horizon;
    moved[2] -= gravity * horizon * horizon;
    const Eigen::Vector3d way = pose.rotation.transpose() * moved;
    const Eigen::Vector3d to = from + way;
    const auto begin = static_cast<std::uint32_t>(out.triangles.size());
    const Eigen::Vector3f p = from.cast<float>(), d = way.cast<float>();
    const float reach = static_cast<float>(balls.radius[i] + beyond),
                per_length = 1 / std::max(d.squaredNorm(), 1e-20f);
    const auto keep_if_near = [&](std::int32_t t) {
      const Eigen::Vector4f& sphere = model.bounds[static_cast<std::size_t>(t)];
      const Eigen::Vector3f away = sphere.head<3>() - p;
      const float along = std::clamp(away.dot(d) * per_length, 0.0f, 1.0f), within = sphere[3] + reach;
      if ((away - along * d).squaredNorm() <= within * within) append(out.triangles, t);
    };
    if (model.grid.cell_of(from) == model.grid.cell_of(to)) {
      for (const std::int32_t t : model.grid.near(from)) keep_if_near(t);
    } else {
      model.grid.near(from.cwiseMin(to), from.cwiseMax(to), keep_if_near);
      std::sort(out.triangles.begin() + begin, out.triangles.end());
      out.triangles.erase(std::unique(out.triangles.begin() + begin, out.triangles.end()), out.triangles.end());
    }
    const auto end = static_cast<std::uint32_t>(out.triangles.size());
    if (end > begin) append(out.balls, {static_cast<std::uint32_t>(i), begin, end});
  }
}

void assemble_rows(const DrumModel& model, const DrumState& state, const WallCandidates& candidates, const Pose& pose,
                   Assembly& out) {
  const Balls& balls = state.balls;
  const double h = model.time_step, margin = model.margin(), friction = model.study.material.friction;
  const bool warm = model.study.solver.warm_start;
  out.problem.rows.clear();
  out.impulse.clear();
  out.pair_of.clear();
  out.walls.clear();
  out.velocity.clear();
  out.velocity.resize(balls.size());

  // A row is needed where the pair presses, is within the margin, or would close its gap within the step.
  const auto needs_row = [&](double gap, double separating) { return gap <= margin || gap + separating * h <= 0; };

  // Ball against ball.
  for (std::size_t k = 0; k < state.pairs.size(); ++k) {
    const PairImpulse& pair = state.pairs[k];
    const Eigen::Vector3d apart = balls.position[pair.a] - balls.position[pair.b];
    const double touching = balls.radius[pair.a] + balls.radius[pair.b], squared = apart.squaredNorm();
    const Eigen::Vector3d closing = balls.velocity[pair.a] - balls.velocity[pair.b];
    const double cut = touching + margin;
    if (squared > cut * cut && apart.dot(closing) >= 0) continue;
    const double distance = std::sqrt(squared);
    if (distance == 0) continue;  // no direction; the neighbours push such a pair apart
    const Eigen::Vector3d normal = apart / distance;
    const double separating = normal.dot(closing), gap = distance - touching;
    if (!needs_row(gap, separating)) continue;
    const double inverse_mass = model.inverse_mass(balls.radius[pair.a]) + model.inverse_mass(balls.radius[pair.b]);
    append(out.problem.rows,
           make_row(normal, normal_row(model.law, -gap, separating, h), -gap, inverse_mass, friction, pair.a, pair.b));
    append(out.pair_of, static_cast<std::uint32_t>(k));
    append(out.impulse,
           warm && pair.normal > 0
               ? flattened(Eigen::Vector3d(pair.tangent[0], pair.tangent[1], pair.tangent[2]), pair.normal, normal)
               : Impulse{});
  }

  // Ball against wall: found in the drum's frame, solved in the room. Old impulses are sorted by ball, as the
  // candidates are.
  std::size_t old = 0;
  for (const NearWall& near : candidates.balls) {
    const Eigen::Vector3d& place = balls.position[near.ball];
    const Eigen::Vector3d relative = balls.velocity[near.ball] - pose.wall_velocity(place);
    const double radius = balls.radius[near.ball];
    wall_contacts(model.wall.mesh, {candidates.triangles.data() + near.begin, near.end - near.begin},
                  pose.to_body(place), radius + std::max(margin, relative.norm() * h),
                  balls.exit[near.ball] == static_cast<std::uint8_t>(Exit::inside), out.contacts);
    while (old < state.walls.size() && state.walls[old].ball < near.ball) ++old;
    std::uint32_t taken = 0;
    for (const WallContact& contact : out.contacts) {
      const Eigen::Vector3d normal = pose.rotation * contact.normal;
      const Eigen::Vector3d wall_velocity = pose.wall_velocity(place - normal * contact.distance);
      const double gap = contact.distance - radius, separating = normal.dot(balls.velocity[near.ball] - wall_velocity);
      if (!needs_row(gap, separating)) continue;

      const double inverse_mass = model.inverse_mass(radius);
      append(out.problem.rows, make_row(normal, normal_row(model.law, -gap, separating, h), -gap, inverse_mass,
                                        friction, near.ball, out.velocity.size()));
      append(out.velocity, BodyVelocity{float4(wall_velocity, 0), Float4{}});
      const Eigen::Vector3f direction = contact.normal.cast<float>();
      WallImpulse kept{near.ball, {direction[0], direction[1], direction[2]}, {0, 0, 0}, 0};

      // Warm start from the old contact of this ball with the nearest direction, each used once.
      Impulse start{};
      float best = carried_direction;
      std::size_t from = state.walls.size();
      for (std::size_t o = old; warm && o < state.walls.size() && state.walls[o].ball == near.ball; ++o) {
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
      }
      append(out.impulse, start);
      append(out.walls, kept);
    }
  }
}

void load_velocities(const DrumModel& model, const Balls& balls, Assembly& assembly) {
  for (std::size_t i = 0; i < balls.size(); ++i)
    assembly.velocity[i] = {float4(balls.velocity[i], model.inverse_mass(balls.radius[i])),
                            float4(balls.spin[i] * balls.radius[i], 0)};
}

void store_result(const Pose& pose, const Assembly& assembly, DrumState& state) {
  // The solver works in float on velocities rounded from the state's; only its changes are added back.
  Balls& balls = state.balls;
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
    const Eigen::Vector3f tangent = (pose.rotation.transpose() * Eigen::Vector3d(p[0], p[1], p[2])).cast<float>();
    state.walls[w] = {state.walls[w].ball,
                      {state.walls[w].direction[0], state.walls[w].direction[1], state.walls[w].direction[2]},
                      {tangent[0], tangent[1], tangent[2]},
                      p[3]};
  }
}

}  // namespace drumsweep

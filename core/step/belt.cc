#include "core/step/belt.h"

#include <cmath>

namespace drumsweep {
namespace {

double angle_length(const Eigen::Vector3d& body, double radius) { return std::atan2(body[1], body[0]) * radius; }

/// Whether a centre (body frame, within the outlet) is beyond the wall's surface, which a slot is thought to continue.
bool beyond_wall(const DrumSurface& wall, const Eigen::Vector3d& body) {
  return std::hypot(body[0], body[1]) >
         wall.outlet.radius - wall.texture.height(angle_length(body, wall.outlet.radius), body[2]);
}

}  // namespace

void record_exits_and_landings(const DrumModel& model, const Pose& pose, double time, DrumState& state,
                               std::vector<char>& gone, std::vector<Landing>* landings) {
  const Study& study = model.study;
  const OutletShape& outlet = model.wall.outlet;
  const double h = model.world.time_step, diameter = study.material.diameter_m, wall = outlet.radius;
  // No ball flies this far; one that does would blow up the grid of the contact search.
  const double far = 4 * (study.drum.length_m + outlet.length + study.drum.diameter_m) - model.belt_height;
  const double bumps = wall - model.wall.highest_bump;
  const Eigen::Vector3d axis = model.tilt.col(2);
  Balls& balls = state.balls;
  gone.resize(balls.size(), 0);
  const auto inside = static_cast<std::uint8_t>(Exit::inside), end = static_cast<std::uint8_t>(Exit::end);
  const auto lose = [&](std::size_t i) {
    gone[i] = 1;
    ++state.counts.removed;
  };

  for (std::size_t i = 0; i < balls.size(); ++i) {
    if (gone[i]) continue;
    const Eigen::Vector3d& p = balls.position[i];
    const Eigen::Vector3d from_origin = p - pose.origin;
    const double s = axis.dot(from_origin), squared = from_origin.squaredNorm() - s * s;
    if (!(std::abs(s) + std::sqrt(squared) < far && balls.velocity[i].allFinite() && balls.spin[i].allFinite())) {
      lose(i);
      continue;
    }

    // Way out: over the end; in a slot, through the surface that the slot interrupts; at the latest, through the bare
    // cylinder.
    if (balls.exit[i] == inside) {
      const double outer = wall + balls.radius[i];
      if (s > outlet.length) {
        balls.exit[i] = end;
      } else if (s < -study.drum.length_m - balls.radius[i]) {
        lose(i);
        continue;
      } else if (squared > wall * wall) {
        // The step may carry a ball past the slot's edge by what it moves relative to the wall. A centre that is elsewhere beyond the wall,
        // by less than a radius, is a deep overlap, which the wall pushes back.
        const Eigen::Vector3d body = pose.to_body(p);
        const auto [slot, past] = outlet.nearest_slot(std::max(0.0, s), angle_length(body, wall));
        const double slack = 2 * diameter + h * (balls.velocity[i] - pose.wall_velocity(p)).norm();
        if (s > -diameter && past < slack) {
          balls.exit[i] = static_cast<std::uint8_t>(slot + 1);
        } else if (squared > outer * outer) {
          lose(i);
          continue;
        }
      } else if (s > 0 && squared > bumps * bumps) {
        const Eigen::Vector3d body = pose.to_body(p);
        const auto [slot, beyond] = outlet.nearest_slot(s, angle_length(body, wall));
        if (beyond < 0 && beyond_wall(model.wall, body)) balls.exit[i] = static_cast<std::uint8_t>(slot + 1);
      }
    }

    // Landing: the lower side of the ball has crossed the belt plane in this step.
    const double below = model.belt_height + balls.radius[i] - p[2];
    if (below < 0) continue;
    if (balls.exit[i] == inside) {
      lose(i);
      continue;
    }
    const Eigen::Vector3d& v = balls.velocity[i];
    const double back = v[2] < 0 ? std::min(h, below / -v[2]) : 0.0;
    const Landing landing{time - back,
                          p[0] - back * v[0],
                          p[1] - back * v[1],
                          static_cast<float>(v[0]),
                          static_cast<float>(v[1]),
                          static_cast<float>(v[2]),
                          static_cast<float>(balls.radius[i]),
                          balls.id[i],
                          balls.exit[i]};
    gone[i] = 1;
    const bool on_belt = landing.y >= 0 && landing.y <= study.belt.width_m;
    if (on_belt || study.belt.edge == "skirt")
      ++state.counts.landed;
    else
      ++state.counts.spilled;
    if (landings != nullptr) landings->push_back(landing);
  }
}

void adopt_outlet(const DrumModel& model, DrumState& state) {
  const Pose pose = model.pose(time_of(model, state.num_steps));
  Balls& balls = state.balls;
  for (std::size_t i = 0; i < balls.size(); ++i) {
    if (balls.exit[i] != static_cast<std::uint8_t>(Exit::inside)) continue;
    const Eigen::Vector3d p = pose.to_body(balls.position[i]);
    if (p[2] < 0 || p[2] > model.wall.outlet.length) continue;

    if (beyond_wall(model.wall, p))
      balls.exit[i] = static_cast<std::uint8_t>(
          model.wall.outlet.nearest_slot(p[2], angle_length(p, model.wall.outlet.radius)).slot + 1);
  }
  std::erase_if(state.walls, [&](const WallImpulse& w) {
    return pose.to_body(balls.position[w.ball])[2] > -2 * balls.radius[w.ball];
  });
}

}  // namespace drumsweep

#include "core/scene/discharge.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/geometry/primitives.h"
#include "core/step/belt.h"

namespace drumsweep {
namespace {

constexpr double floor_below_belt = 0.25;  ///< what has left the belt is gone from there on [m]

/// Height of a skirt at y: it ends below the drum, beyond which it is as high as the drum is wide [m].
double skirt_height(const Study& study, double y) {
  const double incline = study.drum.inclination_deg * std::numbers::pi / 180;
  const double to_end = study.outlet.length_m - (y - study.belt.outlet_begin_m) / std::cos(incline);
  if (to_end < -study.material.diameter_m) return study.belt.drop_height_m + study.drum.diameter_m;
  return 0.9 * (study.belt.drop_height_m + std::max(0.0, to_end) * std::sin(incline));
}

/// The belt, and where it has them its skirts: smooth sheets, as in the conveyor scene.
void add_belt(DrumModel& model, double height) {
  const BeltConfig& config = model.study.belt;
  const auto [begin, end] = belt_piece(model.study);
  const double resolution = std::max(config.width_m, end - begin);
  const Eigen::Vector3d along(end - begin, 0, 0), across(0, config.width_m, 0);
  TriangleMesh belt;
  add_plate(belt, {begin, 0, height}, along, across);
  Motion motion;
  motion.belt = {config.speed_m_s, 0, 0};
  model.world.add_wall(std::move(belt), resolution, motion);
  if (config.edge != "skirt") return;
  TriangleMesh skirts;
  const auto up = [&](double y) { return Eigen::Vector3d(0, 0, skirt_height(model.study, y)); };
  add_plate(skirts, {begin, 0, height}, up(0), along);
  add_plate(skirts, {begin, config.width_m, height}, along, up(config.width_m));
  Surface smooth = wall_surface(model.study);
  smooth.friction = 0;
  smooth.friction_speed.on = false;
  smooth.rolling = smooth.twisting = 0;
  model.world.add_wall(std::move(skirts), resolution, {}, smooth);
}

}  // namespace

BeltPiece belt_piece(const Study& study) { return {-0.9 * study.drum.diameter_m, 0.9 * study.drum.diameter_m}; }

Discharge::Discharge(const Study& study, const OutletConfig& outlet, DrumState state)
    : belt_height_(0), model_(study, outlet), state_(std::move(state)) {
  belt_height_ = model_.belt_height;
  adopt_outlet(model_, state_);
  add_belt(model_, belt_height_);
  // The recorder of landings takes care of the floor instead.
  model_.belt_height -= floor_below_belt;
}

bool Discharge::run_until(double until, const std::function<bool()>& go_on) {
  const double half = 0.5 * model_.study.solver.outer_step_s;
  while (time() < until - half) {
    step();
    if (go_on && !go_on()) return false;
  }
  return true;
}

void Discharge::step() {
  work_.threads = threads;
  feed_balls(model_, state_, feed_);
  work_.gone.assign(state_.balls.size(), 0);
  advance(model_.world, state_, work_, [&](double time) {
    record_exits_and_landings(model_, model_.pose(time), time, state_, work_.gone, nullptr);
  });
  // Carried to the end of the belt, or fallen past its beginning: the piece is cut out of a longer belt.
  const BeltPiece belt = belt_piece(model_.study);
  for (std::size_t i = 0; i < state_.balls.size(); ++i) {
    const Eigen::Vector3d& p = state_.balls.position[i];
    const bool past = p[0] > belt.end || (p[0] < belt.begin && p[2] < belt_height_ + state_.balls.radius[i]);
    if (past && state_.balls.exit[i] != static_cast<std::uint8_t>(Exit::inside)) work_.gone[i] = 1;
  }
  drop_gone(state_, work_.gone);
}

}  // namespace drumsweep

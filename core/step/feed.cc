#include "core/step/feed.h"

#include <cmath>
#include <optional>

#include "core/geometry/random.h"

namespace drumsweep {
namespace {

constexpr std::uint32_t max_attempts = 30;

/// Lowest place for a ball of radius r straight above (x, axial place) with everything beneath it, or none below the
/// ceiling. Frame: x across, `up` perpendicular to the axis, `along` the axis, all from the axis where the outlet
/// begins.
struct Place {
  double x, up, along;
};

}  // namespace

void feed_balls(const DrumModel& model, DrumState& state, FeedScratch& scratch) {
  const Study& study = model.study;
  state.feed_debt_kg += study.feed.rate_kg_s * study.solver.outer_step_s;
  // Each ball has its own mass where sizes differ.
  const auto next_radius = [&] { return model.world.radius_of(static_cast<std::uint32_t>(state.counts.fed)); };
  const auto mass = [&](double radius) { return 1 / model.world.inverse_mass(radius); };
  const double largest = model.world.largest_radius;
  double r = next_radius();
  const bool alike = study.effects.size_spread == 0;
  const auto due = [&] { return alike ? model.world.mean_mass : mass(r); };
  if (state.feed_debt_kg < due()) return;

  const Eigen::Vector3d origin(0, study.belt.outlet_begin_m, 0), along = model.tilt.col(2), up = -model.tilt.col(1);
  const double begin = -study.drum.length_m + study.feed.zone_begin_m;
  const auto local = [&](const Eigen::Vector3d& p) {
    return Place{p[0] - origin[0], up.dot(p - origin), along.dot(p - origin)};
  };

  Balls& balls = state.balls;
  scratch.in_zone.clear();
  for (std::size_t i = 0; i < balls.size(); ++i) {
    const double a = along.dot(balls.position[i] - origin);
    if (a > begin - 2 * largest && a < begin + study.feed.zone_length_m + 2 * largest)
      scratch.in_zone.push_back(static_cast<std::uint32_t>(i));
  }

  // The smooth cylinder inside all bumps bounds the wall; a ball must start below the axis.
  const auto find_place = [&](const std::array<double, 4>& draw) -> std::optional<Place> {
    const double free_radius = 0.5 * study.drum.diameter_m - model.wall.highest_bump - 1.05 * r;
    Place place{(draw[0] - 0.5) * study.feed.zone_width_m, 0, begin + draw[1] * study.feed.zone_length_m};
    place.along = std::max(place.along, -study.drum.length_m + 1.05 * r);
    if (std::abs(place.x) >= free_radius) return std::nullopt;
    place.up = -std::sqrt(free_radius * free_radius - place.x * place.x);
    for (const std::uint32_t i : scratch.in_zone) {
      const Place q = local(balls.position[i]);
      const double apart = (1 + 1e-6) * (r + balls.radius[i]), dx = q.x - place.x, da = q.along - place.along;
      const double room = apart * apart - dx * dx - da * da;
      if (room > 0) place.up = std::max(place.up, q.up + std::sqrt(room));
    }
    place.up += 0.02 * r;
    if (place.up > -r) return std::nullopt;
    return place;
  };

  const std::int64_t seed = replicate_seed(study.seed, study.record.replicate);
  while (state.feed_debt_kg >= due()) {
    const auto id = static_cast<std::uint32_t>(state.counts.fed);
    std::optional<Place> place;
    for (std::uint32_t attempt = 0; attempt < max_attempts && !place; ++attempt)
      place = find_place(uniform4(seed, Purpose::feed, id, attempt));
    if (!place) return;
    scratch.in_zone.push_back(static_cast<std::uint32_t>(balls.size()));
    balls.add(origin + Eigen::Vector3d(place->x, 0, 0) + up * place->up + along * place->along, r, id);
    ++state.counts.fed;
    state.feed_debt_kg -= due();
    r = next_radius();
  }
}

}  // namespace drumsweep

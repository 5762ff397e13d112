#include "core/step/feed.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/step/stepper.h"
#include "support/small_drum.h"

namespace drumsweep {
namespace {

TEST(Feed, places_balls_without_overlap_at_the_given_rate) {
  const Study study = small_drum();
  const DrumModel model(study, study.outlet);
  DrumState state;
  FeedScratch scratch;
  // No motion in between: every ball has to find room above those before it.
  for (int i = 0; i < 60; ++i) feed_balls(model, state, scratch);
  const Balls& b = state.balls;
  EXPECT_EQ(state.counts.fed,
            static_cast<std::int64_t>(60 * study.solver.outer_step_s * study.feed.rate_kg_s / model.world.mean_mass));
  std::vector<WallContact> contacts;
  const Pose pose = model.pose(0);
  for (std::size_t i = 0; i < b.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) EXPECT_GT((b.position[i] - b.position[j]).norm(), b.radius[i] + b.radius[j]);
    const Eigen::Vector3d p = pose.to_body(b.position[i]);
    std::vector<std::int32_t> near;
    model.world.walls.front().grid.near(p.cast<float>(), p.cast<float>(), [&](const WallGrid::Triangles& t) {
      near.assign(t.index.begin(), t.index.end());
    });
    wall_contacts(model.mesh(), near, p, 2 * b.radius[i], true, contacts);
    for (const WallContact& c : contacts) EXPECT_GT(c.distance, b.radius[i]);
  }
}

TEST(Feed, a_blocked_zone_keeps_the_balls_due_instead_of_dropping_them) {
  Study study = small_drum();
  study.feed.rate_kg_s = 50;
  const DrumModel model(study, study.outlet);
  DrumState state;
  FeedScratch scratch;
  for (int i = 0; i < 100; ++i) feed_balls(model, state, scratch);
  const double placed = static_cast<double>(state.counts.fed) * model.world.mean_mass;
  EXPECT_GT(state.feed_debt_kg, 1);
  EXPECT_NEAR(placed + state.feed_debt_kg, 100 * study.solver.outer_step_s * 50, 1e-9);
}

}  // namespace
}  // namespace drumsweep

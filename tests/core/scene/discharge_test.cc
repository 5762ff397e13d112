#include "core/scene/discharge.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/small_drum.h"

namespace drumsweep {
namespace {

DrumState loaded(const Study& study) { return filled_drum(DrumModel(study, study.outlet), 250); }

/// Balls that lie on the belt, out of reach of those that still fall.
std::vector<std::size_t> on_belt(const Discharge& d) {
  std::vector<std::size_t> list;
  const Balls& b = d.state().balls;
  for (std::size_t i = 0; i < b.size(); ++i)
    if (b.exit[i] != 0 && b.position[i][0] > 0.14 && b.position[i][2] < d.belt_height() + 1.2 * b.radius[i])
      list.push_back(i);
  return list;
}

TEST(Discharge, balls_land_on_the_belt_lie_on_it_and_ride_away_at_its_speed) {
  const Study study = small_drum();
  Discharge run(study, study.outlet, loaded(study));
  ASSERT_TRUE(run.run_until(3.0, {}));
  EXPECT_NEAR(run.time(), 3.0, study.solver.outer_step_s);
  const Balls& balls = run.state().balls;
  const std::vector<std::size_t> bed = on_belt(run);
  ASSERT_GT(bed.size(), 20u);
  double speed = 0;
  for (const std::size_t i : bed) {
    EXPECT_GT(balls.position[i][2], run.belt_height() + 0.9 * balls.radius[i]);
    speed += balls.velocity[i][0] / static_cast<double>(bed.size());
  }
  EXPECT_NEAR(speed, study.belt.speed_m_s, 0.02 * study.belt.speed_m_s);
  const double end = belt_piece(study).end;
  for (std::size_t i = 0; i < balls.size(); ++i)
    if (balls.exit[i] != 0) {
      EXPECT_LE(balls.position[i][0], end);
    }
  EXPECT_EQ(run.state().counts.removed, 0);
}

TEST(Discharge, is_the_same_for_any_number_of_threads_and_stops_when_asked) {
  const Study study = small_drum();
  Discharge one(study, study.outlet, loaded(study)), two(study, study.outlet, loaded(study));
  two.threads = 2;
  one.run_until(0.4, {});
  two.run_until(0.4, {});
  EXPECT_EQ(state_hash(one.state()), state_hash(two.state()));
  int left = 3;
  EXPECT_FALSE(one.run_until(9, [&] { return --left > 0; }));
  EXPECT_NEAR(one.time(), 0.4 + 3 * study.solver.outer_step_s, 1e-9);
}

TEST(Discharge, an_open_belt_has_no_skirts_and_both_have_the_drum_first) {
  Study study = small_drum();
  EXPECT_EQ(Discharge(study, study.outlet, {}).model().world.walls.size(), 3u);
  study.belt.edge = "open";
  EXPECT_EQ(Discharge(study, study.outlet, {}).model().world.walls.size(), 2u);
}

}  // namespace
}  // namespace drumsweep

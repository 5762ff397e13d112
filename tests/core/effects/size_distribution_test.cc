#include "core/effects/size_distribution.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/step/feed.h"
#include "support/small_drum.h"

namespace drumsweep {
namespace {

TEST(SizeDistribution, has_the_mean_and_spread_that_were_asked_for) {
  for (const char* kind : {"normal", "lognormal"}) {
    Physics p;
    p.effects.size_distribution = kind;
    p.effects.size_spread = 0.1;
    p.effects.size_cut = 4;
    double sum = 0, squares = 0, mass = 0;
    constexpr int num = 40000;
    for (std::uint32_t id = 0; id < num; ++id) {
      const double d = 2 * radius_of_ball(p, id) / p.material.diameter_m;
      sum += d;
      squares += d * d;
      mass += p.material.density_kg_m3 * M_PI / 6 * std::pow(2 * radius_of_ball(p, id), 3);
    }
    const double mean = sum / num, sigma = std::sqrt(squares / num - mean * mean);
    EXPECT_NEAR(mean, 1, 4 * 0.1 / std::sqrt(num)) << kind;
    EXPECT_NEAR(sigma, 0.1, 0.002) << kind;
    EXPECT_NEAR(mass / num / mean_ball_mass(p), 1, 0.01) << kind;
  }
}

TEST(SizeDistribution, is_cut_where_it_says_and_depends_on_the_id_alone) {
  Physics p;
  p.effects.size_spread = 0.2;
  p.effects.size_cut = 1.5;
  double least = 1, most = 0;
  for (std::uint32_t id = 0; id < 5000; ++id) {
    const double r = radius_of_ball(p, id);
    EXPECT_EQ(r, radius_of_ball(p, id));
    least = std::min(least, r);
    most = std::max(most, r);
  }
  EXPECT_GE(least, smallest_radius(p));
  EXPECT_LE(most, largest_radius(p));
  EXPECT_LT(least, 1.02 * smallest_radius(p));
  EXPECT_GT(most, 0.98 * largest_radius(p));
}

TEST(SizeDistribution, feed_places_each_ball_with_its_own_size_and_the_mass_flow_is_kept) {
  Study study = small_drum();
  study.effects.size_spread = 0.2;
  const DrumModel model(study, study.outlet);
  DrumState state;
  FeedScratch scratch;
  for (int i = 0; i < 200; ++i) feed_balls(model, state, scratch);
  double mass = 0;
  for (std::size_t i = 0; i < state.balls.size(); ++i) {
    EXPECT_EQ(state.balls.radius[i], radius_of_ball(study, state.balls.id[i]));
    mass += 1 / model.world.inverse_mass(state.balls.radius[i]);
  }
  EXPECT_GT(state.balls.size(), 20u);
  EXPECT_NEAR(mass + state.feed_debt_kg, 200 * study.feed.rate_kg_s * study.solver.outer_step_s, 1e-12);
  for (std::size_t i = 0; i < state.balls.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      EXPECT_GE((state.balls.position[i] - state.balls.position[j]).norm(),
                state.balls.radius[i] + state.balls.radius[j]);
}

}  // namespace
}  // namespace drumsweep

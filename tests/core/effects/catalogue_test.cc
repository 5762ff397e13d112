#include "core/effects/catalogue.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

#include "core/config/schema.h"
#include "core/scene/drum.h"
#include "core/step/belt.h"
#include "support/small_drum.h"

namespace drumsweep {
namespace {

Study plain() {
  Study study = small_drum();
  study.drum.length_m = 0.1;
  study.outlet.length_m = 0.06;
  study.feed.zone_length_m = 0.05;
  return study;
}

Study with(const Effect& effect, double value) {
  Study study = plain();
  std::vector<Field> list = fields(study);
  for (Field& f : list)
    if (f.key == effect.key) *std::get<double*>(f.value) = value;
  validate(study);
  return study;
}

std::uint64_t hash_after(const Study& study, int steps) {
  const DrumModel model(study, study.outlet);
  DrumState state = filled_drum(model, 120);
  DrumWorkspace work;
  for (int i = 0; i < steps; ++i) advance(model, state, work);
  EXPECT_EQ(state.counts.removed, 0);
  return state_hash(state);
}

TEST(EffectCatalogue, names_numeric_keys_once_and_their_neutral_value_is_the_default) {
  Study study;
  std::set<std::string> ids;
  for (const Effect& effect : effect_catalogue()) {
    EXPECT_TRUE(ids.insert(effect.id).second) << effect.id;
    const double by_default = get_number(study, effect.key);
    EXPECT_TRUE(by_default == effect.neutral || (std::isnan(by_default) && std::isnan(effect.neutral))) << effect.id;
  }
}

TEST(EffectCatalogue, neutral_strength_is_bitwise_the_plain_model_and_a_large_one_is_not) {
  const std::uint64_t none = hash_after(plain(), 60);
  for (const Effect& effect : effect_catalogue()) {
    EXPECT_EQ(hash_after(with(effect, effect.neutral), 60), none) << effect.id;
    EXPECT_NE(hash_after(with(effect, effect.large), 60), none) << effect.id;
  }
}

TEST(EffectCatalogue, effects_that_are_written_out_but_change_nothing_are_the_plain_model_too) {
  Study study = plain();
  study.effects.wall_rolling_friction = study.effects.wall_twisting_friction = study.effects.wall_cohesion_force_N = 0;
  study.material.wall_friction = study.material.friction;
  study.material.wall_restitution = 0;
  study.effects.dynamic_friction = study.material.friction;  // mu_d = mu_s
  EXPECT_EQ(hash_after(study, 60), hash_after(plain(), 60));
}

TEST(EffectCatalogue, all_effects_together_run_and_restart_bitwise) {
  Study study = plain();
  for (const Effect& effect : effect_catalogue()) {
    for (Field& f : fields(study))
      if (f.key == effect.key) *std::get<double*>(f.value) = effect.large;
  }
  study.effects.outlet_coating_m = 0.003;
  study.effects.drum_coating_m = 0.003;
  study.effects.cohesion_force_N = 0.02;
  validate(study);
  for (const char* method : {"nonsmooth", "smooth"}) {
    study.step.method = method;
    const DrumModel model(study, study.outlet);
    DrumState straight = filled_drum(model, 120), broken = straight;
    DrumWorkspace work;
    for (int i = 0; i < 30; ++i) advance(model, straight, work);
    for (int part = 0; part < 2; ++part) {
      DrumWorkspace fresh;
      for (int i = 0; i < 15; ++i) advance(model, broken, fresh);
    }
    EXPECT_EQ(state_hash(straight), state_hash(broken)) << method;
    EXPECT_EQ(straight.counts.removed, 0) << method;
    for (const Eigen::Vector3d& v : straight.balls.velocity) EXPECT_LT(v.norm(), 5) << method;
  }
}

}  // namespace
}  // namespace drumsweep

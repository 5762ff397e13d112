// Every bit of a run is that of configuration and seed: not of threads, vector width or restart.
#include <gtest/gtest.h>

#include "core/scene/drum.h"
#include "core/scene/scene_run.h"
#include "core/simd/targets.h"
#include "core/step/drum_step.h"
#include "support/small_drum.h"

namespace drumsweep {
namespace {

/// All that acts on contacts at once.
void switch_on_effects(Physics& p) {
  p.material.restitution = 0.3;
  p.effects.rolling_friction = 0.1;
  p.effects.twisting_friction = 0.05;
  p.effects.size_spread = 0.1;
  p.effects.cohesion_force_N = 0.005;
  p.effects.cohesion_range_m = 5e-4;
  p.effects.dynamic_friction = 0.4;
  p.effects.drag_coefficient = 0.5;
}

std::uint64_t hash_after(const Study& study, std::int64_t balls, int steps, int threads) {
  const DrumModel model(study, study.outlet);
  DrumState state = filled_drum(model, balls);
  DrumWorkspace work;
  work.threads = threads;
  for (int i = 0; i < steps; ++i) advance(model, state, work);
  return state_hash(state);
}

class Determinism : public testing::TestWithParam<bool> {
 protected:
  Study study() const {
    Study s = small_drum();
    s.drum.length_m = 0.8;  // several slabs
    s.solver.sub_steps = 2;
    if (GetParam()) switch_on_effects(s);
    return s;
  }
  void TearDown() override { use_simd_target(""); }
};

TEST_P(Determinism, same_bits_for_any_number_of_threads) {
  const std::uint64_t alone = hash_after(study(), 3000, 12, 1);
  for (const int threads : {2, 3}) EXPECT_EQ(hash_after(study(), 3000, 12, threads), alone) << threads;
}

TEST_P(Determinism, same_bits_for_any_vector_width) {
  ASSERT_EQ(simd_targets().back(), "scalar");
  use_simd_target("scalar");
  const std::uint64_t scalar = hash_after(study(), 3000, 12, 1);
  for (const std::string& name : simd_targets()) {
    use_simd_target(name);
    EXPECT_EQ(hash_after(study(), 3000, 12, 1), scalar) << name;
  }
}

INSTANTIATE_TEST_SUITE_P(PlainAndAllEffects, Determinism, testing::Bool());

TEST(Determinism, of_a_periodic_packing_whose_pairs_cross_the_boundary) {
  const auto run = [](int threads) {
    Physics p;
    p.solver.outer_step_s = 2e-3;
    World world(p, 1);
    world.set_period(0.3);
    SceneRun scene{std::move(world), {}, Eigen::Vector3d::Constant(-5), Eigen::Vector3d::Constant(5)};
    for (const Eigen::Vector3d& at : lattice({0, 0, 0}, {0.08, 0.3, 0.08}, 0.005, 3))
      scene.add(at, {0.2 - 5 * at[0], 0, 0.2 - 5 * at[2]});
    scene.threads = threads;
    scene.run_until("flying", 0.05);
    return state_hash(scene.state);
  };
  EXPECT_EQ(run(1), run(3));
}

}  // namespace
}  // namespace drumsweep

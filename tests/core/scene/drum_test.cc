#include "core/scene/drum.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/config/schema.h"
#include "core/io/hdf5_image.h"
#include "core/io/snapshot.h"
#include "core/step/belt.h"
#include "support/small_drum.h"

namespace drumsweep {
namespace {

/// One warm drum for all tests of this file.
const WarmState& warm() {
  static const WarmState state = [] {
    WarmState w;
    warm_up(small_drum(), w, {}, {});
    return w;
  }();
  return state;
}

const Design wider{{"outlet.opening_angle_deg", 8.0}, {"outlet.base_width_m", 0.05}};
const Design narrow{{"outlet.opening_angle_deg", 0.0}, {"outlet.base_width_m", 0.012}};

void expect_balance(const Counts& c, std::int64_t inside) {
  EXPECT_EQ(c.fed, c.landed + c.spilled + c.removed + inside);
}

TEST(WarmUp, ends_steady_with_inflow_and_outflow_within_the_tolerance) {
  ASSERT_TRUE(warm().finished);
  EXPECT_TRUE(warm().steady);
  const WarmupWindow& last = warm().windows.back();
  EXPECT_LE(std::abs(static_cast<double>(last.fed - last.left)), 0.10 * static_cast<double>(last.fed));
  EXPECT_EQ(warm().state.counts.removed, 0);
  expect_balance(warm().state.counts, static_cast<std::int64_t>(warm().state.balls.size()));
}

TEST(WarmUp, stops_at_its_cap_and_says_so) {
  Study study = small_drum();
  study.warmup.max_turns = 1;
  WarmState w;
  EXPECT_TRUE(warm_up(study, w, {}, {}));
  EXPECT_TRUE(w.finished);
  EXPECT_FALSE(w.steady);
}

TEST(Restart, from_a_stored_state_is_bitwise_the_uninterrupted_run) {
  const Study study = small_drum();
  const DrumModel model(study, study.outlet);
  DrumState straight = warm().state, resumed = warm().state;
  DrumWorkspace one;
  for (int i = 0; i < 60; ++i) advance(model, straight, one);
  for (int part = 0; part < 3; ++part) {
    DrumWorkspace fresh;
    for (int i = 0; i < 20; ++i) advance(model, resumed, fresh);
    resumed = unpack_warm_state(pack_warm_state(study, {resumed, {}, false, false}), study, "memory").state;
  }
  EXPECT_EQ(state_hash(straight), state_hash(resumed));
  EXPECT_EQ(straight.balls.size(), resumed.balls.size());
}

TEST(Restart, an_interrupted_warm_up_ends_in_the_same_state) {
  Study study = small_drum();
  WarmState kept;
  int steps = 0;
  // Stopped inside windows, each time going on from the file.
  for (int i = 0; i < 3; ++i) {
    EXPECT_FALSE(warm_up(study, kept, [&](const Progress&) { return ++steps % 150 != 0; }, {}));
    kept = unpack_warm_state(pack_warm_state(study, kept), study, "memory");
  }
  EXPECT_EQ(kept.state.num_steps, 450);
  EXPECT_FALSE(kept.finished);
  WarmState again = kept;
  EXPECT_TRUE(warm_up(study, again, {}, {}));
  for (std::size_t i = 0; i < again.windows.size(); ++i) {
    EXPECT_EQ(again.windows[i].fed, warm().windows[i].fed);
    EXPECT_EQ(again.windows[i].left, warm().windows[i].left);
  }
  EXPECT_EQ(state_hash(again.state), state_hash(warm().state));
  EXPECT_EQ(again.windows.size(), warm().windows.size());
}

TEST(DesignRun, is_a_function_of_study_and_design_alone_and_its_mass_balance_closes) {
  const Recording one = run_design(small_drum(), warm().state, wider, {}),
                  two = run_design(small_drum(), warm().state, wider, {});
  EXPECT_EQ(one.hash, two.hash);
  EXPECT_EQ(pack_recording(small_drum(), "x", wider, one), pack_recording(small_drum(), "x", wider, two));
  expect_balance(one.counts, one.inside);
  EXPECT_EQ(one.lost, 0);
  EXPECT_GT(one.landings.size(), 100u);
  for (const Landing& l : one.landings) {
    EXPECT_GE(l.time, one.begin_s);
    EXPECT_NE(l.exit, 0);
  }
}

TEST(DesignRun, interrupted_anywhere_and_continued_from_its_file_gives_the_same_recording_to_the_byte) {
  const Study study = small_drum();
  const Recording straight = run_design(study, warm().state, wider, {});
  DesignProgress progress;
  int steps = 0, parts = 0;
  Recording resumed;
  do {
    resumed = continue_design(study, warm().state, wider, progress, [&](const Progress&) { return ++steps % 37 != 0; });
    progress =
        unpack_progress(pack_progress(study, "x", wider, progress, ++parts), study, "x", wider, "memory").progress;
  } while (resumed.stopped);
  EXPECT_GT(parts, 5);
  const std::string file = pack_progress(study, "x", wider, progress, 12);
  const std::size_t line = file.find('\n') + 1;
  EXPECT_EQ(attempt_in_head(file.substr(line, file.find('\n', line) - line)), 12);
  EXPECT_EQ(resumed.hash, straight.hash);
  EXPECT_EQ(pack_recording(study, "x", wider, resumed), pack_recording(study, "x", wider, straight));
}

TEST(DesignRun, open_belt_edges_count_what_falls_past_them_as_spilled) {
  Study study = small_drum();
  study.belt.edge = "open";
  study.belt.width_m = 0.12;
  const Recording r = run_design(study, warm().state, wider, {});
  EXPECT_GT(r.counts.spilled, 0);
  expect_balance(r.counts, r.inside);
}

TEST(DesignRun, narrow_slots_send_the_balls_over_the_end_and_wide_ones_through_the_slots) {
  const auto over_the_end = [](const Recording& r) {
    double n = 0;
    for (const Landing& l : r.landings) n += l.exit == static_cast<std::uint8_t>(Exit::end) ? 1 : 0;
    return n / static_cast<double>(r.landings.size());
  };
  EXPECT_GT(over_the_end(run_design(small_drum(), warm().state, narrow, {})), 0.8);
  EXPECT_LT(over_the_end(run_design(small_drum(), warm().state, wider, {})), 0.2);
}

TEST(DesignRun, swapping_the_outlet_gives_no_burst_of_kinetic_energy) {
  const Study study = small_drum();
  for (const Design& design : {wider, narrow}) {
    const DrumModel model(study, study.outlet),
        swapped_model(study_of_design(study, design), study_of_design(study, design).outlet);
    DrumState undisturbed = warm().state, swapped = warm().state;
    adopt_outlet(swapped_model, swapped);
    DrumWorkspace a, b;
    // A burst shows within a few steps; after some 50 ms more (or fewer) balls fall through the new slots, as they
    // should.
    for (int i = 0; i < 6; ++i) {
      advance(model, undisturbed, a);
      advance(swapped_model, swapped, b);
      EXPECT_LE(kinetic_energy(swapped_model, swapped), 1.05 * kinetic_energy(model, undisturbed)) << "step " << i;
    }
    EXPECT_EQ(swapped.counts.removed, 0);
  }
}

TEST(DesignRun, a_ball_where_none_can_be_is_counted_as_lost) {
  const Study study = small_drum();
  const DrumModel model(study, study.outlet);
  DrumState state = warm().state;
  const auto before = static_cast<std::int64_t>(state.balls.size());
  state.balls.position[0] = model.pose(0).origin + model.tilt * Eigen::Vector3d(0.2, 0, -0.1);  // outside the wall
  // Its neighbours would catch it: alone in the air.
  state.balls.position[1] = model.pose(0).origin + model.tilt * Eigen::Vector3d(0, 0, 0.08);
  state.balls.velocity[1][0] = std::nan("");
  DrumWorkspace work;
  advance(model, state, work);
  EXPECT_EQ(state.counts.removed, 2);
  expect_balance(state.counts, static_cast<std::int64_t>(state.balls.size()));
  EXPECT_LT(static_cast<std::int64_t>(state.balls.size()), before + 5);
}

TEST(DesignRun, impossible_designs_are_refused_with_the_reason) {
  EXPECT_THROW(run_design(small_drum(), warm().state, {{"outlet.base_width_m", 0.3}}, {}), InputError);
}

TEST(Snapshot, of_another_study_is_refused_key_by_key) {
  const std::string bytes = pack_warm_state(small_drum(), warm());
  Study other = small_drum();
  other.material.friction = 0.5;
  other.record.turns = 7;  // does not matter to the warm drum
  try {
    unpack_warm_state(bytes, other, "warm_state.h5");
    FAIL();
  } catch (const MismatchError& error) {
    EXPECT_NE(std::string(error.what()).find("material.friction: stored 0.7, now 0.5"), std::string::npos);
    EXPECT_EQ(std::string(error.what()).find("record.turns"), std::string::npos);
  }
}

TEST(Snapshot, recording_comes_back_as_it_was) {
  const Recording r = run_design(small_drum(), warm().state, wider, {});
  const Recording back =
      unpack_recording(pack_recording(small_drum(), "abc", wider, r), small_drum(), "abc", wider, "memory");
  EXPECT_EQ(back.hash, r.hash);
  ASSERT_EQ(back.landings.size(), r.landings.size());
  EXPECT_EQ(back.landings[5].y, r.landings[5].y);
  EXPECT_EQ(back.quality.residual.mean, r.quality.residual.mean);
  EXPECT_THROW(unpack_recording(pack_recording(small_drum(), "abc", wider, r), small_drum(), "abd", wider, "memory"),
               MismatchError);
}

TEST(Quality, the_step_report_sees_overlap_and_a_balanced_momentum) {
  const Study study = small_drum();
  const DrumModel model(study, study.outlet);
  DrumState state = warm().state;
  DrumWorkspace work;
  const StepReport report = advance(model, state, work);
  EXPECT_GT(report.num_contacts, 50u);
  EXPECT_LT(report.force_balance, 1e-5);
  EXPECT_GT(report.mean_overlap, 0);
  EXPECT_LT(report.mean_overlap, 0.03);
}

TEST(Belt, a_landing_is_where_and_when_free_flight_ends_on_the_belt) {
  const Study study = small_drum();
  const DrumModel model(study, study.outlet);
  DrumState state;
  // Below the outlet, thrown forward: s beyond the end, so it has left over the end.
  const Eigen::Vector3d from(0.02, study.belt.outlet_begin_m + 0.14, model.belt_height + 0.05), v(0.3, 0.1, -0.2);
  state.balls.add(from, model.world.largest_radius, 0);
  state.balls.velocity[0] = v;
  state.feed_debt_kg = -1;  // no feed
  ++state.counts.fed;
  DrumWorkspace work;
  std::vector<Landing> landings;
  while (landings.empty() && state.num_steps < 1000) advance(model, state, work, &landings);
  ASSERT_EQ(landings.size(), 1u);
  const double fall = 0.05 - model.world.largest_radius, g = 9.81;
  const double t = (v[2] + std::sqrt(v[2] * v[2] + 2 * g * fall)) / g, h = model.world.time_step;
  EXPECT_NEAR(landings[0].time, t, h);
  EXPECT_NEAR(landings[0].x, from[0] + 0.3 * t, 0.3 * h);
  EXPECT_NEAR(landings[0].y, from[1] + 0.1 * t, 0.1 * h);
  EXPECT_NEAR(landings[0].vz, v[2] - g * t, g * h);
  EXPECT_EQ(landings[0].exit, static_cast<std::uint8_t>(Exit::end));
  EXPECT_EQ(state.counts.landed, 1);
  // The belt lies drop_height below the lowest point of the outlet's end.
  const double incline = study.drum.inclination_deg * M_PI / 180;
  EXPECT_NEAR(model.belt_height, -0.12 * std::sin(incline) - 0.12 * std::cos(incline) - study.belt.drop_height_m,
              1e-12);
}

TEST(Drum, walls_carry_what_rests_on_them_with_their_own_speed) {
  Study study = small_drum();
  const DrumModel model(study, study.outlet);
  const Pose now = model.pose(0.3), later = model.pose(0.3 + 1e-6);
  const Eigen::Vector3d body(0.1, -0.05, 0.07);
  const Eigen::Vector3d place = now.origin + now.rotation * body, moved = later.origin + later.rotation * body;
  EXPECT_LT(((moved - place) / 1e-6 - now.wall_velocity(place)).norm(), 1e-5);
}

}  // namespace
}  // namespace drumsweep

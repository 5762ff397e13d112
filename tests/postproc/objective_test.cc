#include "postproc/objective.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "core/config/schema.h"
#include "tests/postproc/synthetic.h"

namespace drumsweep {
namespace {

/// S1's formula, term by term, with both signs of n.
double direct_unevenness(const std::vector<double>& height, const std::string& weights,
                         const std::string& normalization) {
  const int size = static_cast<int>(height.size()), num_modes = size / 2;
  double sum = 0.0;
  for (int n = -num_modes; n <= num_modes; ++n) {
    if (n == 0) continue;
    std::complex<double> a = 0.0;
    for (int k = 0; k < size; ++k)
      a += height[static_cast<std::size_t>(k)] * std::polar(1.0, -2.0 * std::numbers::pi * n * k / size);
    const double power = std::abs(n) - 1;
    sum += std::abs(a) * (weights == "uniform" ? 1.0 : std::pow(2.0, weights == "growing" ? power : -power));
  }
  return sum / (normalization == "samples" ? 2.0 * num_modes : num_modes);
}

RC_GTEST_PROP(Objective, equals_the_direct_sum_for_every_option, ()) {
  std::vector<double> height;
  const int half = *rc::gen::inRange(1, 25);
  for (int k = 0; k < 2 * half; ++k) height.push_back(*rc::gen::inRange(0, 1000) * 1e-4);
  for (const char* weights : {"decaying", "growing", "uniform"}) {
    for (const char* normalization : {"modes", "samples"}) {
      ObjectiveConfig objective;
      objective.weights = weights;
      objective.normalization = normalization;
      const double expected = direct_unevenness(height, weights, normalization);
      RC_ASSERT(std::abs(unevenness(height, objective) - expected) <= 1e-9 * (expected + 1e-3));
    }
  }
}

RC_GTEST_PROP(Objective, is_unchanged_by_shifting_the_profile_around, ()) {
  std::vector<double> height;
  for (int k = 0; k < 40; ++k) height.push_back(*rc::gen::inRange(0, 1000) * 1e-4);
  const double before = unevenness(height, ObjectiveConfig{});
  std::rotate(height.begin(), height.begin() + *rc::gen::inRange(0, 40), height.end());
  RC_ASSERT(std::abs(unevenness(height, ObjectiveConfig{}) - before) <= 1e-13);
}

TEST(Objective, level_bed_scores_0) {
  EXPECT_NEAR(unevenness(std::vector<double>(40, 0.01006), ObjectiveConfig{}), 0.0, 1e-15);
}

TEST(Objective, cosine_of_mode_n_scores_its_amplitude_times_2_w_n) {
  // |a_n| = |a_-n| = A N for n < N; at n = N both are one term of 2 A N.
  for (int n = 1; n <= 20; ++n) {
    std::vector<double> height;
    for (int k = 0; k < 40; ++k) height.push_back(0.01 + 0.003 * std::cos(2.0 * std::numbers::pi * n * k / 40.0));
    const double exact = 0.003 * (n < 20 ? 2.0 : 4.0) * std::ldexp(1.0, 1 - n);
    EXPECT_NEAR(unevenness(height, ObjectiveConfig{}), exact, 1e-14) << n;
  }
}

TEST(Objective, one_cell_heap_at_lab_values_scores_80_mm_if_it_does_not_topple) {
  std::vector<double> height(40, 0.0);
  height[33] = 40 * 0.01006;
  ObjectiveConfig objective;
  EXPECT_NEAR(unevenness(height, objective), 0.0805, 0.0001);
  objective.normalization = "samples";
  EXPECT_NEAR(unevenness(height, objective), 0.0402, 0.0001);
}

TEST(Objective, level_bed_under_the_outlet_only_scores_17_6_mm_on_the_belt_and_0_on_the_footprint) {
  const double mean = 0.01006;
  std::vector<double> height(40, 0.0);
  std::fill(height.begin() + 6, height.begin() + 36, mean * 40.0 / 30.0);
  const double on_belt = unevenness(height, ObjectiveConfig{});
  std::printf("level bed on [0.15, 0.90] m: f on the belt = %.5f m\n", on_belt);
  EXPECT_NEAR(on_belt, 0.0176, 0.0001);
  EXPECT_NEAR(unevenness(std::span(height).subspan(6, 30), ObjectiveConfig{}), 0.0, 1e-15);
}

// S1 reports 77 mm for its point III: more than its own bed can score with packing 0.7, 35 degrees and 4.4 kg/s.
TEST(Objective, all_balls_on_one_line_score_68_mm_once_toppled_on_the_belt_and_at_the_skirt) {
  for (double y : {0.9375, 1.01}) {
    std::mt19937_64 random(14);
    const Objective result = evaluate(poisson_landings(random, [&](auto&) { return y; }), 0.0, 2.0, Study{});
    std::printf("all balls at y = %.4f m: f = %.4f m, f / mean height = %.2f\n", y, result.f_m,
                result.f_m / result.mean_height_m);
    EXPECT_NEAR(result.f_m / result.mean_height_m, 6.85, 0.15);
  }
}

TEST(Objective, no_landing_gives_zeros_and_no_nan) {
  Study study;
  const Objective nothing = evaluate({}, 0.0, 2.0, study);
  for (double value : {nothing.f_m, nothing.sigma_f_m, nothing.f_belt_m, nothing.sigma_f_belt_m, nothing.f_footprint_m,
                       nothing.sigma_f_footprint_m, nothing.max_an_over_a0, nothing.mean_height_m})
    EXPECT_EQ(value, 0.0);
  EXPECT_EQ(nothing.landed, 0);
}

TEST(Objective, window_option_chooses_which_f_is_reported_and_both_are_there) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> across(0.15, 0.9);
  const std::vector<Landing> landings = poisson_landings(random, [&](auto& r) { return across(r); });
  Study study;
  const Objective belt = evaluate(landings, 0.0, 2.0, study);
  study.objective.window = "footprint";
  const Objective outlet = evaluate(landings, 0.0, 2.0, study);
  EXPECT_EQ(belt.f_m, belt.f_belt_m);
  EXPECT_EQ(outlet.f_m, belt.f_footprint_m);
  EXPECT_EQ(outlet.sigma_f_m, belt.sigma_f_footprint_m);
  EXPECT_NEAR(belt.f_belt_m, 0.0176, 0.002);
  EXPECT_LT(belt.f_footprint_m, 0.002);
  EXPECT_GT(belt.max_an_over_a0, outlet.max_an_over_a0);
  EXPECT_EQ(belt.landed, static_cast<std::int64_t>(landings.size()));
}

TEST(Objective, mean_height_of_the_lab_flow_is_10_06_mm) {
  std::mt19937_64 random(12);
  const std::vector<Landing> landings = poisson_landings(random, [](auto&) { return 0.5; });
  const Objective result = evaluate(landings, 0.0, 2.0, Study{});
  EXPECT_NEAR(result.mean_height_m / 0.01006, 1.0, 0.03);  // Poisson: 0.8 %
}

TEST(Objective, details_agree_with_the_numbers_and_repeat_bit_for_bit) {
  std::mt19937_64 random(13);
  std::uniform_real_distribution<double> across(-0.1, 1.1);
  const std::vector<Landing> landings = poisson_landings(random, [&](auto& r) { return across(r); });
  const Study study;
  const Evaluation first = evaluate_in_detail(landings, 0.0, 2.0, study);
  const Objective second = evaluate(landings, 0.0, 2.0, study);
  EXPECT_EQ(first.objective.f_m, second.f_m);
  EXPECT_EQ(first.objective.sigma_f_m, second.sigma_f_m);
  EXPECT_EQ(first.num_blocks, 6);
  EXPECT_EQ(first.belt_blocks.size(), 6U);
  EXPECT_EQ(first.belt_amplitudes_m.size(), 21U);
  EXPECT_EQ(first.footprint_amplitudes_m.size(), 16U);
  EXPECT_EQ(unevenness(first.belt.height_m, study.objective), first.objective.f_belt_m);
}

TEST(Objective, standing_drum_is_refused_by_name) {
  Study study;
  study.drum.angular_velocity_rad_s = 0.0;
  EXPECT_THROW(evaluate({}, 0.0, 2.0, study), InputError);
}

/// Spread of f over independent recordings against the error that each recording reports for itself.
void expect_sigma_to_be_the_spread(const char* what, const std::function<double(std::mt19937_64&)>& draw_y) {
  std::mt19937_64 random(2024);
  constexpr int repeats = 80;
  double sum = 0.0, squares = 0.0, variance = 0.0, footprint_variance = 0.0, footprint_sum = 0.0,
         footprint_squares = 0.0;
  for (int k = 0; k < repeats; ++k) {
    const Objective result = evaluate(poisson_landings(random, draw_y), 0.0, 2.0, Study{});
    sum += result.f_belt_m;
    squares += result.f_belt_m * result.f_belt_m;
    variance += result.sigma_f_belt_m * result.sigma_f_belt_m / repeats;
    footprint_sum += result.f_footprint_m;
    footprint_squares += result.f_footprint_m * result.f_footprint_m;
    footprint_variance += result.sigma_f_footprint_m * result.sigma_f_footprint_m / repeats;
  }
  const auto spread = [&](double s, double s2) { return std::sqrt((s2 - s * s / repeats) / (repeats - 1)); };
  const double belt = std::sqrt(variance) / spread(sum, squares);
  const double outlet = std::sqrt(footprint_variance) / spread(footprint_sum, footprint_squares);
  std::printf(
      "%s: belt f = %.3f mm, spread %.3f mm, jackknife/spread = %.2f; footprint f = %.3f mm, spread %.3f mm, "
      "jackknife/spread = %.2f\n",
      what, 1e3 * sum / repeats, 1e3 * spread(sum, squares), belt, 1e3 * footprint_sum / repeats,
      1e3 * spread(footprint_sum, footprint_squares), outlet);
  for (double ratio : {belt, outlet}) {
    EXPECT_GT(ratio, 1.0 / 1.5) << what;
    EXPECT_LT(ratio, 1.5) << what;
  }
}

// Landings are independent here: clustering of a real drum, which the blocks see and this test does not, adds to both.
TEST(Objective, jackknife_sigma_is_the_spread_of_repeated_recordings) {
  expect_sigma_to_be_the_spread("level on the footprint", [](std::mt19937_64& random) {
    return std::uniform_real_distribution<double>(0.15, 0.9)(random);
  });
  // Heap at the outlet's end: 40 % of the balls around 0.93 m.
  expect_sigma_to_be_the_spread("level with a heap at the end", [](std::mt19937_64& random) {
    const bool over_the_end = std::uniform_real_distribution<double>(0.0, 1.0)(random) < 0.4;
    return over_the_end ? std::normal_distribution<double>(0.93, 0.02)(random)
                        : std::uniform_real_distribution<double>(0.15, 0.9)(random);
  });
  // A slope, so that the footprint has a signal above its noise.
  expect_sigma_to_be_the_spread("slope", [](std::mt19937_64& random) {
    return std::sqrt(std::uniform_real_distribution<double>(0.0, 1.0)(random));
  });
}

TEST(Objective, level_belt_scores_the_floor_of_counting_noise_which_falls_with_the_number_of_balls) {
  std::mt19937_64 random(5);
  constexpr int repeats = 30;
  double floor_of_two = 0.0, floor_of_half = 0.0;
  for (int k = 0; k < repeats; ++k) {
    const std::vector<Landing> landings =
        poisson_landings(random, [](auto& r) { return std::uniform_real_distribution<double>(0.0, 1.0)(r); });
    floor_of_two += evaluate(landings, 0.0, 2.0, Study{}).f_belt_m / repeats;
    floor_of_half += evaluate(landings, 0.0, 0.5, Study{}).f_belt_m / repeats;
  }
  std::printf("floor of f by counting noise: %.3f mm in two turns, %.3f mm in half a turn\n", 1e3 * floor_of_two,
              1e3 * floor_of_half);
  EXPECT_NEAR(floor_of_two, 0.0005, 0.0002);
  EXPECT_NEAR(floor_of_half / floor_of_two, 2.0, 0.4);
}

TEST(Unevenness, of_the_lowest_modes_only_counts_and_divides_by_these) {
  // Modes 1 and 5 of 40 cells, with moduli 40 / 2 times their amplitudes.
  std::vector<double> height;
  for (int k = 0; k < 40; ++k)
    height.push_back(0.01 + 0.002 * std::cos(2 * M_PI * k / 40) + 0.001 * std::cos(2 * M_PI * 5 * k / 40));
  ObjectiveConfig objective;
  objective.weights = "uniform";
  EXPECT_NEAR(unevenness(height, objective), 2 * 20 * (0.002 + 0.001) / 20, 1e-14);
  objective.modes = 4;
  EXPECT_NEAR(unevenness(height, objective), 2 * 20 * 0.002 / 4, 1e-14);
  objective.modes = 5;
  EXPECT_NEAR(unevenness(height, objective), 2 * 20 * (0.002 + 0.001) / 5, 1e-14);
  // More than there are: all.
  objective.modes = 500;
  EXPECT_NEAR(unevenness(height, objective), 2 * 20 * (0.002 + 0.001) / 20, 1e-14);
}

}  // namespace
}  // namespace drumsweep

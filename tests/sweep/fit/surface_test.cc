#include "sweep/fit/surface.h"

#include <gtest/gtest.h>

#include "tests/sweep/fit/synthetic.h"

namespace drumsweep {
namespace {

Laboratory laboratory(std::int64_t seed) {
  Laboratory lab;
  lab.truth = Valley(seed);
  lab.seed = seed;
  return lab;
}

TEST(FittedSurface, left_out_rows_of_the_closed_form_are_those_of_a_fit_without_them) {
  const Laboratory lab = laboratory(3);
  std::vector<Measurement> rows = lab.measure(space_filling(lab.box, 8, 3), 2);
  const Measurement last = rows.back();
  rows.pop_back();
  // with_row keeps the parameters, so the fit without the last row is `fit`.
  const FittedSurface fit(lab.box, rows);
  const FittedSurface whole = fit.with_row(last);
  const Site site = {last.at, last.replicate};
  const LeftOut left = whole.leave_one_out().back();
  EXPECT_NEAR(left.error_m, last.f_m - fit.mean({site})[0], 1e-9);
  EXPECT_NEAR(left.sd_m, std::hypot(std::sqrt(fit.variance({site})[0]), fit.run_sd_m(last.at)), 1e-9);
  EXPECT_NEAR(fit.variance({site})[0], fit.covariance({site}, {site})(0, 0), 1e-15);
}

TEST(FittedSurface, the_truth_lies_within_the_stated_errors) {
  // Mean square of (fit - truth) / sd over the box and 25 seeds: 1 when honest; shared error included.
  double one = 0, three = 0;
  constexpr int num_seeds = 25;
  for (std::int64_t seed = 1; seed <= num_seeds; ++seed) {
    const Laboratory lab = laboratory(seed);
    const std::vector<Point> points = space_filling(lab.box, 16, seed),
                             probes = space_filling(lab.box, 30, seed + 1000);
    for (const int num_replicates : {1, 3}) {
      const FittedSurface fit(lab.box, lab.measure(points, num_replicates));
      const Posterior p = fit.posterior(probes);
      for (Eigen::Index i = 0; i < p.mean.size(); ++i) {
        const double truth = lab.truth(to_unit(lab.box, probes[static_cast<std::size_t>(i)]));
        (num_replicates == 1 ? one : three) += std::pow(p.mean[i] - truth, 2) / p.covariance(i, i) / 30 / num_seeds;
      }
    }
  }
  RecordProperty("chi2_one_replicate", std::to_string(one));
  RecordProperty("chi2_three_replicates", std::to_string(three));
  EXPECT_GT(one, 0.4);
  EXPECT_LT(one, 1.6);
  EXPECT_GT(three, 0.4);
  EXPECT_LT(three, 1.6);
}

TEST(FittedSurface, replicates_tell_the_shared_error_from_the_surface) {
  const Laboratory lab = laboratory(5);
  const FittedSurface fit(lab.box, lab.measure(space_filling(lab.box, 20, 5), 4));
  EXPECT_NEAR(fit.parameters().rho, 1, 0.4);
  EXPECT_GT(fit.parameters().shared, 0.75);
  EXPECT_LT(fit.parameters().shared, 0.98);
}

TEST(FittedSurface, a_function_without_noise_is_met_between_its_points) {
  Laboratory lab = laboratory(2);
  lab.sigma_m = 1e-9;
  const FittedSurface fit(lab.box, lab.measure(space_filling(lab.box, 40, 2)));
  for (const Point& at : space_filling(lab.box, 30, 77))
    EXPECT_NEAR(fit.mean_m(at), lab.truth(to_unit(lab.box, at)), 1e-4) << at[0] << " " << at[1];
}

TEST(FittedSurface, one_and_four_variables_are_fitted_too) {
  for (const std::size_t d : {1u, 4u}) {
    Laboratory lab;
    lab.box.clear();
    for (std::size_t i = 0; i < d; ++i) lab.box.push_back({"x" + std::to_string(i), 0, 1, 0.01});
    lab.truth = [](const Point& unit) {
      double sum = 0.01;
      for (const double u : unit) sum += 0.01 * (u - 0.4) * (u - 0.4);
      return sum;
    };
    const FittedSurface fit(lab.box, lab.measure(space_filling(lab.box, 15 * d, 1), 2));
    const Point best(d, 0.4);
    EXPECT_NEAR(fit.mean_m(best), 0.01, 4 * fit.sd_m(best));
  }
}

TEST(FittedSurface, the_same_rows_give_the_same_bits) {
  const Laboratory lab = laboratory(1);
  const std::vector<Measurement> rows = lab.measure(space_filling(lab.box, 12, 1));
  const FittedSurface a(lab.box, rows), b(lab.box, rows);
  EXPECT_EQ(a.mean_m({3, 0.04}), b.mean_m({3, 0.04}));
  EXPECT_EQ(a.sd_m({3, 0.04}), b.sd_m({3, 0.04}));
}

TEST(Quadratic, a_quadratic_passes_its_residual_test_and_its_minimum_is_found) {
  Laboratory lab;
  lab.shared = 0;
  lab.truth = [](const Point& u) { return 0.01 + 0.02 * std::pow(u[0] - 0.3, 2) + 0.03 * std::pow(u[1] - 0.6, 2); };
  int rejected = 0;
  for (std::int64_t seed = 1; seed <= 200; ++seed) {
    lab.seed = seed;
    std::vector<Measurement> rows = lab.measure(space_filling(lab.box, 30, seed));
    std::vector<Sample> samples;
    for (const Measurement& row : rows)
      samples.push_back({row.at, row.f_m, lab.sigma_m * (0.6 + 0.8 * to_unit(lab.box, row.at)[1]), 1});
    const auto fit = quadratic_fit(lab.box, samples);
    ASSERT_TRUE(fit && fit->minimum);
    EXPECT_NEAR(to_unit(lab.box, *fit->minimum)[0], 0.3, 0.1);
    rejected += fit->p_value < 0.05;
  }
  EXPECT_GE(rejected, 3);  // 5 % of 200 are 10 +- 3
  EXPECT_LE(rejected, 19);
}

TEST(Quadratic, a_surface_with_a_kink_fails_its_residual_test) {
  Laboratory lab;
  lab.shared = 0;
  lab.truth = [](const Point& u) { return 0.01 + 0.02 * std::abs(u[0] - 0.5); };
  const auto fit = quadratic_fit(lab.box, pool(lab.box, lab.measure(space_filling(lab.box, 60, 1))).samples);
  ASSERT_TRUE(fit);
  EXPECT_LT(fit->p_value, 1e-3);
  EXPECT_FALSE(quadratic_fit(lab.box, {fit ? Sample{{1, 0.03}, 0.01, 0.001, 1} : Sample{}}));
}

}  // namespace
}  // namespace drumsweep

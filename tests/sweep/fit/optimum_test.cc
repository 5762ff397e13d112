#include "sweep/fit/optimum.h"

#include <gtest/gtest.h>

#include "tests/sweep/fit/synthetic.h"

namespace drumsweep {
namespace {

struct Coverage {
  double inside[2] = {0, 0};
};

/// Share of seeds whose true optimum lies in the region, a variable. Measured over 60 seeds: 0.90 to 0.97 in the cases
/// below, with regions half the box wide.
Coverage coverage(const Laboratory& model, int num_points, int num_replicates, int num_seeds) {
  Coverage out;
  for (std::int64_t seed = 1; seed <= num_seeds; ++seed) {
    Laboratory lab = model;
    const Valley valley(seed);
    lab.truth = valley;
    lab.seed = seed;
    const FittedSurface fit(
        lab.box, lab.measure(space_filling(lab.box, static_cast<std::size_t>(num_points), seed), num_replicates));
    const Optimum best = optimum(fit, seed, {150, 160, 8});
    const Point low = to_unit(lab.box, best.low), high = to_unit(lab.box, best.high);
    for (std::size_t k = 0; k < 2; ++k)
      out.inside[k] += (low[k] <= valley.at[k] && valley.at[k] <= high[k]) / static_cast<double>(num_seeds);
  }
  return out;
}

TEST(Optimum, the_true_optimum_lies_in_the_region_in_about_95_of_100) {
  const Laboratory lab;
  double all = 0;
  for (const auto& [num_points, num_replicates] : {std::pair{16, 1}, {16, 3}, {30, 1}}) {
    const Coverage c = coverage(lab, num_points, num_replicates, 40);
    for (const double inside : c.inside) {
      EXPECT_GE(inside, 0.85) << num_points << " x " << num_replicates;
      all += inside / 6;
    }
  }
  EXPECT_GE(all, 0.90);
}

TEST(Optimum, a_sharp_minimum_without_noise_is_found_to_the_lattice_and_on_a_face_too) {
  Laboratory lab;
  lab.sigma_m = 1e-8;
  for (const double x : {0.35, 0.0, 1.0}) {
    lab.truth = [x](const Point& u) { return 0.01 + 0.02 * std::pow(u[0] - x, 2) + 0.02 * std::pow(u[1] - 0.6, 2); };
    const Optimum best = optimum(FittedSurface(lab.box, lab.measure(space_filling(lab.box, 30, 1))), 1);
    const Point unit = to_unit(lab.box, best.at);
    EXPECT_NEAR(unit[0], x, 0.02);
    EXPECT_NEAR(unit[1], 0.6, 0.02);
    EXPECT_EQ(best.at, quantised(lab.box, best.at));
    EXPECT_NEAR(best.f_m, 0.01, 2e-5);
    EXPECT_LE(best.low[0], best.at[0] + 0.1);
    EXPECT_GE(best.high[0], best.at[0] - 0.1);
  }
}

TEST(Optimum, of_two_valleys_the_deeper_is_found_whichever_is_wider) {
  Laboratory lab;
  lab.sigma_m = 1e-6;
  lab.truth = [](const Point& u) {
    const auto pit = [&](double x, double y, double w) {
      return std::exp(-(std::pow(u[0] - x, 2) + std::pow(u[1] - y, 2)) / (w * w));
    };
    return 0.02 - 0.004 * pit(0.25, 0.3, 0.4) - 0.007 * pit(0.8, 0.8, 0.15);
  };
  const Optimum best = optimum(FittedSurface(lab.box, lab.measure(space_filling(lab.box, 60, 1))), 1);
  EXPECT_NEAR(to_unit(lab.box, best.at)[0], 0.8, 0.05);
  EXPECT_NEAR(to_unit(lab.box, best.at)[1], 0.8, 0.05);
}

TEST(Optimum, the_same_fit_and_seed_give_the_same_bits) {
  Laboratory lab;
  lab.truth = Valley(1);
  const FittedSurface fit(lab.box, lab.measure(space_filling(lab.box, 16, 1)));
  const Optimum a = optimum(fit, 5), b = optimum(fit, 5);
  EXPECT_EQ(a.argmins, b.argmins);
  EXPECT_EQ(a.at, b.at);
  EXPECT_EQ(a.f_m, b.f_m);
}

}  // namespace
}  // namespace drumsweep

#include "sweep/fit/samples.h"

#include <gtest/gtest.h>

#include "tests/sweep/fit/synthetic.h"

namespace drumsweep {
namespace {

TEST(Pool, the_stated_sigma_of_the_mean_is_right_on_average_whatever_the_own_sigma_says) {
  // Own sigmas are wrong by a common factor; with replicates it is found.
  for (const double factor : {0.5, 1.0, 2.0}) {
    double chi2 = 0;
    int num = 0;
    for (std::int64_t seed = 1; seed <= 40; ++seed) {
      Laboratory lab;
      lab.truth = Valley(seed);
      lab.shared = 0;
      lab.seed = seed;
      std::vector<Measurement> rows = lab.measure(space_filling(lab.box, 20, seed), 3);
      for (Measurement& row : rows) row.sigma_m *= factor;
      for (const Sample& s : pool(lab.box, rows).samples) {
        EXPECT_EQ(s.count, 3);
        chi2 += std::pow((s.f_m - lab.truth(to_unit(lab.box, s.at))) / s.sigma_m, 2);
        ++num;
      }
    }
    EXPECT_NEAR(chi2 / num, 1, 0.25) << "own sigma times " << factor;
  }
}

TEST(Pool, an_own_sigma_that_only_scatters_is_replaced_by_its_trend) {
  Laboratory lab;
  lab.truth = Valley(1);
  const std::vector<Measurement> rows = lab.measure(space_filling(lab.box, 60, 1));
  const Pooled pooled = pool(lab.box, rows);
  double raw = 0, shrunk = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double truth = lab.sigma_m * (0.6 + 0.8 * to_unit(lab.box, rows[i].at)[1]);
    raw += std::pow(std::log(rows[i].sigma_m / truth), 2) / 60;
    shrunk += std::pow(std::log(pooled.own_sigma_m[i] / truth), 2) / 60;
  }
  EXPECT_LT(std::sqrt(shrunk), 0.5 * std::sqrt(raw));
}

TEST(Pool, a_missing_sigma_takes_the_trend) {
  Laboratory lab;
  lab.truth = Valley(1);
  std::vector<Measurement> rows = lab.measure(space_filling(lab.box, 30, 1));
  rows[3].sigma_m = NAN;
  rows[4].sigma_m = 0;
  const Pooled pooled = pool(lab.box, rows);
  for (const std::size_t i : {3u, 4u})
    EXPECT_NEAR(pooled.own_sigma_m[i], pooled.trend.sigma(lab.box, rows[i].at), 1e-12);
}

TEST(Pool, the_gain_of_shared_streams_is_found) {
  Laboratory lab;
  lab.truth = Valley(1);
  lab.shared = 0.95;
  const std::vector<Point> points = space_filling(lab.box, 100, 1);
  const SharedNoise shared = pool(lab.box, lab.measure(points, 6)).noise;
  EXPECT_GT(shared.gain_neighbours, 5);  // neighbours are a tenth of the box apart, the shared error's length is 0.6
  EXPECT_LT(shared.gain, shared.gain_neighbours);
  lab.shared = 0;
  const SharedNoise none = pool(lab.box, lab.measure(points, 6)).noise;
  EXPECT_NEAR(none.gain_neighbours, 1, 0.3);
  EXPECT_NEAR(none.gain, 1, 0.1);
  EXPECT_NEAR(none.scatter_over_own, 1, 0.15);
}

}  // namespace
}  // namespace drumsweep

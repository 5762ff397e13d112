#include "diagnosis/model/second_wave.h"

#include <gtest/gtest.h>

#include "diagnosis/model/draws.h"

namespace drumsweep {
namespace {

using Index = Eigen::Index;

/// One parameter, two effects; one output, steeper in the first effect than any quadratic.
double response(double u, double p, double other) { return 2 * u + 6 * p + 24 * p * p * p * p + 3 * other + p * u; }

constexpr double noise = 0.3;

Emulator quadratic_emulator() {
  constexpr Index num = 400;
  CampaignRuns runs{Eigen::MatrixXd(num, 1), Eigen::MatrixXd(num, 2), Eigen::MatrixXd(num, 1)};
  for (Index i = 0; i < num; ++i) {
    const Eigen::VectorXd at = uniform_draws(1, Purpose::campaign, static_cast<std::uint64_t>(i), 3);
    runs.parameters(i, 0) = 4 * at[0] - 2;
    runs.strengths.row(i) = at.tail(2).transpose();
    runs.outputs(i, 0) = response(runs.parameters(i, 0), at[1], at[2]) +
                         noise * normal_draws(2, Purpose::campaign, static_cast<std::uint64_t>(i), 1)[0];
  }
  return {runs, Eigen::VectorXd::Ones(1)};
}

LocalRuns box_of_runs(Index num) {
  LocalRuns box{{{0}, Eigen::VectorXd{{0.5, 0.6}}, Eigen::VectorXd{{0.4, 0.2}}},
                Eigen::MatrixXd(num, 2),
                Eigen::MatrixXd(num, 1)};
  for (Index i = 0; i < num; ++i) {
    const Eigen::VectorXd at = uniform_draws(3, Purpose::campaign, static_cast<std::uint64_t>(i), 2);
    for (Index j = 0; j < 2; ++j) box.x(i, j) = box.centre.x[j] + box.centre.half_width[j] * (2 * at[j] - 1);
    box.outputs(i, 0) = response(box.x(i, 0), box.x(i, 1), 0) +
                        noise * normal_draws(4, Purpose::campaign, static_cast<std::uint64_t>(i), 1)[0];
  }
  return box;
}

}  // namespace

TEST(SecondWave, correction_takes_the_lack_of_fit_out_where_its_runs_are) {
  const Emulator emulator = quadratic_emulator();
  const ModelEmulator plain = emulator.of_model({0});
  const LocalRuns box = box_of_runs(60);
  const ModelEmulator better = corrected(plain, local_correction(emulator, box));
  const Eigen::VectorXd x{{0.5, 0.6}};
  const double truth = response(0.5, 0.6, 0), sigma = noise / std::sqrt(60);
  EXPECT_GT(std::abs(plain.predict(x)[0] - truth), 5 * sigma);
  EXPECT_LT(std::abs(better.predict(x)[0] - truth), 4 * sigma);
  // Its error is that of the mean of its runs, and its noise that of the runs without any lack of fit.
  EXPECT_NEAR(better.variance_factor(x) * 60, 1, 0.25);
  EXPECT_NEAR(std::sqrt((*better.noise)(0, 0)), noise, 0.1);
  EXPECT_GT(std::sqrt((*plain.noise)(0, 0)), 1.5 * noise);
  // Further away it knows less.
  EXPECT_GT(better.variance_factor(Eigen::VectorXd{{0.5, 0.0}}), 4 * better.variance_factor(x));
}

}  // namespace drumsweep

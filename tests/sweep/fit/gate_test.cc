#include "sweep/fit/gate.h"

#include <gtest/gtest.h>

#include <map>

#include "tests/sweep/fit/synthetic.h"

namespace drumsweep {
namespace {

constexpr int num_seeds = 60;

/// How often each verdict is given over the seeds.
std::map<GateVerdict, int> verdicts(const Laboratory& model, bool valley, int num_points) {
  std::map<GateVerdict, int> out;
  for (std::int64_t seed = 1; seed <= num_seeds; ++seed) {
    Laboratory lab = model;
    lab.seed = seed;
    if (valley) lab.truth = Valley(seed);
    const Gate verdict =
        gate(FittedSurface(lab.box, lab.measure(space_filling(lab.box, static_cast<std::size_t>(num_points), seed))));
    EXPECT_FALSE(verdict.reason.empty());
    ++out[verdict.verdict];
  }
  return out;
}

std::string text(const std::map<GateVerdict, int>& counts) {
  const std::map<GateVerdict, std::string> names = {{GateVerdict::smooth, "smooth"},
                                                    {GateVerdict::noisy, "noisy"},
                                                    {GateVerdict::unresolved, "unresolved"},
                                                    {GateVerdict::rough, "rough"},
                                                    {GateVerdict::few_points, "few points"}};
  std::string out;
  for (const auto& [verdict, count] : counts) out += names.at(verdict) + " " + std::to_string(count) + "  ";
  return out;
}

TEST(Gate, a_smooth_surface_with_the_drums_noise_passes_in_nine_of_ten) {
  Laboratory lab;
  lab.sigma_m = 0.0003;
  for (const int num_points : {16, 30}) {
    auto counts = verdicts(lab, true, num_points);
    EXPECT_GE(counts[GateVerdict::smooth], num_seeds * 9 / 10) << text(counts);
  }
}

TEST(Gate, a_surface_with_more_noise_is_left_to_the_fit) {
  Laboratory lab;
  lab.sigma_m = 0.00045;
  lab.shared = 0;
  auto counts = verdicts(lab, true, 30);
  EXPECT_LE(counts[GateVerdict::smooth], num_seeds / 10) << text(counts);
  EXPECT_GE(counts[GateVerdict::noisy], num_seeds / 4) << text(counts);
  EXPECT_EQ(counts[GateVerdict::rough], 0) << text(counts);
}

TEST(Gate, pure_noise_never_passes_in_sixty) {
  Laboratory lab;
  lab.truth = [](const Point&) { return 0.011; };
  for (const double shared : {0.0, 0.9}) {
    lab.shared = shared;
    for (const int num_points : {12, 30}) {
      auto counts = verdicts(lab, false, num_points);
      EXPECT_EQ(counts[GateVerdict::smooth], 0) << text(counts);
    }
  }
}

TEST(Gate, bumps_below_the_sampling_distance_never_pass_in_sixty) {
  // Random waves of a tenth of the box, sampled at a fifth.
  Laboratory lab, waves;
  lab.sigma_m = 0.0003;
  lab.truth = [&](const Point& u) { return 0.011 + 0.002 * waves.smooth_error({8 * u[0], 8 * u[1]}, 7); };
  auto counts = verdicts(lab, false, 25);
  EXPECT_EQ(counts[GateVerdict::smooth], 0) << text(counts);
  EXPECT_GE(counts[GateVerdict::rough], num_seeds * 8 / 10) << text(counts);
}

TEST(Gate, too_few_points_are_no_surface) {
  Laboratory lab;
  auto counts = verdicts(lab, true, 9);
  EXPECT_EQ(counts[GateVerdict::few_points], num_seeds);
  const Gate none = too_few_points(lab.box, 3, 3);
  EXPECT_EQ(none.verdict, GateVerdict::few_points);
  EXPECT_NE(none.reason.find("10 are needed"), std::string::npos) << none.reason;
}

}  // namespace
}  // namespace drumsweep

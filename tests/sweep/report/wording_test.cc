#include "sweep/report/wording.h"

#include <gtest/gtest.h>

#include <cmath>

namespace drumsweep {
namespace {

TEST(Wording, values_have_units_and_the_digits_of_their_error) {
  EXPECT_EQ(millimetres(0.00620, 0.00041), "6.20 ± 0.41\u00a0mm");
  EXPECT_EQ(millimetres(0.0621, 0.0123), "62 ± 12\u00a0mm");
  EXPECT_EQ(millimetres(0.0100, 0), "10\u00a0mm");
  EXPECT_EQ(millimetres(std::nan(""), 0), "–");
  EXPECT_EQ(place_text({{"opening_angle_deg", 0.2}, {"base_width_m", 0.048}}),
            "opening angle 0.2° and base width 0.048\u00a0m");
  EXPECT_EQ(plain(-0.25), "−0.25");
  EXPECT_EQ(counted(1, "run"), "1 run");
  EXPECT_EQ(counted(2, "run"), "2 runs");
}

TEST(Wording, quantiles_are_of_the_finite_values) {
  EXPECT_EQ(quantile({3, 1, std::nan(""), 2}, 0.5), 2);
  EXPECT_EQ(quantile({3, 1, 2}, 0.0), 1);
  EXPECT_EQ(quantile({3, 1, 2}, 1.0), 3);
  EXPECT_TRUE(std::isnan(quantile({}, 0.5)));
}

}  // namespace
}  // namespace drumsweep

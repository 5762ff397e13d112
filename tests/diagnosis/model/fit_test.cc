#include "diagnosis/model/fit.h"

#include <gtest/gtest.h>

#include "diagnosis/model/verdict.h"

namespace drumsweep {
TEST(Laws, agree_with_tables) {
  EXPECT_NEAR(chi2_tail(3.8415, 1), 0.05, 1e-5);
  EXPECT_NEAR(chi2_tail(43.773, 30), 0.05, 1e-5);
  EXPECT_NEAR(chi2_tail(14.953, 30), 0.99, 1e-4);
  EXPECT_NEAR(student_95(7), 2.3646, 1e-4);
  EXPECT_NEAR(student_95(1), 12.706, 1e-3);
  EXPECT_NEAR(normal_cdf(1.96), 0.975, 1e-4);
}
}  // namespace drumsweep

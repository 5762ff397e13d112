#include "diagnosis/model/linear_algebra.h"

#include <gtest/gtest.h>

namespace drumsweep {
namespace {

const Eigen::MatrixXd a{{4.0, 1.0, 0.5}, {1.0, 3.0, -0.2}, {0.5, -0.2, 2.0}},
    b{{2.0, 0.3, 0.1}, {0.3, 1.0, 0.0}, {0.1, 0.0, 0.5}};

}  // namespace

TEST(LinearAlgebra, inverse_solution_and_determinant_agree) {
  const Eigen::MatrixXd one = product(a, inverse_symmetric(a));
  EXPECT_LT((one - Eigen::MatrixXd::Identity(3, 3)).norm(), 1e-14);
  const Eigen::VectorXd x{{1.0, -2.0, 0.5}};
  EXPECT_LT((solve_symmetric(a, times(a, x)) - x).norm(), 1e-14);
  // By Sarrus' rule.
  EXPECT_NEAR(std::exp(log_determinant_symmetric(a)), 4 * (6 - 0.04) - 1 * (2 + 0.1) + 0.5 * (-0.2 - 1.5), 1e-12);
}

TEST(LinearAlgebra, two_forms_become_diagonal_together) {
  const auto [vectors, values] = diagonalise_together(a, b);
  EXPECT_LT((congruence(vectors.transpose(), b) - Eigen::MatrixXd::Identity(3, 3)).norm(), 1e-13);
  EXPECT_LT((congruence(vectors.transpose(), a) - Eigen::MatrixXd(values.asDiagonal())).norm(), 1e-13);
  EXPECT_LE(values[0], values[1]);
}

TEST(LinearAlgebra, least_squares_finds_a_line_and_says_when_columns_are_the_same) {
  const Eigen::MatrixXd f{{1.0, 0.0}, {1.0, 1.0}, {1.0, 2.0}}, y{{1.0}, {3.0}, {5.0}};
  const LeastSquares fit = least_squares(f, y);
  ASSERT_TRUE(fit.regular);
  EXPECT_NEAR(fit.coefficients(0, 0), 1, 1e-14);
  EXPECT_NEAR(fit.coefficients(1, 0), 2, 1e-14);
  const LeastSquares with_nothing =
      least_squares(Eigen::MatrixXd{{1.0, 0.0, 0.0}, {1.0, 0.0, 1.0}, {1.0, 0.0, 2.0}}, y);
  ASSERT_TRUE(with_nothing.regular);
  EXPECT_EQ(with_nothing.coefficients(1, 0), 0);
  EXPECT_NEAR(with_nothing.coefficients(2, 0), 2, 1e-14);
  EXPECT_FALSE(least_squares(Eigen::MatrixXd{{1.0, 1.0}, {1.0, 1.0}, {1.0, 1.0}}, y).regular);
}

}  // namespace drumsweep

/// Dense linear algebra of a diagnosis, compiled once: Eigen's decompositions and products of matrices of any size are templates that
/// would cost every source that uses them some twenty seconds of compiling under the sanitizers.
#pragma once

#include <Eigen/Core>

namespace drumsweep {

Eigen::VectorXd times(const Eigen::MatrixXd& a, const Eigen::VectorXd& x);               ///< a x
Eigen::VectorXd transposed_times(const Eigen::MatrixXd& a, const Eigen::VectorXd& x);    ///< a^T x
Eigen::MatrixXd product(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);             ///< a b
Eigen::MatrixXd transposed_product(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);  ///< a^T b
Eigen::MatrixXd product_transposed(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);  ///< a b^T
Eigen::MatrixXd weighted_gram(const Eigen::MatrixXd& a, const Eigen::VectorXd& weight);  ///< a^T diag(weight) a
Eigen::MatrixXd congruence(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);          ///< a b a^T

/// Of a symmetric positive definite matrix.
Eigen::VectorXd solve_symmetric(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);
Eigen::MatrixXd inverse_symmetric(const Eigen::MatrixXd& a);
double log_determinant_symmetric(const Eigen::MatrixXd& a);

/// V^T b V = 1 and V^T a V = diag(values) of two symmetric matrices, b positive definite; values ascending.
struct SimultaneousDiagonal {
  Eigen::MatrixXd vectors;
  Eigen::VectorXd values;
};
SimultaneousDiagonal diagonalise_together(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

/// Ordinary least squares of many right-hand sides: coefficients = A F^T y with A = (F^T F)^-1. A column of zeros (a pair of effects that
/// no run has had) gets coefficients 0 without error.
struct LeastSquares {
  Eigen::MatrixXd coefficients;         ///< (columns of f x columns of y)
  Eigen::MatrixXd inverse_information;  ///< A
  bool regular;                         ///< whether the rows of f tell its columns apart
};
LeastSquares least_squares(const Eigen::MatrixXd& f, const Eigen::MatrixXd& y);

}  // namespace drumsweep

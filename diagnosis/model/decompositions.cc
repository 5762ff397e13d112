/// The part of linear_algebra.h that decomposes matrices; a source of its own for the time it takes to compile.
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <vector>

#include "diagnosis/model/linear_algebra.h"

namespace drumsweep {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;

VectorXd solve_symmetric(const MatrixXd& a, const VectorXd& b) { return a.llt().solve(b); }

MatrixXd inverse_symmetric(const MatrixXd& a) {
  const Eigen::LLT<MatrixXd> llt(a);
  MatrixXd out(a.rows(), a.cols());
  for (Index i = 0; i < a.cols(); ++i) {
    const VectorXd unit = VectorXd::Unit(a.cols(), i);
    out.col(i) = llt.solve(unit);
  }
  return out;
}

double log_determinant_symmetric(const MatrixXd& a) {
  const Eigen::LLT<MatrixXd> llt(a);
  double sum = 0;
  for (Index i = 0; i < a.rows(); ++i) sum += 2 * std::log(llt.matrixLLT()(i, i));
  return sum;
}

SimultaneousDiagonal diagonalise_together(const MatrixXd& a, const MatrixXd& b) {
  // With b = L L^T this is the eigenproblem of L^-1 a L^-T. Eigen's generalised solver does the same, and takes twice as long to compile.
  const Eigen::LLT<MatrixXd> llt(b);
  MatrixXd root(b.rows(), b.cols());  // L^-T
  for (Index i = 0; i < b.cols(); ++i) {
    const VectorXd unit = VectorXd::Unit(b.cols(), i);
    root.col(i) = llt.matrixU().solve(unit);
  }
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(transposed_product(root, product(a, root)));
  return {product(root, solver.eigenvectors()), solver.eigenvalues()};
}

LeastSquares least_squares(const MatrixXd& f, const MatrixXd& y) {
  LeastSquares out;
  MatrixXd information = transposed_product(f, f);
  std::vector<Index> unseen;
  for (Index j = 0; j < f.cols(); ++j)
    if (information(j, j) == 0) unseen.push_back(j);
  for (const Index j : unseen) information(j, j) = 1;
  const Eigen::LLT<MatrixXd> llt(information);
  out.regular = llt.info() == Eigen::Success && llt.rcond() >= 1e-12;
  if (!out.regular) return out;
  out.inverse_information = inverse_symmetric(information);
  for (const Index j : unseen) out.inverse_information(j, j) = 0;
  out.coefficients = product(out.inverse_information, transposed_product(f, y));
  return out;
}

}  // namespace drumsweep

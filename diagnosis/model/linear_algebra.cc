#include "diagnosis/model/linear_algebra.h"

namespace drumsweep {

using Eigen::MatrixXd, Eigen::VectorXd;

VectorXd times(const MatrixXd& a, const VectorXd& x) { return a * x; }
VectorXd transposed_times(const MatrixXd& a, const VectorXd& x) { return a.transpose() * x; }
MatrixXd product(const MatrixXd& a, const MatrixXd& b) { return a * b; }
MatrixXd transposed_product(const MatrixXd& a, const MatrixXd& b) { return a.transpose() * b; }
MatrixXd product_transposed(const MatrixXd& a, const MatrixXd& b) { return a * b.transpose(); }
MatrixXd weighted_gram(const MatrixXd& a, const VectorXd& weight) {
  const MatrixXd weighted = weight.asDiagonal() * a;
  return transposed_product(a, weighted);
}
MatrixXd congruence(const MatrixXd& a, const MatrixXd& b) { return product_transposed(product(a, b), a); }

}  // namespace drumsweep

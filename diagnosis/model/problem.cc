#include "diagnosis/model/problem.h"

#include <fmt/format.h>

namespace drumsweep {

std::string name_of(const Datum& d) {
  return fmt::format("{} {}{}", d.condition, d.quantity,
                     std::isnan(d.position) ? "" : fmt::format(" at {:.4g} {}", d.position, d.position_unit));
}

Eigen::MatrixXd Problem::measurement_covariance() const {
  if (covariance.size() > 0) return covariance;
  Eigen::VectorXd variance(num_data());
  for (Eigen::Index i = 0; i < num_data(); ++i) variance[i] = std::pow(data[static_cast<std::size_t>(i)].sigma, 2);
  return variance.asDiagonal();
}

std::vector<Eigen::Index> Problem::with_use(Use use) const {
  std::vector<Eigen::Index> list;
  for (Eigen::Index i = 0; i < num_data(); ++i)
    if (data[static_cast<std::size_t>(i)].use == use) list.push_back(i);
  return list;
}

}  // namespace drumsweep

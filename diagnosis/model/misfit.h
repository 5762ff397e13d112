/// Is anything wrong, and where?
///
/// Q_0 is S (fit.h) of the model without any effect, theta recalibrated. p = min(1, 2 min(p_omnibus, p_directed)) with the statistics Q_0
/// and max_k (Q_0 - Q_k); both null laws from a parametric bootstrap on the emulator at the fitted theta, in which data and bench
/// measurements are drawn anew and everything is fitted again.
#pragma once

#include "diagnosis/model/inquiry.h"

namespace drumsweep {

struct GroupMisfit {
  std::string group;
  std::size_t num_data;
  double chi2, p;
};

struct Misfit {
  double p_value = 1, p_omnibus = 1, p_directed = 1, q0 = 0, birge = 1;
  Eigen::Index num_fitted_data = 0;
  ModelFit plain;                 ///< theta recalibrated, no effect
  std::vector<ModelFit> singles;  ///< one fit an effect
  std::vector<GroupMisfit> groups;
  std::vector<double> directed_draws;  ///< max_k (Q_0 - Q_k) where nothing is wrong
};
Misfit test_misfit(const Inquiry& inquiry);

/// One datum before and after recalibration, in the data's units.
struct DatumMisfit {
  double simulated_before, simulated_after, sigma_before, sigma_after;
  double z_before, z_after;  ///< measured - simulated, over the error of the difference
  double off_before;         ///< the same before recalibration, with the parameters taken as the bench has them
};

struct Whereabouts {
  std::vector<DatumMisfit> misfits;  ///< of all data
  std::vector<double> theta_z;       ///< of the recalibrated parameters against their bench priors
  bool at_edge = false;              ///< a fitted parameter lies at the edge of what the campaign covers
};
Whereabouts look_where(const Inquiry& inquiry, const ModelFit& plain);

}  // namespace drumsweep

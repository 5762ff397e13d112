/// Solver quality of a time step, measured outside the solver.
#pragma once

#include <cstdint>

#include "core/step/stepper.h"

namespace drumsweep {

/// After the solve and before its result is stored.
StepReport make_report(const World& world, const Balls& balls, Workspace& work, int iterations);

/// Averages over outer steps, maxima kept.
class ReportMean {
 public:
  ReportMean() = default;
  ReportMean(const StepReport& sum, std::int64_t num) : sum_(sum), num_(num) {}
  void add(const StepReport& report);
  StepReport mean() const;  ///< residual.max, max_overlap and force_balance are maxima, all else means
  // To be kept for a restart.
  const StepReport& sum() const { return sum_; }
  std::int64_t num() const { return num_; }

 private:
  StepReport sum_;
  std::int64_t num_ = 0;
};

}  // namespace drumsweep

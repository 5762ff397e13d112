/// Solver quality of a time step, measured outside the solver.
#pragma once

#include "core/step/stepper.h"

namespace drumsweep {

/// After the solve and before its result is stored.
StepReport make_report(const World& world, const Balls& balls, Workspace& work, int iterations);

/// Averages over outer steps, maxima kept.
class ReportMean {
 public:
  void add(const StepReport& report);
  StepReport mean() const;  ///< residual.max, max_overlap and force_balance are maxima, all else means
 private:
  StepReport sum_;
  double num_ = 0;
};

}  // namespace drumsweep

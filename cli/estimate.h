/// What a study costs, from formulas; `check` and `plan` show it.
#pragma once

#include "core/config/study.h"

namespace drumsweep {

/// Numbers that follow from a study without simulating it.
struct CostEstimate {
  double ball_kg, balls_per_s, bed_height_m, froude, turn_s, wall_speed_m_s, step_s;
  double residence_s, balls;  ///< Sullivan; infinite for a level drum
  double filling;             ///< of the drum's volume, bed at the stated packing
  double memory_bytes, core_s_per_s, warmup_core_s, design_core_s;
};

CostEstimate estimate_cost(const Study& study);

}  // namespace drumsweep

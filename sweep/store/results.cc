#include "sweep/store/results.h"

#include <fmt/format.h>

#include <cmath>
#include <exception>

#include "core/effects/size_distribution.h"
#include "postproc/objective.h"

namespace drumsweep {

ResultRow failed_row(const PlannedDesign& design, const std::string& reason) {
  ResultRow row;
  row.design_id = design.id;
  row.stage = design.stage;
  row.state = "failed";
  row.variables = design.row;
  row.reason = reason;
  return row;
}

ResultRow evaluated_row(const Study& base, const PlannedDesign& design, const Recording& recording, bool steady) {
  try {
    const Study study = study_of_design(base, design.values);
    const Objective objective = evaluate(recording.landings, recording.begin_s, recording.turns, study);
    if (!std::isfinite(objective.f_m)) return failed_row(design, "f is not a finite number");

    ResultRow row;
    row.design_id = design.id;
    row.stage = design.stage;
    row.state = "done";
    row.variables = design.row;
    row.f_m = objective.f_m;
    row.sigma_f_m = objective.sigma_f_m;
    row.f_footprint_m = objective.f_footprint_m;
    row.sigma_f_footprint_m = objective.sigma_f_footprint_m;
    row.max_an_over_a0 = objective.max_an_over_a0;
    row.mean_height_m = objective.mean_height_m;
    row.landed = objective.landed;
    row.lost_balls = recording.lost;
    row.residual = recording.quality.residual.mean;
    row.overlap_95 = recording.quality.overlap_95;
    row.force_balance_m_s = recording.quality.force_balance;
    row.iterations = recording.quality.iterations;
    row.state_hash = fmt::format("{:016x}", recording.hash);

    // Less than a ball is always due; more than a second's feed means that the feed zone is full.
    const double ball_kg = mean_ball_mass(study);
    if (!steady) {
      row.state = "untrusted";
      row.reason = "warm drum not steady";
    } else if (recording.lost > 0) {
      row.state = "untrusted";
      row.reason = fmt::format("{} balls lost", recording.lost);
    } else if (objective.f_m == 0) {
      row.state = "untrusted";
      row.reason = "nothing landed in the window of the objective";
    } else if (recording.feed_debt_kg > study.feed.rate_kg_s + ball_kg) {
      row.state = "untrusted";
      row.reason = fmt::format("feed blocked: {:.3g} kg found no room", recording.feed_debt_kg);
    } else if (row.residual > study.solver.residual_limit_m_s) {
      row.state = "untrusted";
      row.reason = fmt::format("mean residual {:.3g} m/s is above solver.residual_limit_m_s = {:g}", row.residual,
                               study.solver.residual_limit_m_s);
    }
    return row;
  } catch (const std::exception& error) {
    return failed_row(design, std::string("cannot be evaluated: ") + error.what());
  }
}

std::optional<std::size_t> best_row(const std::vector<ResultRow>& rows) {
  for (const char* state : {"done", "untrusted"}) {
    std::optional<std::size_t> best;
    for (std::size_t i = 0; i < rows.size(); ++i)
      if (rows[i].state == state && (!best || rows[i].f_m < rows[*best].f_m)) best = i;
    if (best) return best;
  }
  return std::nullopt;
}

}  // namespace drumsweep

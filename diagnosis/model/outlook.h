/// What these data can see at all, and what to measure next.
#pragma once

#include "diagnosis/model/misfit.h"

namespace drumsweep {

struct Detection {
  double limit_low,
      limit_high;   ///< strength that is found in 9 of 10 campaigns like this one; NaN where not in the range
  double d_at_end;  ///< effect in sigma at the end of its range, after recalibration
};

struct Twins {
  int a, b;
  double distance;  ///< in sigma, at the strength where they would be seen with certainty
  bool exact;
};

struct Advice {
  std::string measurement;  ///< a condition with use = available, or "repeat the campaign"
  double distance;          ///< least predicted distance of two members of the set, in sigma
  double power;             ///< of telling the truth apart from the nearest other member
  double gained = 0;        ///< what it adds to the square of that distance
};

inline constexpr double exact_twins = 0.5;  ///< distance in sigma below which no such data tell two effects apart

struct Outlook {
  std::vector<Detection> detection;
  Eigen::MatrixXd isolation;  ///< D (truth x rival) [sigma] where the truth is as strong as d = 5, or at its end
  std::vector<Twins> twins;
  std::vector<double>
      pattern_cosine;  ///< of the residual with each effect's signature, a hint when nothing explains it
};
Outlook look_at_candidates(const Inquiry& inquiry, const Misfit& misfit);

/// Which measurement separates the members of a set, best first; none where there is nothing to separate.
std::vector<Advice> advise(const Inquiry& inquiry, const std::vector<const ModelFit*>& members);

}  // namespace drumsweep

/// What the conditions say that were never used for choosing.
#pragma once

#include "diagnosis/model/inquiry.h"

namespace drumsweep {

struct HeldOutJudgement {
  double p = std::nan("");     ///< of the fit's predictions; NaN where nothing is held out
  double nats = std::nan("");  ///< log predictive density over that of the plain model
};
HeldOutJudgement judge_held_out(const Inquiry& inquiry, const ModelFit& plain, const ModelFit& fit);

/// Gain of a fit over that of the plain model on the data with use = holdout.
struct HeldOutGain {
  std::vector<std::string> conditions;
  std::vector<double> nats;  ///< of each condition
  double mean = std::nan(""), low = std::nan(""),
         high = std::nan("");  ///< 95 % t interval, skewness taken out (Hall 1992)
  double rms_z_before = std::nan(""), rms_z_after = std::nan("");
  double coverage_before = std::nan(""), coverage_after = std::nan("");  ///< of 90 % bands
  struct Quantity {
    std::string quantity, unit;
    double rms_before, rms_after;
  };
  std::vector<Quantity> quantities;
  bool adopted = false;
};
HeldOutGain held_out_gain(const Inquiry& inquiry, const ModelFit& plain, const ModelFit& best);

}  // namespace drumsweep

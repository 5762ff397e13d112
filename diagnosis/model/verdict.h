/// The diagnosis itself, from measured data and an emulated campaign: is anything wrong and where (misfit.h), why (naming.h), what is
/// gained (held_out.h), what can be seen at all and what to measure next (outlook.h). Here: the order of these, and the grade.
#pragma once

#include "diagnosis/model/held_out.h"
#include "diagnosis/model/laws.h"
#include "diagnosis/model/misfit.h"
#include "diagnosis/model/naming.h"
#include "diagnosis/model/outlook.h"

namespace drumsweep {

enum class Verdict { nothing_wrong, established, suspected, ambiguous, none_of_these };
const char* to_text(Verdict verdict);

/// What every step has found.
struct Diagnosis : Misfit, Whereabouts, Naming, Outlook {
  Verdict verdict = Verdict::nothing_wrong;
  std::vector<Advice> advice;  ///< best first
  HeldOutGain gain;  ///< of the best member: log predictive density of each held-out condition over the plain model's
};

/// @param emulator  of the campaign  @throws InputError: fewer data than free parameters, ...
Diagnosis diagnose(const Problem& problem, const Emulator& emulator, const DiagnosisOptions& options = {},
                   const std::vector<LocalRuns>& second_wave = {});

/// Where a second wave of runs is worth most: round the leading explanations of a first diagnosis; nowhere where it found nothing wrong.
std::vector<LocalCentre> second_wave_of(const Diagnosis& first, const Problem& problem);

/// Scale for an emulator of this problem: the data's sigma.
Eigen::VectorXd scale_of(const Problem& problem);

}  // namespace drumsweep

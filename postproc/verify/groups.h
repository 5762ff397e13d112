/// The groups of verify_groups(), one function each, in a file of its name.
#pragma once

#include "postproc/verify/verify.h"

namespace drumsweep {

std::vector<VerifyCase> verify_oblique_impact(const VerifyOptions& options);
std::vector<VerifyCase> verify_closed_forms(const VerifyOptions& options);
std::vector<VerifyCase> verify_static_pile(const VerifyOptions& options);
std::vector<VerifyCase> verify_belt_bed(const VerifyOptions& options);
std::vector<VerifyCase> verify_column_collapse(const VerifyOptions& options);
std::vector<VerifyCase> verify_slot_discharge(const VerifyOptions& options);
std::vector<VerifyCase> verify_pile_of_pellets(const VerifyOptions& options);
std::vector<VerifyCase> verify_rotating_drum(const VerifyOptions& options);
std::vector<VerifyCase> verify_smooth_reference(const VerifyOptions& options);

}  // namespace drumsweep

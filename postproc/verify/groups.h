/// The groups of verify_groups(), one function each, in a file of its name.
#pragma once

#include "postproc/verify/verify.h"

namespace drumsweep {

std::vector<VerifyCase> verify_oblique_impact(const VerifyOptions& options);

}  // namespace drumsweep

/// Laws of probability that a verdict needs.
#pragma once

namespace drumsweep {

double normal_cdf(double x);
/// P(chi^2_k > x)
double chi2_tail(double x, double k);
/// Two-sided 95 % point of Student's t.
double student_95(double dof);

}  // namespace drumsweep

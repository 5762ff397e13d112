#include "diagnosis/model/laws.h"

#include <algorithm>
#include <cmath>

namespace drumsweep {

double normal_cdf(double x) { return 0.5 * std::erfc(-x / std::sqrt(2.0)); }

double chi2_tail(double x, double k) {
  // Regularised incomplete gamma function, by series below the mean and by Lentz's continued fraction above it.
  const double a = 0.5 * k, y = 0.5 * x;
  if (!(y > 0)) return 1;
  const double front = std::exp(a * std::log(y) - y - std::lgamma(a));
  if (y < a + 1) {
    double term = 1 / a, sum = term;
    for (int n = 1; n < 1000 && term > 1e-16 * sum; ++n) sum += term *= y / (a + n);
    return std::clamp(1 - front * sum, 0.0, 1.0);
  }
  double b = y + 1 - a, c = 1e300, d = 1 / b, h = d;
  for (int n = 1; n < 1000; ++n) {
    const double an = -n * (n - a);
    b += 2;
    d = 1 / (an * d + b);
    c = b + an / c;
    h *= d * c;
    if (std::abs(d * c - 1) < 1e-15) break;
  }
  return std::clamp(front * h, 0.0, 1.0);
}

double student_95(double dof) {
  // Newton's method on the tail of Student's law, with the tail integrated by Simpson's rule in the angle atan(t / sqrt(dof)).
  const auto inside = [&](double t) {
    const double end = std::atan(t / std::sqrt(dof));
    constexpr int num = 400;
    const auto f = [&](double angle) { return std::pow(std::cos(angle), dof - 1); };
    double sum = f(0) + f(end);
    for (int i = 1; i < num; ++i) sum += (i % 2 == 1 ? 4 : 2) * f(end * i / num);
    const double norm = std::exp(std::lgamma(0.5 * (dof + 1)) - std::lgamma(0.5 * dof)) / std::sqrt(M_PI);
    return 2 * norm * sum * end / (3 * num);
  };
  double low = 0, high = 1000;
  for (int halving = 0; halving < 80; ++halving) {
    const double middle = 0.5 * (low + high);
    (inside(middle) < 0.95 ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace drumsweep

#include "postproc/spectrum.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <thread>

namespace drumsweep {
namespace {

/// The definition, term by term.
std::vector<double> direct_amplitudes(const std::vector<double>& values) {
  std::vector<double> moduli;
  for (std::size_t n = 0; n <= values.size() / 2; ++n) {
    std::complex<double> sum = 0.0;
    for (std::size_t k = 0; k < values.size(); ++k)
      sum += values[k] *
             std::polar(1.0, -2.0 * std::numbers::pi * static_cast<double>(n * k) / static_cast<double>(values.size()));
    moduli.push_back(std::abs(sum));
  }
  return moduli;
}

RC_GTEST_PROP(Spectrum, equals_the_direct_sum_for_any_size, ()) {
  std::vector<double> values;
  const int size = *rc::gen::inRange(1, 90);
  for (int k = 0; k < size; ++k) values.push_back(*rc::gen::inRange(-1000, 1000) * 1e-3);
  const std::vector<double> got = amplitudes(values), expected = direct_amplitudes(values);
  RC_ASSERT(got.size() == expected.size());
  for (std::size_t n = 0; n < got.size(); ++n) RC_ASSERT(std::abs(got[n] - expected[n]) < 1e-11);
}

TEST(Spectrum, of_nothing_is_nothing) { EXPECT_TRUE(amplitudes({}).empty()); }

TEST(Spectrum, same_bits_from_any_thread_and_any_alignment) {
  std::vector<double> values(41);
  for (std::size_t k = 0; k < values.size(); ++k) values[k] = std::sin(1.7 * static_cast<double>(k * k));
  const std::vector<double> expected = amplitudes(std::span(values).first(40));
  // One cell further in memory: another alignment of the caller's array.
  std::vector<double> moved(42);
  std::copy(values.begin(), values.end(), moved.begin() + 1);
  EXPECT_EQ(amplitudes(std::span(moved).subspan(1, 40)), expected);

  std::vector<int> equal(4, 0);
  std::vector<std::thread> threads;
  for (std::size_t t = 0; t < equal.size(); ++t)
    threads.emplace_back([&, t] {
      for (int repeat = 0; repeat < 200; ++repeat)
        equal[t] += amplitudes(std::span(values).first(40)) == expected ? 1 : 0;
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(equal, std::vector<int>(4, 200));
}

}  // namespace
}  // namespace drumsweep

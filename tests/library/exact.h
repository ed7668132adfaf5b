// Exact arithmetic on floats, by GMP: numbers as whole multiples of 2^-149, the
// smallest float, of which every float and every sum of floats is a multiple.
#ifndef HALFSPACE_TESTS_LIBRARY_EXACT_H_
#define HALFSPACE_TESTS_LIBRARY_EXACT_H_

#include <gmpxx.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <span>

namespace halfspace::testing {

// The exact value of a finite float, or of a double that is a sum of floats.
inline mpz_class Exact(double value) {
  // Scaling by a power of two is exact, and 2^149 * FLT_MAX fits a double.
  return mpz_class(std::ldexp(value, 149));
}

inline mpz_class ExactSumOf(std::span<const float> values) {
  mpz_class sum = 0;
  for (float value : values) sum += Exact(value);
  return sum;
}

// `bound` is the largest float that is not above `exact`.
inline ::testing::AssertionResult IsTightestBelow(float bound,
                                                  const mpz_class& exact) {
  if (Exact(bound) > exact) {
    return ::testing::AssertionFailure()
           << bound << " is above the exact value";
  }
  const float inwards =
      std::nextafter(bound, std::numeric_limits<float>::infinity());
  if (Exact(inwards) <= exact) {
    return ::testing::AssertionFailure()
           << "the next float after " << bound << " is a bound as well";
  }
  return ::testing::AssertionSuccess();
}

// `bound` is the smallest float that is not below `exact`.
inline ::testing::AssertionResult IsTightestAbove(float bound,
                                                  const mpz_class& exact) {
  return IsTightestBelow(-bound, -exact) << " (everything negated)";
}

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_EXACT_H_

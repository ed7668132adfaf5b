// Exact real numbers, to compare bounds with: rationals, by GMP, and rationals
// plus or minus a square root.
#ifndef HALFSPACE_TESTS_FUZZ_EXACT_REAL_H_
#define HALFSPACE_TESTS_FUZZ_EXACT_REAL_H_

#include <gmpxx.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <span>
#include <vector>

namespace halfspace::testing {

struct ExactReal {
  mpq_class rational;
  mpq_class radicand = 0;
  int root_sign = 0;  // of the root that is added; 0 if there is none
};

// Less than, equal to or more than 0 as `value` is below, at or above `real`.
inline int Compare(const mpq_class& value, const ExactReal& real) {
  const mpq_class apart = value - real.rational;
  if (real.root_sign == 0) return sgn(apart);
  if (sgn(apart) != real.root_sign) return -real.root_sign;
  return real.root_sign * cmp(apart * apart, real.radicand);
}

// How far a bound may lie outside the tightest one.
struct Tolerance {
  int ulps = 0;
  mpq_class slack = 0;
};

inline ::testing::AssertionResult IsBelowAll(std::span<const ExactReal> values,
                                             float bound) {
  for (const ExactReal& value : values) {
    if (!std::isfinite(bound) || Compare(mpq_class(bound), value) > 0) {
      return ::testing::AssertionFailure()
             << bound << " is above the exact value";
    }
  }
  return ::testing::AssertionSuccess();
}

// `bound` is above one of the values, or as little below it as is tolerated.
inline ::testing::AssertionResult IsTight(std::span<const ExactReal> values,
                                          float bound,
                                          const Tolerance& tolerance) {
  float inwards = bound;
  for (int ulp = 0; ulp <= tolerance.ulps; ++ulp) {
    inwards = std::nextafter(inwards, std::numeric_limits<float>::infinity());
  }
  for (const ExactReal& value : values) {
    if (!std::isfinite(inwards) ||
        Compare(mpq_class(inwards) + tolerance.slack, value) > 0) {
      return ::testing::AssertionSuccess();
    }
  }
  return ::testing::AssertionFailure()
         << bound << " is not as tight as it should be";
}

// `bound` is not above any of the values, and as tight as asked for.
inline ::testing::AssertionResult IsMinimumOf(std::span<const ExactReal> values,
                                              float bound,
                                              const Tolerance& tolerance) {
  auto result = IsBelowAll(values, bound);
  if (!result) return result;
  return IsTight(values, bound, tolerance);
}

// Maxima are checked as the minima of the mirrored values.
inline std::vector<ExactReal> Mirrored(std::span<const ExactReal> values) {
  std::vector<ExactReal> mirrored;
  for (const ExactReal& value : values) {
    mirrored.push_back({-value.rational, value.radicand, -value.root_sign});
  }
  return mirrored;
}

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_FUZZ_EXACT_REAL_H_

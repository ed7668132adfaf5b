// Quotients of exact sums, rounded outward.
//
// Only for translation units compiled without fast-math and contraction.
#ifndef HALFSPACE_DISPATCH_EXACT_QUOTIENT_H_
#define HALFSPACE_DISPATCH_EXACT_QUOTIENT_H_

#include <cmath>
#include <limits>

#include "dispatch/exact/outward.h"

namespace halfspace::dispatch {

// The relative error of value / value. Both values are off by less than an ulp,
// 2^-52, and the division rounds once.
inline constexpr double kQuotientError = 0x1p-50;

// Returns a float that is not above numerator / denominator. The denominator is
// not 0. It is the largest such float if doubles hold both sums, and else at
// most one float below that. Both sums must be far from the limits of double.
inline float QuotientDown(const ExactSum& numerator,
                          const ExactSum& denominator) {
  const double quotient = numerator.value / denominator.value;
  if (numerator.rest == 0.0 && denominator.rest == 0.0) {
    const double remainder =
        std::fma(-quotient, denominator.value, numerator.value);
    const bool is_above = (remainder < 0.0 && denominator.value > 0.0) ||
                          (remainder > 0.0 && denominator.value < 0.0);
    return RoundDown({quotient, is_above ? -1.0 : 0.0});
  }
  const double below = quotient - std::fabs(quotient) * kQuotientError;
  return RoundDown(
      {std::nextafter(below, -std::numeric_limits<double>::infinity()), 0.0});
}

inline float QuotientUp(const ExactSum& numerator,
                        const ExactSum& denominator) {
  return -QuotientDown({-numerator.value, -numerator.rest}, denominator);
}

}  // namespace halfspace::dispatch

#endif  // HALFSPACE_DISPATCH_EXACT_QUOTIENT_H_

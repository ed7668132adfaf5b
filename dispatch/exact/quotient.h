// Quotients of exact sums, rounded outward.
//
// Only for translation units compiled without fast-math and contraction.
#ifndef HALFSPACE_DISPATCH_EXACT_QUOTIENT_H_
#define HALFSPACE_DISPATCH_EXACT_QUOTIENT_H_

#include <cmath>
#include <limits>

#include "dispatch/exact/outward.h"

namespace halfspace::dispatch {

// The relative error of value / value: both parts are off by less than an ulp,
// 2^-52, and the division rounds once more.
inline constexpr double kQuotientError = 0x1p-50;

// A float that is not above numerator / denominator, which is not 0: the
// largest one where double holds both sums, else at most one below that.
// Neither side may come near the ends of double's range.
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

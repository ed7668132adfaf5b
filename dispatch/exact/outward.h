// Exact sums of a few numbers, and their rounding outward to float.
//
// Sums are in double, with Knuth's TwoSum, which keeps the rounding error of
// each addition. So they are exact: sums in double do not underflow, and all
// values are far below the largest double.
//
// Only for translation units compiled without fast-math and contraction, which
// would delete TwoSum.
#ifndef HALFSPACE_DISPATCH_EXACT_OUTWARD_H_
#define HALFSPACE_DISPATCH_EXACT_OUTWARD_H_

#include <array>
#include <cfloat>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "kernels/compiler.h"

namespace halfspace::dispatch {

static_assert(FLT_EVAL_METHOD == 0,
              "halfspace needs floats without excess precision: on 32-bit x86 "
              "compile it with -msse2 -mfpmath=sse");
#if defined(__SOFTFP__)
// gcc 12: 1 - 0x1.012fa25ddbd03p-33 is the double below the nearest one.
static_assert(false,
              "halfspace needs sums that are rounded right, and floating point "
              "in software rounds some wrongly: on 32-bit ARM compile it with "
              "-march=armv6k+fp -mfloat-abi=softfp");
#endif

struct TwoSumResult {
  double sum;
  double error;  // sum + error is the exact a + b
};

inline TwoSumResult TwoSum(double a, double b) {
  const double sum = a + b;
  const double b_part = sum - a;
  return {sum, (a - (sum - b_part)) + (b - b_part)};
}

// An exact sum: `value` is less than an ulp away, and `rest` has the sign of
// what is missing (exact - value), 0 if nothing is.
struct ExactSum {
  double value;
  double rest;
};

// The general case: Shewchuk's expansions, components of increasing magnitude
// that do not overlap, then a pass that gathers them into the last one.
template <std::size_t kCount>
ExactSum SumByExpansion(const std::array<double, kCount>& values) {
  std::array<double, kCount> parts{};
  for (std::size_t n = 0; n < kCount; ++n) {
    double carry = values[n];
    for (std::size_t i = 0; i < n; ++i) {
      const TwoSumResult step = TwoSum(carry, parts[i]);
      carry = step.sum;
      parts[i] = step.error;
    }
    parts[n] = carry;
  }
  for (std::size_t i = 1; i < kCount; ++i) {
    const TwoSumResult step = TwoSum(parts[i], parts[i - 1]);
    parts[i] = step.sum;
    parts[i - 1] = step.error;
  }
  double rest = 0.0;
  for (std::size_t i = kCount - 1; i-- > 0 && rest == 0.0;) rest = parts[i];
  return {parts[kCount - 1], rest};
}

// The sum of `values`, which must be finite and below 2^1000. A double almost
// always holds the sum of a few floats exactly, and the errors of the additions
// show it.
template <std::size_t kCount>
ExactSum SumExactly(const std::array<double, kCount>& values) {
  double sum = values[0];
  bool exact = true;
  for (std::size_t i = 1; i < kCount; ++i) {
    const TwoSumResult step = TwoSum(sum, values[i]);
    sum = step.sum;
    exact &= step.error == 0.0;
  }
  if (exact) return {sum, 0.0};
  return SumByExpansion(values);
}

// The largest float that is not above the sum. No branch on whether the nearest
// float is above, which would be mispredicted every second time.
inline float RoundDown(const ExactSum& sum) {
  const float nearest = static_cast<float>(sum.value);
  const double back = nearest;
  const std::uint32_t above = static_cast<std::uint32_t>(back > sum.value) |
                              (static_cast<std::uint32_t>(back == sum.value) &
                               static_cast<std::uint32_t>(sum.rest < 0.0));
  // Below zero, magnitudes grow: +0 counts as -0 there.
  const auto bits = kernels::BitCast<std::uint32_t>(nearest);
  const auto is_positive = static_cast<std::uint32_t>(nearest > 0.0f);
  const std::uint32_t below =
      (bits | ((is_positive - 1) & 0x80000000u)) + 1 - 2 * is_positive;
  return kernels::BitCast<float>(bits ^ ((bits ^ below) & (0 - above)));
}

// The smallest float that is not below the sum.
inline float RoundUp(const ExactSum& sum) {
  return -RoundDown({-sum.value, -sum.rest});
}

}  // namespace halfspace::dispatch

#endif  // HALFSPACE_DISPATCH_EXACT_OUTWARD_H_

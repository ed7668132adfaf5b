// Sums in double that know their error, and their rounding outward to float.
// docs/exactness.md has the proof.
//
// Only for translation units compiled without fast-math and contraction, which
// would delete TwoSum, and only in the default floating-point mode
// (default_fp_mode.h).
#ifndef HALFSPACE_DISPATCH_OUTWARD_H_
#define HALFSPACE_DISPATCH_OUTWARD_H_

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

// The largest float that is not above value + rest. `rest` is less than the
// distance from `value` to its neighbours. No branch on whether the nearest
// float is above, which would be mispredicted every second time.
inline float RoundDown(double value, double rest = 0.0) {
  const float nearest = static_cast<float>(value);
  const double back = nearest;
  const std::uint32_t above = static_cast<std::uint32_t>(back > value) |
                              (static_cast<std::uint32_t>(back == value) &
                               static_cast<std::uint32_t>(rest < 0.0));
  // Below zero, magnitudes grow: +0 counts as -0 there.
  const auto bits = kernels::BitCast<std::uint32_t>(nearest);
  const auto is_positive = static_cast<std::uint32_t>(nearest > 0.0f);
  const std::uint32_t below =
      (bits | ((is_positive - 1) & 0x80000000u)) + 1 - 2 * is_positive;
  return kernels::BitCast<float>(bits ^ ((bits ^ below) & (0 - above)));
}

// The smallest float that is not below value + rest.
inline float RoundUp(double value, double rest = 0.0) {
  return -RoundDown(-value, -rest);
}

// A float that is not below the value, and at most two ulps above it. Takes
// less time than RoundUp().
inline float RoundUpLoosely(double value) {
  return static_cast<float>(value + std::fabs(value) * 0x1p-23 + 0x1p-149);
}

// A sum of at most some hundred terms, all below 2^1000. The exact sum is at
// most 2 * error() away from value(). If doubles held all sums and products,
// error() is 0.
class OutwardSum {
 public:
  explicit OutwardSum(double value = 0.0, double error = 0.0)
      : value_(value), error_(error) {}

  // Double holds a product of floats.
  static OutwardSum ProductOf(float a, float b) {
    return OutwardSum(double{a} * double{b});
  }
  static OutwardSum ProductOf(double a, double b) {
    const double product = a * b;
    const bool is_zero = a == 0.0 || b == 0.0;
    return OutwardSum(product, std::fabs(std::fma(a, b, -product)) +
                                   (is_zero ? 0.0 : LostBelow(product)));
  }

  double value() const { return value_; }
  double error() const { return error_; }

  void Add(double term) {
    const TwoSumResult step = TwoSum(value_, term);
    value_ = step.sum;
    error_ += std::fabs(step.error);
  }
  void Add(const OutwardSum& sum) {
    Add(sum.value_);
    error_ += sum.error_;
  }
  template <typename Scalar>
  void AddProduct(Scalar a, Scalar b) {
    Add(ProductOf(a, b));
  }

  OutwardSum operator-() const { return OutwardSum(-value_, error_); }

  // For a divisor of at least 1.
  OutwardSum DividedBy(double divisor) const {
    const double quotient = value_ / divisor;
    const double rest = std::fma(-quotient, divisor, value_);
    return OutwardSum(quotient, (std::fabs(rest) + error_) / divisor +
                                    (value_ == 0.0 ? 0.0 : LostBelow(value_)));
  }

  float Down() const {
    if (error_ == 0.0) return RoundDown(value_);
    const TwoSumResult low = TwoSum(value_, -2.0 * error_);
    return RoundDown(low.sum, low.error);
  }
  float Up() const { return -(-*this).Down(); }

 private:
  // What a product or a remainder that is next to nothing may lose in addition,
  // because doubles end.
  static double LostBelow(double value) {
    return std::fabs(value) < 0x1p-900 ? 0x1p-1000 : 0.0;
  }

  double value_;
  double error_;
};

}  // namespace halfspace::dispatch

#endif  // HALFSPACE_DISPATCH_OUTWARD_H_

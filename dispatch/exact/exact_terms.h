// Sums of coordinates and of products of two numbers, exactly.
//
// Only for translation units compiled without fast-math and contraction, and
// only in the default floating-point mode (default_fp_mode.h).
#ifndef HALFSPACE_DISPATCH_EXACT_EXACT_TERMS_H_
#define HALFSPACE_DISPATCH_EXACT_EXACT_TERMS_H_

#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

#include "dispatch/default_fp_mode.h"
#include "dispatch/exact/outward.h"
#include "kernels/compiler.h"

namespace halfspace::dispatch {

// Returns a sum that rounds to float as the exact sum does, in both directions,
// although the terms lack an unknown number of at most `left_out`. If the exact
// sum is too close to a float, which is rare, it returns nothing. Then the
// terms have to be added exactly, which takes ten times as long.
template <std::size_t kCount>
std::optional<ExactSum> TrySumToRound(const std::array<double, kCount>& terms,
                                      double left_out) {
  double sum = 0.0;
  double magnitude = 0.0;
  for (double term : terms) {
    sum += term;
    magnitude += std::fabs(term);
  }
  // Twice the rounding error of kCount additions.
  const double error = magnitude * (kCount * 0x1p-52) + left_out;
  const double low = sum - error;
  const double high = sum + error;
  const float nearest = static_cast<float>(low);
  if (nearest != static_cast<float>(high)) return std::nullopt;
  // Both compares and one branch, because the side cannot be predicted.
  const bool is_above_low = nearest >= low;
  const bool is_below_high = nearest <= high;
  if (is_above_low & is_below_high) return std::nullopt;
  return ExactSum{sum, 0.0};
}

// At most kProducts products and kNumbers other terms, whose sum is below
// 2^1000. Of floats: double holds a product exactly.
template <typename Scalar, std::size_t kProducts, std::size_t kNumbers>
class ExactTerms {
 public:
  void Add(Scalar number) { terms_[count_++] = number; }
  void AddProduct(Scalar a, Scalar b) {
    terms_[count_++] = double{a} * double{b};
  }

  ExactSum Sum() const { return SumExactly(terms_); }
  // Rounds to float as Sum() does, in both directions.
  ExactSum SumToRound() const {
    const auto sum = TrySumToRound(terms_, 0.0);
    return sum ? *sum : SumApart();
  }

 private:
  // Not inlined, because the code of an exact sum is long and rarely needed.
  HALFSPACE_NOINLINE ExactSum SumApart() const { return Sum(); }

  std::array<double, kProducts + kNumbers> terms_{};
  std::size_t count_ = 0;
};

// A product of doubles is a double and its error, which is a double too unless
// the product is next to nothing.
template <std::size_t kProducts, std::size_t kNumbers>
class ExactTerms<double, kProducts, kNumbers> {
 public:
  void Add(double number) { terms_[count_++] = number; }
  void AddProduct(double a, double b) {
    const double product = a * b;
    if (std::fabs(product) < kTiny && a != 0.0 && b != 0.0) {
      AddTinyProduct(a, b);
      return;
    }
    terms_[count_++] = product;
    terms_[count_++] = std::fma(a, b, -product);
  }

  ExactSum Sum() const {
    return tiny_count_ == 0 ? SumExactly(terms_) : SumWithTiny();
  }

  ExactSum SumToRound() const {
    constexpr double kTinySum = kTermCount * kTiny;
    const auto sum = TrySumToRound(terms_, tiny_count_ == 0 ? 0.0 : kTinySum);
    return sum ? *sum : SumApart();
  }

 private:
  static constexpr std::size_t kTermCount = 2 * kProducts + kNumbers;

  // Products below kTiny are stored separately, multiplied by 2^kTinyScale. So
  // any product of two doubles, which is a multiple of 2^-2148, is a double and
  // its error.
  static constexpr double kTiny = 0x1p-900;
  static constexpr int kTinyScale = 1200;
  static constexpr int kLeast = -1074;  // 2^kLeast is the smallest double

  HALFSPACE_NOINLINE void AddTinyProduct(double a, double b) {
    int a_exponent = 0;
    int b_exponent = 0;
    const double x = std::frexp(a, &a_exponent);
    const double y = std::frexp(b, &b_exponent);
    const double product = x * y;
    const int scale = a_exponent + b_exponent + kTinyScale;
    tiny_[tiny_count_++] = std::ldexp(product, scale);
    tiny_[tiny_count_++] = std::ldexp(std::fma(x, y, -product), scale);
  }

  // Divides a scaled number into the nearest multiple of 2^kLeast, as a double,
  // and the scaled rest.
  static double TakeDouble(double& scaled) {
    const double whole =
        std::nearbyint(std::ldexp(scaled, -kTinyScale - kLeast));
    scaled -= std::ldexp(whole, kTinyScale + kLeast);
    return std::ldexp(whole, kLeast);
  }

  HALFSPACE_NOINLINE ExactSum SumApart() const { return Sum(); }

  HALFSPACE_NOINLINE ExactSum SumWithTiny() const {
    std::array<double, kTermCount + 2 * kProducts + 1> doubles{};
    std::size_t n = 0;
    for (double term : terms_) doubles[n++] = term;
    std::array<double, 2 * kProducts> left = tiny_;
    for (double& scaled : left) doubles[n++] = TakeDouble(scaled);
    ExactSum below = SumExactly(left);
    doubles[n] = TakeDouble(below.value);
    // The rest below all doubles is less than the smallest double.
    ExactSum sum = SumByExpansion(doubles);
    if (sum.rest == 0.0) {
      sum.rest = below.value != 0.0 ? below.value : below.rest;
    }
    return sum;
  }

  std::array<double, kTermCount> terms_{};
  std::size_t count_ = 0;
  std::array<double, 2 * kProducts> tiny_{};
  std::size_t tiny_count_ = 0;
};

}  // namespace halfspace::dispatch

#endif  // HALFSPACE_DISPATCH_EXACT_EXACT_TERMS_H_

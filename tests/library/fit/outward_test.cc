// The exact sums and their rounding, against GMP.
#include "dispatch/exact/outward.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <type_traits>

#include "dispatch/exact/exact_terms.h"
#include "tests/library/fit/random_shapes.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/exact.h"

namespace halfspace::dispatch {
namespace {

using testing::Exact;
using testing::IsTightestAbove;
using testing::IsTightestBelow;

// From a double to the next one away from zero.
mpq_class UlpOf(double value) {
  const double magnitude = std::fabs(value);
  const double next =
      std::nextafter(magnitude, std::numeric_limits<double>::infinity());
  return Exact(next) - Exact(magnitude);
}

template <typename Terms>
class OutwardTest : public ::testing::Test {};

template <std::size_t kTerms>
using TermsConstant = std::integral_constant<std::size_t, kTerms>;
using AllTerms =
    ::testing::Types<TermsConstant<2>, TermsConstant<3>, TermsConstant<4>>;
struct TermsNames {
  template <typename Terms>
  static std::string GetName(int) {
    return std::to_string(Terms::value) + "Terms";
  }
};
TYPED_TEST_SUITE(OutwardTest, AllTerms, TermsNames);

TYPED_TEST(OutwardTest, SumsAreExactAndRoundOutward) {
  constexpr std::size_t kTerms = TypeParam::value;
  testing::Random random(5);
  std::size_t with_rest = 0;
  std::size_t without_rest = 0;
  for (testing::PointKind kind : testing::kPointKinds) {
    SCOPED_TRACE(NameOf(kind));
    for (std::size_t i = 0; i < testing::Scaled(50'000); ++i) {
      std::array<float, kTerms> point;
      testing::RandomFloats<float>(kind, random, point);
      std::array<double, kTerms> values;
      std::copy(point.begin(), point.end(), values.begin());
      const mpq_class exact = testing::ExactSumOf(point);

      const ExactSum sum = SumExactly(values);
      const mpq_class missing = exact - Exact(sum.value);
      ASSERT_EQ(sgn(missing), (sum.rest > 0.0) - (sum.rest < 0.0));
      if (missing != 0) {
        ASSERT_LT(abs(missing), UlpOf(sum.value));
      }
      ++(sum.rest == 0.0 ? without_rest : with_rest);
      ASSERT_TRUE(IsTightestBelow(RoundDown(sum), exact));
      ASSERT_TRUE(IsTightestAbove(RoundUp(sum), exact));

      // The general case must give the same where the short cut was taken.
      const ExactSum general = SumByExpansion(values);
      ASSERT_EQ(general.value, sum.value);
      ASSERT_EQ(general.rest == 0.0, sum.rest == 0.0);
    }
  }
  EXPECT_GT(with_rest, 0u);
  EXPECT_GT(without_rest, 0u);
}

// 1 + 2^-30 + 2^-60 takes 61 bits, more than a double has.
TEST(OutwardKnownTest, RestKnowsWhatDoubleDropped) {
  const ExactSum above = SumExactly<3>({1.0, 0x1p-30, 0x1p-60});
  EXPECT_EQ(above.value, 1.0 + 0x1p-30);
  EXPECT_GT(above.rest, 0.0);
  const ExactSum below = SumExactly<3>({1.0, 0x1p-30, -0x1p-60});
  EXPECT_EQ(below.value, 1.0 + 0x1p-30);
  EXPECT_LT(below.rest, 0.0);
}

// A rest too small for the double still moves the float: 1 is not below
// 1 - 2^-60.
TEST(OutwardKnownTest, RestMovesAFloatThatIsOtherwiseExact) {
  EXPECT_EQ(RoundDown({1.0, -0x1p-60}), 0x1.fffffep-1f);
  EXPECT_EQ(RoundDown({1.0, 0x1p-60}), 1.f);
  EXPECT_EQ(RoundUp({1.0, 0x1p-60}), 0x1.000002p0f);
  EXPECT_EQ(RoundUp({1.0, -0x1p-60}), 1.f);
}

TEST(OutwardKnownTest, BothZerosHaveTheSameNeighbours) {
  for (double zero : {0.0, -0.0}) {
    EXPECT_EQ(RoundDown({zero, 0.0}), 0.f);
    EXPECT_EQ(RoundUp({zero, 0.0}), 0.f);
    EXPECT_EQ(RoundDown({zero, -0x1p-200}), -0x1p-149f);
    EXPECT_EQ(RoundUp({zero, 0x1p-200}), 0x1p-149f);
  }
}

// Of products from 2^-2148 on, some of which cancel, and of numbers near
// floats.
TEST(ExactTermsTest, ProductsOfDoublesAreExact) {
  testing::Random random(6);
  std::size_t tiny = 0;
  for (std::size_t i = 0; i < testing::Scaled(100'000); ++i) {
    ExactTerms<double, 4, 2> terms;
    mpq_class exact = 0;
    const auto number = [&](int least, int most) {
      const int exponent = testing::RandomExponent(least, most, random);
      return std::ldexp(
          testing::WithMoreBits(
              testing::RandomSign(random) * testing::RandomMantissa(random),
              random),
          exponent);
    };
    // From one line on, or around the smallest double and its half.
    const int range = testing::OneIn(2, random) ? 1074 : 530;
    for (int p = 0; p < 2; ++p) {
      double a = number(-range, p == 0 ? 40 : -500);
      double b = number(-range, p == 0 ? 40 : -500);
      terms.AddProduct(a, b);
      exact += Exact(a) * Exact(b);
      tiny += std::fabs(a * b) < 0x1p-900;
      // Its opposite, by other factors, or nearly.
      a = std::ldexp(a, a < 0x1p-500 ? 3 : -3);
      b = std::ldexp(-b, a < 0x1p-500 ? -3 : 3);
      if (testing::OneIn(3, random)) b = std::nextafter(b, 1.0);
      terms.AddProduct(a, b);
      exact += Exact(a) * Exact(b);
    }
    for (int n = 0; n < 2; ++n) {
      double x = testing::OneIn(2, random) ? number(-1074, 40) : 1.0;
      if (testing::OneIn(4, random)) x = 0x1p-1074;
      if (testing::OneIn(4, random)) x = 0.0;
      terms.Add(x);
      exact += Exact(x);
    }
    for (const ExactSum& sum : {terms.Sum(), terms.SumToRound()}) {
      ASSERT_TRUE(IsTightestBelow(RoundDown(sum), exact)) << i;
      ASSERT_TRUE(IsTightestAbove(RoundUp(sum), exact)) << i;
    }
    const ExactSum sum = terms.Sum();
    ASSERT_EQ(sgn(exact), sum.value != 0.0
                              ? (sum.value > 0.0 ? 1 : -1)
                              : (sum.rest > 0.0) - (sum.rest < 0.0))
        << i;
  }
  EXPECT_GT(tiny, testing::Scaled(100'000) / 10);
}

// Halves of the smallest double add up to it, and what is left counts.
TEST(ExactTermsTest, WhatIsLeftOfTinyProductsCounts) {
  for (double left : {0x1p-1000, -0x1p-1000}) {
    ExactTerms<double, 3, 1> terms;
    terms.AddProduct(0x1p-537, 0x1p-538);
    terms.AddProduct(0x1p-538, 0x1p-537);
    terms.AddProduct(left, 0x1p-1000);
    terms.Add(-0x1p-1074);
    EXPECT_EQ(RoundUp(terms.Sum()), left > 0.0 ? 0x1p-149f : 0.f);
    EXPECT_EQ(RoundDown(terms.SumToRound()), left > 0.0 ? 0.f : -0x1p-149f);
  }
}

}  // namespace
}  // namespace halfspace::dispatch

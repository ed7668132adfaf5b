// Exact sums of products of doubles that are next to nothing, and their
// rounding, against GMP: shapes in fit_test.cc have too few of them.
#include "dispatch/exact/outward.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>

#include "dispatch/exact/exact_terms.h"
#include "tests/library/fit/random_shapes.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/exact.h"

namespace halfspace::dispatch {
namespace {

using testing::Exact;

// Of products from 2^-2148 on, some of which cancel, and of numbers near
// floats.
TEST(ExactTermsTest, ProductsOfDoublesAreExact) {
  testing::Random random(6);
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
      ASSERT_TRUE(testing::IsBelow(RoundDown(sum), exact, 0)) << i;
      ASSERT_TRUE(testing::IsAbove(RoundUp(sum), exact, 0)) << i;
    }
  }
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

// The exact sums and their rounding, against GMP.
#include "kernels/exact/outward.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <type_traits>

#include "tests/library/support/environment.h"
#include "tests/library/support/exact.h"
#include "tests/library/support/points.h"

namespace halfspace::kernels {
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
      const auto point = testing::RandomPoint<kTerms>(kind, random);
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

}  // namespace
}  // namespace halfspace::kernels

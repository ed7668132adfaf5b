// The builders' bounds against the exact extremes of what they bound.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "halfspace/fit.h"
#include "tests/library/dims.h"
#include "tests/library/environment.h"
#include "tests/library/exact.h"
#include "tests/library/points.h"

namespace halfspace::testing {
namespace {

template <typename Dims>
class FitExactTest : public ::testing::Test {
 protected:
  using Point = std::array<float, Dims::value>;

  static mpz_class ExactD(const Point& point) { return -ExactSumOf(point); }

  static Point PointOf(PointKind kind, Random& random) {
    return RandomPoint<std::size_t{Dims::value}>(kind, random);
  }

  // Coordinates copied, D as tight as floats can be around the exact values.
  static void ExpectTightest(const Aabo<Dims::value>& bound, const Point& low,
                             const Point& high, const mpz_class& low_d,
                             const mpz_class& high_d) {
    for (int k = 0; k < Dims::value; ++k) {
      ASSERT_EQ(bound.min[k], low[k]);
      ASSERT_EQ(bound.max[k], high[k]);
    }
    ASSERT_TRUE(IsTightestBelow(bound.min[Dims::value], low_d));
    ASSERT_TRUE(IsTightestAbove(bound.max[Dims::value], high_d));
  }
};

TYPED_TEST_SUITE(FitExactTest, AllDims, DimsNames);

TYPED_TEST(FitExactTest, BoundPointsIsTightest) {
  constexpr int kDims = TypeParam::value;
  Random random(6);
  std::vector<typename TestFixture::Point> points;
  for (PointKind kind : kPointKinds) {
    SCOPED_TRACE(NameOf(kind));
    for (std::size_t i = 0; i < Scaled(50'000); ++i) {
      points.resize(1 + random() % 4);
      for (auto& point : points) point = this->PointOf(kind, random);
      auto low = points.front();
      auto high = points.front();
      mpz_class low_d = this->ExactD(points.front());
      mpz_class high_d = low_d;
      for (const auto& point : points) {
        for (std::size_t k = 0; k < point.size(); ++k) {
          low[k] = std::min(low[k], point[k]);
          high[k] = std::max(high[k], point[k]);
        }
        const mpz_class d = this->ExactD(point);
        if (d < low_d) low_d = d;
        if (d > high_d) high_d = d;
      }
      const Aabo<kDims> bound =
          BoundPoints<kDims>({points.front().data(), points.size()});
      this->ExpectTightest(bound, low, high, low_d, high_d);
      if (this->HasFatalFailure()) return;
    }
  }
}

// The corner with all maxima has the least D, that with all minima the most.
TYPED_TEST(FitExactTest, BoundAabbIsTightest) {
  constexpr int kDims = TypeParam::value;
  Random random(7);
  for (PointKind kind : kPointKinds) {
    SCOPED_TRACE(NameOf(kind));
    for (std::size_t i = 0; i < Scaled(50'000); ++i) {
      auto low = this->PointOf(kind, random);
      auto high = this->PointOf(kind, random);
      for (std::size_t k = 0; k < low.size(); ++k) {
        if (low[k] > high[k]) std::swap(low[k], high[k]);
      }
      const Aabo<kDims> bound = BoundAabb<kDims>({low, high});
      this->ExpectTightest(bound, low, high, this->ExactD(high),
                           this->ExactD(low));
      if (this->HasFatalFailure()) return;
    }
  }
}

}  // namespace
}  // namespace halfspace::testing

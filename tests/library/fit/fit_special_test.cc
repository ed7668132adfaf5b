// Shapes and bounds that floats cannot bound become Everything() or an error,
// and are counted. Nothing becomes Empty().
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "halfspace/fit.h"
#include "tests/library/fit/builders.h"
#include "tests/library/fit/exact_answers.h"
#include "tests/library/support/special_values.h"

namespace halfspace::testing {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

class FitSpecialTest : public ::testing::TestWithParam<Builder> {
 protected:
  // Of a box or a bound: this for minima, and its opposite for maxima.
  static Shape ShapeOf(double minimum) {
    Shape shape = ShapeOfOnes(GetParam());
    for (std::size_t i = 0; i < GetParam().roles.size(); ++i) {
      const Role role = BoundRole(i);
      if (role == Role::kMinimum) shape.Set(i, minimum);
      if (role == Role::kMaximum) shape.Set(i, -minimum);
    }
    return shape;
  }

  // The other bound of Merge() has roles too.
  static Role BoundRole(std::size_t i) {
    const Builder& builder = GetParam();
    const bool is_merge =
        builder.kind == Kind::kChange && builder.change == Change::kMerge;
    return builder.roles[is_merge ? i % builder.first_argument() : i];
  }

  // What engines initialise boxes to.
  static double Untouched() {
    return GetParam().is_double ? std::numeric_limits<double>::max()
                                : std::numeric_limits<float>::max();
  }

  static void ExpectAll(const Shape& shape, const Planes& expected,
                        std::size_t everything) {
    FitStatus status;
    EXPECT_EQ(GetParam().Build(shape, &status), expected);
    EXPECT_EQ(status.results, GetParam().results());
    EXPECT_EQ(status.everything, everything);
  }
};

// Special values, and those around what can be bounded, as each number.
TEST_P(FitSpecialTest, NumbersThatCannotBeBounded) {
  const Builder& builder = GetParam();
  const bool moves_vertices = builder.kind == Kind::kChange &&
                              builder.change == Change::kTranslateVertices;
  for (std::size_t i = 0; i < builder.roles.size(); ++i) {
    std::vector<double> values = {0x1p125, 0x1.00002p125, 0x1p126,
                                  0x1.000002p126, 1e37};
    if (builder.IsDouble(i)) {
      values.insert(values.end(), kSpecialValues<double>.begin(),
                    kSpecialValues<double>.end());
    } else {
      values.insert(values.end(), kSpecialValues<float>.begin(),
                    kSpecialValues<float>.end());
    }
    for (double value : values) {
      for (double sign : {1.0, -1.0}) {
        Shape shape = ShapeOfOnes(builder);
        if (moves_vertices && std::isfinite(value)) continue;
        shape.Set(i, sign * value);
        ASSERT_TRUE(IsExact(builder, shape))
            << sign * value << " as number " << i;
      }
    }
  }
}

TEST_P(FitSpecialTest, EmptyAndEverythingStay) {
  const Builder& builder = GetParam();
  if (std::find(builder.roles.begin(), builder.roles.end(), Role::kMinimum) ==
          builder.roles.end() &&
      builder.part != Part::kDown) {
    return;
  }
  for (double minimum : {kInfinity, Untouched()}) {
    ExpectAll(ShapeOf(minimum), builder.Empty(), 0);
    // Of nothing there is nothing to change.
    Shape shape = ShapeOf(minimum);
    if (builder.kind != Kind::kChange || builder.change == Change::kMerge) {
      continue;
    }
    for (std::size_t i = builder.first_argument(); i < builder.roles.size();
         ++i) {
      shape.Set(i, kInfinity);
    }
    ExpectAll(shape, builder.Empty(), 0);
  }
  ExpectAll(ShapeOf(-Untouched()), builder.Everything(), 1);
}

INSTANTIATE_TEST_SUITE_P(, FitSpecialTest,
                         ::testing::ValuesIn(BuildersAndChanges()),
                         BuilderNames());

// Calls, how many of them gave Everything(), and which was the first of those.
using Counts = std::array<std::size_t, 3>;
Counts CountsOf(const FitStatus& status) {
  return {status.results, status.everything, status.first_everything};
}

TEST(FitLimitTest, StatusCountsCallsAndNamesTheFirst) {
  const Aabb3 box{{0, 0, 0}, {1, 1, 1}};
  FitStatus status;
  BoundPoint<3>({1, 1, 1}, &status);
  BoundAabb(box, &status);
  EXPECT_EQ(CountsOf(status), (Counts{2, 0, 0}));
  BoundPoint<3>({1, detail::kInf<float>, 1}, &status);
  BoundPoint<3>({1, 1, 1}, &status);
  BoundAabb(Aabb3::Everything(), &status);
  EXPECT_EQ(CountsOf(status), (Counts{5, 2, 2}));
}

TEST(FitLimitTest, NoPoints) {
  FitStatus status;
  const float unread = detail::kInf<float>;
  EXPECT_EQ(BoundPoints<3>({nullptr, 0}, &status), Aabo3::Empty());
  EXPECT_EQ(BoundPoints(PointsSoa3{}, &status), Aabo3::Empty());
  EXPECT_EQ(BoundPoints(Points<3, double>{}, &status), Aabo3::Empty());
  EXPECT_EQ(BoundPoints(Points3{&unread, 7}, {}, &status), Aabo3::Empty());
  EXPECT_EQ(BoundPoints(PointsSoa3{{}, 7}, {}, &status), Aabo3::Empty());
  EXPECT_EQ(BoundTransformed(Points3{}, Affine3{}, &status), Aabo3::Empty());
  BoundSegmentPieces(Segment3{}, {}, &status);
  EXPECT_EQ(CountsOf(status), (Counts{6, 0, 0}));
}

// The naive sum of 2e38, 2e38 and -3e38 overflows, or is a NaN.
TEST(FitLimitTest, SumOfMagnitudesIsWhatIsLimited) {
  const Aabo3 bound = BoundPoint<3>({0x1p124f, -0x1p124f, 0});
  EXPECT_EQ(bound.min[3], 0.f);
  EXPECT_EQ(bound.max[3], 0.f);
  // Two ulps: the sum is taken in the precision of the input, and rounds.
  EXPECT_EQ(BoundPoint<3>({0x1p124f, -0x1.000004p124f, 0}),
            Aabo3::Everything());
  EXPECT_EQ(BoundPoint<3>({2e38f, -2e38f, 0}), Aabo3::Everything());
  // What is not told from the products: it may come to anything.
  Affine<3, double> map{};
  map.linear[0][0] = std::nextafter(0x1p900, kInfinity);
  EXPECT_EQ(BoundTransformed(Aabb3{}, map), Aabo3::Everything());
}

// Infinitely far along no direction, as many times as one likes of nothing: no
// number says what that is.
TEST(FitLimitTest, InfinityTimesZero) {
  constexpr float kInf = detail::kInf<float>;
  EXPECT_EQ(BoundRay<3>({{}, {}, kInf}), Aabo3::Everything());
  EXPECT_EQ(BoundOrientedBox(OrientedBox3{{}, {}, {kInf, 0, 0}}),
            Aabo3::Everything());
  Affine3 map{};
  map.linear[0][0] = kInf;
  const Point3 origin{};
  EXPECT_EQ(BoundTransformed(Points3{origin.data(), 1}, map),
            Aabo3::Everything());
  EXPECT_EQ(BoundTransformed(Aabb3{}, map), Aabo3::Everything());
}

// Although every piece but the last one would be small enough.
TEST(FitLimitTest, OfEachPieceIsThatOfTheSegment) {
  std::array<Aabo3, 4> pieces;
  for (const float far : {0x1p125f, 0x1.000002p125f}) {
    for (const Segment3& segment :
         {Segment3{{0, 0, 0}, {0, 0, far}}, Segment3{{0, 0, far}, {0, 0, 0}}}) {
      FitStatus status;
      BoundSegmentPieces(segment, pieces, &status);
      EXPECT_EQ(CountsOf(status), (Counts{4, far == 0x1p125f ? 0u : 4u, 0u}));
    }
  }
}

// The largest values in a plane are bounded, and one float farther they are
// not. A plane without a bound keeps to itself.
TEST_P(FitSpecialTest, PlanesOfBoundsAtTheLimit) {
  const Builder& builder = GetParam();
  if (builder.kind != Kind::kChange) return;
  for (std::size_t p = 0; p < builder.first_argument(); ++p) {
    const double sign = builder.roles[p] == Role::kMinimum ? -1 : 1;
    for (double limit : {0x1p126, double{std::numeric_limits<float>::max()}}) {
      Shape shape;
      shape.Set(p, sign * limit);
      const std::size_t argument = builder.first_argument();
      if (builder.change == Change::kScale) shape.Set(argument, 1);
      if (builder.change >= Change::kTranslateVertices &&
          builder.change != Change::kScale &&
          builder.change != Change::kSweep) {
        // Other planes give way, or are farther than the limit.
        if (limit == 0x1p126) continue;
        EXPECT_NE(builder.Build(shape), builder.Everything()) << p;
        continue;
      }
      Planes expected{};
      expected[p] = static_cast<float>(sign * limit);
      EXPECT_EQ(builder.Build(shape), expected) << p << ", " << limit;
      if (builder.change == Change::kScale) shape.Set(argument, 0x1.000002p0);
      if (builder.change == Change::kInflate ||
          builder.change == Change::kInflateByBox) {
        shape.Set(argument, 0x1p103);
      }
      if (shape.doubles[argument] == 0 || limit != 0x1p126) continue;
      EXPECT_EQ(builder.Build(shape), builder.Everything()) << p;
    }
  }
}

}  // namespace
}  // namespace halfspace::testing

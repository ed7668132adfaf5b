// Every builder, and every change of a bound: random and special numbers
// against exact arithmetic, in every floating-point mode; and hard cases by
// hand.
#include "halfspace/fit.h"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <vector>

#include "tests/library/fit/builders.h"
#include "tests/library/fit/exact_answers.h"
#include "tests/library/fit/exact_shapes.h"
#include "tests/library/fit/random_shapes.h"
#include "tests/library/support/fp_modes.h"
#include "tests/library/support/special_values.h"

namespace halfspace::testing {
namespace {

// The outcome is exact, and the same in every floating-point mode of the
// caller.
void ExpectExact(const Builder& builder, const Shape& shape) {
  const Outcome outcome = Try(builder, shape);
  ASSERT_TRUE(IsExact(builder, shape, outcome));
  for (FpMode mode : kFpModes) {
    Outcome again;
    RunIn(mode, [&] { again = Try(builder, shape); });
    ASSERT_TRUE(again.is_refused == outcome.is_refused &&
                SameBits(again.planes, outcome.planes))
        << "mode " << static_cast<int>(mode);
  }
}

class FitExactTest : public ::testing::TestWithParam<Builder> {};

TEST_P(FitExactTest, EnclosesAndIsAsTightAsPromised) {
  const Builder& builder = GetParam();
  const bool is_round =
      builder.kind == Kind::kSphere || builder.kind == Kind::kCapsule;
  ForEachSample(20, is_round ? 1000 : 200, [&](PointKind kind, Random& random) {
    Shape shape = RandomShape(builder, kind, random);
    if (OneIn(4, random)) Spoil(builder, shape, random);
    ExpectExact(builder, shape);
  });
}

bool MovesVertices(const Builder& builder) {
  return builder.kind == Kind::kChange &&
         builder.change == Change::kTranslateVertices;
}

std::vector<Builder> AllButVertices() {
  std::vector<Builder> builders = BuildersAndChanges();
  std::erase_if(builders, MovesVertices);
  return builders;
}
INSTANTIATE_TEST_SUITE_P(, FitExactTest, ::testing::ValuesIn(AllButVertices()),
                         ::testing::PrintToStringParamName());

class TranslateVerticesTest : public ::testing::TestWithParam<Builder> {};

// Against vertices that are really moved, and rounded.
TEST_P(TranslateVerticesTest, EnclosesMovedVertices) {
  const Builder& builder = GetParam();
  const Builder& points = BuilderOf(Kind::kTriangle, builder.dims);
  const std::size_t first = builder.first_argument();
  ForEachSample(60, 300, [&](PointKind kind, Random& random) {
    const Shape vertices = RandomShape(points, kind, random);
    Shape shape = RandomShape(builder, kind, random);
    for (std::size_t k = 0; k < builder.dims; ++k) {
      if (kind == PointKind::kCancelling) {
        shape.Set(first + k, shape.floats[first + k] + vertices.floats[k]);
      }
    }
    SetPlanesOfVertices(builder, vertices, shape);
    ASSERT_TRUE(
        EnclosesMovedVertices(builder, vertices, shape, Try(builder, shape)));
  });
}

TEST_P(TranslateVerticesTest, PlanesWithoutABoundStaySo) {
  const Builder& builder = GetParam();
  ForEachSample(61, 100, [&](PointKind kind, Random& random) {
    const Shape shape = RandomShape(builder, kind, random);
    const Planes moved = builder.Build(shape);
    for (std::size_t p = 0; p < builder.first_argument(); ++p) {
      const float plane = shape.floats[p];
      if (std::fabs(plane) == std::numeric_limits<float>::max()) {
        ASSERT_EQ(moved[p], plane);
      }
    }
  });
}

std::vector<Builder> VertexChanges() {
  std::vector<Builder> changes = Changes();
  std::erase_if(changes, [](const Builder& b) { return !MovesVertices(b); });
  return changes;
}
INSTANTIATE_TEST_SUITE_P(, TranslateVerticesTest,
                         ::testing::ValuesIn(VertexChanges()),
                         ::testing::PrintToStringParamName());

// Neighbours both have the point where they meet, and nothing is left out.
TEST(FitPiecesExactTest, ManyPieces) {
  for (bool is_double : {false, true}) {
    const Builder& builder = BuilderOf(Kind::kPieces, 3, is_double);
    ForEachSample(36, 20, [&](PointKind kind, Random& random) {
      const Shape shape = RandomShape(builder, kind, random);
      std::vector<Aabo3> pieces(1 + random() % 1000);
      Segment3 segment;
      Segment<3, double> wide;
      std::memcpy(&segment, shape.floats.data(), sizeof(segment));
      std::memcpy(&wide, shape.doubles.data(), sizeof(wide));
      is_double ? BoundSegmentPieces(wide, pieces)
                : BoundSegmentPieces(segment, pieces);
      for (std::size_t i = 0; i < pieces.size(); ++i) {
        ASSERT_TRUE(HullOf(builder, shape, i, pieces.size())
                        .IsEnclosedBy(pieces[i].min.data(), kWithinOneUlp))
            << i << " of " << pieces.size();
      }
    });
  }
}

// Shapes and bounds that floats cannot bound become Everything() or an error,
// and are counted.

class FitSpecialTest : public ::testing::TestWithParam<Builder> {};

// Special values, and those around what can be bounded, as each number; the
// others are one or zero. (Infinity times zero can be anything.)
TEST_P(FitSpecialTest, NumbersThatCannotBeBounded) {
  const Builder& builder = GetParam();
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
        if (MovesVertices(builder) && std::isfinite(value)) continue;
        for (Shape shape : {ShapeOfOnes(builder), Shape()}) {
          SCOPED_TRACE(::testing::Message()
                       << sign * value << " as number " << i);
          shape.Set(i, sign * value);
          ExpectExact(builder, shape);
          if (HasFatalFailure()) return;
        }
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(, FitSpecialTest,
                         ::testing::ValuesIn(BuildersAndChanges()),
                         ::testing::PrintToStringParamName());

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

// Frusta that are hard for BoundFrustum(), by hand. FitExactTest compares
// random ones with their exact corners.

// |p y + z| <= 1 and |y + s z| <= 1, where p s - 1 = -2^-46: a needle, from
// y = -(s + 1) 2^46 to +(s + 1) 2^46 and z = -(p + 1) 2^46 to +(p + 1) 2^46.
// Its determinants are u times -2^-46, the difference of products that take
// more bits than a double has. 0 <= x <= 1, so that D goes from -2^24 - 1 to
// 2^24, of which the first is no float.
TEST(FitFrustumHardTest, NeedleFromProductsThatDoubleCannotHold) {
  constexpr float p = 0x1.000002p0f;
  constexpr float s = 0x1.fffffcp-1f;
  for (std::uint32_t mantissa = 1; mantissa < 0x800000; mantissa += 65'538) {
    const auto u = std::bit_cast<float>(0x3f800000 | mantissa);
    const SixPlanes needle = {{{{u, 0, 0}, 0},
                               {{-u, 0, 0}, u},
                               {{0, p, 1}, 1},
                               {{0, -p, -1}, 1},
                               {{0, 1, s}, 1},
                               {{0, -1, -s}, 1}}};
    const Aabo3 bound = BoundFrustum(needle);
    EXPECT_EQ(bound.min, (std::array{0.f, -0x1.fffffep46f, -0x1.000002p47f,
                                     -0x1.000002p24f}))
        << u;
    EXPECT_EQ(bound.max,
              (std::array{1.f, 0x1.fffffep46f, 0x1.000002p47f, 0x1p24f}))
        << u;
  }
}

// The planes x - 2^-24 y = 65/64 and 2^-24 x + y = 2^-24 meet at
// x = 65/64 - 2^-6 / (2^48 + 1), which double rounds to 65/64. They are ordered
// so that all determinants of that edge have one sign, then the other.
TEST(FitFrustumHardTest, CornersThatDoubleRoundsToAFloat) {
  constexpr HalfSpace3 left = {{1, -0x1p-24f, 0}, -65.f / 64};
  constexpr HalfSpace3 below = {{0x1p-24f, 1, 0}, -0x1p-24f};
  constexpr HalfSpace3 near = {{0, 0, 1}, 0};
  constexpr HalfSpace3 far = {{0, 0, -1}, 1};
  constexpr HalfSpace3 right = {{-1, 0x1p-24f, 0}, 3};
  constexpr HalfSpace3 above = {{-0x1p-24f, -1, 0}, 1};
  for (const SixPlanes& planes :
       {SixPlanes{left, far, below, near, right, above},
        SixPlanes{below, far, left, near, right, above}}) {
    EXPECT_EQ(BoundFrustum(planes).min[0], 0x1.03fffep0f);
  }
}

// 0 <= z <= 1, -1 <= y <= 2 and 1 <= x <= 1 - 2^-60 y, which is 1 to a double:
// what is above y = 0 is in front of all but one plane, and not of that.
TEST(FitFrustumHardTest, CornersBehindAPlaneByLessThanDoubleCanTell) {
  SixPlanes planes = {{{{1, 0, 0}, -1},
                       {{-1, -0x1p-60f, 0}, 1},
                       {{0, 1, 0}, 1},
                       {{0, -1, 0}, 2},
                       {{0, 0, 1}, 0},
                       {{0, 0, -1}, 1}}};
  const Aabo3 bound = BoundFrustum(planes);
  EXPECT_EQ(bound.min[1], -1.f);
  EXPECT_EQ(bound.max[1], 0.f);
  // Above y = 0x1p-149 there is nothing.
  planes[2].offset = -0x1p-149f;
  EXPECT_EQ(BoundFrustum(planes), Aabo3::Empty());
}

TEST(FitFrustumHardTest, DoublesFarApart) {
  std::array<HalfSpace<3, double>, 6> cube{};
  for (std::size_t i = 0; i < 6; ++i) {
    cube[i].normal[i / 2] = i % 2 == 0 ? 1 : -1;
    cube[i].offset = 1;
  }
  EXPECT_EQ(BoundFrustum(cube).max[0], 1.f);
  // So long a normal, so short a normal.
  cube[1] = {{-0x1p1023, 0, 0}, 0x1p1023};
  cube[2] = {{0, 0x1p-1074, 0}, 0x1p-1074};
  EXPECT_EQ(BoundFrustum(cube).max[0], 1.f);
  EXPECT_EQ(BoundFrustum(cube).min[1], -1.f);
  cube[1] = {{-1, 0x1p-200, 0}, 1};
  EXPECT_EQ(BoundFrustum(cube).max[0], 0x1.000002p0f);
  cube[1].normal[1] = 0x1p-201;
  EXPECT_EQ(BoundFrustum(cube), Aabo3::Everything());
  cube[1] = {{-1, 0, 0}, 0x1p201};
  EXPECT_EQ(BoundFrustum(cube), Aabo3::Everything());
  // In front of it everywhere, and behind it everywhere.
  cube[1] = {{-1, 0, 0}, 1};
  cube[0].offset = -0x1p-200;
  EXPECT_EQ(BoundFrustum(cube).min[0], 0.f);
}

// The wrappers of the calls above.
TEST(FitKnownTest, OnePointAndStrideZero) {
  const Aabo3 bound{{1, 2, 3, -6}, {1, 2, 3, -6}};
  const Point3 point = {1, 2, 3};
  EXPECT_EQ(BoundPoint<3>(point), bound);
  EXPECT_EQ(BoundPoints(Points3{point.data(), 50, 0}), bound);
  EXPECT_EQ((BoundPoint<3, double>({1, 2, 3})), bound);
}

}  // namespace
}  // namespace halfspace::testing

// Every builder, and every change of a bound: random and special numbers
// against exact arithmetic, and cases by hand.
#include "halfspace/fit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "tests/library/fit/builders.h"
#include "tests/library/fit/exact_answers.h"
#include "tests/library/fit/exact_frustum.h"
#include "tests/library/fit/exact_shapes.h"
#include "tests/library/fit/random_shapes.h"
#include "tests/library/support/special_values.h"

namespace halfspace::testing {
namespace {

class FitExactTest : public ::testing::TestWithParam<Builder> {};

TEST_P(FitExactTest, EnclosesAndIsAsTightAsPromised) {
  const Builder& builder = GetParam();
  const bool is_round =
      builder.kind == Kind::kSphere || builder.kind == Kind::kCapsule;
  ForEachSample(20, is_round ? 1000 : 200, builder.results(),
                [&](PointKind kind, Random& random) {
                  Shape shape = RandomShape(builder, kind, random);
                  if (OneIn(4, random)) Spoil(builder, shape, random);
                  ASSERT_TRUE(IsExact(builder, shape));
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
                         BuilderNames());

class TranslateVerticesTest : public ::testing::TestWithParam<Builder> {};

// Against vertices that are really moved, and rounded.
TEST_P(TranslateVerticesTest, EnclosesMovedVertices) {
  const Builder& builder = GetParam();
  const Builder& points = BuilderOf(Kind::kTriangle, builder.dims);
  const std::size_t first = builder.first_argument();
  std::size_t exact_moves_that_cut = 0;
  ForEachSample(60, 300, 1, [&](PointKind kind, Random& random) {
    const Shape vertices = RandomShape(points, kind, random);
    Shape shape = RandomShape(builder, kind, random);
    for (std::size_t k = 0; k < builder.dims; ++k) {
      if (kind == PointKind::kCancelling) {
        shape.Set(first + k, shape.floats[first + k] + vertices.floats[k]);
      }
    }
    SetPlanesOfVertices(builder, vertices, shape);
    bool cuts = false;
    ASSERT_TRUE(EnclosesMovedVertices(builder, vertices, shape,
                                      Try(builder, shape), &cuts));
    exact_moves_that_cut += cuts ? 1 : 0;
  });
  // Otherwise the other call would do.
  EXPECT_TRUE(builder.part == Part::kAabb || exact_moves_that_cut > 0);
}

TEST_P(TranslateVerticesTest, PlanesWithoutABoundStaySo) {
  const Builder& builder = GetParam();
  ForEachSample(61, 100, 1, [&](PointKind kind, Random& random) {
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
                         ::testing::ValuesIn(VertexChanges()), BuilderNames());

// Neighbours both have the point where they meet, and nothing is left out.
TEST(FitPiecesExactTest, ManyPieces) {
  for (bool is_double : {false, true}) {
    const Builder& builder = BuilderOf(Kind::kPieces, 3, is_double);
    ForEachSample(36, 20, 1000, [&](PointKind kind, Random& random) {
      const Shape shape = RandomShape(builder, kind, random);
      const ExactNumbers numbers(builder, shape);
      std::vector<Aabo3> pieces(1 + random() % 1000);
      Segment3 segment;
      Segment<3, double> wide;
      for (std::size_t k = 0; k < 3; ++k) {
        segment.a[k] = shape.floats[k];
        segment.b[k] = shape.floats[k + 3];
        wide.a[k] = shape.doubles[k];
        wide.b[k] = shape.doubles[k + 3];
      }
      is_double ? BoundSegmentPieces(wide, pieces)
                : BoundSegmentPieces(segment, pieces);
      for (std::size_t i = 0; i < pieces.size(); ++i) {
        ExactHull hull(3);
        for (std::size_t end : {i, i + 1}) {
          const mpq_class share = mpq_class(end) / mpq_class(pieces.size());
          ExactPoint point;
          for (std::size_t k = 0; k < 3; ++k) {
            point.push_back(numbers[k] + share * (numbers[k + 3] - numbers[k]));
          }
          hull.AddPoint(point);
        }
        ASSERT_TRUE(hull.IsEnclosedBy(pieces[i].min.data(), kWithinOneUlp))
            << i << " of " << pieces.size();
      }
    });
  }
}

// Shapes and bounds that floats cannot bound become Everything() or an error,
// and are counted. Nothing becomes Empty().

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

// By one float: the planes' sum is exact.
TEST_P(FitSpecialTest, SimplexWithoutAPoint) {
  const Builder& builder = GetParam();
  if (builder.change != Change::kCircumscribe) return;
  const double sign = builder.part == Part::kUp ? 1 : -1;
  Shape shape;
  for (std::size_t k = 0; k < builder.dims; ++k) shape.Set(k, sign);
  shape.Set(builder.dims, -sign * static_cast<double>(builder.dims));
  EXPECT_FALSE(Try(builder, shape).is_refused);
  shape.Set(0, sign * (1 + 0x1p-23));
  EXPECT_TRUE(Try(builder, shape).is_refused);
  EXPECT_TRUE(IsExact(builder, shape));
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

// Frusta that are hard for BoundFrustum(), by hand. FitExactTest compares
// random ones with their exact corners.

// The random ones are of each kind. Doubles have the bound of the same floats,
// or none, as they may be too far apart.
TEST(FitFrustumTest, RandomOnesAreOpenEmptyAndClosed) {
  std::array<std::size_t, 3> counts{};
  const Builder& of_floats = BuilderOf(Kind::kFrustum, 3);
  const Builder& of_doubles = BuilderOf(Kind::kFrustum, 3, true);
  ForEachSample(43, 200, 1, [&](PointKind kind, Random& random) {
    const SixPlanes planes = RandomFrustum(kind, random);
    const ExactFrustum exact(planes);
    ++counts[exact.IsOpen() ? 0 : exact.IsEmpty() ? 1 : 2];
    const Shape shape = ShapeOf(planes, false, random);
    const Planes bound = of_doubles.Build(shape);
    ASSERT_TRUE(bound == of_doubles.Everything() ||
                bound == of_floats.Build(shape));
  });
  for (std::size_t count : counts) EXPECT_GE(count, Scaled(20));
}

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

// Bounds by hand: small whole numbers, whose sums are exact.

struct Known {
  const char* why;
  const char* builder;          // a name of builders.h
  std::vector<double> numbers;  // of the shape
  std::vector<float> planes;    // minima, then maxima
};

const std::vector<Known> kKnown = {
    {"-(1 + 2) = -3 and -(4 - 5) = 1",
     "BoundPoints2",
     {1, 2, 4, -5, 4, -5},
     {1, -5, -3, 4, 2, 1}},
    {"-(4 + 5 + 6), -(1 + 2 + 3)",
     "BoundAabb3",
     {1, 2, 3, 4, 5, 6},
     {1, 2, 3, -15, 4, 5, 6, -6}},
    // A double cannot hold the sum, so these also show that the library's own
    // flags left the error-free additions alone.
    {"-(1 + 2^-60) lies between -1 and the float below",
     "BoundSegment2",
     {1, 0x1p-60, 1, 0x1p-60},
     {1, 0x1p-60f, -0x1.000002p0f, 1, 0x1p-60f, -1}},
    {"1 + 2^-60 - 2^-60",
     "BoundSegment3",
     {1, 0x1p-60, -0x1p-60, 1, 0x1p-60, -0x1p-60},
     {1, 0x1p-60f, -0x1p-60f, -1, 1, 0x1p-60f, -0x1p-60f, -1}},
    {"the nearest double to 0.1 lies between two floats; -0.1 - 0.1 too",
     "BoundSphere2Double",
     {0.1, 0.1, 0},
     {0x1.999998p-4f, 0x1.999998p-4f, -0x1.99999ap-3f, 0x1.99999ap-4f,
      0x1.99999ap-4f, -0x1.999998p-3f}},
    {"a triangle",
     "BoundTriangle3",
     {0, 0, 0, 1, 0, 0, 0, 2, 0},
     {0, 0, 0, -2, 1, 2, 0, 0}},
    {"from (1, 1, 1) to (7, 1, -2)",
     "BoundRay3",
     {1, 1, 1, 2, 0, -1, 3},
     {1, 1, -2, -6, 7, 1, 1, -3}},
    {"piece i goes from (i, 2 i) to (i + 1, 2 i + 2)",
     "BoundSegmentPieces2",
     {0, 0, 3, 6},
     {0, 0, -3, 1, 2, 0, 1, 2, -6, 2, 4, -3, 2, 4, -9, 3, 6, -6}},
    {"arms of (3, 4) and (-8, 6): X reaches 3 + 8, Y 4 + 6, D 7 + 2",
     "BoundOrientedBox2",
     {10, 0, 3, 4, -4, 3, 1, 2},
     {-1, -10, -19, 21, 10, -1}},
    {"the square root of 4 is 2",
     "BoundSphere4",
     {1, 2, 3, 4, 2},
     {-1, 0, 1, 2, -14, 3, 4, 5, 6, -6}},
    {"the square root of 4 is 2",
     "BoundCapsule4",
     {0, 0, 0, 0, 4, 0, 0, 0, 1},
     {-1, -1, -1, -1, -6, 5, 1, 1, 1, 2}},
    {"-2 <= x <= z and so on, from an eye in the origin: the far end's corners "
     "are at (+-2, +-2, 2)",
     "BoundFrustum3",
     {1, 0,  1, 0, -1, 0, 1, 0,  0, 1, 1,  0,
      0, -1, 1, 0, 0,  0, 1, -1, 0, 0, -1, 2},
     {-2, -2, 1, -6, 2, 2, 2, 2}},
    {"x, y, z >= 0 and x + y + z <= 3",
     "BoundFrustum3",
     {1,  0,  0,  0, 0,  2,  0,  0, 0, 0, 3, 0,
      -1, -1, -1, 3, -2, -2, -2, 6, 0, 0, 1, 0},
     {0, 0, 0, -3, 3, 3, 3, 0}},
    {"(x, y) becomes (5 - 2 y, 7 + 3 x)",
     "BoundTransformed2PointsMap",
     {0, 0, 1, 0, 0, 1, 0, -2, 3, 0, 5, 7},
     {3, 7, -15, 5, 10, -10}},
    {"the square around it",
     "BoundTransformed2BoxMap",
     {0, 0, 2, 1, 0, -2, 3, 0, 5, 7},
     {3, 7, -18, 5, 13, -10}},

    // The box from (0, 0, 0) to (1, 2, 3), without a corner: x + y + z <= 5.
    {"D too",
     "Merge3Aabo",
     {0, 0, 0, -5, 1, 2, 3, 0, -1, 1, 1, -4, 0, 3, 2, -1},
     {-1, 0, 0, -5, 1, 3, 3, 0}},
    {"in 4 dimensions D moves by twice the radius",
     "Inflate4Aabo",
     {0, 0, 0, 0, -4, 1, 1, 1, 1, 0, 3},
     {-3, -3, -3, -3, -10, 4, 4, 4, 4, 6}},
    {"D moves by three times the margin",
     "InflateByBox3Aabo",
     {0, 0, 0, -5, 1, 2, 3, 0, 2},
     {-2, -2, -2, -11, 3, 4, 5, 6}},
    {"by (1, -2, 3)",
     "Translate3Aabo",
     {0, 0, 0, -5, 1, 2, 3, 0, 1, -2, 3},
     {1, -2, 3, -7, 2, 0, 6, -2}},
    {"1 + 2^-60 is no float",
     "Translate2Aabb",
     {1, 1, 1, 1, 0x1p-60, -0x1p-60},
     {1, 0x1.fffffep-1f, 0x1.000002p0f, 1}},
    {"twice",
     "Scale3Aabo",
     {0, 0, 0, -5, 1, 2, 3, 0, 2},
     {0, 0, 0, -10, 2, 4, 6, 0}},
    {"turned over",
     "Scale3Aabo",
     {0, 0, 0, -5, 1, 2, 3, 0, -1},
     {-1, -2, -3, 0, 0, 0, 0, 5}},
    {"D moves by -3",
     "Sweep3Aabo",
     {0, 0, 0, -5, 1, 2, 3, 0, 4, 0, -1},
     {0, 0, -1, -8, 5, 2, 3, 0}},
    {"x, y >= 0 and x + y <= 1 lies in x, y <= 1 and x + y >= 0",
     "Circumscribe2Up",
     {0, 0, -1},
     {1, 1, 0}},
    {"down", "Circumscribe3Down", {1, 1, 1, 0}, {-2, -2, -2, -3}},
};

TEST(FitKnownTest, Rows) {
  std::vector<Builder> builders = Builders({2, 3, 4});
  for (const Builder& change : Changes({2, 3, 4})) builders.push_back(change);
  for (const Known& known : kKnown) {
    SCOPED_TRACE(::testing::Message() << known.builder << ": " << known.why);
    const auto builder = std::find_if(
        builders.begin(), builders.end(),
        [&](const Builder& row) { return row.name == known.builder; });
    ASSERT_NE(builder, builders.end());
    ASSERT_EQ(known.numbers.size(), builder->roles.size());
    Shape shape;
    for (std::size_t i = 0; i < known.numbers.size(); ++i) {
      shape.Set(i, known.numbers[i]);
    }
    Planes expected{};
    std::copy(known.planes.begin(), known.planes.end(), expected.begin());
    EXPECT_EQ(builder->Build(shape), expected);
  }
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

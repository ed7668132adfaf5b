// BoundFrustum against the exact corners of what lies in front of the planes.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "halfspace/fit.h"
#include "tests/library/fit/exact_answers.h"
#include "tests/library/fit/exact_frustum.h"
#include "tests/library/fit/random_shapes.h"

namespace halfspace::testing {
namespace {

constexpr std::size_t kSamples = 40;

using SixPlanes = std::array<HalfSpace3, 6>;

float Dot(const Point3& a, const Point3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

Point3 Combined(float s, const Point3& a, float t, const Point3& b) {
  return {s * a[0] + t * b[0], s * a[1] + t * b[1], s * a[2] + t * b[2]};
}

Point3 RandomPoint3(PointKind kind, Random& random) {
  Point3 point;
  RandomFloats<float>(kind, random, point);
  return point;
}

float RandomLength(PointKind kind, Random& random) {
  return static_cast<float>(RandomNumbers(kind, false, random).Length());
}

Aabb3 RandomBox(PointKind kind, Random& random) {
  const Point3 a = RandomPoint3(kind, random);
  const Point3 b = RandomPoint3(kind, random);
  return BoundSegment(Segment3{a, b}).aabb();
}

// Small enough for products with any coordinate.
Point3 RandomNormal(PointKind kind, Random& random) {
  Point3 normal = RandomPoint3(kind, random);
  if (kind == PointKind::kWideExponents) {
    for (float& x : normal) x *= 0x1p-122f;
  }
  return normal;
}

// The plane through a point, or nearly: it is what its floats say.
HalfSpace3 PlaneThrough(const Point3& point, const Point3& normal) {
  return {normal, -Dot(normal, point)};
}

// Neither the order of the planes nor the lengths of the normals matter.
void Disguise(SixPlanes& planes, Random& random) {
  for (HalfSpace3& plane : planes) {
    const int exponent = RandomExponent(-20, 4, random);
    for (float& x : plane.normal) x = std::ldexp(x, exponent);
    plane.offset = std::ldexp(plane.offset, exponent);
  }
  std::shuffle(planes.begin(), planes.end(), random);
}

SixPlanes FacesOf(const Aabb3& box) {
  SixPlanes planes{};
  for (std::size_t k = 0; k < 3; ++k) {
    planes[k].normal[k] = 1.f;
    planes[k].offset = -box.min[k];
    planes[k + 3].normal[k] = -1.f;
    planes[k + 3].offset = box.max[k];
  }
  return planes;
}

using WidePlanes = std::array<HalfSpace<3, double>, 6>;

// Numbers beside those of the floats, and then any lengths of the normals.
WidePlanes Widened(const SixPlanes& planes, Random& random) {
  WidePlanes wide;
  for (std::size_t i = 0; i < planes.size(); ++i) {
    const int exponent = RandomExponent(-300, 300, random);
    const auto widened = [&](float value) {
      return std::ldexp(value == 0.f ? 0.0 : WithMoreBits(value, random),
                        exponent);
    };
    for (std::size_t k = 0; k < 3; ++k) {
      wide[i].normal[k] = widened(planes[i].normal[k]);
    }
    wide[i].offset = widened(planes[i].offset);
  }
  return wide;
}

template <typename AnyPlanes>
::testing::AssertionResult IsExactOf(const AnyPlanes& planes) {
  const Builder& builder =
      BuilderOf(Kind::kFrustum, 3, std::is_same_v<AnyPlanes, WidePlanes>);
  Shape shape;
  for (std::size_t i = 0; i < planes.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k)
      shape.Set(4 * i + k, planes[i].normal[k]);
    shape.Set(4 * i + 3, planes[i].offset);
  }
  return IsExact(builder, shape);
}

void ExpectExact(SixPlanes planes, Random& random) {
  Disguise(planes, random);
  ASSERT_TRUE(IsExactOf(planes));
  ASSERT_TRUE(IsExactOf(Widened(planes, random)));
  // The same numbers, as doubles.
  WidePlanes same;
  for (std::size_t i = 0; i < planes.size(); ++i) {
    std::copy(planes[i].normal.begin(), planes[i].normal.end(),
              same[i].normal.begin());
    same[i].offset = planes[i].offset;
  }
  ASSERT_TRUE(IsExactOf(same));
  // Doubles too far apart have no bound.
  const Aabo3 bound = BoundFrustum(same);
  if (bound != Aabo3::Everything()) {
    ASSERT_EQ(bound, BoundFrustum(planes));
  }
}

TEST(FitFrustumExactTest, Boxes) {
  ForEachSample(40, kSamples, 1, [](PointKind kind, Random& random) {
    ExpectExact(FacesOf(RandomBox(kind, random)), random);
  });
}

// Of three random directions, around a random point.
TEST(FitFrustumExactTest, Parallelepipeds) {
  ForEachSample(41, kSamples, 1, [](PointKind kind, Random& random) {
    const auto center = RandomPoint3(PointKind::kUniform, random);
    SixPlanes planes;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto normal = RandomNormal(kind, random);
      for (float side : {-1.f, 1.f}) {
        const Point3 face = Combined(side, normal, 0.f, normal);
        HalfSpace3& plane = planes[side < 0.f ? k : k + 3];
        plane = PlaneThrough(center, face);
        plane.offset += std::fabs(plane.offset) * RandomMantissa(random);
      }
    }
    ExpectExact(planes, random);
  });
}

// Four planes through an eye, and two across the view.
TEST(FitFrustumExactTest, Frusta) {
  ForEachSample(42, kSamples, 1, [](PointKind kind, Random& random) {
    const auto eye = RandomPoint3(
        kind == PointKind::kWideExponents ? PointKind::kUniform : kind, random);
    std::array<Point3, 3> view;  // right, up, forward
    for (auto& v : view) {
      v = RandomPoint3(PointKind::kUniform, random);
    }
    const auto [right, up, forward] = view;
    const float wide = RandomMantissa(random);
    const float high = RandomMantissa(random);
    const float near = RandomMantissa(random);
    const Point3 to = Combined(1.f, eye, near, forward);
    const Point3 end = Combined(1.f, eye, 2.f + near, forward);
    const SixPlanes planes = {
        PlaneThrough(eye, Combined(wide, forward, 1.f, right)),
        PlaneThrough(eye, Combined(wide, forward, -1.f, right)),
        PlaneThrough(eye, Combined(high, forward, 1.f, up)),
        PlaneThrough(eye, Combined(high, forward, -1.f, up)),
        PlaneThrough(to, forward),
        PlaneThrough(end, Combined(-1.f, forward, 0.f, up))};
    ExpectExact(planes, random);
  });
}

// About half of these are open; some are empty.
TEST(FitFrustumExactTest, RandomHalfSpaces) {
  std::size_t open = 0;
  std::size_t empty = 0;
  std::size_t closed = 0;
  ForEachSample(43, 2 * kSamples, 1, [&](PointKind kind, Random& random) {
    const auto inside = RandomPoint3(kind, random);
    const bool around = !OneIn(4, random);
    SixPlanes planes;
    for (HalfSpace3& plane : planes) {
      plane = PlaneThrough(inside, RandomNormal(kind, random));
      plane.offset += around ? std::fabs(plane.offset) : plane.offset;
    }
    const ExactFrustum exact(planes);
    ++(exact.IsOpen() ? open : exact.IsEmpty() ? empty : closed);
    ExpectExact(planes, random);
  });
  if (open + empty + closed >= 100) {
    EXPECT_GT(open, 0u);
    EXPECT_GT(empty, 0u);
    EXPECT_GT(closed, 0u);
  }
}

// A box without width, one face of which leans by less than doubles can tell:
// it is cut, or gone.
TEST(FitFrustumExactTest, BoxesThatAllButVanish) {
  ForEachSample(45, kSamples, 1, [](PointKind kind, Random& random) {
    auto box = RandomBox(kind, random);
    const std::size_t axis = random() % 3;
    box.max[axis] = box.min[axis];
    SixPlanes planes = FacesOf(box);
    for (std::size_t k = 0; k < 3; ++k) {
      if (k == axis) continue;
      planes[axis].normal[k] =
          RandomSign(random) *
          std::ldexp(1.f, RandomExponent(-70, -46, random));
    }
    ExpectExact(planes, random);
  });
}

// x, y, z >= the origin's and x + y + z <= something: a corner of a box.
TEST(FitFrustumExactTest, FourPlanesAndTwoMore) {
  ForEachSample(44, kSamples, 4, [](PointKind kind, Random& random) {
    const auto origin = RandomPoint3(kind, random);
    SixPlanes planes{};
    for (std::size_t k = 0; k < 3; ++k) {
      planes[k].normal[k] = 1.f;
      planes[k].offset = -origin[k];
      planes[3].normal[k] = -1.f;
    }
    planes[3].offset =
        -Dot(planes[3].normal, origin) + RandomLength(kind, random);
    // The same again; without a normal, and in front or on it everywhere.
    planes[4] = planes[5] = planes[random() % 4];
    ExpectExact(planes, random);
    planes[4] = {{0.f, 0.f, 0.f}, 0.f};
    planes[5] = {{0.f, -0.f, 0.f}, RandomLength(kind, random)};
    ExpectExact(planes, random);
    // Without a normal, and behind it everywhere.
    planes[4].offset = -0x1p-149f;
    ASSERT_EQ(BoundFrustum(planes), Aabo3::Empty());
    // Open.
    planes[3] = planes[random() % 3];
    ASSERT_EQ(BoundFrustum(planes), Aabo3::Everything());
  });
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
  WidePlanes cube{};
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

}  // namespace
}  // namespace halfspace::testing

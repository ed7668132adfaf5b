// BoundFrustum against the exact corners of what lies in front of the planes.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <type_traits>

#include "halfspace/fit.h"
#include "tests/library/fit/exact_frustum.h"
#include "tests/library/support/random_shapes.h"
#include "tests/library/support/samples.h"

namespace halfspace::testing {
namespace {

constexpr std::size_t kSamples = 40;

using Planes = std::array<HalfSpace3, 6>;

float Dot(const Point3& a, const Point3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

Point3 Combined(float s, const Point3& a, float t, const Point3& b) {
  return {s * a[0] + t * b[0], s * a[1] + t * b[1], s * a[2] + t * b[2]};
}

// Small enough for products with any coordinate.
Point3 RandomNormal(PointKind kind, Random& random) {
  auto normal = RandomPointOf<3, float>(kind, random);
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
void Disguise(Planes& planes, Random& random) {
  for (HalfSpace3& plane : planes) {
    const int exponent = RandomExponent(-20, 4, random);
    for (float& x : plane.normal) x = std::ldexp(x, exponent);
    plane.offset = std::ldexp(plane.offset, exponent);
  }
  std::shuffle(planes.begin(), planes.end(), random);
}

Planes FacesOf(const Box<3>& box) {
  Planes planes{};
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
WidePlanes Widened(const Planes& planes, Random& random) {
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

// What BoundFrustum says it does not bound.
bool AreTooFarApart(const WidePlanes& planes) {
  return std::any_of(planes.begin(), planes.end(), [](const auto& plane) {
    const auto& n = plane.normal;
    const double largest =
        std::max({std::fabs(n[0]), std::fabs(n[1]), std::fabs(n[2])});
    const auto is_apart = [&](double value) {
      const double ratio = std::fabs(value) / largest;
      return value != 0.0 && (ratio < 0x1p-199 || ratio > 0x1p199);
    };
    return largest != 0.0 && (is_apart(n[0]) || is_apart(n[1]) ||
                              is_apart(n[2]) || is_apart(plane.offset));
  });
}

// Of a bound, if there is one; of Everything() and Empty(), that they are due.
template <typename AnyPlanes>
void ExpectExactOf(const AnyPlanes& planes) {
  const ExactFrustum exact(planes);
  const Aabo3 bound = BoundFrustum(planes);
  if constexpr (std::is_same_v<AnyPlanes, WidePlanes>) {
    if (bound == Aabo3::Everything() && AreTooFarApart(planes)) return;
  }
  if (exact.IsOpen()) {
    ASSERT_EQ(bound, Aabo3::Everything());
  } else if (exact.IsEmpty()) {
    // If the planes would not close a volume anyway, that is the answer.
    ASSERT_TRUE(bound == Aabo3::Empty() || bound == Aabo3::Everything());
  } else if (exact.Magnitude() > Exact(0x1p125)) {
    ASSERT_EQ(bound, Aabo3::Everything());
  } else {
    ASSERT_TRUE(exact.Hull().IsEnclosedBy(bound, kWithinOneUlp));
  }
}

void ExpectExact(Planes planes, Random& random) {
  Disguise(planes, random);
  ExpectExactOf(planes);
  ExpectExactOf(Widened(planes, random));
  // The same numbers, as doubles.
  WidePlanes same;
  for (std::size_t i = 0; i < planes.size(); ++i) {
    std::copy(planes[i].normal.begin(), planes[i].normal.end(),
              same[i].normal.begin());
    same[i].offset = planes[i].offset;
  }
  if (!AreTooFarApart(same)) {
    ASSERT_EQ(BoundFrustum(same), BoundFrustum(planes));
  }
}

TEST(FitFrustumExactTest, Boxes) {
  ForEachSample(40, kSamples, 1, [](PointKind kind, Random& random) {
    const auto box = RandomBox<3, float>(kind, random);
    const Planes planes = FacesOf(box);
    ASSERT_TRUE(ExactFrustum(planes).Hull().IsEnclosedBy(BoundAabb(box),
                                                         kAnyLooseness));
    ExpectExact(planes, random);
  });
}

// Of three random directions, around a random point.
TEST(FitFrustumExactTest, Parallelepipeds) {
  ForEachSample(41, kSamples, 1, [](PointKind kind, Random& random) {
    const auto center = RandomPointOf<3, float>(PointKind::kUniform, random);
    Planes planes;
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
    const auto eye = RandomPointOf<3, float>(
        kind == PointKind::kWideExponents ? PointKind::kUniform : kind, random);
    std::array<Point3, 3> view;  // right, up, forward
    for (auto& v : view) {
      v = RandomPointOf<3, float>(PointKind::kUniform, random);
    }
    const auto [right, up, forward] = view;
    const float wide = RandomMantissa(random);
    const float high = RandomMantissa(random);
    const float near = RandomMantissa(random);
    const Point3 to = Combined(1.f, eye, near, forward);
    const Point3 end = Combined(1.f, eye, 2.f + near, forward);
    const Planes planes = {
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
    const auto inside = RandomPointOf<3, float>(kind, random);
    const bool around = !OneIn(4, random);
    Planes planes;
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
    auto box = RandomBox<3, float>(kind, random);
    const std::size_t axis = random() % 3;
    box.max[axis] = box.min[axis];
    Planes planes = FacesOf(box);
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
    const auto origin = RandomPointOf<3, float>(kind, random);
    Planes planes{};
    for (std::size_t k = 0; k < 3; ++k) {
      planes[k].normal[k] = 1.f;
      planes[k].offset = -origin[k];
      planes[3].normal[k] = -1.f;
    }
    planes[3].offset =
        -Dot(planes[3].normal, origin) + RandomLength<float>(kind, random);
    // The same again; without a normal, and in front or on it everywhere.
    planes[4] = planes[5] = planes[random() % 4];
    ExpectExact(planes, random);
    planes[4] = {{0.f, 0.f, 0.f}, 0.f};
    planes[5] = {{0.f, -0.f, 0.f}, RandomLength<float>(kind, random)};
    ExpectExact(planes, random);
    // Without a normal, and behind it everywhere.
    planes[4].offset = -0x1p-149f;
    ASSERT_EQ(BoundFrustum(planes), Aabo3::Empty());
    // Open.
    planes[3] = planes[random() % 3];
    ASSERT_EQ(BoundFrustum(planes), Aabo3::Everything());
  });
}

}  // namespace
}  // namespace halfspace::testing

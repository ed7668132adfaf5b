// HitTriangle() and ClosestPoint() against rational arithmetic.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <random>
#include <vector>

#include "halfspace/halfspace.h"
#include "tests/library/support/exact.h"

namespace halfspace::testing {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

using Rational = std::array<mpq_class, 3>;

Rational ToRational(const Point<3>& a) {
  return {Exact(a[0]), Exact(a[1]), Exact(a[2])};
}
Rational Minus(const Rational& a, const Rational& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
Rational Cross(const Rational& a, const Rational& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
          a[0] * b[1] - a[1] * b[0]};
}
mpq_class Dot(const Rational& a, const Rational& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
std::array<Rational, 3> From(const Point<3>& origin,
                             const Triangle<3>& triangle) {
  const Rational from = ToRational(origin);
  return {Minus(ToRational(triangle.a), from),
          Minus(ToRational(triangle.b), from),
          Minus(ToRational(triangle.c), from)};
}

// Whether the hit is right, and counts those on an edge.
::testing::AssertionResult IsHit(const Ray<3>& ray, const Triangle<3>& triangle,
                                 std::size_t& hits, std::size_t& on_edges) {
  const float found = HitTriangle(ray, triangle);
  const auto [a, b, c] = From(ray.origin, triangle);
  const Rational d = ToRational(ray.direction);
  const std::array<mpq_class, 3> sides = {
      Dot(d, Cross(a, b)), Dot(d, Cross(b, c)), Dot(d, Cross(c, a))};
  int low = 1;
  int high = -1;
  for (const mpq_class& side : sides) {
    low = std::min(low, sgn(side));
    high = std::max(high, sgn(side));
  }
  const mpq_class sum = sides[0] + sides[1] + sides[2];
  const bool is_on_line = (low >= 0 || high <= 0) && low != high;
  const bool is_inside = low == high && low != 0;
  if (!is_on_line && !is_inside) {
    if (found == kInfinity) return ::testing::AssertionSuccess();
    return ::testing::AssertionFailure() << "a miss has t " << found;
  }
  const mpq_class t = Dot(a, Cross(b, c)) / sum;
  if (t < 0) {
    if (found == kInfinity) return ::testing::AssertionSuccess();
    return ::testing::AssertionFailure() << "behind, and has t " << found;
  }
  // t is between the neighbours of what is found. A t near the limit can be on
  // either side.
  const mpq_class limit = Exact(std::min(ray.max_t, 1e38f));
  if (found == kInfinity) {
    if (Exact(std::nextafter(ray.max_t, 0.0f)) < t || t > limit) {
      return ::testing::AssertionSuccess();
    }
    return ::testing::AssertionFailure() << "missed at t " << t.get_d();
  }
  ++hits;
  if (is_on_line) ++on_edges;
  if (found > ray.max_t || std::signbit(found) ||
      Exact(std::nextafter(found, -1.0f)) >= t ||
      Exact(std::nextafter(found, kInfinity)) <= t) {
    return ::testing::AssertionFailure()
           << "t is " << found << " instead of " << t.get_d();
  }
  return ::testing::AssertionSuccess();
}

// Numbers of several kinds, so that rays hit edges, corners and planes.
struct Numbers {
  const char* name;
  std::function<float(std::mt19937&)> next;
};
const std::vector<Numbers>& AllNumbers() {
  using Engine = std::mt19937;
  static const std::vector<Numbers> all = {
      {"small integers",
       [](Engine& engine) { return static_cast<float>(engine() % 5) - 2; }},
      {"uniform",
       [](Engine& engine) {
         return static_cast<float>(engine() >> 8) * 0x1p-24f;
       }},
      {"far from zero",
       [](Engine& engine) {
         return 1000.0f + static_cast<float>(engine() % 7) * 0x1p-13f;
       }},
      {"all exponents",
       [](Engine& engine) {
         const auto value = static_cast<float>(engine() % 4) - 1.5f;
         return std::ldexp(value, static_cast<int>(engine() % 200) - 140);
       }},
      {"subnormal",
       [](Engine& engine) {
         return std::ldexp(static_cast<float>(engine() % 9) - 4.0f, -149);
       }},
  };
  return all;
}

TEST(TrianglesTest, HitsAreExact) {
  for (const Numbers& numbers : AllNumbers()) {
    SCOPED_TRACE(numbers.name);
    std::mt19937 engine(1);
    const auto point = [&] {
      return Point<3>{numbers.next(engine), numbers.next(engine),
                      numbers.next(engine)};
    };
    std::size_t hits = 0;
    std::size_t on_edges = 0;
    for (int i = 0; i < 20'000; ++i) {
      const Triangle<3> triangle = {point(), point(), point()};
      Ray<3> ray = {point(), point(), i % 5 == 0 ? 1.0f : kInfinity};
      if (i % 2 == 0) {
        // Towards a point of an edge, rounded.
        const float s = static_cast<float>(engine() % 5) / 4;
        for (std::size_t k = 0; k < 3; ++k) {
          ray.direction[k] = triangle.a[k] +
                             s * (triangle.b[k] - triangle.a[k]) -
                             ray.origin[k];
        }
      }
      ASSERT_TRUE(IsHit(ray, triangle, hits, on_edges)) << "case " << i;
    }
    EXPECT_GT(hits, 100u);
    if (&numbers == AllNumbers().data()) {
      EXPECT_GT(on_edges, 1000u);
    }
  }
}

TEST(TrianglesTest, WhatIsNotFiniteIsAMiss) {
  const Triangle<3> triangle = {{0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
  const Ray<3> ray = {{0.25f, 0.25f, 0}, {0, 0, 2}, 5};
  EXPECT_EQ(HitTriangle(ray, triangle), 0.5f);
  EXPECT_EQ(HitTriangle({ray.origin, ray.direction, 0.5f}, triangle), 0.5f);
  EXPECT_EQ(HitTriangle({ray.origin, ray.direction, 0.25f}, triangle),
            kInfinity);
  EXPECT_EQ(HitTriangle({ray.origin, {0, 0, -2}, 5}, triangle), kInfinity);
  EXPECT_EQ(HitTriangle({ray.origin, {0, 0, 0}, 5}, triangle), kInfinity);
  for (float bad : {kInfinity, -kInfinity, std::nanf("")}) {
    for (std::size_t k = 0; k < 3; ++k) {
      Ray<3> its_ray = ray;
      its_ray.origin[k] = bad;
      EXPECT_EQ(HitTriangle(its_ray, triangle), kInfinity) << bad << k;
      its_ray = ray;
      its_ray.direction[k] = bad;
      EXPECT_EQ(HitTriangle(its_ray, triangle), kInfinity) << bad << k;
      Triangle<3> its_triangle = triangle;
      its_triangle.b[k] = bad;
      EXPECT_EQ(HitTriangle(ray, its_triangle), kInfinity) << bad << k;
    }
  }
}

mpq_class ExactSquareTo(const std::array<Rational, 3>& corners) {
  mpq_class best = Dot(corners[0], corners[0]);
  for (std::size_t k = 0; k < 3; ++k) {
    const Rational edge = Minus(corners[(k + 1) % 3], corners[k]);
    const mpq_class square = Dot(edge, edge);
    if (square == 0) continue;
    mpq_class s = -Dot(corners[k], edge) / square;
    s = std::clamp<mpq_class>(s, 0, 1);
    Rational at;
    for (std::size_t i = 0; i < 3; ++i) at[i] = corners[k][i] + s * edge[i];
    best = std::min<mpq_class>(best, Dot(at, at));
  }
  const Rational normal =
      Cross(Minus(corners[1], corners[0]), Minus(corners[2], corners[0]));
  bool is_inside = Dot(normal, normal) != 0;
  for (std::size_t k = 0; k < 3; ++k) {
    is_inside &=
        Dot(normal, Cross(corners[(k + 1) % 3], corners[(k + 2) % 3])) >= 0;
  }
  if (!is_inside) return best;
  const mpq_class height = Dot(normal, corners[0]);
  return height * height / Dot(normal, normal);
}

TEST(TrianglesTest, ClosestPointsAreClosest) {
  for (const Numbers& numbers : AllNumbers()) {
    SCOPED_TRACE(numbers.name);
    std::mt19937 engine(3);
    const auto point = [&] {
      return Point<3>{numbers.next(engine), numbers.next(engine),
                      numbers.next(engine)};
    };
    for (int i = 0; i < 10'000; ++i) {
      const Triangle<3> triangle = {point(), point(), point()};
      const Point<3> from = point();
      const TrianglePoint found = ClosestPoint(from, triangle);
      const auto corners = From(from, triangle);
      const double exact = std::sqrt(ExactSquareTo(corners).get_d());
      double far = 0.0;
      for (const Rational& corner : corners) {
        far = std::max(far, std::sqrt(Dot(corner, corner).get_d()));
      }
      const double error = 0x1p-23 * exact + 0x1p-45 * far + 0x1p-149;
      ASSERT_NEAR(found.distance, exact, error) << i;
      double square = 0.0;
      double size = 0.0;
      for (std::size_t k = 0; k < 3; ++k) {
        const double gap = double{found.point[k]} - double{from[k]};
        square += gap * gap;
        size = std::max(size, std::fabs(double{found.point[k]}));
      }
      ASSERT_NEAR(std::sqrt(square), exact, 2 * error + 0x1p-23 * size) << i;
    }
  }
}

}  // namespace
}  // namespace halfspace::testing

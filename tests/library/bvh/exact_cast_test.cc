// Casts of a Bvh, of each type, against rational arithmetic: no hit is missed,
// and no t is above the exact one. Broad phases give the same (histories).
// HitTriangle() and ClosestPoint() against it, too.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "halfspace/halfspace.h"
#include "tests/library/bvh/answers.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/exact.h"

namespace halfspace::testing {
namespace {

// Between -1 and 1.
float Unit(Random& random) {
  return static_cast<float>(random() % (1 << 24)) * 0x1p-23f - 1;
}

// Where numbers are from.
struct Scale {
  const char* name;
  float (*coordinate)(Random& random);
  bool is_usual = false;

  Point<3> NextPoint(Random& random) const {
    return {coordinate(random), coordinate(random), coordinate(random)};
  }
  float Size(Random& random) const {
    const float size = std::abs(coordinate(random));
    return is_usual ? size / 8 : random() % 4 == 0 ? 0 : size;
  }
  float Speed(Random& random) const {
    if (random() % 6 == 0) return 0;
    return is_usual ? Unit(random) : coordinate(random);
  }
};
constexpr Scale kScales[] = {
    {"usual", [](Random& random) { return Unit(random) * 10; }, true},
    // Much touches exactly, and moves along planes, edges and corners.
    {"small integers",
     [](Random& random) { return static_cast<float>(random() % 5) - 2; }},
    {"far from zero",
     [](Random& random) {
       return 1000.0f + static_cast<float>(random() % 7) * 0x1p-13f;
     }},
    {"subnormals", [](Random& random) { return Unit(random) * 0x1p-140f; }},
    {"huge", [](Random& random) { return Unit(random) * 0x1p98f; }},
    {"any magnitude", [](Random& random) {
       return std::ldexp(Unit(random), static_cast<int>(random() % 250) - 148);
     }}};

// One axis of a body and of what moves to it. A plane that limits nothing is
// absent.
struct ExactAxis {
  std::optional<mpq_class> min;
  std::optional<mpq_class> max;
  mpq_class low;  // of what moves
  mpq_class high;
  mpq_class speed;

  // The distance of a point from the body.
  mpq_class GapAt(const mpq_class& t) const {
    const mpq_class at = low + speed * t;
    if (min && at < *min) return *min - at;
    if (max && at > *max) return at - *max;
    return 0;
  }
};

struct Times {
  mpq_class from;
  mpq_class to;

  // The times at which factor * t <= most.
  void Limit(const mpq_class& factor, const mpq_class& most) {
    if (factor > 0) {
      to = std::min<mpq_class>(to, most / factor);
    } else if (factor < 0) {
      from = std::max<mpq_class>(from, most / factor);
    } else if (most < 0) {
      to = from - 1;
    }
  }
  bool IsEmpty() const { return from > to; }
};

// The times at which a point is within a squared distance of the axes, rounded
// inward by 2^-60 of them.
Times TimesWithin(const std::vector<ExactAxis>& axes,
                  const mpq_class& squared_distance, const Times& all) {
  const auto excess = [&](const mpq_class& t) {
    mpq_class sum = -squared_distance;
    for (const ExactAxis& axis : axes) {
      const mpq_class gap = axis.GapAt(t);
      sum += gap * gap;
    }
    return sum;
  };
  // Where it is nearest: between two of these the square is one parabola.
  std::vector<mpq_class> stops = {all.from, all.to};
  for (const ExactAxis& axis : axes) {
    if (axis.speed == 0) continue;
    for (const auto& plane : {axis.min, axis.max}) {
      if (!plane) continue;
      const mpq_class t = (*plane - axis.low) / axis.speed;
      if (t > all.from && t < all.to) stops.push_back(t);
    }
  }
  std::sort(stops.begin(), stops.end());
  mpq_class nearest = all.from;
  mpq_class least = excess(nearest);
  for (std::size_t i = 0; i + 1 < stops.size(); ++i) {
    const mpq_class middle = (stops[i] + stops[i + 1]) / 2;
    mpq_class a = 0;
    mpq_class b = 0;
    for (const ExactAxis& axis : axes) {
      const mpq_class at = axis.low + axis.speed * middle;
      const bool is_below = axis.min && at < *axis.min;
      const bool is_above = axis.max && at > *axis.max;
      if (!is_below && !is_above) continue;
      a += axis.speed * axis.speed;
      b += axis.speed * (axis.low - (is_below ? *axis.min : *axis.max));
    }
    mpq_class t = stops[i + 1];
    if (a != 0) {
      t = std::clamp<mpq_class>(-b / a, stops[i], stops[i + 1]);
    }
    const mpq_class value = excess(t);
    if (value < least) {
      least = value;
      nearest = t;
    }
  }
  if (least > 0) return {1, 0};
  const mpq_class kPrecision = Exact(0x1p60);
  const auto last_within = [&](mpq_class beyond) {
    if (excess(beyond) <= 0) return beyond;
    mpq_class within = nearest;
    for (int i = 0; i < 400; ++i) {
      const mpq_class apart = beyond - within;
      if (abs(apart) * kPrecision < abs(beyond)) break;
      const mpq_class middle = (within + beyond) / 2;
      (excess(middle) <= 0 ? within : beyond) = middle;
    }
    return within;
  };
  return {last_within(all.from), last_within(all.to)};
}

// The t at which what moves touches the bound, larger by `margin`.
std::optional<mpq_class> ExactEntry(const Layout& layout, const Planes& bound,
                                    const Motion& motion,
                                    const mpq_class& margin = 0) {
  const std::size_t dims = layout.dims;
  std::vector<ExactAxis> axes(layout.axes);
  for (std::size_t k = 0; k < axes.size(); ++k) {
    const float min = bound[k];
    const float max = layout.has_max ? bound[layout.first_max + k] : kInf;
    if (min == kInf || max == -kInf) return std::nullopt;
    if (min > -kInf) axes[k].min = Exact(min) - margin;
    if (max < kInf) axes[k].max = Exact(max) + margin;
    if (k < dims) {
      axes[k].low = Exact(motion.place.min[k]);
      axes[k].high = Exact(motion.place.max[k]);
      axes[k].speed = Exact(motion.direction[k]);
    } else {
      for (std::size_t i = 0; i < dims; ++i) {
        axes[k].low -= axes[i].high;
        axes[k].high -= axes[i].low;
        axes[k].speed -= axes[i].speed;
      }
    }
  }
  Times times = {0, Exact(std::min(motion.max_t, kMost))};
  if (motion.kind == Motion::kBall && motion.radius > 0) {
    const Times all = times;
    const mpq_class radius = Exact(motion.radius) + margin;
    const auto limit = [&](const std::vector<ExactAxis>& some,
                           std::size_t factor) {
      const Times within =
          TimesWithin(some, mpq_class(factor) * radius * radius, all);
      times.from = std::max(times.from, within.from);
      times.to = std::min(times.to, within.to);
    };
    limit({axes.begin(), axes.begin() + static_cast<std::ptrdiff_t>(dims)}, 1);
    if (axes.size() > dims) limit({axes[dims]}, dims);
  } else {
    for (const ExactAxis& axis : axes) {
      if (axis.max) times.Limit(axis.speed, *axis.max - axis.low);
      if (axis.min) times.Limit(-axis.speed, axis.high - *axis.min);
    }
  }
  if (times.IsEmpty()) return std::nullopt;
  return times.from;
}

Planes SomeBound(const Layout& layout, const Scale& scale, Random& random) {
  std::array<float, 4> min{};
  std::array<float, 4> max{};
  for (std::size_t k = 0; k <= layout.dims; ++k) {
    min[k] = scale.coordinate(random);
    max[k] = min[k] + scale.Size(random);
    if (random() % 20 == 0) max[k] = kInf;
    if (random() % 20 == 0) min[k] = -kInf;
  }
  // A D that belongs to the box, for most of them.
  if (random() % 4 != 0) {
    float& min_d = min[layout.dims];
    float& max_d = max[layout.dims];
    min_d = max_d = 0;
    for (std::size_t k = 0; k < layout.dims; ++k) {
      min_d -= max[k];
      max_d -= min[k];
    }
  }
  Planes bound{};
  for (std::size_t p = 0; p < layout.plane_count; ++p) {
    bound[p] = IsMin(layout, p) ? min[p] : max[p - layout.axes];
  }
  return bound;
}

class ExactCastTest : public ::testing::TestWithParam<Layout> {};
INSTANTIATE_TEST_SUITE_P(Of, ExactCastTest,
                         ::testing::ValuesIn(LayoutsOf(false)), LayoutName());

TEST_P(ExactCastTest, NoHitIsMissedAndNoneIsLate) {
  const Layout layout = GetParam();
  constexpr std::uint32_t kBodies = 80;  // in two leaves
  for (const Scale& scale : kScales) {
    Random random(1);
    std::vector<Planes> bounds;
    for (std::uint32_t id = 0; id < kBodies; ++id) {
      bounds.push_back(SomeBound(layout, scale, random));
    }
    const auto bvh = MakeBvh(layout, bounds);
    const std::size_t casts = 3 + Scaled(30);
    std::size_t hits = 0;
    for (std::size_t i = 0; i < casts * 3; ++i) {
      constexpr Motion::Kind kKinds[] = {Motion::kRay, Motion::kBox,
                                         Motion::kBall};
      Motion motion;
      motion.kind = kKinds[i % 3];
      motion.place.is_point = motion.kind != Motion::kBox;
      for (std::size_t k = 0; k < layout.dims; ++k) {
        motion.place.min[k] = motion.place.max[k] = scale.coordinate(random);
        if (motion.kind == Motion::kBox) {
          motion.place.max[k] += scale.Size(random);
        }
        motion.direction[k] = scale.Speed(random);
      }
      if (random() % 10 == 0) motion.direction = {};
      constexpr float kTimes[] = {1, 3, 20, 0, 0x1p-130f, 0x1p60f, kInf};
      motion.max_t = kTimes[random() % std::size(kTimes)];
      if (motion.kind == Motion::kBall) motion.radius = scale.Size(random);
      std::map<std::uint32_t, float> found;
      bvh->Cast(motion,
                [&](std::uint32_t id, float t, const Planes&) {
                  EXPECT_TRUE(found.emplace(id, t).second);
                  return Limit{kInf};
                },
                {});
      for (std::uint32_t id = 0; id < kBodies; ++id) {
        SCOPED_TRACE(::testing::Message()
                     << scale.name << ", cast " << i << ", body " << id);
        const auto entry = ExactEntry(layout, bounds[id], motion);
        const auto t = found.find(id);
        if (entry) {
          ++hits;
          ASSERT_NE(t, found.end()) << entry->get_d();
          ASSERT_LE(Exact(t->second), *entry) << entry->get_d();
        }
        // Nothing is found by more than what is rounded off.
        if (!scale.is_usual || t == found.end()) continue;
        const auto early =
            ExactEntry(layout, bounds[id], motion, Exact(0x1p-14));
        ASSERT_TRUE(early);
        ASSERT_GE(Exact(t->second), *early * (1 - Exact(0x1p-17)))
            << t->second << " " << early->get_d();
      }
    }
    EXPECT_GT(hits, 0u);
  }
}

// Triangles.

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
    if (found == kInf) return ::testing::AssertionSuccess();
    return ::testing::AssertionFailure() << "a miss has t " << found;
  }
  const mpq_class t = Dot(a, Cross(b, c)) / sum;
  if (t < 0) {
    if (found == kInf) return ::testing::AssertionSuccess();
    return ::testing::AssertionFailure() << "behind, and has t " << found;
  }
  // t is between the neighbours of what is found. A t near the limit can be on
  // either side.
  const mpq_class limit = Exact(std::min(ray.max_t, 1e38f));
  if (found == kInf) {
    if (Exact(std::nextafter(ray.max_t, 0.0f)) < t || t > limit) {
      return ::testing::AssertionSuccess();
    }
    return ::testing::AssertionFailure() << "missed at t " << t.get_d();
  }
  ++hits;
  if (is_on_line) ++on_edges;
  if (found > ray.max_t || std::signbit(found) ||
      Exact(std::nextafter(found, -1.0f)) >= t ||
      Exact(std::nextafter(found, kInf)) <= t) {
    return ::testing::AssertionFailure()
           << "t is " << found << " instead of " << t.get_d();
  }
  return ::testing::AssertionSuccess();
}

TEST(TrianglesTest, HitsAreExact) {
  for (const Scale& scale : kScales) {
    SCOPED_TRACE(scale.name);
    Random random(1);
    const auto point = [&] { return scale.NextPoint(random); };
    std::size_t hits = 0;
    std::size_t on_edges = 0;
    for (int i = 0; i < 20'000; ++i) {
      const Triangle<3> triangle = {point(), point(), point()};
      Ray<3> ray = {point(), point(), i % 5 == 0 ? 1.0f : kInf};
      if (i % 2 == 0) {
        // Towards a point of an edge, rounded.
        const float s = static_cast<float>(random() % 5) / 4;
        for (std::size_t k = 0; k < 3; ++k) {
          ray.direction[k] = triangle.a[k] +
                             s * (triangle.b[k] - triangle.a[k]) -
                             ray.origin[k];
        }
      }
      ASSERT_TRUE(IsHit(ray, triangle, hits, on_edges)) << "case " << i;
    }
    EXPECT_GT(hits, 100u);
    if (&scale == &kScales[1]) {
      EXPECT_GT(on_edges, 1000u);
    }
  }
}

TEST(TrianglesTest, WhatIsNotFiniteIsAMiss) {
  const Triangle<3> triangle = {{0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
  const Ray<3> ray = {{0.25f, 0.25f, 0}, {0, 0, 2}, 5};
  EXPECT_EQ(HitTriangle(ray, triangle), 0.5f);
  EXPECT_EQ(HitTriangle({ray.origin, ray.direction, 0.5f}, triangle), 0.5f);
  EXPECT_EQ(HitTriangle({ray.origin, ray.direction, 0.25f}, triangle), kInf);
  EXPECT_EQ(HitTriangle({ray.origin, {0, 0, -2}, 5}, triangle), kInf);
  EXPECT_EQ(HitTriangle({ray.origin, {0, 0, 0}, 5}, triangle), kInf);
  for (float bad : {kInf, -kInf, std::nanf("")}) {
    for (std::size_t k = 0; k < 3; ++k) {
      Ray<3> its_ray = ray;
      its_ray.origin[k] = bad;
      EXPECT_EQ(HitTriangle(its_ray, triangle), kInf) << bad << k;
      its_ray = ray;
      its_ray.direction[k] = bad;
      EXPECT_EQ(HitTriangle(its_ray, triangle), kInf) << bad << k;
      Triangle<3> its_triangle = triangle;
      its_triangle.b[k] = bad;
      EXPECT_EQ(HitTriangle(ray, its_triangle), kInf) << bad << k;
    }
  }
}

// The closest point of a triangle to the origin.
Rational ExactClosest(const std::array<Rational, 3>& corners) {
  const Rational normal =
      Cross(Minus(corners[1], corners[0]), Minus(corners[2], corners[0]));
  const mpq_class size = Dot(normal, normal);
  bool is_inside = size != 0;
  for (std::size_t k = 0; k < 3; ++k) {
    is_inside &=
        Dot(normal, Cross(corners[(k + 1) % 3], corners[(k + 2) % 3])) >= 0;
  }
  Rational best = corners[0];
  if (is_inside) {
    const mpq_class height = Dot(normal, corners[0]) / size;
    for (std::size_t i = 0; i < 3; ++i) best[i] = height * normal[i];
    return best;
  }
  for (std::size_t k = 0; k < 3; ++k) {
    const Rational edge = Minus(corners[(k + 1) % 3], corners[k]);
    const mpq_class square = Dot(edge, edge);
    if (square == 0) continue;
    mpq_class s = -Dot(corners[k], edge) / square;
    s = std::clamp<mpq_class>(s, 0, 1);
    Rational at;
    for (std::size_t i = 0; i < 3; ++i) at[i] = corners[k][i] + s * edge[i];
    if (Dot(at, at) < Dot(best, best)) best = at;
  }
  return best;
}

double LengthOf(const Rational& a) { return std::sqrt(Dot(a, a).get_d()); }

::testing::AssertionResult IsClosest(const Point<3>& from,
                                     const Triangle<3>& triangle) {
  const TrianglePoint found = ClosestPoint(from, triangle);
  const auto corners = From(from, triangle);
  const Rational exact = ExactClosest(corners);
  double slack = 0x1p-149;
  for (const Rational& corner : corners) {
    slack = std::max(slack, 0x1p-45 * LengthOf(corner));
  }
  const auto is_near = [&](float result, const mpq_class& value) {
    const mpq_class error = abs(Exact(result) - value);
    return error <= Exact(0x1p-24) * abs(value) + Exact(slack);
  };
  const Rational origin = ToRational(from);
  bool is_right = is_near(found.distance, LengthOf(exact));
  for (std::size_t k = 0; k < 3; ++k) {
    is_right &= is_near(found.point[k], origin[k] + exact[k]);
  }
  if (is_right) return ::testing::AssertionSuccess();
  auto failure = ::testing::AssertionFailure();
  for (std::size_t k = 0; k < 3; ++k) {
    failure << found.point[k] << " instead of "
            << mpq_class(origin[k] + exact[k]).get_d() << ", ";
  }
  return failure << "at " << found.distance << " instead of " << LengthOf(exact)
                 << ", slack " << slack;
}

TEST(TrianglesTest, ClosestPointsAreClosest) {
  for (const Scale& scale : kScales) {
    SCOPED_TRACE(scale.name);
    Random random(3);
    for (int i = 0; i < 10'000; ++i) {
      const auto point = [&] { return scale.NextPoint(random); };
      const Triangle<3> triangle = {point(), point(), point()};
      ASSERT_TRUE(IsClosest(point(), triangle)) << i;
    }
  }
}

// Squares of distances, and weights of the corners, lose the closest point.
TEST(TrianglesTest, ClosestPointsOfThinAndFarTriangles) {
  const Triangle<3> unit = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  EXPECT_TRUE(IsClosest({0.25f, 0.25f, 1e8f}, unit));
  Random random(4);
  const auto tiny = [&](int most) {
    return std::ldexp(Unit(random), -static_cast<int>(random() % most));
  };
  for (int i = 0; i < 20'000; ++i) {
    // Near a point of the line of an edge, and then far from the triangle.
    std::array<Point<3>, 4> points;
    const float part = 2 * Unit(random);
    const float place = 2 * Unit(random);
    const float along = tiny(20);
    const float up = i % 2 == 0 ? 0 : std::ldexp(tiny(20), i % 60);
    for (std::size_t k = 0; k < 3; ++k) {
      auto& [a, b, c, from] = points;
      a[k] = random() % 2 == 0 ? 0 : Unit(random);
      b[k] = a[k] + (random() % 4 == 0 ? 0 : Unit(random));
      c[k] = a[k] + part * (b[k] - a[k]) + tiny(40);
      from[k] = a[k] + place * (b[k] - a[k]) + tiny(40) + along;
    }
    points[3][i % 3] += up;
    std::swap(points[random() % 3], points[0]);
    ASSERT_TRUE(IsClosest(points[3], {points[0], points[1], points[2]})) << i;
  }
  // Far from zero, and next to an edge.
  for (int i = 0; i < 5'000; ++i) {
    std::array<Point<3>, 4> points;
    for (Point<3>& point : points) {
      for (std::size_t k = 0; k < 3; ++k) {
        point[k] = static_cast<float>(random() % (k == 0 ? 2 : 64));
      }
    }
    auto& [a, b, c, from] = points;
    const float part = std::fabs(Unit(random));
    for (std::size_t k = 0; k < 3; ++k) {
      from[k] = std::floor(a[k] + part * (b[k] - a[k]));
      for (Point<3>& point : points) point[k] += 0x1p23f;
    }
    ASSERT_TRUE(IsClosest(from, {a, b, c})) << i;
  }
  // Points of a lattice whose coordinates are Fibonacci numbers: an edge is up
  // to 2^22 cells long, and the triangle as large as a few cells. Each axis has
  // its own scale. The point is above the lattice.
  const auto power = [&](int least, int most) {
    return std::ldexp(1.0f,
                      least + static_cast<int>(random() % (most - least + 1)));
  };
  for (int i = 0; i < 20'000; ++i) {
    Point<3> scale;
    Point<3> s;
    Point<3> t;
    for (std::size_t k = 0; k < 3; ++k) {
      scale[k] = power(-20, 20);
      s[k] = static_cast<float>(random() % 9) - 4;
      t[k] = static_cast<float>(random() % 9) - 4;
    }
    std::array<Point<3>, 4> points;
    for (Point<3>& point : points) {
      float of_s = 0;
      float of_t = static_cast<float>(random() % 3) - 1;
      for (std::size_t n = random() % 29; n > 0; --n) {
        of_s = std::exchange(of_t, of_s + of_t);
      }
      for (std::size_t k = 0; k < 3; ++k) {
        point[k] = scale[k] * (of_s * s[k] + of_t * t[k]);
      }
    }
    const float up = power(-10, 40);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t next = (k + 1) % 3;
      const std::size_t last = (k + 2) % 3;
      points[3][k] += up / scale[k] * (s[next] * t[last] - s[last] * t[next]);
    }
    ASSERT_TRUE(IsClosest(points[3], {points[0], points[1], points[2]})) << i;
  }
}

}  // namespace
}  // namespace halfspace::testing

// TriangleMesh on every target, against HitTriangle() and ClosestPoint() of
// every triangle.
#include "halfspace/mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <new>
#include <random>
#include <stdexcept>
#include <utility>
#include <vector>

#include "halfspace/triangles.h"
#include "tests/library/support/counting_memory.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/expect_invalid.h"

namespace halfspace::testing {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

using Random = std::mt19937;
using Triangles = std::vector<Triangle3>;

// Between -1 and 1.
float Unit(Random& random) {
  return static_cast<float>(random() % (1 << 24)) * 0x1p-23f - 1;
}
Point3 UnitPoint(Random& random) {
  return {Unit(random), Unit(random), Unit(random)};
}
Point3 Blend(const Point3& a, const Point3& b, float part) {
  Point3 point;
  for (std::size_t k = 0; k < 3; ++k) point[k] = a[k] + part * (b[k] - a[k]);
  return point;
}

// Small triangles in a cube.
Triangles Soup(std::size_t count, float size, Random& random) {
  Triangles triangles(count);
  for (Triangle3& triangle : triangles) {
    const Point3 center = UnitPoint(random);
    for (Point3* corner : {&triangle.a, &triangle.b, &triangle.c}) {
      *corner = Blend(center, UnitPoint(random), size);
    }
  }
  return triangles;
}

// A grid of squares whose corners are small integers, so that much is exactly
// on edges and corners, and many triangles are in one plane.
Triangles Grid(int side) {
  const auto at = [](int x, int y) {
    return Point3{static_cast<float>(x), static_cast<float>(y),
                  static_cast<float>((x / 3 + y / 3) % 2)};
  };
  Triangles triangles;
  for (int x = 0; x < side; ++x) {
    for (int y = 0; y < side; ++y) {
      triangles.push_back({at(x, y), at(x + 1, y), at(x + 1, y + 1)});
      triangles.push_back({at(x, y), at(x + 1, y + 1), at(x, y + 1)});
    }
  }
  return triangles;
}

// Thin, without an area, each twice, or of very unlike sizes.
Triangles Slivers(std::size_t count, Random& random) {
  Triangles triangles = Soup(count, 0.5f, random);
  for (Triangle3& triangle : triangles) {
    const float part = Unit(random);
    switch (random() % 5) {
      case 0:
        triangle.c = Blend(triangle.a, triangle.b, part);
        break;
      case 1:
        triangle.c = triangle.a;
        break;
      case 2:
        triangle.b = triangle.c = triangle.a;
        break;
      case 3:
        triangle = triangles[random() % count];
        break;
      default:
        triangle.b = Blend(triangle.a, triangle.b, part * part * 0x1p-20f);
    }
  }
  return triangles;
}

Triangles Times(Triangles triangles, float scale) {
  for (Triangle3& triangle : triangles) {
    for (Point3* corner : {&triangle.a, &triangle.b, &triangle.c}) {
      for (float& x : *corner) x *= scale;
    }
  }
  return triangles;
}

Triangles Moved(Triangles triangles, float way) {
  for (Triangle3& triangle : triangles) {
    for (Point3* corner : {&triangle.a, &triangle.b, &triangle.c}) {
      for (float& x : *corner) x += way;
    }
  }
  return triangles;
}

// Some of which have a NaN or an infinity, or any magnitude.
Triangles Altered(Triangles triangles, Random& random) {
  for (std::size_t i = 0; i < triangles.size(); i += 1 + random() % 4) {
    Triangle3& triangle = triangles[i];
    Point3* const corners[] = {&triangle.a, &triangle.b, &triangle.c};
    float& x = (*corners[random() % 3])[random() % 3];
    const std::array<float, 5> values = {
        kNaN, kInf, -kInf, std::numeric_limits<float>::max(),
        std::ldexp(Unit(random), static_cast<int>(random() % 250) - 125)};
    x = values[random() % values.size()];
  }
  return triangles;
}

std::vector<std::pair<const char*, Triangles>> Scenes() {
  Random random(1);
  const Triangles soup = Soup(600, 0.05f, random);
  const Triangles slivers = Slivers(300, random);
  Triangles unlike = Soup(200, 0x1p-14f, random);
  const Triangles large = Soup(20, 1.0f, random);
  unlike.insert(unlike.end(), large.begin(), large.end());
  std::vector<std::pair<const char*, Triangles>> scenes = {
      {"none", {}},
      {"one", Soup(1, 1.0f, random)},
      {"a full group", Soup(16, 1.0f, random)},
      {"more than a group", Soup(17, 1.0f, random)},
      {"a soup", Soup(4000, 0.02f, random)},
      {"a grid", Grid(20)},
      {"slivers", slivers},
      {"unlike sizes", unlike},
      {"far from zero", Moved(soup, 4096.0f)},
      {"all the same", Triangles(100, soup[0])},
      {"altered", Altered(soup, random)},
      {"altered slivers", Altered(slivers, random)}};
  for (float scale : {1e-44f, 1e-40f, 1e-30f, 1e-20f, 1e-15f, 1e8f, 1e12f,
                      1e18f, 1e20f, 1e30f, 1e38f}) {
    scenes.emplace_back("a scaled soup", Times(soup, scale));
    scenes.emplace_back("scaled slivers", Times(slivers, scale));
    scenes.emplace_back("a scaled grid", Times(Grid(8), scale));
  }
  // Each of them twice as far away as the one before.
  Triangles steps;
  for (int i = -140; i < 120; ++i) {
    steps.push_back(Times({soup[0]}, std::ldexp(1.0f, i))[0]);
  }
  scenes.emplace_back("steps", std::move(steps));
  return scenes;
}

// A point on or near a triangle, often on a corner or an edge, or anywhere.
Point3 PointNear(const Triangles& triangles, Random& random) {
  if (triangles.empty()) return UnitPoint(random);
  const Triangle3& triangle = triangles[random() % triangles.size()];
  const float part = static_cast<float>(random() % 5) / 4;
  const Point3 on_edge = Blend(triangle.a, triangle.b, part);
  switch (random() % 5) {
    case 0:
      return triangle.c;
    case 1:
      return on_edge;
    case 2:
      return Blend(on_edge, triangle.c, part);
    case 3: {
      Point3 point = Blend(on_edge, triangle.c, 0.25f);
      for (float& x : point) x *= 1 + Unit(random) * 0x1p-6f;
      return point;
    }
    default: {
      const Triangle3& other = triangles[random() % triangles.size()];
      return Blend(triangle.a, other.b, Unit(random) * 3);
    }
  }
}

Ray3 RayNear(const Triangles& triangles, Random& random) {
  Ray3 ray = {PointNear(triangles, random), PointNear(triangles, random), kInf};
  for (std::size_t k = 0; k < 3; ++k) ray.direction[k] -= ray.origin[k];
  switch (random() % 6) {
    case 0:
      ray.direction = {};
      ray.direction[random() % 3] = Unit(random);
      break;
    case 1:
      for (float& x : ray.direction) x *= std::ldexp(1.0f, -40);
      break;
    case 2:
      for (float& x : ray.direction) x *= 0x1p60f;
      break;
    default:
      break;
  }
  return ray;
}

struct Expected {
  MeshHit first = {kNoId, kInf};
  std::map<std::uint32_t, float> all;
};

Expected HitsOf(const Ray3& ray, const Triangles& triangles) {
  Expected expected;
  for (std::uint32_t id = 0; id < triangles.size(); ++id) {
    const float t = HitTriangle(ray, triangles[id]);
    if (!(t < kInf)) continue;
    expected.all[id] = t;
    if (t < expected.first.t) expected.first = {id, t};
  }
  return expected;
}

MeshPoint ClosestOf(const Point3& point, const Triangles& triangles,
                    float max_distance) {
  MeshPoint closest = {kNoId, kInf, {}};
  const auto is_finite = [](const Point3& p) {
    return std::all_of(p.begin(), p.end(),
                       [](float x) { return std::isfinite(x); });
  };
  for (std::uint32_t id = 0; id < triangles.size(); ++id) {
    const Triangle3& t = triangles[id];
    if (!is_finite(t.a) || !is_finite(t.b) || !is_finite(t.c)) continue;
    const TrianglePoint found = ClosestPoint(point, t);
    if (found.distance <= max_distance && found.distance < closest.distance) {
      closest = {id, found.distance, found.point};
    }
  }
  return closest;
}

TEST(MeshTest, RaysHitWhatHitTriangleHits) {
  Random random(2);
  std::size_t hits = 0;
  for (const auto& [name, triangles] : Scenes()) {
    SCOPED_TRACE(name);
    const TriangleMesh mesh(triangles);
    ASSERT_EQ(mesh.size(), triangles.size());
    for (std::size_t i = 0; i < Scaled(100); ++i) {
      Ray3 ray = RayNear(triangles, random);
      Expected expected = HitsOf(ray, triangles);
      if (random() % 3 == 0 && expected.first.t < kInf) {
        // At the limit, or just beyond it.
        ray.max_t = random() % 2 == 0 ? expected.first.t
                                      : std::nextafter(expected.first.t, 0.0f);
        expected = HitsOf(ray, triangles);
      }
      hits += expected.all.size();
      for (Target target : TargetsUnderTest()) {
        MeshHit first;
        mesh.FirstHits({&ray, 1}, {&first, 1}, target);
        ASSERT_EQ(first.id, expected.first.id) << i;
        ASSERT_EQ(first.t, expected.first.t) << i;
        bool is_hit = false;
        mesh.Occluded({&ray, 1}, {&is_hit, 1}, target);
        ASSERT_EQ(is_hit, !expected.all.empty()) << i;
        std::map<std::uint32_t, float> all;
        std::size_t calls = 0;
        mesh.ForEachHit(
            ray,
            [&](std::uint32_t id, float t) {
              ++calls;
              all[id] = t;
            },
            target);
        ASSERT_EQ(all, expected.all) << i;
        ASSERT_EQ(calls, all.size()) << i;
      }
    }
  }
  EXPECT_GT(hits, Scaled(1000));
}

TEST(MeshTest, PointsAreClosestToWhatClosestPointSays) {
  Random random(3);
  for (const auto& [name, triangles] : Scenes()) {
    SCOPED_TRACE(name);
    const TriangleMesh mesh(triangles);
    for (std::size_t i = 0; i < Scaled(50); ++i) {
      Point3 point = PointNear(triangles, random);
      if (!std::isfinite(point[0] + point[1] + point[2])) {
        point = UnitPoint(random);
      }
      float max_distance = kInf;
      MeshPoint expected = ClosestOf(point, triangles, max_distance);
      if (random() % 3 == 0) {
        max_distance = random() % 2 == 0
                           ? expected.distance
                           : std::nextafter(expected.distance, 0.0f);
        expected = ClosestOf(point, triangles, max_distance);
      }
      for (Target target : TargetsUnderTest()) {
        MeshPoint closest;
        mesh.ClosestPoints({&point, 1}, {&closest, 1}, max_distance, target);
        ASSERT_EQ(closest.id, expected.id) << i;
        ASSERT_EQ(closest.distance, expected.distance) << i;
        if (closest.id == kNoId) {
          ASSERT_TRUE(std::isnan(closest.point[0]));
        } else {
          ASSERT_EQ(closest.point, expected.point) << i;
        }
      }
    }
  }
}

TEST(MeshTest, IndicesNameVertices) {
  const std::vector<Point3> vertices = {
      {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 5, 5}};
  const std::vector<std::uint32_t> indices = {3, 3, 3, 2, 0, 1};
  TriangleMesh mesh(vertices, indices);
  const Ray3 ray = {{0.25f, 0.25f, 2}, {0, 0, -1}, 10};
  EXPECT_EQ(mesh.FirstHit(ray).id, 1u);
  EXPECT_EQ(mesh.FirstHit(ray).t, 2.0f);
  EXPECT_TRUE(mesh.Occluded(ray));
  EXPECT_EQ(mesh.ClosestPoint({5, 5, 6}).id, 0u);
  EXPECT_EQ(mesh.ClosestPoint({5, 5, 6}, 0.5f).id, kNoId);
  TriangleMesh moved = std::move(mesh);
  EXPECT_EQ(moved.FirstHit(ray).id, 1u);
  mesh = TriangleMesh();
  EXPECT_EQ(mesh.FirstHit(ray).id, kNoId);
  EXPECT_EQ(mesh.size(), 0u);
  EXPECT_EQ(mesh.bytes(), 0u);
  EXPECT_GT(moved.bytes(), 2 * sizeof(Triangle3));
}

TEST(MeshTest, NonFiniteQueriesFindNothing) {
  Random random(4);
  const TriangleMesh mesh(Soup(100, 1.0f, random));
  for (float bad : {kNaN, kInf, -kInf}) {
    EXPECT_FALSE(mesh.Occluded({{bad, 0, 0}, {1, 0, 0}, 1}));
    EXPECT_FALSE(mesh.Occluded({{0, 0, 0}, {1, bad, 0}, 1}));
    EXPECT_EQ(mesh.ClosestPoint({0, bad, 0}).id, kNoId);
  }
  EXPECT_FALSE(mesh.Occluded({{0, 0, 0}, {0, 0, 0}, kInf}));
}

TEST(MeshTest, FunctionsEndTheSearch) {
  Random random(5);
  const Triangles triangles = Soup(2000, 0.5f, random);
  const TriangleMesh mesh(triangles);
  const Ray3 ray = {{-2, 0, 0}, {1, 0, 0}, kInf};
  const std::size_t all = HitsOf(ray, triangles).all.size();
  ASSERT_GT(all, 8u);
  std::size_t calls = 0;
  mesh.ForEachHit(ray, [&](std::uint32_t, float) {
    ++calls;
    return Visit::kStop;
  });
  EXPECT_EQ(calls, 1u);
  float first = kInf;
  std::size_t limited = 0;
  mesh.ForEachHit(ray, [&](std::uint32_t, float t) {
    ++limited;
    first = std::min(first, t);
    return Limit{first};
  });
  EXPECT_EQ(first, mesh.FirstHit(ray).t);
  EXPECT_LT(limited, all);
  EXPECT_THROW(mesh.ForEachHit(ray,
                               [](std::uint32_t, float) {
                                 throw std::runtime_error("in a callback");
                               }),
               std::runtime_error);
}

TEST(MeshTest, RefusesWrongArguments) {
  const std::vector<Point3> vertices(4);
  const std::vector<std::uint32_t> indices = {0, 1, 2, 3};
  const Span<const std::uint32_t> three(indices.data(), 3);
  EXPECT_REFUSED((TriangleMesh(vertices, indices)), "TriangleMesh", "indices");
  EXPECT_REFUSED((TriangleMesh({vertices.data(), 2}, three)), "TriangleMesh",
                 "indices");
  const TriangleMesh mesh(vertices, three);
  std::array<MeshHit, 2> hits;
  std::array<bool, 2> is_hit;
  std::array<MeshPoint, 2> points;
  const std::vector<Ray3> rays = {{{}, {}, -1}, {{}, {}, kNaN}};
  EXPECT_REFUSED((mesh.FirstHits({rays.data(), 1}, hits)), "FirstHits", "hits");
  EXPECT_REFUSED((mesh.FirstHits({rays.data(), 1}, {hits.data(), 1})),
                 "FirstHits", "max_t");
  EXPECT_REFUSED((mesh.Occluded({rays.data() + 1, 1}, {is_hit.data(), 1})),
                 "Occluded", "max_t");
  EXPECT_REFUSED((mesh.ClosestPoints(vertices, points)), "ClosestPoints",
                 "results");
  EXPECT_REFUSED((mesh.ClosestPoints({vertices.data(), 2}, points, -1.0f)),
                 "ClosestPoints", "max_distance");
  EXPECT_REFUSED((mesh.ForEachHit(rays[0], [](std::uint32_t, float) {})),
                 "ForEachHit", "max_t");
}

TEST(MeshTest, AllMemoryIsOfTheResource) {
  Random random(6);
  const Triangles triangles = Soup(1000, 0.1f, random);
  for (std::size_t left = 0;; ++left) {
    CountingMemory memory;
    memory.left = left;
    try {
      const TriangleMesh mesh(triangles, MemoryFrom(memory));
      EXPECT_GT(left, 2u);
      EXPECT_GT(memory.blocks, 0u);
      break;
    } catch (const std::bad_alloc&) {
      EXPECT_EQ(memory.blocks, 0u);
    }
  }
}

}  // namespace
}  // namespace halfspace::testing

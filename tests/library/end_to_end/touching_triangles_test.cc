// Triangles that share a point in exact arithmetic are never told apart,
// whichever builders and targets made and tested their bounds.
//
// "Naive" is what a builder without outward rounding would do. It rejects a
// share of these pairs, which shows that they are hard enough.
#include "tests/library/end_to_end/touching_triangles.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <random>
#include <vector>

#include "halfspace/halfspace.h"
#include "tests/library/end_to_end/exact_triangles.h"
#include "tests/library/end_to_end/kept.h"
#include "tests/library/end_to_end/triangle_builders.h"
#include "tests/library/support/samples.h"

namespace halfspace::testing {
namespace {

constexpr std::size_t kPairs = 5000;
constexpr std::size_t kFewestPairs = 1000;  // or the naive ones may all pass
constexpr std::size_t kBatch = 64;
constexpr std::size_t kCombinations = 24;  // of builders, for each batch

float NaiveD(const Point3& p) { return -((p[0] + p[1]) + p[2]); }
float NaiveDReversed(const Point3& p) { return -((p[2] + p[1]) + p[0]); }

// One order of coordinates on one side, another one on the other.
bool NaiveRejects(const TouchingTriangles& pair) {
  const auto& u = pair.upper;
  const auto& l = pair.lower;
  return std::min({NaiveD(u.a), NaiveD(u.b), NaiveD(u.c)}) >
         std::max(
             {NaiveDReversed(l.a), NaiveDReversed(l.b), NaiveDReversed(l.c)});
}

// Pairs i of the two lists intersect.
struct Batch {
  std::vector<Triangle3> upper;
  std::vector<Triangle3> lower;

  void Add(const TouchingTriangles& pair) {
    upper.push_back(pair.upper);
    lower.push_back(pair.lower);
  }
};

// change(bounds) is applied to both sides.
template <typename Change>
void ExpectKept(const Batch& batch, Random& random, Change change) {
  static const auto builders = TriangleBuilders();
  for (std::size_t n = 0; n < kCombinations; ++n) {
    const auto& one = builders[random() % builders.size()];
    const auto& other = builders[random() % builders.size()];
    const Bounds upper = change(one.bound(batch.upper));
    const Bounds lower = change(other.bound(batch.lower));
    ASSERT_TRUE(AllKept<3>(upper, lower)) << one.name << ", " << other.name;
    ASSERT_TRUE(AllKept<3>(lower, upper)) << other.name << ", " << one.name;
  }
}

class TouchingTrianglesTest : public ::testing::TestWithParam<TouchingKind> {};

TEST_P(TouchingTrianglesTest, AreKept) {
  Random random(100);
  const std::size_t pairs = std::max(kFewestPairs, Scaled(kPairs));
  std::size_t naive_rejects = 0;
  for (std::size_t done = 0; done < pairs; done += kBatch) {
    Batch batch;
    while (batch.upper.size() < kBatch) {
      const auto pair = RandomTouching(GetParam(), random);
      ASSERT_TRUE(Intersect(pair.upper, pair.lower));
      naive_rejects += NaiveRejects(pair);
      batch.Add(pair);
    }
    ExpectKept(batch, random, [](const Bounds& bounds) { return bounds; });
    // Both sides moved by the same: exact shapes move exactly.
    const auto by = RandomPoint<3>(PointKind::kUniform, random);
    ExpectKept(batch, random, [&](Bounds bounds) {
      for (Aabo3& bound : bounds) bound = Translate(bound, by);
      return bounds;
    });
    if (HasFatalFailure()) return;
  }
  RecordSize("pairs", pairs);
  RecordSize("naive_rejects", naive_rejects);
  EXPECT_GT(naive_rejects, pairs / 100) << "of " << pairs;
}

// Moved vertices are rounded: what still intersects then must be kept. One side
// is moved as a bound, the other as vertices.
TEST_P(TouchingTrianglesTest, AreKeptWhenTheirVerticesMove) {
  Random random(101);
  const std::size_t pairs = std::max(kFewestPairs, Scaled(kPairs));
  std::size_t naive_rejects = 0;
  std::size_t intersecting = 0;
  const auto moved = [](Triangle3 t, const Point3& by) {
    for (Point3* p : {&t.a, &t.b, &t.c}) {
      for (std::size_t k = 0; k < 3; ++k) (*p)[k] += by[k];
    }
    return t;
  };
  for (std::size_t i = 0; i < pairs; ++i) {
    const auto pair = RandomTouching(GetParam(), random);
    const float reach = std::fabs(pair.upper.a[0]) + 1.f;
    std::uniform_real_distribution<float> shift(-reach, reach);
    const Point3 by = {shift(random), shift(random), shift(random)};
    const Triangle3 upper = moved(pair.upper, by);
    const Triangle3 lower = moved(pair.lower, by);
    if (!Intersect(upper, lower)) continue;
    ++intersecting;
    const Aabo3 upper_bound = TranslateVertices(BoundTriangle(pair.upper), by);
    const Aabo3 lower_bound = TranslateVertices(BoundTriangle(pair.lower), by);
    ASSERT_TRUE(
        AllKept<3>({upper_bound, lower_bound, upper_bound},
                   {lower_bound, BoundTriangle(upper), BoundTriangle(lower)}));
    ASSERT_TRUE(AllKept<3>({lower_bound, BoundTriangle(upper)},
                           {upper_bound, lower_bound}));
    // The naive way adds to D.
    naive_rejects += BoundTriangle(pair.upper).min[3] + NaiveD(by) >
                     BoundTriangle(lower).max[3];
  }
  RecordSize("pairs", intersecting);
  RecordSize("naive_rejects", naive_rejects);
  EXPECT_GT(intersecting, 0u);
  if (GetParam() == TouchingKind::kSharedVertex) {
    EXPECT_GT(naive_rejects, intersecting / 20) << "of " << intersecting;
  }
}

// Apart by the least there is on D: the exact test can tell.
TEST_P(TouchingTrianglesTest, AreJustTouching) {
  Random random(102);
  for (std::size_t i = 0; i < Scaled(100); ++i) {
    auto pair = RandomTouching(GetParam(), random);
    for (Point3* p : {&pair.upper.a, &pair.upper.b, &pair.upper.c}) {
      (*p)[1] =
          std::nextafter((*p)[1], -std::numeric_limits<float>::infinity());
    }
    ASSERT_FALSE(Intersect(pair.upper, pair.lower));
    ASSERT_FALSE(Intersect(pair.lower, pair.upper));
  }
}

INSTANTIATE_TEST_SUITE_P(All, TouchingTrianglesTest,
                         ::testing::ValuesIn(kTouchingKinds),
                         [](const auto& instance) {
                           std::string name = NameOf(instance.param);
                           std::erase_if(name, [](char c) {
                             return c == ' ' || c == '-';
                           });
                           return name;
                         });

// Of all that are near each other.
TEST(IntersectingTrianglesTest, AreKept) {
  Random random(103);
  const std::size_t pairs = std::max(kFewestPairs, Scaled(kPairs));
  std::uniform_real_distribution<float> coordinate(-1.f, 1.f);
  const auto triangle = [&] {
    Triangle3 t;
    for (Point3* p : {&t.a, &t.b, &t.c}) {
      for (float& x : *p) x = coordinate(random);
    }
    return t;
  };
  for (std::size_t done = 0; done < pairs; done += kBatch) {
    Batch batch;
    while (batch.upper.size() < kBatch) {
      const TouchingTriangles pair{triangle(), triangle()};
      if (Intersect(pair.upper, pair.lower)) batch.Add(pair);
    }
    ExpectKept(batch, random, [](const Bounds& bounds) { return bounds; });
    if (::testing::Test::HasFatalFailure()) return;
  }
  RecordSize("pairs", pairs);
}

}  // namespace
}  // namespace halfspace::testing

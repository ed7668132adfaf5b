// Bounds of boxes, spheres, capsules, rays and pieces of segments, against
// their exact extremes.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "halfspace/fit.h"
#include "tests/library/support/dims.h"
#include "tests/library/support/exact_hull.h"
#include "tests/library/support/random_shapes.h"
#include "tests/library/support/samples.h"

namespace halfspace::testing {
namespace {

constexpr std::size_t kSamples = 1000;

template <typename Dims>
class FitSolidsExactTest : public ::testing::Test {};
TYPED_TEST_SUITE(FitSolidsExactTest, AllDims, DimsNames);

// Two opposite corners have the extremes of D too.
template <int kDims, typename Scalar>
ExactHull<kDims> HullOf(const Box<kDims, Scalar>& box) {
  ExactHull<kDims> hull;
  hull.AddPoint(ExactPointOf(box.min));
  hull.AddPoint(ExactPointOf(box.max));
  return hull;
}

TYPED_TEST(FitSolidsExactTest, Boxes) {
  constexpr int kDims = TypeParam::value;
  ForEachSample(30, kSamples, 3, [](PointKind kind, Random& random) {
    const auto box = RandomBox<kDims, float>(kind, random);
    ASSERT_TRUE(HullOf(box).IsEnclosedBy(BoundAabb(box), kTightest));
    const auto wide = RandomBox<kDims, double>(kind, random);
    ASSERT_TRUE(HullOf(wide).IsEnclosedBy(BoundAabb(wide), kTightest));
  });
}

// All 2^kDims corners.
template <int kDims, typename Scalar>
void CheckOrientedBoxes() {
  ForEachSample(31, kSamples, 1, [](PointKind kind, Random& random) {
    const auto box = RandomOrientedBox<kDims, Scalar>(kind, random);
    ExactHull<kDims> hull;
    for (std::size_t corner = 0; corner < (1u << kDims); ++corner) {
      auto point = ExactPointOf(box.center);
      for (std::size_t i = 0; i < kDims; ++i) {
        mpq_class half = Exact(box.half_extents[i]);
        if ((corner >> i & 1) != 0) half = -half;
        for (std::size_t k = 0; k < kDims; ++k) {
          point[k] += half * Exact(box.axes[i][k]);
        }
      }
      hull.AddPoint(point);
    }
    ASSERT_TRUE(hull.IsEnclosedBy(BoundOrientedBox(box), kTightest));
  });
}

TYPED_TEST(FitSolidsExactTest, OrientedBoxes) {
  CheckOrientedBoxes<TypeParam::value, float>();
  CheckOrientedBoxes<TypeParam::value, double>();
}

template <int kDims, typename Scalar>
ExactHull<kDims> HullOf(const Sphere<kDims, Scalar>& sphere) {
  ExactHull<kDims> hull;
  hull.AddSphere(ExactPointOf(sphere.center), Exact(sphere.radius));
  return hull;
}

// All rounded to nearest, as one would write it.
template <int kDims>
bool NaiveIsBelow(const Sphere<kDims>& sphere) {
  float center = 0.f;
  mpq_class exact = 0;
  for (float x : sphere.center) {
    center += x;
    exact += Exact(x);
  }
  const float reach =
      sphere.radius * static_cast<float>(std::sqrt(double{kDims}));
  return Compare({Exact(center + reach), 0, kDims},
                 {exact, Exact(sphere.radius), kDims}) < 0;
}

TYPED_TEST(FitSolidsExactTest, NaiveSpheresAreTooSmall) {
  constexpr int kDims = TypeParam::value;
  Random random(37);
  std::size_t below = 0;
  const std::size_t count = std::max<std::size_t>(1000, Scaled(kSamples));
  for (std::size_t i = 0; i < count; ++i) {
    below +=
        NaiveIsBelow(RandomSphere<kDims, float>(PointKind::kUniform, random));
  }
  EXPECT_GT(below, count / 5);
  RecordSize("naive_spheres_per_mille", 1000 * below / count);
}

TYPED_TEST(FitSolidsExactTest, Spheres) {
  constexpr int kDims = TypeParam::value;
  ForEachSample(32, 3 * kSamples, 2, [](PointKind kind, Random& random) {
    const auto sphere = RandomSphere<kDims, float>(kind, random);
    ASSERT_TRUE(HullOf(sphere).IsEnclosedBy(BoundSphere(sphere),
                                            RoundD(sphere.radius)));
    const auto wide = RandomSphere<kDims, double>(kind, random);
    ASSERT_TRUE(
        HullOf(wide).IsEnclosedBy(BoundSphere(wide), RoundD(wide.radius)));
  });
  RecordSize("spheres", 2 * kPointKinds.size() * Scaled(3 * kSamples));
}

TYPED_TEST(FitSolidsExactTest, RadiusZeroIsThePoint) {
  constexpr int kDims = TypeParam::value;
  ForEachSample(33, kSamples / 10, 2, [](PointKind kind, Random& random) {
    const auto center = RandomPointOf<kDims, float>(kind, random);
    const auto point = BoundPoint<kDims>(center);
    ASSERT_EQ(BoundSphere(Sphere<kDims>{center, 0.f}), point);
    ASSERT_EQ(BoundSphere(Sphere<kDims>{center, -0.f}), point);
  });
}

template <int kDims, typename Scalar>
void CheckCapsules() {
  ForEachSample(34, kSamples, 1, [](PointKind kind, Random& random) {
    const auto capsule = RandomCapsule<kDims, Scalar>(kind, random);
    ExactHull<kDims> hull;
    hull.AddSphere(ExactPointOf(capsule.a), Exact(capsule.radius));
    hull.AddSphere(ExactPointOf(capsule.b), Exact(capsule.radius));
    ASSERT_TRUE(
        hull.IsEnclosedBy(BoundCapsule(capsule), RoundD(capsule.radius)));
  });
}

TYPED_TEST(FitSolidsExactTest, Capsules) {
  CheckCapsules<TypeParam::value, float>();
  CheckCapsules<TypeParam::value, double>();
}

template <int kDims, typename Scalar>
void CheckRays() {
  ForEachSample(35, kSamples, 1, [](PointKind kind, Random& random) {
    const auto ray = RandomRay<kDims, Scalar>(kind, random);
    ExactHull<kDims> hull;
    auto end = ExactPointOf(ray.origin);
    hull.AddPoint(end);
    for (std::size_t k = 0; k < kDims; ++k) {
      end[k] += Exact(ray.max_t) * Exact(ray.direction[k]);
    }
    hull.AddPoint(end);
    ASSERT_TRUE(hull.IsEnclosedBy(BoundRay(ray), kTightest));
  });
}

TYPED_TEST(FitSolidsExactTest, Rays) {
  CheckRays<TypeParam::value, float>();
  CheckRays<TypeParam::value, double>();
}

// Each piece encloses its exact part of the segment. So neighbours both have
// the point where they meet, and nothing is left out.
template <int kDims, typename Scalar>
void CheckSegmentPieces() {
  constexpr std::size_t kMostPieces = 7;
  ForEachSample(
      36, kSamples / 4, kMostPieces / 2, [](PointKind kind, Random& random) {
        const Segment<kDims, Scalar> segment{
            RandomPointOf<kDims, Scalar>(kind, random),
            RandomPointOf<kDims, Scalar>(kind, random)};
        // Few pieces, or, now and then, many.
        const std::size_t count =
            OneIn(100, random) ? 1000 : 1 + random() % kMostPieces;
        std::vector<Aabo<kDims>> pieces(count);
        BoundSegmentPieces(segment, pieces);
        const auto along = [&](std::size_t i) {
          ExactPoint<kDims> point;
          const mpq_class share = mpq_class(i) / mpq_class(count);
          for (std::size_t k = 0; k < kDims; ++k) {
            const mpq_class a = Exact(segment.a[k]);
            point[k] = a + share * (Exact(segment.b[k]) - a);
          }
          return point;
        };
        for (std::size_t i = 0; i < count; ++i) {
          ExactHull<kDims> hull;
          hull.AddPoint(along(i));
          hull.AddPoint(along(i + 1));
          ASSERT_TRUE(hull.IsEnclosedBy(pieces[i], kWithinOneUlp)) << i;
        }
      });
}

TYPED_TEST(FitSolidsExactTest, SegmentPieces) {
  CheckSegmentPieces<TypeParam::value, float>();
  CheckSegmentPieces<TypeParam::value, double>();
}

}  // namespace
}  // namespace halfspace::testing

// Bounds of points, in every layout, against their exact extremes.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "halfspace/fit.h"
#include "tests/library/support/dims.h"
#include "tests/library/support/exact_hull.h"
#include "tests/library/support/random_shapes.h"
#include "tests/library/support/samples.h"

namespace halfspace::testing {
namespace {

constexpr std::size_t kSamples = 600;

// Some points, and the same in every layout, among NaN that must not be read.
template <int kDims, typename Scalar>
struct Layouts {
  std::vector<Point<kDims, Scalar>> points;
  std::size_t stride;
  std::vector<Scalar> strided;
  std::array<std::vector<Scalar>, std::size_t{kDims}> columns;
  std::vector<std::uint32_t> indices;  // of all points, some of them twice
  std::vector<Scalar> shuffled;        // what the indices are of
  std::array<std::vector<Scalar>, std::size_t{kDims}> shuffled_columns;

  Layouts(PointKind kind, Random& random)
      : points(1 + random() % 4), stride(kDims + random() % 4) {
    constexpr Scalar kNan = std::numeric_limits<Scalar>::quiet_NaN();
    for (auto& p : points) p = RandomPointOf<kDims, Scalar>(kind, random);
    strided.assign(points.size() * stride, kNan);
    for (std::size_t i = 0; i < points.size(); ++i) {
      std::copy(points[i].begin(), points[i].end(), &strided[i * stride]);
      for (std::size_t k = 0; k < kDims; ++k) {
        columns[k].push_back(points[i][k]);
      }
    }
    // Every other place is a NaN; the rest are the points in reverse order.
    shuffled.assign(2 * points.size() * stride, kNan);
    for (auto& c : shuffled_columns) c.assign(2 * points.size(), kNan);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const std::size_t place = 2 * (points.size() - i) - 1;
      std::copy(points[i].begin(), points[i].end(), &shuffled[place * stride]);
      for (std::size_t k = 0; k < kDims; ++k) {
        shuffled_columns[k][place] = points[i][k];
      }
      indices.insert(indices.end(), 1 + random() % 2,
                     static_cast<std::uint32_t>(place));
    }
    std::shuffle(indices.begin(), indices.end(), random);
  }

  Points<kDims, Scalar> Strided() const {
    return {strided.data(), points.size(), stride};
  }
  Points<kDims, Scalar> Shuffled() const {
    return {shuffled.data(), 2 * points.size(), stride};
  }
  static PointsSoa<kDims, Scalar> Soa(const decltype(columns)& from) {
    PointsSoa<kDims, Scalar> soa{.coords = {}, .count = from[0].size()};
    for (std::size_t k = 0; k < kDims; ++k) soa.coords[k] = from[k].data();
    return soa;
  }

  ExactHull<kDims> Hull() const {
    ExactHull<kDims> hull;
    for (const auto& point : points) hull.AddPoint(ExactPointOf(point));
    return hull;
  }
};

template <typename Dims>
class FitPointsExactTest : public ::testing::Test {};
TYPED_TEST_SUITE(FitPointsExactTest, AllDims, DimsNames);

template <int kDims, typename Scalar>
void CheckLayouts() {
  using AllLayouts = Layouts<kDims, Scalar>;
  ForEachSample(20, kSamples, 2, [](PointKind kind, Random& random) {
    const AllLayouts layouts(kind, random);
    const auto hull = layouts.Hull();
    const auto bound = BoundPoints(layouts.Strided());
    ASSERT_TRUE(hull.IsEnclosedBy(bound, kTightest));
    ASSERT_EQ(BoundPoints(AllLayouts::Soa(layouts.columns)), bound);
  });
}

TYPED_TEST(FitPointsExactTest, Floats) {
  CheckLayouts<TypeParam::value, float>();
}

TYPED_TEST(FitPointsExactTest, Doubles) {
  CheckLayouts<TypeParam::value, double>();
}

template <int kDims, typename Scalar>
void CheckIndexed() {
  ForEachSample(21, kSamples, 2, [](PointKind kind, Random& random) {
    const Layouts<kDims, Scalar> layouts(kind, random);
    const auto bound = BoundPoints(layouts.Shuffled(), layouts.indices);
    ASSERT_TRUE(layouts.Hull().IsEnclosedBy(bound, kTightest));
    const auto soa = layouts.Soa(layouts.shuffled_columns);
    ASSERT_EQ(BoundPoints(soa, layouts.indices), bound);
  });
}

TYPED_TEST(FitPointsExactTest, Indexed) {
  CheckIndexed<TypeParam::value, float>();
  CheckIndexed<TypeParam::value, double>();
}

template <int kDims, typename Scalar>
void CheckPointSegmentTriangle() {
  ForEachSample(22, kSamples, 3, [](PointKind kind, Random& random) {
    const auto a = RandomPointOf<kDims, Scalar>(kind, random);
    const auto b = RandomPointOf<kDims, Scalar>(kind, random);
    const auto c = RandomPointOf<kDims, Scalar>(kind, random);
    ExactHull<kDims> hull;
    hull.AddPoint(ExactPointOf(a));
    ASSERT_TRUE(hull.IsEnclosedBy(BoundPoint<kDims>(a), kTightest));
    hull.AddPoint(ExactPointOf(b));
    ASSERT_TRUE(hull.IsEnclosedBy(BoundSegment(Segment<kDims, Scalar>{a, b}),
                                  kTightest));
    hull.AddPoint(ExactPointOf(c));
    ASSERT_TRUE(hull.IsEnclosedBy(
        BoundTriangle(Triangle<kDims, Scalar>{a, b, c}), kTightest));
  });
}

TYPED_TEST(FitPointsExactTest, PointSegmentTriangle) {
  CheckPointSegmentTriangle<TypeParam::value, float>();
  CheckPointSegmentTriangle<TypeParam::value, double>();
}

template <int kDims, typename Scalar, typename MapScalar>
ExactPoint<kDims> Image(const Point<kDims, Scalar>& point,
                        const Affine<kDims, MapScalar>& map) {
  ExactPoint<kDims> image = ExactPointOf(map.translation);
  for (std::size_t i = 0; i < kDims; ++i) {
    for (std::size_t k = 0; k < kDims; ++k) {
      image[i] += Exact(map.linear[i][k]) * Exact(point[k]);
    }
  }
  return image;
}

template <typename To, typename From, std::size_t kCount>
std::array<To, kCount> As(const std::array<From, kCount>& from) {
  std::array<To, kCount> to;
  for (std::size_t k = 0; k < kCount; ++k) to[k] = static_cast<To>(from[k]);
  return to;
}

template <int kDims, typename Scalar, typename MapScalar>
void CheckImagesOfPoints() {
  ForEachSample(23, kSamples, 1, [](PointKind kind, Random& random) {
    const Layouts<kDims, Scalar> layouts(kind, random);
    const auto map = RandomAffine<kDims, MapScalar>(
        kind, As<MapScalar>(layouts.points[0]), random);
    ExactHull<kDims> hull;
    for (const auto& p : layouts.points) {
      hull.AddPoint(Image<kDims, Scalar>(p, map));
    }
    const auto bound = BoundTransformed(layouts.Strided(), map);
    ASSERT_TRUE(hull.IsEnclosedBy(bound, kTightest));
  });
}

TYPED_TEST(FitPointsExactTest, ImagesOfPoints) {
  CheckImagesOfPoints<TypeParam::value, float, float>();
  CheckImagesOfPoints<TypeParam::value, float, double>();
  CheckImagesOfPoints<TypeParam::value, double, double>();
}

template <int kDims, typename Scalar, typename MapScalar>
void CheckImagesOfBoxes() {
  ForEachSample(24, kSamples, 1, [](PointKind kind, Random& random) {
    const auto box = RandomBox<kDims, Scalar>(kind, random);
    const auto map =
        RandomAffine<kDims, MapScalar>(kind, As<MapScalar>(box.min), random);
    ExactHull<kDims> hull;
    for (std::size_t corner = 0; corner < (1u << kDims); ++corner) {
      Point<kDims, Scalar> point = box.min;
      for (std::size_t k = 0; k < kDims; ++k) {
        if ((corner >> k & 1) != 0) point[k] = box.max[k];
      }
      hull.AddPoint(Image<kDims, Scalar>(point, map));
    }
    const auto bound = BoundTransformed(box, map);
    ASSERT_TRUE(hull.IsEnclosedBy(bound, kTightest));
    if constexpr (sizeof(Scalar) == sizeof(float)) {
      ASSERT_EQ(BoundTransformed(Aabb<kDims>{box.min, box.max}, map), bound);
    }
  });
}

TYPED_TEST(FitPointsExactTest, ImagesOfBoxes) {
  CheckImagesOfBoxes<TypeParam::value, float, float>();
  CheckImagesOfBoxes<TypeParam::value, float, double>();
  CheckImagesOfBoxes<TypeParam::value, double, float>();
  CheckImagesOfBoxes<TypeParam::value, double, double>();
}

}  // namespace
}  // namespace halfspace::testing

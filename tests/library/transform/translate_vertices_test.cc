// TranslateVertices against vertices that were really moved, and rounded.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "halfspace/fit.h"
#include "tests/library/support/dims.h"
#include "tests/library/support/samples.h"
#include "tests/library/transform/exact_planes.h"

namespace halfspace::testing {
namespace {

constexpr std::size_t kSamples = 1000;

template <typename Dims>
class TranslateVerticesTest : public ::testing::Test {};
TYPED_TEST_SUITE(TranslateVerticesTest, AllDims, DimsNames);

// D may give way by what rounding can do to the largest coordinates, and round
// once; it was rounded when the bound was made.
template <int kDims>
void ExpectNoLooserThanDocumented(const Aabo<kDims>& moved,
                                  const Aabo<kDims>& bound,
                                  const Point<kDims>& by) {
  mpq_class give = 0;
  for (std::size_t k = 0; k < kDims; ++k) {
    give += Exact(std::max(std::fabs(moved.min[k]), std::fabs(moved.max[k])));
  }
  give *= Exact(0x1p-24);
  const mpq_class shift = -ExactSumOf(by);
  const mpq_class low = Exact(bound.min[kDims]) + shift - give;
  const mpq_class high = Exact(bound.max[kDims]) + shift + give;
  ASSERT_GE(std::nextafter(moved.min[kDims], detail::kInf<float>), low);
  ASSERT_LE(std::nextafter(moved.max[kDims], -detail::kInf<float>), high);
}

TYPED_TEST(TranslateVerticesTest, EnclosesMovedVertices) {
  constexpr int kDims = TypeParam::value;
  std::size_t exact_moves_that_cut = 0;
  ForEachSample(60, kSamples, 2, [&](PointKind kind, Random& random) {
    std::vector<Point<kDims>> points(1 + random() % 4);
    for (auto& p : points) p = RandomPointOf<kDims, float>(kind, random);
    const auto bound =
        BoundPoints<kDims>({points.front().data(), points.size()});
    auto by = RandomPointOf<kDims, float>(kind, random);
    if (kind == PointKind::kCancelling) {
      for (std::size_t k = 0; k < kDims; ++k) by[k] += points[0][k];
    }
    ExactHull<kDims> hull;
    for (auto& p : points) {
      for (std::size_t k = 0; k < kDims; ++k) p[k] += by[k];
      hull.AddPoint(ExactPointOf(p));
    }
    const auto moved = TranslateVertices(bound, by);
    constexpr Looseness kCoordinatesCopied{.d = kAnyFloats};
    ASSERT_TRUE(hull.IsEnclosedBy(moved, kCoordinatesCopied));
    ExpectNoLooserThanDocumented<kDims>(moved, bound, by);
    ASSERT_EQ(TranslateVertices(bound.aabb(), by), moved.aabb());
    exact_moves_that_cut +=
        !hull.IsEnclosedBy(Translate(bound, by), kAnyLooseness);
  });
  // Otherwise the other call would do.
  EXPECT_GT(exact_moves_that_cut, 0u);
}

TYPED_TEST(TranslateVerticesTest, PlanesWithoutABoundStaySo) {
  constexpr int kDims = TypeParam::value;
  ForEachSample(61, kSamples / 10, 1, [](PointKind kind, Random& random) {
    auto bound = RandomPlanes<kDims>(kind, random);
    const auto by = RandomPointOf<kDims, float>(kind, random);
    const auto moved = TranslateVertices(bound, by);
    for (std::size_t k = 0; k <= kDims; ++k) {
      if (bound.min[k] == -detail::kMax<float>) {
        ASSERT_EQ(moved.min[k], -detail::kMax<float>);
      }
      if (bound.max[k] == detail::kMax<float>) {
        ASSERT_EQ(moved.max[k], detail::kMax<float>);
      }
    }
  });
}

}  // namespace
}  // namespace halfspace::testing

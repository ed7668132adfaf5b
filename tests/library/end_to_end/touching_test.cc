// Objects that share one point, and touch on D only, are never told apart,
// although each side's D is a rounded sum of other numbers.
//
// "Naive" below is what a builder without outward rounding would do. It falsely
// rejects some of these pairs, which shows that they are hard enough.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "halfspace/halfspace.h"
#include "tests/library/end_to_end/kept.h"
#include "tests/library/end_to_end/point_beyond.h"
#include "tests/library/support/dims.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/exact.h"
#include "tests/library/support/inputs.h"
#include "tests/library/support/points.h"
#include "tests/library/support/samples.h"

namespace halfspace::testing {
namespace {

// Two point sets. Exact D is nowhere lower in `upper` than in `lower`, and the
// same in the point that both contain.
template <int kDims>
struct TouchingPair {
  std::vector<Point<kDims>> upper;
  std::vector<Point<kDims>> lower;
};

template <int kDims>
mpq_class ExactD(const Point<kDims>& point) {
  return -ExactSumOf(point);
}

// Triangles that share a vertex, in another place of the list.
template <int kDims>
TouchingPair<kDims> SharedVertex(Random& random) {
  const auto shared =
      RandomPoint<std::size_t{kDims}>(PointKind::kUniform, random);
  const auto beyond = [&](int sign) {
    return PointBeyond(shared, sign, 1.f, random);
  };
  return {{shared, beyond(1), beyond(1)}, {beyond(-1), beyond(-1), shared}};
}

// A vertex in the middle of the other's edge, along which D is constant: what
// one coordinate gains, another loses. Each coordinate is a whole multiple of
// a power of two of its own, so that the vertex is exactly on the edge, and the
// sums round more than once.
template <int kDims>
TouchingPair<kDims> VertexInsideEdge(Random& random) {
  constexpr int kHalf = 1 << 23;  // floats hold whole numbers up to twice that
  std::uniform_int_distribution<int> whole(-kHalf, kHalf);
  Point<kDims> middle;
  std::array<int, std::size_t{kDims}> exponent;
  for (std::size_t k = 0; k < middle.size(); ++k) {
    exponent[k] = RandomExponent(0, 6, random);
    middle[k] = std::ldexp(static_cast<float>(whole(random)), exponent[k]);
  }
  const std::size_t k = random() % kDims;
  const std::size_t other = (k + 1 + random() % (kDims - 1)) % kDims;
  const auto [fine, coarse] = std::minmax(exponent[k], exponent[other]);
  const float gain =
      std::ldexp(static_cast<float>(whole(random) >> (coarse - fine)), coarse);
  Point<kDims> begin = middle;
  begin[k] -= gain;
  begin[other] += gain;
  Point<kDims> end = middle;
  end[k] += gain;
  end[other] -= gain;
  EXPECT_EQ(ExactD<kDims>(begin), ExactD<kDims>(middle));
  EXPECT_EQ(ExactD<kDims>(end), ExactD<kDims>(middle));
  const auto beyond = [&](int sign) {
    return PointBeyond(middle, sign, 0x1p20f, random);
  };
  return {{middle, beyond(1), beyond(1)}, {begin, end, beyond(-1)}};
}

template <int kDims>
Aabo<kDims> BoundOf(const std::vector<Point<kDims>>& points) {
  return BoundPoints<kDims>({points.front().data(), points.size()});
}

// The same bound, by another way to the sums: coordinates in reverse.
template <int kDims>
Aabo<kDims> BoundReversed(std::vector<Point<kDims>> points) {
  for (auto& point : points) std::reverse(point.begin(), point.end());
  Aabo<kDims> bound = BoundOf<kDims>(points);
  std::reverse(bound.min.begin(), bound.min.end() - 1);
  std::reverse(bound.max.begin(), bound.max.end() - 1);
  return bound;
}

// A looser one, by the other builder.
template <int kDims>
Aabo<kDims> BoundOfBox(const std::vector<Point<kDims>>& points) {
  return BoundAabb(BoundOf<kDims>(points).aabb());
}

template <int kDims>
float NaiveD(const Point<kDims>& point) {
  float sum = 0.f;
  for (float x : point) sum += x;
  return -sum;
}
template <int kDims>
float NaiveDReversed(Point<kDims> point) {
  std::reverse(point.begin(), point.end());
  return NaiveD<kDims>(point);
}

// Whether naive sums, in one order on one side and in the other on the other,
// would tell the two apart on D.
template <int kDims>
bool NaiveRejects(const TouchingPair<kDims>& pair) {
  std::vector<float> upper;
  std::vector<float> lower;
  for (const auto& p : pair.upper) upper.push_back(NaiveD<kDims>(p));
  for (const auto& p : pair.lower) lower.push_back(NaiveDReversed<kDims>(p));
  return *std::min_element(upper.begin(), upper.end()) >
         *std::max_element(lower.begin(), lower.end());
}

template <typename Dims>
class TouchingTest : public ::testing::Test {
 protected:
  static constexpr int kDims = Dims::value;

  template <typename MakePair>
  void ExpectNeverRejected(MakePair make_pair) {
    Random random(10);
    std::size_t naive_rejects = 0;
    const std::size_t pairs = std::max<std::size_t>(1000, Scaled(5000));
    for (std::size_t i = 0; i < pairs; ++i) {
      const TouchingPair<kDims> pair = make_pair(random);
      naive_rejects += NaiveRejects(pair);
      const Aabo<kDims> upper[] = {BoundOf<kDims>(pair.upper),
                                   BoundReversed<kDims>(pair.upper),
                                   BoundOfBox<kDims>(pair.upper)};
      const Aabo<kDims> lower[] = {BoundOf<kDims>(pair.lower),
                                   BoundReversed<kDims>(pair.lower),
                                   BoundOfBox<kDims>(pair.lower)};
      for (const auto& one : upper) {
        for (const auto& other : lower) {
          ASSERT_TRUE(AllKept<kDims>({one, other}, {other, one}));
        }
      }
    }
    RecordSize("pairs", pairs);
    RecordSize("naive_rejects", naive_rejects);
    // Two floats have one sum, in either order.
    if (kDims > 2) {
      EXPECT_GT(naive_rejects, pairs / 1000);
    }
  }
};
TYPED_TEST_SUITE(TouchingTest, AllDims, DimsNames);

TYPED_TEST(TouchingTest, SharedVertex) {
  this->ExpectNeverRejected(SharedVertex<TypeParam::value>);
}

TYPED_TEST(TouchingTest, VertexInsideEdge) {
  this->ExpectNeverRejected(VertexInsideEdge<TypeParam::value>);
}

}  // namespace
}  // namespace halfspace::testing

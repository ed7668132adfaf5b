// Spheres that touch a point, a box or another sphere in one exact point, in a
// direction so near to D's that D alone could tell them apart.
//
// With d * d = a * a + b * b + ..., the sphere around c of radius s d touches
// c + s (a, b, ...) exactly. Where a, b, ... differ by 1, D ends less than an
// ulp behind the point that is touched; in 4D, where 1 + 1 + 1 + 1 = 2 * 2,
// right there.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "halfspace/halfspace.h"
#include "tests/library/end_to_end/kept.h"
#include "tests/library/support/dims.h"
#include "tests/library/support/exact_hull.h"
#include "tests/library/support/points.h"
#include "tests/library/support/samples.h"

namespace halfspace::testing {
namespace {

constexpr std::size_t kBatch = 64;
constexpr std::size_t kPairs = 5000;
constexpr std::size_t kFewestPairs = 1000;  // or the naive ones may all pass

// Whole numbers, the last one the length of the others.
template <int kDims>
using Tuple = std::array<int, static_cast<std::size_t>(kDims) + 1>;

[[maybe_unused]] std::vector<Tuple<2>> TuplesOf(DimsConstant<2>) {
  return {{119, 120, 169},
          {696, 697, 985},
          {4060, 4059, 5741},
          {23661, 23660, 33461},
          {137904, 137903, 195025}};
}
std::vector<Tuple<3>> TuplesOf(DimsConstant<3>) {
  return {{88, 88, 89, 153},
          {330, 330, 329, 571},
          {1230, 1230, 1231, 2131},
          {4592, 4592, 4591, 7953},
          {17136, 17136, 17137, 29681},
          {63954, 63954, 63953, 110771}};
}
[[maybe_unused]] std::vector<Tuple<4>> TuplesOf(DimsConstant<4>) {
  return {{1, 1, 1, 1, 2}};
}

template <int kDims>
struct TouchingSphere {
  Sphere<kDims> sphere;
  Point<kDims> touched;
  Sphere<kDims> other;  // on the other side of that point
};

// All of it exact: whole multiples of one power of two, below 2^24 of them.
// Their sums are larger, and round.
template <int kDims>
TouchingSphere<kDims> RandomTouchingSphere(Random& random) {
  const auto tuples = TuplesOf(DimsConstant<kDims>());
  Tuple<kDims> tuple = tuples[random() % tuples.size()];
  std::shuffle(tuple.begin(), tuple.end() - 1, random);
  const int largest = std::max(1, (1 << 19) / tuple[kDims]);
  const int times = 1 + static_cast<int>(random() % largest);
  const int side = OneIn(2, random) ? -1 : 1;
  const int exponent = RandomExponent(-30, 30, random);
  const auto scaled = [&](int whole) {
    return std::ldexp(static_cast<float>(whole), exponent);
  };
  constexpr int kMost = (1 << 24) - 2 * (1 << 19);
  std::uniform_int_distribution<int> whole(-kMost, kMost);
  TouchingSphere<kDims> result;
  result.sphere.radius = result.other.radius = scaled(times * tuple[kDims]);
  for (std::size_t k = 0; k < kDims; ++k) {
    const int center = whole(random);
    const int step = side * times * tuple[k];
    result.sphere.center[k] = scaled(center);
    result.touched[k] = scaled(center + step);
    result.other.center[k] = scaled(center + 2 * step);
  }
  return result;
}

template <int kDims>
bool TouchesExactly(const Sphere<kDims>& sphere, const Point<kDims>& point) {
  mpq_class squares = 0;
  for (std::size_t k = 0; k < kDims; ++k) {
    const mpq_class step = Exact(point[k]) - Exact(sphere.center[k]);
    squares += step * step;
  }
  return squares == Exact(sphere.radius) * Exact(sphere.radius);
}

// A box that has the point as the corner that faces the sphere.
template <int kDims>
Aabb<kDims> BoxBehind(const TouchingSphere<kDims>& pair) {
  Aabb<kDims> box;
  for (std::size_t k = 0; k < kDims; ++k) {
    const auto [low, high] = std::minmax(pair.touched[k], pair.other.center[k]);
    box.min[k] = low;
    box.max[k] = high;
  }
  return box;
}

template <int kDims>
std::vector<Aabo<kDims>> BoundInBulk(const std::vector<Sphere<kDims>>& spheres,
                                     const FitOptions& options) {
  AaboWorld<kDims> world;
  world.Resize(spheres.size());
  Spheres<kDims> source{.radius = &spheres[0].radius,
                        .count = spheres.size(),
                        .stride = sizeof(Sphere<kDims>) / sizeof(float)};
  for (std::size_t k = 0; k < kDims; ++k) {
    source.center[k] = spheres[0].center.data() + k;
  }
  BoundSpheres(source, world.planes(), options);
  std::vector<Aabo<kDims>> bounds;
  for (std::size_t i = 0; i < world.size(); ++i) bounds.push_back(world.Get(i));
  return bounds;
}

// The spheres' bounds by every builder.
template <int kDims>
std::vector<std::vector<Aabo<kDims>>> BoundByAll(
    const std::vector<Sphere<kDims>>& spheres) {
  std::vector<std::vector<Aabo<kDims>>> all(4);
  for (const Sphere<kDims>& sphere : spheres) {
    Sphere<kDims, double> wide{{}, sphere.radius};
    std::copy(sphere.center.begin(), sphere.center.end(), wide.center.begin());
    all[0].push_back(BoundSphere(sphere));
    all[1].push_back(BoundSphere(wide));
    all[2].push_back(
        BoundCapsule<kDims>({sphere.center, sphere.center, sphere.radius}));
    all[3].push_back(Inflate(BoundPoint<kDims>(sphere.center), sphere.radius));
  }
  for (Target target : TargetsUnderTest()) {
    for (bool tightest : {false, true}) {
      all.push_back(BoundInBulk<kDims>(
          spheres, {.tightest = tightest, .target = target}));
    }
  }
  return all;
}

template <int kDims>
float NaiveSum(const Point<kDims>& point) {
  float sum = 0.f;
  for (float x : point) sum += x;
  return sum;
}

// Whether D of the sphere, rounded to nearest, ends before the point.
template <int kDims>
bool NaiveRejects(const TouchingSphere<kDims>& pair) {
  const float reach =
      pair.sphere.radius * static_cast<float>(std::sqrt(double{kDims}));
  const float center = NaiveSum<kDims>(pair.sphere.center);
  const float point = NaiveSum<kDims>(pair.touched);
  return point > center + reach || point < center - reach;
}

template <typename Dims>
class TouchingSpheresTest : public ::testing::Test {};
TYPED_TEST_SUITE(TouchingSpheresTest, AllDims, DimsNames);

TYPED_TEST(TouchingSpheresTest, AreKept) {
  constexpr int kDims = TypeParam::value;
  using Bounds = std::vector<Aabo<kDims>>;
  Random random(110);
  const std::size_t pairs = std::max(kFewestPairs, Scaled(kPairs));
  std::size_t naive_rejects = 0;
  for (std::size_t done = 0; done < pairs; done += kBatch) {
    std::vector<Sphere<kDims>> spheres;
    std::vector<Sphere<kDims>> other_spheres;
    Bounds points;
    Bounds boxes;
    for (std::size_t i = 0; i < kBatch; ++i) {
      const auto pair = RandomTouchingSphere<kDims>(random);
      ASSERT_TRUE(TouchesExactly<kDims>(pair.sphere, pair.touched));
      ASSERT_TRUE(TouchesExactly<kDims>(pair.other, pair.touched));
      naive_rejects += NaiveRejects<kDims>(pair);
      spheres.push_back(pair.sphere);
      other_spheres.push_back(pair.other);
      points.push_back(BoundPoint<kDims>(pair.touched));
      boxes.push_back(BoundAabb(BoxBehind<kDims>(pair)));
    }
    const auto others = BoundByAll<kDims>(other_spheres);
    for (const Bounds& bounds : BoundByAll<kDims>(spheres)) {
      ASSERT_TRUE(AllKept<kDims>(bounds, points));
      ASSERT_TRUE(AllKept<kDims>(points, bounds));
      ASSERT_TRUE(AllKept<kDims>(bounds, boxes));
      ASSERT_TRUE(AllKept<kDims>(boxes, bounds));
      const Bounds& other = others[random() % others.size()];
      ASSERT_TRUE(AllKept<kDims>(bounds, other));
      ASSERT_TRUE(AllKept<kDims>(other, bounds));
    }
  }
  RecordSize("pairs", 3 * pairs);
  RecordSize("naive_rejects", naive_rejects);
  EXPECT_GT(naive_rejects, pairs / 100) << "of " << pairs;
}

}  // namespace
}  // namespace halfspace::testing

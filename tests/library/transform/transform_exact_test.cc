// Bounds of bounds against the exact planes.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "halfspace/transform.h"
#include "tests/library/support/dims.h"
#include "tests/library/support/samples.h"
#include "tests/library/transform/exact_planes.h"

namespace halfspace::testing {
namespace {

constexpr std::size_t kSamples = 600;
constexpr std::size_t kBounds = 4;  // each sample: an AABO and its three parts

template <typename Dims>
class TransformExactTest : public ::testing::Test {};
TYPED_TEST_SUITE(TransformExactTest, AllDims, DimsNames);

TYPED_TEST(TransformExactTest, Merge) {
  constexpr int kDims = TypeParam::value;
  ForEachSample(50, kSamples, kBounds, [](PointKind kind, Random& random) {
    const auto a = RandomPlanes<kDims>(kind, random);
    const auto b = RandomPlanes<kDims>(kind, random);
    auto expected = a;
    for (std::size_t k = 0; k <= kDims; ++k) {
      expected.min[k] = std::min(a.min[k], b.min[k]);
      expected.max[k] = std::max(a.max[k], b.max[k]);
    }
    ASSERT_EQ(Merge(a, b), expected);
    ASSERT_EQ(Merge(b, a), expected);
    ASSERT_EQ(Merge(a.up(), b.up()), expected.up());
    ASSERT_EQ(Merge(a.down(), b.down()), expected.down());
    ASSERT_EQ(Merge(a.aabb(), b.aabb()), expected.aabb());
  });
}

TYPED_TEST(TransformExactTest, Inflate) {
  constexpr int kDims = TypeParam::value;
  ForEachSample(51, kSamples, kBounds, [](PointKind kind, Random& random) {
    const auto bound = RandomPlanes<kDims>(kind, random);
    float radius = RandomLength<float>(kind, random);
    if (kind == PointKind::kCancelling && bound.min[kDims] > -0x1p100f) {
      radius = std::fabs(bound.min[kDims]) / std::sqrt(float{kDims});
    }
    ExactPlanes<kDims> exact(bound);
    exact.ForEach([&](ExactValue& value, std::size_t axis, int sign) {
      const mpq_class grow = sign * Exact(radius);
      if (axis == kDims) {
        value = {value.rational, grow, kDims};
      } else {
        value.rational += grow;
      }
    });
    const auto inflate = [&](const auto& b) { return Inflate(b, radius); };
    ASSERT_TRUE(exact.AreTightIn(inflate(bound), {.d = 1}));
    ASSERT_TRUE(SameOfParts(bound, inflate));
  });
}

TYPED_TEST(TransformExactTest, InflateByBox) {
  constexpr int kDims = TypeParam::value;
  ForEachSample(52, kSamples, kBounds, [](PointKind kind, Random& random) {
    const auto bound = RandomPlanes<kDims>(kind, random);
    const float margin = RandomLength<float>(kind, random);
    ExactPlanes<kDims> exact(bound);
    exact.ForEach([&](ExactValue& value, std::size_t axis, int sign) {
      const int times = axis == kDims ? kDims : 1;
      value.rational += sign * times * Exact(margin);
    });
    const auto inflate = [&](const auto& b) { return InflateByBox(b, margin); };
    ASSERT_TRUE(exact.AreTightIn(inflate(bound), kTightest));
    ASSERT_TRUE(SameOfParts(bound, inflate));
  });
}

// What the exact move adds to a coordinate or to D.
template <std::size_t kDims>
mpq_class ShiftOf(const std::array<float, kDims>& by, std::size_t axis) {
  if (axis == kDims) return -ExactSumOf(by);
  return Exact(by[axis]);
}

template <int kDims>
Point<kDims> RandomMove(PointKind kind, const Aabo<kDims>& bound,
                        Random& random) {
  auto by = RandomPointOf<kDims, float>(kind, random);
  if (kind == PointKind::kCancelling) {
    for (std::size_t k = 0; k < kDims; ++k) {
      if (bound.max[k] < 0x1p100f) by[k] = -bound.max[k];
    }
  }
  return by;
}

TYPED_TEST(TransformExactTest, Translate) {
  constexpr int kDims = TypeParam::value;
  ForEachSample(53, kSamples, kBounds, [](PointKind kind, Random& random) {
    const auto bound = RandomPlanes<kDims>(kind, random);
    const auto by = RandomMove<kDims>(kind, bound, random);
    ExactPlanes<kDims> exact(bound);
    exact.ForEach([&](ExactValue& value, std::size_t axis, int) {
      value.rational += ShiftOf(by, axis);
    });
    const auto translate = [&](const auto& b) { return Translate(b, by); };
    ASSERT_TRUE(exact.AreTightIn(translate(bound), kTightest));
    ASSERT_TRUE(SameOfParts(bound, translate));
  });
}

TYPED_TEST(TransformExactTest, Sweep) {
  constexpr int kDims = TypeParam::value;
  ForEachSample(54, kSamples, kBounds, [](PointKind kind, Random& random) {
    const auto bound = RandomPlanes<kDims>(kind, random);
    const auto motion = RandomMove<kDims>(kind, bound, random);
    ExactPlanes<kDims> exact(bound);
    exact.ForEach([&](ExactValue& value, std::size_t axis, int sign) {
      const mpq_class shift = ShiftOf(motion, axis);
      if (sgn(shift) == sign) value.rational += shift;
    });
    const auto sweep = [&](const auto& b) { return Sweep(b, motion); };
    ASSERT_TRUE(exact.AreTightIn(sweep(bound), kTightest));
    ASSERT_TRUE(SameOfParts(bound, sweep));
  });
}

TYPED_TEST(TransformExactTest, Scale) {
  constexpr int kDims = TypeParam::value;
  ForEachSample(55, kSamples, kBounds, [](PointKind kind, Random& random) {
    const auto bound = RandomPlanes<kDims>(kind, random);
    const float factor = OneIn(16, random) ? 0.f : RandomFactor(kind, random);
    ExactPlanes<kDims> exact(bound);
    if (factor < 0.f) std::swap(exact.min, exact.max);
    exact.ForEach([&](ExactValue& value, std::size_t, int) {
      value.rational *= Exact(factor);
    });
    const auto scale = [&](const auto& b) { return Scale(b, factor); };
    ASSERT_TRUE(exact.AreTightIn(scale(bound), kTightest));
    ASSERT_EQ(scale(bound.aabb()), scale(bound).aabb());
    if (factor >= 0.f) {
      ASSERT_TRUE(SameOfSimplices(bound, scale));
    }
  });
}

// The planes of the axes sum to zero: on each axis, what the others leave.
TYPED_TEST(TransformExactTest, Circumscribe) {
  constexpr int kDims = TypeParam::value;
  ForEachSample(56, kSamples, 2, [](PointKind kind, Random& random) {
    UpSimplex<kDims> simplex{RandomPoint<kDims + 1>(kind, random)};
    // Some point must be inside.
    if (sgn(ExactSumOf(simplex.min)) > 0) {
      for (float& min : simplex.min) min = -min;
    }
    const mpq_class sum = ExactSumOf(simplex.min);
    const auto down = Circumscribe(simplex);
    DownSimplex<kDims> turned;
    for (std::size_t k = 0; k <= kDims; ++k) {
      const mpq_class others = sum - Exact(simplex.min[k]);
      ASSERT_TRUE(IsTightestAbove(down.max[k], mpq_class(-others)));
      turned.max[k] = -simplex.min[k];
    }
    const auto up = Circumscribe(turned);
    for (std::size_t k = 0; k <= kDims; ++k) {
      ASSERT_EQ(up.min[k], -down.max[k]);
    }
  });
}

}  // namespace
}  // namespace halfspace::testing

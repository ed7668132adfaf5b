// The caller's floating-point mode changes no bound and no error, and is left
// as it was.
#include <gtest/gtest.h>

#include <bit>
#include <cfenv>
#include <cstddef>
#include <cstdint>
#include <stdexcept>

#include "halfspace/halfspace.h"
#include "tests/library/fit/every_builder.h"
#include "tests/library/fit/random_every_shape.h"
#include "tests/library/support/dims.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/expect_invalid.h"
#include "tests/library/support/fp_modes.h"

namespace halfspace::testing {
namespace {

// All numbers of the shapes.
template <int kDims>
void FillWith(float value, double wide, EveryShape<kDims>& s) {
  const auto fill = [&](auto&... points) { (points.fill(value), ...); };
  for (auto& point : s.points) fill(point);
  for (auto& point : s.wide_points) point.fill(wide);
  for (auto& axis : s.oriented_box.axes) fill(axis);
  for (auto& row : s.map.linear) fill(row);
  for (auto& plane : s.planes) fill(plane.normal);
  for (auto& plane : s.planes) plane.offset = value;
  fill(s.ray.origin, s.ray.direction, s.box.min, s.box.max,
       s.oriented_box.center, s.oriented_box.half_extents, s.sphere.center,
       s.capsule.a, s.capsule.b, s.map.translation, s.bound.min, s.bound.max,
       s.simplex.min, s.move);
  s.ray.max_t = s.sphere.radius = s.capsule.radius = value;
  s.length = s.factor = value;
  s.wide_box.min.fill(wide);
  s.wide_box.max.fill(wide);
  s.wide_sphere.center.fill(wide);
  s.wide_sphere.radius = wide;
  for (auto& box : s.boxes) fill(box.min, box.max);
  for (auto& sphere : s.spheres) {
    fill(sphere.center);
    sphere.radius = value;
  }
  for (auto& vertex : s.vertices) fill(vertex);
}

template <typename Dims>
class FitFpModesTest : public ::testing::Test {
 protected:
  static Bits Bound(const EveryShape<Dims::value>& shape) {
    return BitsOfEveryBound(shape, TargetsUnderTest());
  }

  // enter() returns an object in whose life another mode rules. Bounds are
  // compared as bits: a compare of floats would depend on the mode.
  template <typename Enter>
  static void ExpectSameBounds(Enter enter) {
    Random random(9);
    for (PointKind kind : kPointKinds) {
      for (std::size_t i = 0; i < Scaled(30); ++i) {
        const auto shape = RandomEveryShape<Dims::value>(kind, random);
        const Bits expected = Bound(shape);
        Bits given;
        {
          const auto mode = enter();
          given = Bound(shape);
        }
        ASSERT_EQ(given, expected) << NameOf(kind) << ", sample " << i;
      }
    }
  }
};
TYPED_TEST_SUITE(FitFpModesTest, AllDims, DimsNames);

TYPED_TEST(FitFpModesTest, SubnormalsCountWhereTheyAreFlushed) {
  this->ExpectSameBounds([] { return FlushDenormals(); });
}

TYPED_TEST(FitFpModesTest, RoundingIsOutwardInEveryMode) {
  for (int mode : {FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO}) {
    SCOPED_TRACE(mode);
    this->ExpectSameBounds([mode] { return RoundingMode(mode); });
  }
}

TYPED_TEST(FitFpModesTest, NothingIsTrapped) {
  this->ExpectSameBounds([] { return TrapExceptions(); });
}

// With such values in every number that a builder takes, where it refuses them
// too. As bits, because to convert a signalling NaN is an exception itself.
TYPED_TEST(FitFpModesTest, NothingIsTrappedWhateverTheValues) {
  struct Special {
    std::uint32_t narrow;
    std::uint64_t wide;
  };
  Random random(9);
  auto shape = RandomEveryShape<TypeParam::value>(PointKind::kUniform, random);
  const auto targets = TargetsUnderTest();
  for (const auto& [narrow, wide] :
       {Special{0x7fc00000, 0x7ff8'0000'0000'0000},     // NaN
        Special{0xff800001, 0x7ff0'0000'0000'0001},     // a signalling one
        Special{0x7f800000, 0x7ff0'0000'0000'0000},     // infinity
        Special{0x7f7fffff, 0x7fef'ffff'ffff'ffff},     // the largest
        Special{0xff7fffff, 0xffef'ffff'ffff'ffff},     // the smallest
        Special{0x00000001, 0x0000'0000'0000'0001}}) {  // a subnormal
    SCOPED_TRACE(narrow);
    FillWith(std::bit_cast<float>(narrow), std::bit_cast<double>(wide), shape);
    VisitEveryBuilder(shape, targets, [](const auto& call) {
      bool is_untouched = false;
      {
        const TrapExceptions trap;
        try {
          (void)call();
        } catch (const std::invalid_argument&) {
        }
        is_untouched = trap.IsUntouched();
      }
      EXPECT_TRUE(is_untouched);
    });
  }
}

TYPED_TEST(FitFpModesTest, ModesAreLeftAsTheyWere) {
  Random random(9);
  const auto shape =
      RandomEveryShape<TypeParam::value>(PointKind::kUniform, random);
  for (int mode : {FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO}) {
    const RoundingMode rounding(mode);
    this->Bound(shape);
    EXPECT_EQ(std::fegetround(), mode);
  }
  if (FlushDenormals::kAvailable) {
    const FlushDenormals flush;
    this->Bound(shape);
    EXPECT_TRUE(FlushDenormals::IsOn());
  }
}

// The least number below zero is below zero, and one above another is so even
// where compares take both for zero. A throw leaves the mode as it was, too.
TYPED_TEST(FitFpModesTest, SubnormalMistakesAreRefused) {
  constexpr int kDims = TypeParam::value;
  constexpr float kLeast = -0x1p-149f;
  const Aabo<kDims> bound{};
  const auto expect_refused = [](auto call) {
    ::testing::AssertionResult refused = ::testing::AssertionSuccess();
    bool is_on = true;
    {
      const FlushDenormals flush;
      refused = Refuses(call, {"expected"});
      is_on = FlushDenormals::kAvailable == FlushDenormals::IsOn();
    }
    EXPECT_TRUE(refused);
    EXPECT_TRUE(is_on);
  };
  expect_refused([&] { BoundSphere(Sphere<kDims>{{}, kLeast}); });
  expect_refused([&] { BoundSphere(Sphere<kDims, double>{{}, -0x1p-1074}); });
  expect_refused([&] { BoundCapsule(Capsule<kDims>{{}, {}, kLeast}); });
  expect_refused([&] {
    OrientedBox<kDims> box{};
    box.half_extents[kDims - 1] = kLeast;
    BoundOrientedBox(box);
  });
  expect_refused([&] { BoundRay(Ray<kDims>{{}, {}, kLeast}); });
  Aabb<kDims> inverted{};
  inverted.max[0] = kLeast;
  expect_refused([&] { BoundAabb(inverted); });
  expect_refused([&] { BoundTransformed(inverted, Affine<kDims>{}); });
  expect_refused([&] { Inflate(bound, kLeast); });
  expect_refused([&] { InflateByBox(bound.aabb(), kLeast); });
  expect_refused([&] { Scale(bound.up(), kLeast); });
  expect_refused([&] { Scale(bound.down(), kLeast); });
  expect_refused([&] { Circumscribe(UpSimplex<kDims>{{-kLeast}}); });
}

}  // namespace
}  // namespace halfspace::testing

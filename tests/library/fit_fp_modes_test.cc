// The caller's floating-point mode changes no bound and no error, and is left
// as it was.
#include <gtest/gtest.h>

#include <cfenv>
#include <cstddef>

#include "halfspace/halfspace.h"
#include "tests/library/dims.h"
#include "tests/library/environment.h"
#include "tests/library/every_builder.h"
#include "tests/library/expect_invalid.h"
#include "tests/library/fp_modes.h"
#include "tests/library/random_every_shape.h"

namespace halfspace::testing {
namespace {

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

// The caller's floating-point mode changes no bound, and is left as it was.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cfenv>
#include <cstddef>
#include <cstdint>

#include "halfspace/fit.h"
#include "tests/library/dims.h"
#include "tests/library/fp_modes.h"
#include "tests/library/points.h"

namespace halfspace::testing {
namespace {

template <typename Dims>
class FitFpModesTest : public ::testing::Test {
 protected:
  static constexpr std::size_t kCoords = Dims::value;
  using Bits = std::array<std::uint32_t, 2 * (kCoords + 1)>;

  // Both builders' bounds of two points. As bits: a compare of floats would
  // depend on the mode.
  struct Bounds {
    Bits of_points;
    Bits of_box;
    bool operator==(const Bounds&) const = default;
  };

  struct Sample {
    std::array<float, 2 * kCoords> coords;
    Aabb<Dims::value> box;
  };

  static Sample MakeSample(PointKind kind, Random& random) {
    const auto a = RandomPoint<kCoords>(kind, random);
    const auto b = RandomPoint<kCoords>(kind, random);
    Sample sample;
    for (std::size_t k = 0; k < kCoords; ++k) {
      sample.coords[k] = a[k];
      sample.coords[kCoords + k] = b[k];
      sample.box.min[k] = std::min(a[k], b[k]);
      sample.box.max[k] = std::max(a[k], b[k]);
    }
    return sample;
  }

  static Bounds Bound(const Sample& sample) {
    return {std::bit_cast<Bits>(
                BoundPoints<Dims::value>({sample.coords.data(), 2})),
            std::bit_cast<Bits>(BoundAabb(sample.box))};
  }

  // enter() returns an object in whose life another mode rules.
  template <typename Enter>
  static void ExpectSameBounds(Enter enter) {
    Random random(9);
    for (PointKind kind : kPointKinds) {
      for (int i = 0; i < 500; ++i) {
        const Sample sample = MakeSample(kind, random);
        const Bounds expected = Bound(sample);
        Bounds given;
        {
          const auto mode = enter();
          given = Bound(sample);
        }
        ASSERT_TRUE(given == expected) << NameOf(kind) << ", sample " << i;
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
  const auto sample = this->MakeSample(PointKind::kUniform, random);
  for (int mode : {FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO}) {
    const RoundingMode rounding(mode);
    this->Bound(sample);
    EXPECT_EQ(std::fegetround(), mode);
  }
  if (FlushDenormals::kAvailable) {
    const FlushDenormals flush;
    this->Bound(sample);
    EXPECT_TRUE(FlushDenormals::IsOn());
  }
}

}  // namespace
}  // namespace halfspace::testing

// Builds so large that they are written past the caches, against small ones.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>

#include "halfspace/fit_many.h"
#include "tests/library/arena.h"
#include "tests/library/bulk_point_sources.h"
#include "tests/library/bulk_sources.h"
#include "tests/library/environment.h"

namespace halfspace::testing {
namespace {

// In 3D an AABO takes 32 bytes: 96 MiB, and a tail.
constexpr std::size_t kLarge = 3 * (std::size_t{1} << 20) + 64 + 3;
constexpr std::size_t kSmall = 4093;  // prime: no two tiles are alike

template <typename Source>
class FitManyLargeTest : public ::testing::Test {
 protected:
  static AaboPlanes3 NewPlanes(Arena& arena, std::size_t size) {
    AaboPlanes3 planes{.min = {}, .max = {}, .size = size};
    for (float*& plane : planes.min) plane = arena.New<float>(size);
    for (float*& plane : planes.max) plane = arena.New<float>(size);
    return planes;
  }

  static void ExpectRepeated(const std::array<float*, 4>& large,
                             const std::array<float*, 4>& small) {
    for (std::size_t k = 0; k < 4; ++k) {
      for (std::size_t i = 0; i < kLarge; i += kSmall) {
        const std::size_t count = std::min(kSmall, kLarge - i);
        ASSERT_EQ(std::memcmp(large[k] + i, small[k], count * sizeof(float)), 0)
            << "plane " << k << ", from shape " << i;
      }
    }
  }
};

// Point sets are written one by one whatever their number.
using Sources =
    ::testing::Types<BoxSource<3>, SphereSource<3>, TriangleSource<3>>;
TYPED_TEST_SUITE(FitManyLargeTest, Sources, BulkSourceNames);

TYPED_TEST(FitManyLargeTest, AreTheSameAsSmallOnes) {
#if !defined(__x86_64__)
  GTEST_SKIP() << "only on x86 do large builds take a path of their own";
#endif
  Random random(80);
  auto small = TypeParam::Random(PointKind::kUniform, kSmall, random);
  auto large = small;
  large.Cycle(kLarge);
  for (Layout layout : {Layout::kColumns, Layout::kPacked}) {
    Arena inputs;
    small.Place(inputs, layout);
    large.Place(inputs, layout);
    Arena outputs;
    const auto expected = this->NewPlanes(outputs, kSmall);
    small.Bound(expected);
    const auto planes = this->NewPlanes(outputs, kLarge);
    for (Target target : TargetsUnderTest()) {
      for (const auto& plane : {planes.min, planes.max}) {
        for (float* p : plane) std::fill(p, p + kLarge, 0.f);
      }
      FitStatus status;
      large.Bound(planes, {.target = target}, &status);
      this->ExpectRepeated(planes.min, expected.min);
      this->ExpectRepeated(planes.max, expected.max);
      ASSERT_TRUE(outputs.Intact());
      ASSERT_EQ(status.results, kLarge);
      ASSERT_EQ(status.everything, 0u);
      if (this->HasFailure()) return;
    }
  }
}

}  // namespace
}  // namespace halfspace::testing

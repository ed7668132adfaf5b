// Builds so large that they are written past the caches, against small ones.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <span>

#include "halfspace/fit_many.h"
#include "tests/library/fit_many/arena.h"
#include "tests/library/fit_many/bulk_point_sources.h"
#include "tests/library/fit_many/bulk_sources.h"
#include "tests/library/support/environment.h"

namespace halfspace::testing {
namespace {

// In 3D an AABO takes 32 bytes: 96 MiB, and a tail.
constexpr std::size_t kLarge = 3 * (std::size_t{1} << 20) + 64 + 3;
constexpr std::size_t kSmall = 4093;  // prime: no two tiles are alike

AaboPlanes3 NewPlanes(Arena& arena, std::size_t size) {
  AaboPlanes3 planes{.min = {}, .max = {}, .size = size};
  for (float*& plane : planes.min) plane = arena.New<float>(size);
  for (float*& plane : planes.max) plane = arena.New<float>(size);
  return planes;
}

template <typename Source>
class FitManyLargeTest : public ::testing::Test {
 protected:
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
    const auto expected = NewPlanes(outputs, kSmall);
    small.Bound(expected);
    const auto planes = NewPlanes(outputs, kLarge);
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

// Stores past the caches fault where they are not aligned. One box, over and
// over; the other seven planes alone would be large enough for such stores.
TEST(FitManyLargeMisalignedTest, OnePlane) {
  constexpr std::size_t kBoxes = std::size_t{4} << 20;
  constexpr Aabb3 kBox = {{1, 2, 3}, {4, 5, 6}};
  constexpr Aabo3 kBound = {{1, 2, 3, -15}, {4, 5, 6, -6}};
  Boxes3 boxes = BoxesOf<3>(std::span(&kBox, 1));
  boxes.count = kBoxes;
  boxes.stride = 0;
  Arena aligned;
  AaboPlanes3 planes = NewPlanes(aligned, kBoxes);
  Arena misaligned(1);
  planes.max[3] = misaligned.New<float>(kBoxes);
  const auto is_all = [](const float* plane, float value) {
    return std::all_of(plane, plane + kBoxes,
                       [value](float x) { return x == value; });
  };
  for (Target target : TargetsUnderTest()) {
    BoundBoxes(boxes, planes, {.tightest = true, .target = target});
    for (std::size_t k = 0; k < 4; ++k) {
      ASSERT_TRUE(is_all(planes.min[k], kBound.min[k])) << target.name();
      ASSERT_TRUE(is_all(planes.max[k], kBound.max[k])) << target.name();
      std::fill(planes.min[k], planes.min[k] + kBoxes, 0.f);
      std::fill(planes.max[k], planes.max[k] + kBoxes, 0.f);
    }
  }
  EXPECT_TRUE(aligned.Intact());
  EXPECT_TRUE(misaligned.Intact());
}

}  // namespace
}  // namespace halfspace::testing

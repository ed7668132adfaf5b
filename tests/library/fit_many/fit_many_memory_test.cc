// The bulk builders read nothing past their inputs, write nothing past their
// outputs, and give the same bounds wherever those lie: every size to a few
// vectors, every misalignment, strides, and pages that cannot be touched.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "halfspace/world.h"
#include "tests/library/fit_many/bulk_point_sources.h"
#include "tests/library/fit_many/bulk_sources.h"
#include "tests/library/support/samples.h"

namespace halfspace::testing {
namespace {

template <typename Source>
class FitManyMemoryTest : public ::testing::Test {
 protected:
  static constexpr int kDims = Source::kDimensions;
  using Bound = Aabo<kDims>;
  using Bits = std::array<std::uint32_t, sizeof(Bound) / 4>;

  // More than all sizes that are tried.
  static std::size_t Most() { return 64 + 4 * MostLanes() + 4; }

  // The shapes 0 .. count - 1 of `all`.
  static Source First(const Source& all, std::size_t count) {
    Source some = all;
    some.Truncate(count);
    return some;
  }

  static AaboPlanes<kDims> NewPlanes(Arena& arena, std::size_t size) {
    AaboPlanes<kDims> planes{.min = {}, .max = {}, .size = size};
    for (float*& plane : planes.min) plane = arena.New<float>(size);
    for (float*& plane : planes.max) plane = arena.New<float>(size);
    return planes;
  }

  static Bits BitsOf(const AaboPlanes<kDims>& planes, std::size_t i) {
    Bound bound;
    for (std::size_t k = 0; k < bound.min.size(); ++k) {
      bound.min[k] = planes.min[k][i];
      bound.max[k] = planes.max[k][i];
    }
    return std::bit_cast<Bits>(bound);
  }

  // The bounds of all, on one target, in aligned memory.
  void Expect(const Source& all) {
    Source source = all;
    source.Place(arena_, Layout::kColumns);
    expected_ = NewPlanes(arena_, source.size());
    source.Bound(expected_, {.target = TargetsUnderTest().front()});
  }

  // The first `count`, with inputs and outputs in this memory.
  void ExpectSame(const Source& all, std::size_t count, Layout layout,
                  Target target, Arena& arena) {
    Source source = First(all, count);
    source.Place(arena, layout);
    const auto planes = NewPlanes(arena, count);
    source.Bound(planes, {.target = target});
    for (std::size_t i = 0; i < count; ++i) {
      ASSERT_EQ(BitsOf(planes, i), BitsOf(expected_, i))
          << "shape " << i << " of " << count << ", layout "
          << static_cast<int>(layout) << ", " << target.name();
    }
    ASSERT_TRUE(arena.Intact()) << count << ", " << target.name();
  }

  static Source RandomShapes() {
    Random random(73);
    return Source::Random(PointKind::kWideExponents, Most(), random);
  }

 private:
  Arena arena_;
  AaboPlanes<kDims> expected_;
};

// Each source with few columns and with many. Doubles are bounded one by one.
#if defined(HALFSPACE_TEST_ONLY_3D)
using MemorySources = AllBulkSources;
#else
using MemorySources =
    ::testing::Types<BoxSource<2>, BoxSource<4>, SphereSource<2>,
                     SphereSource<3>, TriangleSource<3>, TriangleSource<4>,
                     PointSetSource<2>, PointSetSource<3>, BoxSource<3, double>,
                     SphereSource<3, double>, TriangleSource<3, double>,
                     PointSetSource<3, double>>;
#endif
TYPED_TEST_SUITE(FitManyMemoryTest, MemorySources, BulkSourceNames);

TYPED_TEST(FitManyMemoryTest, EverySizeAndStride) {
  const auto all = this->RandomShapes();
  this->Expect(all);
  for (Target target : TargetsUnderTest()) {
    for (std::size_t n = 0; n <= 64 + 4 * target.lanes() + 3; ++n) {
      for (Layout layout : kLayouts) {
        Arena arena;
        this->ExpectSame(all, n, layout, target, arena);
        if (this->HasFatalFailure()) return;
      }
    }
  }
}

TYPED_TEST(FitManyMemoryTest, EveryMisalignment) {
  const auto all = this->RandomShapes();
  this->Expect(all);
  for (Target target : TargetsUnderTest()) {
    for (std::size_t offset = 0; offset < target.lanes(); ++offset) {
      for (std::size_t n : {std::size_t{5}, 64 + target.lanes() + 1}) {
        for (Layout layout : kLayouts) {
          Arena arena(offset);
          this->ExpectSame(all, n, layout, target, arena);
          if (this->HasFatalFailure()) return;
        }
      }
    }
  }
}

#if defined(__unix__)
TYPED_TEST(FitManyMemoryTest, GuardPages) {
  const auto all = this->RandomShapes();
  this->Expect(all);
  for (Target target : TargetsUnderTest()) {
    for (std::size_t n = 0; n <= 64 + 4 * target.lanes() + 3; ++n) {
      // All of them at a small size; around whole vectors and tiles beyond.
      if (n > target.lanes() + 1 && n % target.lanes() > 1) continue;
      for (Layout layout : kLayouts) {
        for (GuardedSide side : {GuardedSide::kBefore, GuardedSide::kAfter}) {
          Arena arena(side);
          this->ExpectSame(all, n, layout, target, arena);
          if (this->HasFatalFailure()) return;
        }
      }
    }
  }
}
#endif

// Stride 0: the first shape again and again.
TYPED_TEST(FitManyMemoryTest, BoxesAndSpheresOfStrideZero) {
  auto source = this->RandomShapes();
  if constexpr (requires { source.shapes; }) {
    const std::size_t size = source.size();
    source.Truncate(1);
    Arena arena;
    source.Place(arena, Layout::kColumns);
    source.Repeat(size);
    const auto planes = this->NewPlanes(arena, size);
    for (Target target : TargetsUnderTest()) {
      source.Bound(planes, {.target = target});
      for (std::size_t i = 1; i < size; ++i) {
        ASSERT_EQ(this->BitsOf(planes, i), this->BitsOf(planes, 0));
      }
    }
  }
}

}  // namespace
}  // namespace halfspace::testing

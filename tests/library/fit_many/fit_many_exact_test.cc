// The bulk builders against exact extremes and the single builders, on every
// target.
#include <gtest/gtest.h>

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "halfspace/world.h"
#include "tests/library/fit_many/bulk_point_sources.h"
#include "tests/library/fit_many/bulk_sources.h"
#include "tests/library/support/samples.h"

namespace halfspace::testing {
namespace {

constexpr std::size_t kBatches = 3;
constexpr std::size_t kShapes = 150;  // more than two tiles and a tail

template <typename Source>
class FitManyExactTest : public ::testing::Test {};

TYPED_TEST_SUITE(FitManyExactTest, AllBulkSources, BulkSourceNames);

template <typename Source>
AaboWorld<Source::kDimensions> Built(const Source& source,
                                     const FitOptions& options) {
  AaboWorld<Source::kDimensions> world;
  world.Resize(source.size());
  FitStatus status;
  EXPECT_EQ(source.Bound(world.planes(), options, &status), options.target);
  EXPECT_EQ(status.results, source.size());
  EXPECT_EQ(status.everything, 0u);
  return world;
}

template <int kDims>
using Bits = std::array<std::uint32_t, 2 * (std::size_t{kDims} + 1)>;

// Neither the target nor the layout changes a bit.
template <typename Source>
void ExpectSameBits(const AaboWorld<Source::kDimensions>& world,
                    const AaboWorld<Source::kDimensions>& other) {
  for (std::size_t i = 0; i < world.size(); ++i) {
    ASSERT_EQ(std::bit_cast<Bits<Source::kDimensions>>(world.Get(i)),
              std::bit_cast<Bits<Source::kDimensions>>(other.Get(i)))
        << i;
  }
}

template <typename Source>
void ExpectSameOnAllTargets(Source& source, FitOptions options,
                            const AaboWorld<Source::kDimensions>& expected) {
  for (Layout layout : kLayouts) {
    Arena arena;
    source.Place(arena, layout);
    for (Target target : TargetsUnderTest()) {
      SCOPED_TRACE(target.name());
      options.target = target;
      const auto world = Built(source, options);
      ExpectSameBits<Source>(world, expected);
    }
  }
}

TYPED_TEST(FitManyExactTest, WithinOneUlp) {
  ForEachSample(70, kBatches, kShapes, [](PointKind kind, Random& random) {
    Arena arena;
    auto source = TypeParam::Random(kind, kShapes, random);
    source.Place(arena, Layout::kColumns);
    FitOptions options{.target = TargetsUnderTest().front()};
    const auto world = Built(source, options);
    for (std::size_t i = 0; i < kShapes; ++i) {
      const Looseness loose{.d = 1, .d_slack = source.Give(i, false)};
      ASSERT_TRUE(source.Hull(i).IsEnclosedBy(world.Get(i), loose)) << i;
      ASSERT_EQ(world.Get(i).aabb(), source.Single(i).aabb()) << i;
    }
    ExpectSameOnAllTargets(source, options, world);
  });
}

TYPED_TEST(FitManyExactTest, Tightest) {
  ForEachSample(71, kBatches, kShapes, [](PointKind kind, Random& random) {
    Arena arena;
    auto source = TypeParam::Random(kind, kShapes, random);
    source.Place(arena, Layout::kColumns);
    FitOptions options{.tightest = true, .target = TargetsUnderTest().front()};
    const auto world = Built(source, options);
    for (std::size_t i = 0; i < kShapes; ++i) {
      const Looseness loose{.d_slack = source.Give(i, true)};
      ASSERT_TRUE(source.Hull(i).IsEnclosedBy(world.Get(i), loose)) << i;
    }
    ExpectSameOnAllTargets(source, options, world);
  });
}

// Every kind of planes gets what an AABO's have.
TYPED_TEST(FitManyExactTest, AnyPlanes) {
  constexpr int kDims = TypeParam::kDimensions;
  Random random(72);
  Arena arena;
  auto source = TypeParam::Random(PointKind::kUniform, kShapes, random);
  source.Place(arena, Layout::kColumns);
  for (Target target : TargetsUnderTest()) {
    const FitOptions options{.target = target};
    const auto world = Built(source, options);
    SimplexWorld<kDims> simplices;
    simplices.Resize(kShapes);
    source.Bound(simplices.planes(), options);
    AabbWorld<kDims> boxes;
    boxes.Resize(kShapes);
    source.Bound(boxes.planes(), options);
    std::vector<float> d_min(kShapes);
    std::vector<float> d_max(kShapes);
    source.Bound(DPlanes<kDims>{d_min.data(), d_max.data(), kShapes}, options);
    for (std::size_t i = 0; i < kShapes; ++i) {
      ASSERT_EQ(simplices.Get(i), world.Get(i).up()) << i;
      ASSERT_EQ(boxes.Get(i), world.Get(i).aabb()) << i;
      ASSERT_EQ(d_min[i], world.Get(i).min[kDims]) << i;
      ASSERT_EQ(d_max[i], world.Get(i).max[kDims]) << i;
    }
  }
}

}  // namespace
}  // namespace halfspace::testing

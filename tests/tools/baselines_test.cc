// The baselines give the right answers, or they would be no baselines; and the
// scene that they are measured in is the same everywhere.
#include <gtest/gtest.h>

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "bench/baselines/target_loops.h"
#include "bench/worlds/grid_world.h"
#include "halfspace/reject.h"
#include "halfspace/targets.h"
#include "tests/reference/reference.h"

namespace halfspace::bench {
namespace {

// Tiles of 1024, and a part of one.
constexpr std::size_t kObjects = 20003;

const GridWorld& World() {
  static const GridWorld world(kObjects, 1);
  return world;
}

std::vector<std::size_t> ReferenceCounts(ShapeKind shape) {
  std::vector<std::size_t> counts;
  World().queries().With(
      shape, World().view(), [&](const auto& view, const auto& queries) {
        for (const auto& query : queries) {
          std::vector<std::uint64_t> mask(MaskWords(view.size));
          reference::RejectMask(view, query, mask.data());
          std::size_t count = 0;
          for (std::uint64_t word : mask) {
            count += 64 - static_cast<std::size_t>(std::popcount(word));
          }
          counts.push_back(count);
        }
      });
  return counts;
}

TEST(BaselinesTest, TheGridWorldHasTheReferencesAnswers) {
  for (ShapeKind shape : kShapes) {
    EXPECT_EQ(World().counts(shape), ReferenceCounts(shape)) << NameOf(shape);
  }
}

TEST(BaselinesTest, ScalarCountsAreRight) {
  std::vector<std::size_t> counts(World().queries().size(), 99);
  CountScalar(World().halves(), World().queries().aabos(), counts);
  EXPECT_EQ(counts, World().counts(ShapeKind::kAabo));
}

TEST(BaselinesTest, VectorisedCountsAreRight) {
  const SimplexView3 view = World().view().simplex();
  for (Target target : SupportedTargets()) {
    const TargetLoops loops = LoopsFor(target);
    for (CountSimplices count : {loops.count_by_or, loops.count_by_and}) {
      std::vector<std::size_t> counts(World().queries().size(), 99);
      count({{view.min[0], view.min[1], view.min[2], view.min[3]},
             view.size,
             World().queries().simplices().front().max.data(),
             counts.size(),
             counts.data()});
      EXPECT_EQ(counts, World().counts(ShapeKind::kSimplex)) << target.name();
    }
  }
}

// The check of a benchmark must be able to fail.
TEST(BaselinesTest, FindsAWrongCount) {
  std::vector<std::size_t> counts = World().counts(ShapeKind::kAabb);
  EXPECT_EQ(World().Check(ShapeKind::kAabb, counts), "");
  ++counts[7];
  EXPECT_NE(World().Check(ShapeKind::kAabb, counts), "");
  // The first queries alone may be checked too.
  counts.resize(7);
  EXPECT_EQ(World().Check(ShapeKind::kAabb, counts), "");
}

TEST(GridSceneTest, IsTheSameForTheSameSeed) {
  const Workload a = MakeGridScene(1000, 10, 5);
  const Workload b = MakeGridScene(1000, 10, 5);
  const Workload c = MakeGridScene(1000, 10, 6);
  ASSERT_EQ(a.objects.size(), 1000u);
  ASSERT_EQ(a.queries.size(), 10u);
  EXPECT_EQ(a.objects.Get(999).min, b.objects.Get(999).min);
  EXPECT_EQ(a.queries[9].max, b.queries[9].max);
  EXPECT_NE(a.objects.Get(999).min, c.objects.Get(999).min);
}

TEST(GridSceneTest, LiesInTheCube) {
  const Workload scene = MakeGridScene(1000, 1, 1);
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const Aabo3 object = scene.objects.Get(i);
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_GE(object.min[k], -51.0f);
      EXPECT_LE(object.max[k], 51.0f);
      EXPECT_LE(object.max[k] - object.min[k], 2.001f);
    }
  }
}

// Of 10^9 pairs about 39 230, 84 360 and 35 660 survive.
TEST(GridSceneTest, HasTheDensityOfThePublicBenchmark) {
  const double pairs = static_cast<double>(kObjects) *
                       static_cast<double>(World().queries().size());
  const auto per_billion = [&](ShapeKind shape) {
    return static_cast<double>(World().Survivors(shape)) / pairs * 1e9;
  };
  // 78 AABB survivors here, so a wide interval.
  EXPECT_NEAR(per_billion(ShapeKind::kAabb), 39230, 15000);
  EXPECT_NEAR(per_billion(ShapeKind::kSimplex), 84360, 25000);
  EXPECT_LE(World().Survivors(ShapeKind::kAabo),
            World().Survivors(ShapeKind::kAabb));
}

}  // namespace
}  // namespace halfspace::bench

// The baselines give the right answers, or they would be no baselines.
#include <gtest/gtest.h>

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "bench/inner/target_loops.h"
#include "bench/worlds/scene.h"
#include "halfspace/reject.h"
#include "halfspace/targets.h"
#include "tests/reference/reference.h"

namespace halfspace::bench {
namespace {

// Tiles of 1024, and a part of one.
TEST(BaselinesTest, VectorisedCountsAreRight) {
  const Workload scene = MakeScene(20003, 100, /*seed=*/1, [](double) {});
  const ShapeQueries queries(scene.queries);
  const SimplexView3 view = scene.objects.view().simplex();
  std::vector<std::size_t> expected;
  std::vector<std::uint64_t> mask(MaskWords(view.size));
  for (const DownSimplex3& query : queries.simplices()) {
    reference::RejectMask(view, query, mask.data());
    std::size_t count = 0;
    for (std::uint64_t word : mask) {
      count += 64 - static_cast<std::size_t>(std::popcount(word));
    }
    expected.push_back(count);
  }
  for (Target target : SupportedTargets()) {
    const TargetLoops loops = LoopsFor(target);
    for (CountSimplices count : {loops.count_by_or, loops.count_by_and}) {
      std::vector<std::size_t> counts(queries.size(), 99);
      count({{view.min[0], view.min[1], view.min[2], view.min[3]},
             view.size,
             queries.simplices().front().max.data(),
             counts.size(),
             counts.data()});
      EXPECT_EQ(counts, expected) << target.name();
    }
  }
}

}  // namespace
}  // namespace halfspace::bench

// The paper's work metric: against a count that follows its definition object
// by object, and against the paper's own figures.
#include "bench/paper/work_count.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <utility>
#include <vector>

#include "bench/measure/counts.h"
#include "bench/worlds/scene.h"

namespace halfspace::bench {
namespace {

Workload SmallScene(std::size_t objects, std::size_t queries) {
  return MakeScene(objects, queries, /*seed=*/7, [](double) {});
}

// Half-spaces that object `i` needs before one rejects it; all if none does.
std::size_t NeededByAabb(const Aabo3& object, const Aabo3& query) {
  std::size_t evaluated = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    ++evaluated;
    if (object.min[k] > query.max[k]) return evaluated;
    ++evaluated;
    if (object.max[k] < query.min[k]) return evaluated;
  }
  return evaluated;
}

std::size_t NeededBySimplex(const Aabo3& object, const Aabo3& query) {
  for (std::size_t k = 0; k < 4; ++k) {
    if (object.min[k] > query.max[k]) return k + 1;
  }
  return 4;
}

std::size_t NeededByAabo(const Aabo3& object, const Aabo3& query) {
  for (std::size_t k = 0; k < 4; ++k) {
    if (object.min[k] > query.max[k]) return k + 1;
  }
  for (std::size_t k = 0; k < 4; ++k) {
    if (object.max[k] < query.min[k]) return 5 + k;
  }
  return 8;
}

// A batch needs what its neediest object needs.
template <typename Needed>
double ByDefinition(const Workload& scene, std::size_t width, Needed needed) {
  std::size_t sum = 0;
  std::size_t batches = 0;
  for (const Aabo3& query : scene.queries) {
    for (std::size_t i = 0; i < scene.objects.size(); i += width) {
      std::size_t most = 0;
      const std::size_t end = std::min(i + width, scene.objects.size());
      for (std::size_t j = i; j < end; ++j) {
        most = std::max(most, needed(scene.objects.Get(j), query));
      }
      sum += most;
      ++batches;
    }
  }
  return static_cast<double>(sum) / static_cast<double>(batches);
}

WorkCounter Counted(const Workload& scene) {
  WorkCounter counter(scene.objects.view());
  for (const Aabo3& query : scene.queries) counter.Add(query);
  return counter;
}

TEST(WorkCountTest, IsTheDefinition) {
  // Neither a multiple of 4096 nor of 1024: the last batches are short.
  const Workload scene = SmallScene(2 * 4096 + 5 * 64, 6);
  const WorkCount work = Counted(scene).Average();
  for (std::size_t i = 0; i < kWorkWidths.size(); ++i) {
    const std::size_t w = kWorkWidths[i];
    EXPECT_DOUBLE_EQ(work.aabb[i], ByDefinition(scene, w, NeededByAabb)) << w;
    EXPECT_DOUBLE_EQ(work.simplex[i], ByDefinition(scene, w, NeededBySimplex))
        << w;
    EXPECT_DOUBLE_EQ(work.aabo[i], ByDefinition(scene, w, NeededByAabo)) << w;
  }
}

TEST(WorkCountTest, AddsUpToTheHalfSpacesOfSingleObjects) {
  const WorkCounter counter = Counted(SmallScene(4096, 6));
  const WorkCount work = counter.Average();
  for (const auto& [shape, average] :
       {std::pair(ShapeKind::kAabb, work.aabb[0]),
        std::pair(ShapeKind::kSimplex, work.simplex[0]),
        std::pair(ShapeKind::kAabo, work.aabo[0])}) {
    const std::vector<double> reached = counter.Reached(shape);
    ASSERT_EQ(reached.size(), PlaneCountOf(shape));
    EXPECT_EQ(reached[0], 1.0);
    EXPECT_TRUE(std::is_sorted(reached.rbegin(), reached.rend()));
    EXPECT_NEAR(std::accumulate(reached.begin(), reached.end(), 0.0), average,
                1e-12);
  }
}

TEST(WorkCountTest, ReproducesThePaper) {
  // Many queries: the narrow widths depend on where they lie.
  const Workload scene = SmallScene(1 << 14, 1024);
  const WorkCount work = Counted(scene).Average();
  for (std::size_t i = 0; i < kWorkWidths.size(); ++i) {
    EXPECT_NEAR(work.aabb[i], kPaperWork.aabb[i], 0.1) << kWorkWidths[i];
    EXPECT_NEAR(work.simplex[i], kPaperWork.simplex[i], 0.1) << kWorkWidths[i];
    EXPECT_NEAR(work.aabo[i], kPaperWork.aabo[i], 0.1) << kWorkWidths[i];
  }
}

TEST(SceneTest, SurvivorsAreAsLooseAsInThePaper) {
  const Workload scene = SmallScene(1 << 18, 128);
  PerShape<std::size_t> survivors;
  for (const Aabo3& query : scene.queries) {
    AddSurvivors(scene.objects.view(), query, survivors);
  }
  const auto looseness = [&](std::size_t count) {
    return static_cast<double>(count) / static_cast<double>(survivors.aabb);
  };
  EXPECT_NEAR(looseness(survivors.simplex), 2.18, 0.15);
  EXPECT_NEAR(looseness(survivors.aabo), 0.92, 0.03);
}

TEST(SceneTest, IsTheSameForTheSameSeedOnly) {
  const auto first = [](std::uint64_t seed) {
    return MakeScene(64, 1, seed, [](double) {}).objects.Get(63);
  };
  EXPECT_EQ(first(1), first(1));
  EXPECT_NE(first(1), first(2));
}

}  // namespace
}  // namespace halfspace::bench

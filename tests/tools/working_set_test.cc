// Which sizes are measured on which machine.
#include "bench/worlds/working_set.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <set>
#include <vector>

#include "halfspace/fit.h"

namespace halfspace::bench {
namespace {

constexpr std::size_t kKiB = 1024;
constexpr std::size_t kMiB = 1024 * kKiB;
constexpr std::size_t kAaboBytes = 32;
constexpr std::size_t kSimplexBytes = 16;

Machine ServerWith(std::size_t available_memory) {
  Machine machine;
  machine.caches = {{1, 32 * kKiB, 1}, {2, kMiB, 1}, {3, 32 * kMiB, 8}};
  machine.available_memory = available_memory;
  return machine;
}

TEST(WorkingSetTest, FillsHalfOfEachCache) {
  const auto sizes = WorkingSetSizes(ServerWith(16384 * kMiB));
  ASSERT_EQ(sizes.size(), 4u);
  EXPECT_EQ(sizes[0].objects * kAaboBytes, 16 * kKiB);
  EXPECT_EQ(sizes[1].objects * kAaboBytes, kMiB / 2);
  EXPECT_EQ(sizes[2].objects * kAaboBytes, 16 * kMiB);
  for (const WorkingSetSize& size : sizes) {
    EXPECT_EQ(size.why_not_reached, "") << size.name;
    EXPECT_EQ(size.objects % (size.name == "L1" ? 64 : 4096), 0u) << size.name;
  }
}

TEST(WorkingSetTest, InMemoryEvenTheSimplexIsFourTimesTheLastLevel) {
  const auto sizes = WorkingSetSizes(ServerWith(16384 * kMiB));
  EXPECT_EQ(sizes[3].name, "memory");
  EXPECT_GE(sizes[3].objects * kSimplexBytes, 4 * 32 * kMiB);
}

TEST(WorkingSetTest, SaysHowManyBytesThatIs) {
  const auto sizes = WorkingSetSizes(ServerWith(16384 * kMiB));
  EXPECT_EQ(sizes[1].bytes, kMiB / 2);
  EXPECT_EQ(sizes[3].bytes, 4 * 32 * kMiB);
}

TEST(WorkingSetTest, MemoryIsNotReachedBeyondAQuarterOfWhatIsFree) {
  EXPECT_EQ(WorkingSetSizes(ServerWith(1100 * kMiB))[3].why_not_reached, "");
  EXPECT_NE(WorkingSetSizes(ServerWith(900 * kMiB))[3].why_not_reached, "");
}

TEST(WorkingSetTest, MemoryIsNotReachedUnderEmulation) {
  Machine machine = ServerWith(16384 * kMiB);
  machine.is_emulated = true;
  EXPECT_NE(WorkingSetSizes(machine)[3].why_not_reached, "");
}

TEST(WorkingSetTest, ACacheThatIsNotThereIsNotReached) {
  Machine machine = ServerWith(16384 * kMiB);
  machine.caches.pop_back();
  EXPECT_EQ(WorkingSetSizes(machine)[1].why_not_reached, "");
  EXPECT_NE(WorkingSetSizes(machine)[2].why_not_reached, "");
}

TEST(WorkingSetTest, UnknownCachesAreGuessed) {
  const auto sizes = WorkingSetSizes(Machine());
  ASSERT_EQ(sizes.size(), 4u);
  for (const WorkingSetSize& size : sizes) EXPECT_GT(size.objects, 0u);
}

// The check of a benchmark must be able to fail.
TEST(WorkingSetTest, FindsAWrongMask) {
  Workload workload{"one", {}, {}};
  workload.objects.Push(Aabo3{{0, 0, 0, -3}, {1, 1, 1, 0}});
  workload.timed_queries.push_back(Aabo3{{2, 2, 2, -9}, {3, 3, 3, -6}});
  WorkingSet set(workload, {"test", 128, ""});
  const auto fill = [&set](std::uint64_t word) {
    return [&set, word](const Aabo3&) { set.mask().assign(2, word); };
  };
  EXPECT_EQ(set.Check(ShapeKind::kAabb, fill(~std::uint64_t{0})), "");
  EXPECT_NE(set.Check(ShapeKind::kAabb, fill(~std::uint64_t{1})), "");
  EXPECT_NE(set.Check(ShapeKind::kAabb, fill(0)), "");
}

TEST(WorkingSetTest, TakesAllTimedQueriesInTurn) {
  Workload workload{"one", {}, {}};
  workload.objects.Push(Aabo3::Everything());
  for (int i = 0; i < 3; ++i) {
    workload.timed_queries.push_back(BoundPoint<3>({static_cast<float>(i)}));
  }
  WorkingSet set(workload, {"test", kObjectsPerRun / 2, ""});
  std::vector<float> seen;
  const Case c = set.MakeCase(
      "case", ShapeKind::kAabb,
      [&seen](const Aabo3& query) { seen.push_back(query.min[0]); });
  c.run();
  c.run();
  EXPECT_EQ(seen, (std::vector<float>{0, 1, 2, 0}));
}

// As many as a branch predictor cannot learn, and in no order that it could
// use.
TEST(WorkloadTest, QueriesToTimeAreManyAndInNoOrder) {
  const std::size_t size = 3 * kTimedQueries;
  std::vector<Aabb3> boxes;
  for (std::size_t i = 0; i < size; ++i) {
    const auto x = static_cast<float>(i);
    boxes.push_back({{x, 0, 0}, {x, 0, 0}});
  }
  const Workload workload = WorkloadOfBoxes("boxes", boxes, 0);
  std::set<float> different;
  std::size_t ascents = 0;
  float before = -1.0f;
  for (const Aabo3& query : workload.timed_queries) {
    different.insert(query.min[0]);
    ascents += before < query.min[0] ? 1 : 0;
    before = query.min[0];
  }
  EXPECT_EQ(different.size(), kTimedQueries);
  EXPECT_EQ(workload.timed_queries.size(), kTimedQueries);
  EXPECT_NEAR(static_cast<double>(ascents), kTimedQueries / 2.0,
              kTimedQueries / 20.0);
  EXPECT_LT(workload.queries.size(), std::size_t{300});
  // What the user asks for is what is timed.
  EXPECT_EQ(WorkloadOfBoxes("boxes", boxes, 8).timed_queries.size(), 8u);
}

}  // namespace
}  // namespace halfspace::bench

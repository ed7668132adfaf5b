// What the calls for many queries leave of their outputs, and what they make of
// nothing at all.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include "halfspace/halfspace.h"
#include "tests/library/support/answers.h"
#include "tests/library/support/calls.h"
#include "tests/library/support/canaries.h"
#include "tests/library/support/environment.h"

namespace halfspace::testing {
namespace {

// Object i is a point at x = i; query q is all points with x <= 3 q.
AabbWorld3 PointsOnX(std::size_t n) {
  AabbWorld3 world;
  for (std::size_t i = 0; i < n; ++i) {
    const auto x = static_cast<float>(i);
    world.Push({{x, 0.f, 0.f}, {x, 0.f, 0.f}});
  }
  return world;
}
std::vector<Aabb3> LongerAndLonger(std::size_t count) {
  std::vector<Aabb3> queries(count, Aabb3{});
  for (std::size_t q = 0; q < count; ++q) {
    queries[q].max[0] = static_cast<float>(3 * q);
  }
  return queries;
}

using Pair = std::pair<std::uint32_t, std::uint32_t>;

std::vector<Pair> AllPairs(const AabbWorld3& world,
                           std::span<const Aabb3> queries,
                           const Options& options) {
  std::vector<std::uint32_t> query_indices(world.size() * queries.size());
  std::vector<std::uint32_t> object_indices(query_indices.size());
  const std::size_t count =
      SurvivorPairs(world, queries, query_indices, object_indices, options);
  std::vector<Pair> pairs;
  for (std::size_t j = 0; j < count; ++j) {
    pairs.emplace_back(query_indices[j], object_indices[j]);
  }
  return pairs;
}

// By one of the two spans, or both.
TEST(ManyOutputsTest, PairsThatFitAreWrittenAndAllAreCounted) {
  const AabbWorld3 world = PointsOnX(70);
  const std::vector<Aabb3> queries = LongerAndLonger(20);
  Canaried<std::uint32_t> query_indices;
  Canaried<std::uint32_t> object_indices;
  for (Target target : TargetsUnderTest()) {
    const Options options{.target = target};
    const std::vector<Pair> all = AllPairs(world, queries, options);
    ASSERT_EQ(all.size(), 20u + 3u * 190u);
    const std::size_t lengths[] = {
        0, 1, 63, all.size() - 1, all.size(), all.size() + 1, all.size() + 70};
    for (std::size_t first : lengths) {
      for (std::size_t second : lengths) {
        const auto out_queries = query_indices.Reset(first);
        const auto out_objects = object_indices.Reset(second);
        EXPECT_EQ(
            SurvivorPairs(world, queries, out_queries, out_objects, options),
            all.size());
        const std::size_t written = std::min({first, second, all.size()});
        for (std::size_t j = 0; j < written; ++j) {
          EXPECT_EQ(out_queries[j], all[j].first) << j;
          EXPECT_EQ(out_objects[j], all[j].second) << j;
        }
        EXPECT_TRUE(query_indices.IntactBut(written)) << first << second;
        EXPECT_TRUE(object_indices.IntactBut(written)) << first << second;
      }
    }
  }
}

TEST(ManyOutputsTest, SkippedPairsAreCountedAndNotWritten) {
  const AabbWorld3 world = PointsOnX(5000);
  const std::vector<Aabb3> queries = LongerAndLonger(20);
  Canaried<std::uint32_t> query_indices;
  Canaried<std::uint32_t> object_indices;
  for (Target target : TargetsUnderTest()) {
    const std::vector<Pair> all = AllPairs(world, queries, {.target = target});
    for (std::size_t skip :
         {std::size_t{1}, all.size() / 2, all.size(), ~std::size_t{0}}) {
      const std::size_t left = all.size() - std::min(skip, all.size());
      for (std::size_t capacity : {left / 2, left, left + 70}) {
        const auto out_queries = query_indices.Reset(capacity);
        const auto out_objects = object_indices.Reset(capacity);
        EXPECT_EQ(SurvivorPairs(world, queries, out_queries, out_objects,
                                {.target = target}, skip),
                  all.size());
        const std::size_t written = std::min(capacity, left);
        for (std::size_t j = 0; j < written; ++j) {
          const Pair& pair = all[all.size() - left + j];
          EXPECT_EQ(out_queries[j], pair.first) << skip << ", " << j;
          EXPECT_EQ(out_objects[j], pair.second) << skip << ", " << j;
        }
        EXPECT_TRUE(query_indices.IntactBut(written)) << skip;
        EXPECT_TRUE(object_indices.IntactBut(written)) << skip;
      }
    }
  }
}

// What is too long by far is no error, though its bytes have no number.
TEST(ManyOutputsTest, PairsTakeNoMoreRoomThanThereArePairs) {
  const AabbWorld3 world = PointsOnX(70);
  const std::vector<Aabb3> queries = LongerAndLonger(2);
  std::vector<std::uint32_t> query_indices(140);
  std::vector<std::uint32_t> object_indices(140);
  const std::size_t boundless = ~std::size_t{0} / sizeof(std::uint32_t);
  EXPECT_EQ(SurvivorPairs(world, queries, {query_indices.data(), boundless},
                          {object_indices.data(), boundless}),
            5u);
}

TEST(ManyOutputsTest, RowsAndCountsPastTheQueriesAreNotTouched) {
  for (std::size_t n : {1u, 64u, 70u, 4161u}) {
    const AabbWorld3 world = PointsOnX(n);
    const std::vector<Aabb3> queries = LongerAndLonger(18);
    const std::size_t words = MaskWords(n) * queries.size();
    Canaried<std::uint64_t> rows;
    Canaried<std::size_t> counts;
    for (Target target : TargetsUnderTest()) {
      for (Schedule schedule : kSchedules) {
        const Options options{.schedule = schedule, .target = target};
        RejectMasks(world, queries, rows.Reset(words + 70), options);
        EXPECT_TRUE(rows.IntactBut(words));
        SurvivorMasks(world, queries, rows.Reset(words + 70), options);
        EXPECT_TRUE(rows.IntactBut(words));
        SurvivorCounts(world, queries, counts.Reset(18 + 70), options);
        EXPECT_TRUE(counts.IntactBut(18));
      }
    }
  }
}

// Counts are written, not added to.
TEST(ManyOutputsTest, CountsOfNothingAreZero) {
  const std::vector<Aabb3> queries = LongerAndLonger(3);
  std::vector<std::size_t> counts(3, 7);
  SurvivorCounts(AabbWorld3(), queries, counts);
  EXPECT_EQ(counts, std::vector<std::size_t>(3));
  counts.assign(3, 7);
  SurvivorCounts(PointsOnX(100), queries, counts, {.range = {64, 64}});
  EXPECT_EQ(counts, std::vector<std::size_t>(3));
}

TEST(ManyOutputsTest, NothingNeedsNoMemoryAndHasATarget) {
  const AabbWorld3 world = PointsOnX(10000);
  const std::vector<Aabb3> queries = LongerAndLonger(300);
  CallOutputs outputs;
  for (Target target : TargetsUnderTest()) {
    for (Schedule schedule : kSchedules) {
      const Options options{.schedule = schedule, .target = target};
      // No outputs at all.
      RejectMasks(world, {}, {}, options);
      SurvivorMasks(world, {}, {}, options);
      EXPECT_EQ(SurvivorPairs(world, {}, {}, {}, options), 0u);
      SurvivorCounts(world, {}, {}, options);
      const AabbView3 empty;
      RejectMasks(empty, queries, {}, options);
      SurvivorMasks(empty, queries, {}, options);
      EXPECT_EQ(SurvivorPairs(empty, queries, {}, {}, options), 0u);
      // Outputs that are left alone.
      const auto ask = [](std::string_view, const auto& call) { call(); };
      ForEachManyCall(world, {}, options, outputs, ask);
      EXPECT_TRUE(outputs.Untouched());
      ForEachManyCall(empty, {}, options, outputs, ask);
      EXPECT_TRUE(outputs.Untouched());
    }
  }
}

std::size_t seen_by_function = 0;
void Function(const SurvivorTile& tile) { seen_by_function += tile.queries; }

TEST(ForEachTileTest, TakesAnythingThatTakesATile) {
  const AabbWorld3 world = PointsOnX(100);
  const std::vector<Aabb3> queries = LongerAndLonger(3);
  seen_by_function = 0;
  ForEachTile(world, queries, Function);
  EXPECT_EQ(seen_by_function, 3u);
  ForEachTile(world, queries, &Function);
  EXPECT_EQ(seen_by_function, 6u);

  std::size_t seen = 0;
  const auto add = [&seen](const SurvivorTile& tile) { seen += tile.queries; };
  ForEachTile(world, queries, add);
  EXPECT_EQ(seen, 3u);
  ForEachTile(world, queries, std::function<void(SurvivorTile)>(add));
  EXPECT_EQ(seen, 6u);
  // With a state of its own, which is not copied.
  auto counter = [&seen,
                  count = std::size_t{0}](const SurvivorTile& tile) mutable {
    count += tile.queries;
    seen = count;
  };
  ForEachTile(world, queries, counter);
  counter(SurvivorTile{});
  EXPECT_EQ(seen, 3u);
  auto owner = [p = std::make_unique<int>(3)](const SurvivorTile& tile) {
    EXPECT_EQ(tile.queries, static_cast<std::size_t>(*p));
  };
  ForEachTile(world, queries, std::move(owner));
}

TEST(ForEachTileTest, WhatTheFunctionThrowsPassesThrough) {
  const AabbWorld3 world = PointsOnX(10000);
  const std::vector<Aabb3> queries = LongerAndLonger(40);
  for (Target target : TargetsUnderTest()) {
    std::size_t tiles = 0;
    const auto third = [&tiles](const SurvivorTile&) {
      if (++tiles == 3) throw std::out_of_range("the third");
    };
    EXPECT_THROW(ForEachTile(world, queries, third, {.target = target}),
                 std::out_of_range);
    EXPECT_EQ(tiles, 3u);
  }
}

TEST(ForEachTileTest, StopEndsTheCall) {
  const AabbWorld3 world = PointsOnX(10000);
  const std::vector<Aabb3> queries = LongerAndLonger(40);
  const QuantizedBounds<AabbView3, std::uint8_t> quantized(world);
  const auto check = [&](const auto& any_world, Target target) {
    const auto tiles_until = [&](std::size_t last) {
      std::size_t tiles = 0;
      ForEachTile(any_world, queries,
                  [&](const SurvivorTile&) {
                    return ++tiles == last ? Visit::kStop : Visit::kContinue;
                  },
                  {.target = target});
      return tiles;
    };
    const std::size_t all = tiles_until(0);
    EXPECT_GT(all, 3u);
    for (std::size_t last = 1; last <= all; ++last) {
      EXPECT_EQ(tiles_until(last), last);
    }
  };
  for (Target target : TargetsUnderTest()) {
    check(world, target);
    check(quantized, target);
    check(Refined(quantized, world), target);
  }
}

// A tile's rows stay as they are when its function makes calls of its own.
TEST(ForEachTileTest, FunctionMayCallTheLibrary) {
  const AabbWorld3 world = PointsOnX(1000);
  const std::vector<Aabb3> queries = LongerAndLonger(40);
  std::vector<std::uint64_t> inner(MaskWords(1000));
  std::size_t compared = 0;
  ForEachTile(world, queries, [&](const SurvivorTile& tile) {
    for (std::size_t q = 0; q < tile.queries; ++q) {
      SurvivorMask(world, queries[tile.first_query + q], inner);
      const auto row = tile.Row(q);
      EXPECT_TRUE(std::equal(
          row.begin(), row.end(),
          inner.begin() + static_cast<std::ptrdiff_t>(tile.first_object / 64)));
      compared += row.size();
    }
  });
  EXPECT_EQ(compared, 40 * inner.size());
}

}  // namespace
}  // namespace halfspace::testing

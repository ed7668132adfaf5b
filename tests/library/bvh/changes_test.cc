// BVHs that change answer as a list of their objects does, after any history.
// How they are built and kept in order: the same on every target, in every mode
// and on any threads, as tight as new ones, with memory and work in proportion
// to their objects.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "tests/library/bvh/answers.h"
#include "tests/library/bvh/history.h"
#include "tests/library/bvh/spread.h"
#include "tests/library/support/counting_memory.h"
#include "tests/library/support/environment.h"

namespace halfspace::testing {
namespace {

class BvhChangesTest : public ::testing::TestWithParam<Layout> {};
INSTANTIATE_TEST_SUITE_P(Of, BvhChangesTest,
                         ::testing::ValuesIn(LayoutsOf(false)), LayoutName());

TEST_P(BvhChangesTest, AnyHistoryIsThatOfTheModel) {
  const std::vector<Target> targets = TargetsUnderTest();
  // Two dimensions are the same code.
  const std::size_t rounds =
      std::max<std::size_t>(4, GetParam().dims == 3 ? Scaled(12) : 0);
  for (std::size_t round = 0; round < rounds + 2; ++round) {
    Random random(round);
    Choices choices(GetParam(), random);
    // Few objects, whose pairs are all compared, and thousands.
    const bool is_large = round % 4 == 1;
    const std::size_t most = is_large ? 9000 : 400;
    // The last ones with too little memory at first, for each change.
    CountingMemory memory;
    const bool is_short = round >= rounds;
    BvhHistory history(GetParam(), choices,
                       round % 3 == 0 ? 0 : choices.Below(most),
                       is_large ? 3000 : 300,
                       is_short ? FpMode::kDefault : kFpModes[round % 6],
                       is_short ? &memory : nullptr);
    // Of a large one a list of the objects takes long to ask.
    const std::size_t changes = is_large ? 3 : 1;
    for (std::size_t step = 0; step < (10 + Scaled(30)) / changes; ++step) {
      std::size_t what = 0;
      for (std::size_t i = 0; i < changes; ++i) what = history.Change();
      constexpr std::uint32_t kMasks[] = {0xFFFFFFFF, 0xFFFFFFFF, 1, 6};
      history.ExpectIsModel({.targets = {targets[random() % targets.size()]},
                             .mask = kMasks[random() % 4],
                             .is_special = random() % 8 == 0,
                             .shapes = 2},
                            random);
      if (HasFailure()) {
        FAIL() << "round " << round << ", step " << step << ", " << what;
      }
    }
  }
}

// A few objects in little room, also after Clear() of a blob in place, which
// has other room than its copy.
TEST_P(BvhChangesTest, ASmallHistoryIsThatOfTheModel) {
  Random random(9);
  Choices choices(GetParam(), random);
  BvhHistory history(GetParam(), choices, 0, 40, FpMode::kDefault);
  for (std::size_t step = 0; step < 60; ++step) {
    const std::size_t what = history.Change();
    Random queries(step);
    history.ExpectIsModel({}, queries);
    if (HasFailure()) FAIL() << "step " << step << ", " << what;
  }
}

class BvhBuildTest : public ::testing::TestWithParam<Layout> {
 protected:
  // Queries, by the leaves that they visit: a count of work.
  std::size_t LeavesVisited(const AnyBvh& bvh) const {
    const detail::BvhLevel& level = bvh.levels().level[1];
    std::size_t visited = 0;
    Spheres spheres(GetParam(), 0.2f, 77);
    for (std::size_t q = 0; q < kQueries; ++q) {
      const Planes query = spheres.Next(true);
      for (std::size_t n = 0; n < level.size; ++n) {
        bool is_visited = true;
        for (std::size_t p = 0; p < GetParam().plane_count; ++p) {
          const float v = level.Value(p, n);
          is_visited &= !(IsMin(GetParam(), p) ? v > query[p] : v < query[p]);
        }
        visited += is_visited ? 1 : 0;
      }
    }
    return visited;
  }
  static constexpr std::size_t kQueries = 500;
};
INSTANTIATE_TEST_SUITE_P(Of, BvhBuildTest,
                         ::testing::ValuesIn(LayoutsOf(false)), LayoutName());

bool AreSame(const AnyBvh& a, const AnyBvh& b) {
  return std::ranges::equal(a.Blob(), b.Blob());
}

// On any threads, and of the floats as of doubles that are rounded to them,
// too.
TEST_P(BvhBuildTest, IsTheSameOnEveryTargetAndInEveryMode) {
  auto run = RunOnThreads;
  for (const Scene& scene : Scenes()) {
    std::vector<Planes> bounds = ObjectsIn(scene, GetParam(), 5000, 3);
    // Blocks without a finite value.
    for (int i = 0; i < 200; ++i) bounds.push_back(EmptyOf(GetParam()));
    BoundList lists[] = {bounds, InDoubles(GetParam(), bounds)};
    for (BuildQuality quality : {BuildQuality::kHigh, BuildQuality::kFast}) {
      const auto expected =
          MakeBvh(GetParam(), lists[0],
                  {.quality = quality, .target = TargetsUnderTest()[0]});
      for (Target target : TargetsUnderTest()) {
        EXPECT_TRUE(AreSame(*MakeBvh(GetParam(), lists[0],
                                     {.quality = quality, .target = target}),
                            *expected))
            << scene.name << ", " << target.name();
      }
      EXPECT_TRUE(AreSame(
          *MakeBvh(GetParam(), lists[0], {.quality = quality, .run = run}),
          *expected))
          << scene.name << ", on threads";
      for (FpMode mode : kFpModes) {
        if (mode == FpMode::kTraps && scene.is_special) continue;
        for (const BoundList& list : lists) {
          // A NaN that was a double has other bits.
          if (scene.is_special && &list != lists) continue;
          std::unique_ptr<AnyBvh> bvh;
          RunIn(mode,
                [&] { bvh = MakeBvh(GetParam(), list, {.quality = quality}); });
          EXPECT_TRUE(AreSame(*bvh, *expected))
              << scene.name << ", mode " << static_cast<int>(mode);
        }
      }
    }
  }
}

// A build in runs, from runs of one object to one of all.
TEST_P(BvhBuildTest, RunsMakeTheTreeOfTheCurve) {
  constexpr std::size_t kObjects = 5000;
  const std::size_t object_bytes = 24 + GetParam().plane_count * sizeof(float);
  for (const Scene& scene : Scenes()) {
    const std::vector<Planes> bounds =
        ObjectsIn(scene, GetParam(), kObjects, 3);
    for (const BoundList& list :
         {BoundList(bounds), InDoubles(GetParam(), bounds)}) {
      for (BuildQuality quality : {BuildQuality::kHigh, BuildQuality::kFast}) {
        for (std::size_t run : {std::size_t{1}, std::size_t{64},
                                std::size_t{777}, kObjects - 1, kObjects}) {
          const auto expected = MakeBvh(
              GetParam(), list,
              {.quality = run < kObjects ? BuildQuality::kFast : quality});
          std::unique_ptr<AnyBvh> bvh;
          RunIn(scene.is_special ? FpMode::kDefault : FpMode::kTraps, [&] {
            bvh =
                MakeBvh(GetParam(), list,
                        {.quality = quality, .run_bytes = run * object_bytes});
          });
          EXPECT_TRUE(AreSame(*bvh, *expected))
              << scene.name << ", runs of " << run;
        }
      }
    }
  }
}

// The node that an insertion chooses is the same on every target, also among
// bounds that are empty, infinite or NaN, and for such a bound.
TEST_P(BvhBuildTest, TheNearestNodeIsTheSameOnEveryTarget) {
  Spheres spheres(GetParam(), 1);
  Random random(3);
  const auto any_bound = [&] {
    Planes bound = random() % 8 == 0   ? EmptyOf(GetParam())
                   : random() % 8 == 0 ? EverythingOf(GetParam())
                                       : spheres.Next();
    if (random() % 8 == 0) bound[random() % GetParam().axes] = kNan;
    return bound;
  };
  std::vector<Planes> bounds = spheres.Some(9000);
  for (std::size_t i = 0; i < 9000; i += 1 + random() % 256) {
    bounds[i] = any_bound();
  }
  const auto bvh = MakeBvh(GetParam(), bounds);
  const detail::BvhLevel& level = bvh->levels().level[1];
  for (int round = 0; round < 2000; ++round) {
    const std::size_t block = random() % 2;  // of 141 nodes
    const Planes bound = any_bound();
    const std::uint64_t nodes =
        level.present[block] &
        (round % 4 == 0 ? std::uint64_t{1} << random() % 64 : random());
    if (nodes == 0) continue;
    std::vector<std::size_t> nearest;
    for (Target target : TargetsUnderTest()) {
      nearest.push_back(detail::KernelsFor(bvh->type(), target, "")
                            .nearest_node(level, block, bound.data(), nodes));
      ASSERT_EQ(nearest.back(), nearest[0]) << round << ", " << target.name();
    }
    ASSERT_TRUE(nodes >> nearest[0] & 1) << round;
  }
}

// Nodes are as tight as those of a new world with the same order, whatever
// changed: the blocks of all are equal, codes included.
TEST_P(BvhBuildTest, LevelsStayAsTightAsAfterARefit) {
  Spheres spheres(GetParam(), 1);
  const auto changed = MakeBvh(GetParam(), spheres.Some(9000));
  const BoundList bounds = spheres.Some(9000);
  const auto refitted = changed->Copy();
  const auto batched = changed->Copy();
  const auto listed = changed->Copy();
  Ids ids;
  for (std::uint32_t i = 0; i < 9000; ++i) {
    changed->Set(i, bounds.floats[i]);
    ids.push_back(i);
  }
  std::size_t count = 3;
  for (std::size_t i = 0; i < ids.size(); i += count, count = 703 - count) {
    count = std::min(count, ids.size() - i);
    const auto first = bounds.floats.begin() + static_cast<std::ptrdiff_t>(i);
    const auto some = std::span(ids).subspan(i, count);
    batched->Set(
        some, BoundList({first, first + static_cast<std::ptrdiff_t>(count)}));
    listed->Refit(some, bounds);
  }
  EXPECT_TRUE(AreSame(*changed, *batched));
  EXPECT_TRUE(AreSame(*changed, *listed));
  refitted->Refit(bounds, true, {});
  EXPECT_GT(changed->CostRatio(), 2.0);
  EXPECT_EQ(changed->CostRatio(), refitted->CostRatio());
  const auto& a = changed->levels();
  const auto& b = refitted->levels();
  ASSERT_EQ(a.count, b.count);
  for (std::size_t l = 0; l < a.count; ++l) {
    const std::size_t floats =
        (a.level[l].size + 63) / 64 * 64 * GetParam().plane_count;
    EXPECT_TRUE(std::equal(a.level[l].floats, a.level[l].floats + floats,
                           b.level[l].floats))
        << l;
  }
}

// The first tenth in the world's order change places with each other.
TEST_P(BvhBuildTest, RebuildsMendWhatDecayed) {
  Spheres spheres(GetParam(), 0.2f);
  const std::vector<Planes> bounds = spheres.Some(40'000);
  const auto bvh = MakeBvh(GetParam(), bounds);
  EXPECT_EQ(bvh->CostRatio(), 1.0);
  EXPECT_EQ(bvh->RebuildPartial(100'000), 0u);
  const Ids first(bvh->ids().begin(), bvh->ids().begin() + 4096);
  for (std::size_t i = 0; i < first.size(); ++i) {
    bvh->Set(first[i], bounds[first[(i * 1021) % first.size()]]);
  }
  EXPECT_GT(bvh->CostRatio(), 1.2);
  EXPECT_EQ(bvh->RebuildPartial(4096), 4096u);
  EXPECT_LT(bvh->CostRatio(), 1.05);
  bvh->Refit(BoundList(spheres.Some(40'000)), true, {});
  EXPECT_GT(bvh->CostRatio(), 5.0);
  bvh->Rebuild({});
  EXPECT_EQ(bvh->CostRatio(), 1.0);
}

// One by one, in batches of which none is a multiple of what is sorted, by
// objects that are replaced one by one, and in lists of a few, as bodies of a
// simulation are.
TEST_P(BvhBuildTest, AWorldSortsItselfAsItChanges) {
  constexpr std::uint32_t kSize = 20'000;
  Spheres spheres(GetParam(), 0.2f);
  const std::vector<Planes> bounds = spheres.Some(kSize);
  const auto built = MakeBvh(GetParam(), bounds);
  const std::size_t least = LeavesVisited(*built);
  const auto bvh = MakeBvh(GetParam(), std::vector<Planes>());
  const auto batched = MakeBvh(GetParam(), std::vector<Planes>());
  for (const Planes& bound : bounds) bvh->Insert(bound);
  for (std::size_t i = 0; i < kSize;) {
    const std::size_t end = std::min<std::size_t>(kSize, i + 1 + i / 7);
    Ids ids(end - i);
    batched->Insert(
        BoundList({bounds.begin() + static_cast<std::ptrdiff_t>(i),
                   bounds.begin() + static_cast<std::ptrdiff_t>(end)}),
        ids);
    i = end;
  }
  // Up to four blocks and a few runs have no place in the order yet.
  const std::size_t most = 3 * least + 8 * kQueries;
  EXPECT_LE(LeavesVisited(*batched), most);
  EXPECT_LE(LeavesVisited(*bvh), most);
  Random random(1);
  for (std::size_t i = 0; i < 3 * kSize / 2; ++i) {
    bvh->Erase(static_cast<std::uint32_t>(random() % kSize));
    bvh->Insert(spheres.Next());
  }
  EXPECT_LE(LeavesVisited(*bvh), most);
  // The new ones take the places of those that went, and partial rebuilds do
  // not spread them over the world.
  for (std::size_t i = 0; i < kSize * 19 / 20 / 16; ++i) {
    Ids ids;
    for (std::size_t k = 0; k < 16; ++k) {
      ids.push_back(static_cast<std::uint32_t>(random() % kSize));
    }
    ids = InOrder(ids);
    ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
    built->Erase(ids);
    built->InsertAs(ids, BoundList(spheres.Some(ids.size())));
    if (i % 64 == 0) built->RebuildPartial(2048);
  }
  EXPECT_LE(LeavesVisited(*built), 4 * least + 2 * kQueries);
}

// All objects cross the world. A part of the order that kept its objects would
// end up with some from everywhere.
TEST_P(BvhBuildTest, PartialRebuildsExchangeObjects) {
  constexpr std::size_t kSize = 12'000;
  constexpr std::size_t kFrames = 200;
  const auto from = Spheres(GetParam(), 0.2f, 1).Some(kSize);
  const auto to = Spheres(GetParam(), 0.2f, 2).Some(kSize);
  const auto bvh = MakeBvh(GetParam(), from);
  BoundList bounds = from;
  for (std::size_t frame = 1; frame <= kFrames; ++frame) {
    const float share = static_cast<float>(frame) / kFrames;
    for (std::size_t i = 0; i < kSize; ++i) {
      for (std::size_t p = 0; p < from[i].size(); ++p) {
        bounds.floats[i][p] = from[i][p] * (1 - share) + to[i][p] * share;
      }
    }
    bvh->Refit(bounds, true, {});
    EXPECT_LE(bvh->RebuildPartial(kSize / 16), 2048u);
  }
  EXPECT_LE(LeavesVisited(*bvh),
            3 * LeavesVisited(*MakeBvh(GetParam(), bounds)));
}

// An object that is very far away costs the others none of their order.
TEST_P(BvhBuildTest, OneFarObjectLeavesTheOrder) {
  std::vector<Planes> bounds = Spheres(GetParam(), 0.2f).Some(20'000);
  std::vector<Planes> with_far = bounds;
  with_far[7][0] += 1e30f;
  if (GetParam().has_max) with_far[7][GetParam().first_max] += 1e30f;
  for (BuildQuality quality : {BuildQuality::kHigh, BuildQuality::kFast}) {
    const BuildOptions options{.quality = quality};
    const std::size_t near =
        LeavesVisited(*MakeBvh(GetParam(), bounds, options));
    EXPECT_LE(LeavesVisited(*MakeBvh(GetParam(), with_far, options)),
              near + near / 5)
        << static_cast<int>(quality);
  }
}

// Of a stream, whose oldest object is erased for each that comes further along
// an axis, and of a world that is emptied and filled.
TEST_P(BvhBuildTest, MemoryFollowsTheObjects) {
  Spheres spheres(GetParam(), 1);
  const auto bytes_of = [&](std::size_t size) {
    return MakeBvh(GetParam(), spheres.Some(size))->bytes();
  };
  const auto bvh = MakeBvh(GetParam(), std::vector<Planes>());
  std::deque<std::uint32_t> alive;
  for (std::size_t i = 0; i < 20'000; ++i) {
    Planes bound = spheres.Next();
    bound[0] += static_cast<float>(i);
    if (GetParam().has_max) {
      bound[GetParam().first_max] += static_cast<float>(i);
    }
    alive.push_back(bvh->Insert(bound));
    if (alive.size() > 500) {
      bvh->Erase(alive.front());
      alive.pop_front();
    }
    ASSERT_LE(bvh->ids().size(), 2 * bvh->size() + 64);
  }
  EXPECT_LE(bvh->bytes(), 2 * bytes_of(1000));
  EXPECT_LT(bvh->CostRatio(), 2.0);
  for (int round = 0; round < 5; ++round) {
    for (std::uint32_t id : alive) bvh->Erase(id);
    alive.clear();
    EXPECT_EQ(bvh->ids().size(), 0u);
    for (std::size_t i = 0; i < 5000; ++i) {
      alive.push_back(bvh->Insert(spheres.Next()));
    }
    ASSERT_EQ(bvh->ids().size(), 5000u);
  }
  EXPECT_LE(bvh->bytes(), 2 * bytes_of(5000));
  // The first 100 remain, and with them the least ids.
  for (; alive.size() > 100; alive.pop_back()) bvh->Erase(alive.back());
  bvh->Rebuild({});
  EXPECT_LE(bvh->bytes(), bytes_of(100) + 512);
  EXPECT_EQ(bvh->Insert(spheres.Next()), 100u);
}

// Objects on a line: each leaf must hold neighbours, for any distances.
TEST(BvhOrderTest, ALeafHasNeighboursOnALine) {
  constexpr std::size_t kObjects = 64 * 64 + 1000;
  const auto share = [](std::size_t i) {
    return static_cast<float>(i) / kObjects;
  };
  const std::pair<const char*, std::function<float(std::size_t)>> kLines[] = {
      {"even", [&](std::size_t i) { return share(i); }},
      {"growing",
       [&](std::size_t i) {
         return std::ldexp(1.0f, static_cast<int>(i / 32) - 64);
       }},
      {"tiny", [&](std::size_t i) { return 0x1p-130f * share(i); }},
      {"as far as can be",
       [&](std::size_t i) { return (i % 2 == 0 ? -0.2f : 0.2f) * kMost; }},
      {"infinite",
       [&](std::size_t i) { return i % 100 == 0 ? kInf : share(i); }},
      {"most in two places",
       [&](std::size_t i) {
         return i % 3 == 0 ? share(i) : i % 3 == 1 ? 0.25f : 0.5f;
       }},
      {"all in one place", [](std::size_t) { return 5.0f; }}};
  for (const auto& [name, center] : kLines) {
    SCOPED_TRACE(name);
    std::vector<Aabb3> boxes;
    // In no order: 4093 is prime.
    for (std::size_t i = 0; i < kObjects; ++i) {
      const float x = center(i * 4093 % kObjects);
      boxes.push_back({{x, 0, 0}, {x, 0, 0}});
    }
    const AabbBvh3 bvh(boxes);
    float last = -kInf;
    for (std::size_t first = 0; first < kObjects; first += 64) {
      float least = kInf;
      float greatest = -kInf;
      for (std::size_t s = first; s < std::min(first + 64, kObjects); ++s) {
        const float x = boxes[bvh.ids()[s]].min[0];
        least = std::min(least, x);
        greatest = std::max(greatest, x);
      }
      EXPECT_LE(last, least) << "in leaf " << first / 64;
      last = greatest;
    }
  }
}

// The leaves that a query reads on average, around a sample of the objects.
double LeavesOfQueries(const AabbBvh3& bvh, const std::vector<Aabb3>& boxes,
                       const std::array<float, 3>& extents) {
  constexpr std::size_t kQueries = 100;
  QueryStatistics statistics;
  for (std::size_t q = 0; q < kQueries; ++q) {
    Aabb3 query = boxes[q * (boxes.size() / kQueries)];
    for (std::size_t k = 0; k < 3; ++k) {
      const float center = (query.min[k] + query.max[k]) / 2;
      query.min[k] = center - extents[k] / 2;
      query.max[k] = center + extents[k] / 2;
    }
    std::ignore = CountSurvivors(bvh, query, {.statistics = &statistics});
  }
  return static_cast<double>(statistics.leaves) / kQueries;
}

// A crowded cell of the curve can begin anywhere in a block.
TEST(BvhOrderTest, ACrowdedCellBeginsAnywhere) {
  for (std::size_t first = 4030; first <= 4100; first += 3) {
    Random random(first);
    std::uniform_real_distribution<float> unit;
    std::vector<Aabb3> boxes(first + 18'000);
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      for (float& x : boxes[i].min) {
        x = (i * 7919 % boxes.size() < first ? 0 : 1e6f) + unit(random);
      }
      boxes[i].max = boxes[i].min;
    }
    const AabbBvh3 bvh(boxes, {.quality = BuildQuality::kFast});
    ASSERT_EQ(CountSurvivors(bvh, {{-1, -1, -1}, {2, 2, 2}}), first);
    ASSERT_LE(LeavesOfQueries(bvh, boxes, {0.01f, 0.01f, 0.01f}), 3.0);
  }
}

// Its newest objects are sorted with each other alone, so a query visits leaves
// of each age.
TEST(BvhOrderTest, APartialRebuildOfAllSortsWhatWasInserted) {
  const std::vector<Aabb3> boxes = Spread(0.5f).Some(20'000);
  AabbBvh3 filled;
  for (const Aabb3& box : boxes) filled.Insert(box);
  const double built = LeavesOfQueries(AabbBvh3(boxes), boxes, {});
  EXPECT_GT(LeavesOfQueries(filled, boxes, {}), 1.5 * built);
  EXPECT_EQ(filled.RebuildPartial(filled.size()), filled.size());
  EXPECT_LE(LeavesOfQueries(filled, boxes, {}), 1.1 * built);
  EXPECT_EQ(filled.RebuildPartial(filled.size()), 0u);
}

struct UnevenWorld {
  const char* name;
  // Of objects, before they are moved by `offset`: 0 or this on each axis.
  std::array<float, 3> world;
  float offset;
  std::array<float, 3> object;
  std::array<float, 3> query;
  // The most leaves that a query may read: with the extents of the query, and
  // without. A world of 20 000 objects has 313.
  double told;
  double not_told;
};
constexpr UnevenWorld kUnevenWorlds[] = {
    {"points, any height", {1, 1, 1e4f}, 0, {}, {0.02f, 0.02f, kInf}, 5, 160},
    {"points, degrees and time", {360, 180, 1e6f}, 0, {}, {9, 4, 3e4f}, 6, 16},
    {"tall boxes",
     {1, 1, 1e4f},
     0,
     {5e-3f, 5e-3f, 50},
     {.02f, .02f, 200},
     8,
     8},
    {"degrees, meters",
     {10, 10, 2e3f},
     0,
     {2e-3f, 2e-3f, 20},
     {1, 1, 90},
     6,
     9},
    {"corridor", {1e5f, 100, 30}, 0, {1, 1, 1}, {40, 40, 40}, 4, 5},
    {"points in a corridor", {1e5f, 100, 30}, 0, {}, {40, 40, 40}, 4, 12},
    {"terrain", {4e3f, 4e3f, 100}, 0, {2, 2, 2}, {60, 60, 60}, 4, 4},
    {"clusters far apart", {1, 1, 1}, 1e3f, {}, {0.05f, 0.05f, 0.05f}, 4, 4},
    {"rooms far apart",
     {10, 10, 3},
     1e5f,
     {.1f, .1f, .1f},
     {.5f, .5f, .5f},
     5,
     5},
};

// kFast reads up to three times as many leaves. Each change of the order keeps
// the extents.
TEST(BvhOrderTest, UnevenWorldsAreOrderedForTheirQueries) {
  for (const UnevenWorld& uneven : kUnevenWorlds) {
    SCOPED_TRACE(uneven.name);
    Random random(1);
    std::uniform_real_distribution<float> unit;
    std::vector<Aabb3> boxes(20'000);
    for (Aabb3& box : boxes) {
      const float offset = random() % 2 == 0 ? 0 : uneven.offset;
      for (std::size_t k = 0; k < 3; ++k) {
        const float at = offset + uneven.world[k] * unit(random);
        box.min[k] = at;
        box.max[k] = at + uneven.object[k] * unit(random);
      }
    }
    const auto leaves = [&](const AabbBvh3& bvh) {
      return LeavesOfQueries(bvh, boxes, uneven.query);
    };
    EXPECT_LE(leaves(AabbBvh3(boxes)), uneven.not_told);
    // Points of doubles are rounded outward.
    std::vector<Aabb<3, double>> doubles(boxes.size());
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      for (std::size_t k = 0; k < 3; ++k) {
        doubles[i].min[k] = boxes[i].min[k] * (1 + 1e-10);
        doubles[i].max[k] = boxes[i].max[k] * (1 + 1e-10);
      }
    }
    EXPECT_LE(leaves(AabbBvh3(doubles)), uneven.not_told);
    EXPECT_LE(leaves(AabbBvh3(boxes, {.quality = BuildQuality::kFast})),
              3 * uneven.not_told);
    EXPECT_LE(leaves(AabbBvh3(boxes, {.quality = BuildQuality::kFast,
                                      .query_extents = uneven.query})),
              3 * uneven.told);
    AabbBvh3 told(boxes, {.query_extents = uneven.query});
    EXPECT_LE(leaves(told), uneven.told);
    // Queries are anywhere, and these at objects, which can be in few places.
    if (uneven.offset == 0) {
      EXPECT_NEAR(told.ExpectedLeaves(uneven.query) / leaves(told), 1, 0.3);
    }
    AabbBvh3 loaded = AabbBvh3::FromBlob(told.Blob());
    loaded.Rebuild();
    EXPECT_LE(leaves(loaded), uneven.told);
    // All objects exchange their places.
    std::vector<Aabb3> moved(boxes.rbegin(), boxes.rend());
    loaded.Refit(moved);
    loaded.RebuildPartial(loaded.size());
    EXPECT_LE(leaves(loaded), uneven.told);
    loaded.Rebuild({.query_extents = std::array<float, 3>{kInf, kInf, 0}});
    EXPECT_GT(leaves(loaded), leaves(told));
  }
}

TEST(BvhOrderTest, TheCostRatioIsInfiniteOnlyBeforeTheFirstOrder) {
  AabbBvh3 bvh;
  Spread spread(1.0f);
  for (std::size_t size = 1; size <= 300; ++size) {
    bvh.Insert(spread.Next());
    const double ratio = bvh.CostRatio();
    if (size <= 64) {
      EXPECT_EQ(ratio, 1.0);
    } else if (size < 256) {
      EXPECT_EQ(ratio, kInf);
    } else {
      EXPECT_LT(ratio, 3.0);
    }
  }
  for (std::uint32_t id = 0; id < 295; ++id) bvh.Erase(id);
  EXPECT_EQ(bvh.CostRatio(), 1.0);
  bvh.Clear();
  EXPECT_EQ(bvh.RebuildPartial(100), 0u);
  // The newest objects are sorted, and the others have moved.
  AabbBvh3 moved(spread.Some(3000));
  for (std::uint32_t id = 0; id < 3000; ++id) {
    moved.Set(id, spread.Next());
  }
  const double ratio = moved.CostRatio();
  for (int i = 0; i < 257; ++i) moved.Insert(spread.Next());
  EXPECT_GT(moved.CostRatio(), ratio / 2);
  // Half of the objects in as many leaves.
  AabbBvh3 half(spread.Some(10'000));
  for (std::uint32_t id = 0; id < 10'000; id += 2) half.Erase(id);
  EXPECT_NEAR(half.CostRatio(), 2.0, 0.2);
  EXPECT_EQ(half.RebuildPartial(12'288), 5000u);
  EXPECT_EQ(half.CostRatio(), 1.0);
  EXPECT_EQ(half.ids().size(), 5000u);
}

TEST(RunnerTest, CallsAnyFunctionObject) {
  std::vector<int> calls(5);
  const auto count_all = [&](const Runner& run) {
    run(calls.size(), [&](std::size_t i) { ++calls[i]; });
  };
  int runs = 0;
  auto own = [&runs, state = std::make_unique<int>()](std::size_t count,
                                                      auto part) mutable {
    *state = ++runs;
    for (std::size_t i = 0; i < count; ++i) part(i);
  };
  const std::function<void(std::size_t, const Runner::Part&)> general =
      std::ref(own);
  count_all({});
  count_all(own);
  count_all(general);
  count_all(&RunOnThreads);
  EXPECT_EQ(calls, std::vector<int>(5, 4));
  EXPECT_EQ(runs, 2);
}

// The bytes beyond the planes of floats that a BVH of boxes may have,
// ids and permutation included.
TEST(BvhMemoryTest, IsAtMostThreeQuartersOfTheFloats) {
  CountingMemory memory;
  const AabbBvh3 bvh(Spread(1.0f).Some(200'000), {.memory = memory.resource()});
  EXPECT_EQ(memory.blocks, 1u);
  EXPECT_LE(static_cast<double>(bvh.bytes()), 1.75 * 24.0 * 200'000);
}

// Few objects with great ids take 4.13 bytes for each id below, and ids that
// grow one by one move the block rarely.
TEST(BvhMemoryTest, FollowsTheGreatestId) {
  AabbBvh3 bvh;
  bvh.InsertAs(Ids{3'000'000, 5}, std::vector<Aabb3>(2));
  EXPECT_EQ(bvh.id_limit(), 3'000'001u);
  EXPECT_LE(bvh.bytes(), 3'000'001u * 413 / 100 + 10'000);
  EXPECT_EQ(bvh.Insert(Aabb3{}), 0u);
  EXPECT_FALSE(bvh.Has(2'999'999));
  bvh.Erase(3'000'000);
  bvh.Rebuild();
  EXPECT_EQ(bvh.id_limit(), 6u);
  EXPECT_LE(bvh.bytes(), 10'000u);
  std::size_t moves = 0;
  for (std::uint32_t id = 100; id < 20'000; ++id) {
    const std::uint32_t* const were = bvh.ids().data();
    bvh.InsertAs({&id, 1}, std::vector<Aabb3>(1));
    bvh.Erase(id);
    moves += bvh.ids().data() == were ? 0 : 1;
  }
  EXPECT_LE(moves, 20u);
}

TEST(BvhMemoryTest, CopiesMovesAndSwaps) {
  AabbBvh3 first(Spread(4.0f).Some(1000));
  const AabbBvh3 copy(first);
  const auto is_whole = [&](const AabbBvh3& bvh) {
    return std::ranges::equal(bvh.Blob(), copy.Blob());
  };
  EXPECT_TRUE(is_whole(first));
  EXPECT_EQ(copy.size(), 1000u);
  AabbBvh3 second;
  EXPECT_TRUE(second.empty());
  EXPECT_EQ(CountSurvivors(second, Aabb3::Everything()), 0u);
  swap(first, second);
  EXPECT_TRUE(first.empty() && is_whole(second));
  first = std::move(second);
  EXPECT_TRUE(is_whole(first));
  second = first;
  EXPECT_TRUE(is_whole(second));
}

}  // namespace
}  // namespace halfspace::testing

// A BVH that changes answers as a scan of a list of its objects does,
// after any history, with memory and work in proportion to its objects.

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <new>
#include <numeric>
#include <random>
#include <span>
#include <thread>
#include <tuple>
#include <vector>

#include "dispatch/bvh/tree.h"
#include "halfspace/halfspace.h"
#include "tests/library/bvh/model.h"
#include "tests/library/bvh/spread.h"
#include "tests/library/support/counting_memory.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/expect_invalid.h"

namespace halfspace::testing {
namespace {

template <typename Case>
class BvhChangesTest : public ::testing::Test {};
TYPED_TEST_SUITE(BvhChangesTest, FewBvhCases, CaseNames);

// The bound of each object, and of all.
template <typename View>
void ExpectSameBounds(const Bvh<View>& bvh, const Model<View>& model) {
  using Bound = typename View::Bound;
  auto all = detail::Planes(Bound::Empty());
  for (const auto& [id, object] : model.objects) {
    const auto values = detail::Planes(object.bound);
    for (std::size_t p = 0; p < values.size(); ++p) {
      all[p] = p < Bound::kAxes ? std::min(all[p], values[p])
                                : std::max(all[p], values[p]);
    }
    if (id % 97 == 0) {
      ASSERT_EQ(detail::Planes(bvh.Get(id)), values) << id;
    }
  }
  ASSERT_EQ(detail::Planes(bvh.Bounds()), all);
}

TYPED_TEST(BvhChangesTest, AnyHistoryIsThatOfTheModel) {
  using View = typename TypeParam::View;
  using Bound = typename View::Bound;
  const std::vector<Target> targets = TargetsUnderTest();
  for (std::size_t round = 0; round < std::max<std::size_t>(2, Scaled(12));
       ++round) {
    Random random(round);
    Spread<View> spread(1.0f, round);
    Model<View> model;
    const std::size_t size = round % 3 == 0 ? 0 : random() % 9000;
    const World<View> world = spread.Objects(size);
    for (std::uint32_t i = 0; i < size; ++i) {
      model.objects[i] = {world.Get(i)};
    }
    Bvh<View> bvh(world, {.quality = round % 2 == 0 ? BuildQuality::kHigh
                                                    : BuildQuality::kFast});
    std::size_t ids_ever = size;
    const auto any_id = [&] {
      auto it = model.objects.lower_bound(
          static_cast<std::uint32_t>(random() % (bvh.size() + 1)));
      return (it == model.objects.end() ? model.objects.begin() : it)->first;
    };
    const auto any_bound = [&] {
      switch (random() % 20) {
        case 0:
          return Bound::Everything();
        case 1:
          return Bound::Empty();
        default:
          return spread.NextObject();
      }
    };
    for (std::size_t step = 0; step < 10 + Scaled(20); ++step) {
      const std::size_t what = random() % 15;
      if (what < 4 || model.objects.empty()) {
        for (std::size_t i = random() % 300; i-- > 0;) {
          const Bound bound = any_bound();
          const std::uint32_t id = bvh.Insert(bound);
          ASSERT_TRUE(
              model.objects.emplace(id, typename Model<View>::Object{bound})
                  .second);
          ASSERT_TRUE(bvh.Has(id));
          ids_ever = std::max<std::size_t>(ids_ever, id + 1u);
        }
      } else if (what == 4) {
        for (std::size_t i = random() % 400; i-- > 0 && bvh.size() > 0;) {
          const std::uint32_t id = any_id();
          bvh.Erase(id);
          model.objects.erase(id);
          ASSERT_FALSE(bvh.Has(id));
        }
      } else if (what == 5) {
        for (std::size_t i = random() % 200; i-- > 0;) {
          const std::uint32_t id = any_id();
          model.objects[id].bound = any_bound();
          bvh.Set(id, model.objects[id].bound);
        }
      } else if (what == 6) {
        std::vector<Bound> bounds(bvh.id_limit(), Bound::Everything());
        for (auto& [id, object] : model.objects) {
          bounds[id] = object.bound = any_bound();
        }
        if (random() % 2 == 0) {
          bvh.Refit(bounds);
        } else {
          std::vector<Bound> in_order;
          for (std::uint32_t id : bvh.ids()) {
            in_order.push_back(id == 0xFFFFFFFF ? Bound::Everything()
                                                : bounds[id]);
          }
          bvh.RefitInOrder(in_order);
        }
      } else if (what == 7) {
        bvh.RebuildPartial(random() % 9000);
      } else if (what == 8) {
        bvh.Rebuild({.quality = random() % 2 == 0 ? BuildQuality::kHigh
                                                  : BuildQuality::kFast});
      } else if (what == 11) {
        // Ids that come twice, the last bound of which wins.
        Ids ids;
        std::vector<Bound> bounds;
        for (std::size_t i = random() % 3000; i-- > 0;) {
          ids.push_back(any_id());
          bounds.push_back(any_bound());
          model.objects[ids.back()].bound = bounds.back();
        }
        if (random() % 2 == 0) {
          bvh.Set(ids, bounds);
        } else {
          std::vector<Bound> by_id(bvh.id_limit(), Bound::Everything());
          for (const auto& [id, object] : model.objects) {
            by_id[id] = object.bound;
          }
          bvh.Refit(ids, by_id);
        }
      } else if (what == 12) {
        Ids ids;
        for (std::size_t i = random() % (2 * bvh.size()); i-- > 0;) {
          ids.push_back(any_id());
        }
        if (random() % 8 == 0) {
          ids.assign(bvh.ids().begin(), bvh.ids().end());
          std::erase(ids, 0xFFFFFFFF);
        }
        bvh.Erase(ids);
        for (const std::uint32_t id : ids) model.objects.erase(id);
      } else if (what == 13) {
        std::vector<Bound> bounds(random() % 3 == 0 ? random() % 9000
                                                    : random() % 300);
        for (Bound& bound : bounds) bound = any_bound();
        Ids ids(bounds.size());
        bvh.Insert(bounds, ids);
        for (std::size_t i = 0; i < ids.size(); ++i) {
          ASSERT_TRUE(
              model.objects
                  .emplace(ids[i], typename Model<View>::Object{bounds[i]})
                  .second);
        }
        ids_ever = std::max(ids_ever, bvh.id_limit());
      } else if (what == 14) {
        // Free ids, some far beyond the others, in any order.
        const std::size_t far = random() % 4 == 0 ? 30'000 : 300;
        std::map<std::uint32_t, Bound> added;
        for (std::size_t i = random() % 600; i-- > 0;) {
          const auto id =
              static_cast<std::uint32_t>(random() % (bvh.id_limit() + far));
          if (!model.objects.contains(id)) added[id] = any_bound();
        }
        Ids ids;
        std::vector<Bound> bounds;
        for (const auto& [id, bound] : added) ids.push_back(id);
        if (random() % 2 == 0) std::ranges::shuffle(ids, random);
        for (const std::uint32_t id : ids) {
          bounds.push_back(added[id]);
          model.objects[id] = {added[id]};
        }
        bvh.InsertAs(ids, bounds);
        ids_ever = std::max(ids_ever, bvh.id_limit());
      } else if (what == 10) {
        if (random() % 3 == 0) {
          bvh.Clear();
          model.objects.clear();
          ASSERT_EQ(bvh.id_limit(), 0u);
        }
        const std::size_t more = random() % 2000;
        bvh.Reserve(bvh.size() + more);
        const std::size_t bytes = bvh.bytes();
        for (std::size_t i = more; i-- > 0;) {
          const Bound bound = any_bound();
          ASSERT_TRUE(model.objects
                          .emplace(bvh.Insert(bound),
                                   typename Model<View>::Object{bound})
                          .second);
        }
        ASSERT_EQ(bvh.bytes(), bytes);
        ids_ever = std::max(ids_ever, bvh.id_limit());
      } else if (random() % 2 == 0) {
        for (std::size_t i = random() % 50; i-- > 0;) {
          const std::uint32_t id = any_id();
          model.objects[id].masks = 1u << random() % 3;
          bvh.SetMasks(id, model.objects[id].masks);
        }
      } else {
        Ids masks(bvh.id_limit());
        for (auto& [id, object] : model.objects) {
          object.masks = static_cast<std::uint32_t>(random() % 8);
          masks[id] = object.masks;
        }
        bvh.SetMasks(masks);
      }
      ASSERT_LE(bvh.ids().size(), 2 * bvh.size() + 64);
      ASSERT_LE(bvh.id_limit(), ids_ever);
      ASSERT_TRUE(std::ranges::all_of(model.objects, [&](const auto& object) {
        return bvh.Has(object.first);
      }));
      ExpectSameBounds<View>(bvh, model);
      const auto queries = SomeQueries<View>(random());
      for (std::uint32_t masks : {0xFFFFFFFFu, 1u, 6u}) {
        ExpectIsModel<View>(bvh, model, queries,
                            targets[random() % targets.size()], masks);
        if (this->HasFatalFailure()) {
          FAIL() << "round " << round << ", step " << step << ", " << what;
        }
      }
    }
  }
}

// Nodes are as tight as those of a new world with the same order, whatever
// changed: the blocks of both are equal.
TYPED_TEST(BvhChangesTest, LevelsStayAsTightAsAfterARefit) {
  using View = typename TypeParam::View;
  Spread<View> spread(1.0f);
  Bvh<View> changed(spread.Objects(9000));
  World<View> bounds = spread.Objects(9000);
  Bvh<View> refitted(changed);
  Bvh<View> batched(changed);
  Bvh<View> listed(changed);
  Ids ids;
  std::vector<typename View::Bound> list;
  for (std::uint32_t i = 0; i < 9000; ++i) {
    changed.Set(i, bounds.Get(i));
    ids.push_back(i);
    list.push_back(bounds.Get(i));
  }
  std::size_t count = 3;
  for (std::size_t i = 0; i < ids.size(); i += count, count = 703 - count) {
    count = std::min(count, ids.size() - i);
    batched.Set(std::span(ids).subspan(i, count),
                std::span(list).subspan(i, count));
    listed.Refit(std::span(ids).subspan(i, count), list);
  }
  // The codes are equal, too: they do not depend on the call.
  EXPECT_TRUE(std::ranges::equal(changed.Blob(), batched.Blob()));
  EXPECT_TRUE(std::ranges::equal(changed.Blob(), listed.Blob()));
  refitted.Refit(bounds.view());
  EXPECT_GT(changed.CostRatio(), 2.0);
  EXPECT_EQ(changed.CostRatio(), refitted.CostRatio());
  const auto& a = detail::TreeOf(changed).levels();
  const auto& b = detail::TreeOf(refitted).levels();
  const auto& c = detail::TreeOf(batched).levels();
  ASSERT_EQ(a.count, b.count);
  for (std::size_t l = 0; l < a.count; ++l) {
    const std::size_t floats = (a.level[l].size + 63) / 64 * 64 * kPlanes<View>;
    EXPECT_TRUE(std::equal(a.level[l].floats, a.level[l].floats + floats,
                           b.level[l].floats))
        << l;
    EXPECT_TRUE(std::equal(c.level[l].floats, c.level[l].floats + floats,
                           b.level[l].floats))
        << l;
  }
}

// The node that an insertion chooses is the same on every target, also among
// bounds that are empty, infinite or NaN, and for such a bound.
TYPED_TEST(BvhChangesTest, TheNearestNodeIsThatOfPlainCode) {
  using View = typename TypeParam::View;
  using Bound = typename View::Bound;
  Spread<View> spread(1.0f);
  Random random(3);
  World<View> world = spread.Objects(9000);
  const auto any_bound = [&] {
    Bound bound = random() % 8 == 0   ? Bound::Empty()
                  : random() % 8 == 0 ? Bound::Everything()
                                      : spread.NextObject();
    if (random() % 8 == 0) {
      bound.min[random() % Bound::kAxes] =
          std::numeric_limits<float>::quiet_NaN();
    }
    return bound;
  };
  for (std::size_t i = 0; i < 9000; i += 1 + random() % 256) {
    world.Set(i, any_bound());
  }
  const Bvh<View> bvh(world);
  const detail::BvhTree& tree = detail::TreeOf(bvh);
  const detail::BvhLevel& level = tree.levels().level[1];
  const auto plain = [&](std::size_t block, const auto& values,
                         std::uint64_t nodes) {
    std::int32_t least = std::numeric_limits<std::int32_t>::max();
    for (std::size_t i = 0; i < 64; ++i) {
      float growth = 0;
      for (std::size_t p = 0; p < values.size(); ++p) {
        const float node = level.Value(p, block * 64 + i);
        const float beyond =
            p < Bound::kAxes ? node - values[p] : values[p] - node;
        if (beyond > 0) growth += beyond;
      }
      const std::int32_t key = (std::bit_cast<std::int32_t>(growth) & ~63) |
                               static_cast<std::int32_t>(i);
      if ((nodes >> i & 1) != 0) least = std::min(least, key);
    }
    return static_cast<std::size_t>(least & 63);
  };
  for (std::size_t round = 0; round < 2000; ++round) {
    const std::size_t block = random() % 2;  // of 141 nodes
    const Bound bound = any_bound();
    const auto values = detail::Planes(bound);
    const std::uint64_t nodes = round % 4 == 0
                                    ? std::uint64_t{1} << random() % 64
                                    : level.present[block] & ~random();
    if (nodes == 0) continue;
    for (const Target target : TargetsUnderTest()) {
      ASSERT_EQ(detail::KernelsFor(tree.type(), target, "")
                    .nearest_node(level, block, values.data(), nodes),
                plain(block, values, nodes))
          << round;
    }
  }
}

// Three levels: the root learns of masks that change no bound.
TEST(BvhMasksTest, AMaskIsKnownAtTheRoot) {
  AabbBvh3 bvh(Spread<AabbView3>(1.0f).Objects(9000));
  bvh.SetMasks(Ids(9000, 1));
  bvh.SetMasks(7, 2);
  QueryOptions options;
  options.mask = 2;
  EXPECT_EQ(CountSurvivors(bvh, Aabb3::Everything(), options), 1u);
  bvh.Erase(7);
  EXPECT_EQ(CountSurvivors(bvh, Aabb3::Everything(), options), 0u);
}

TYPED_TEST(BvhChangesTest, RebuildsMendWhatDecayed) {
  using View = typename TypeParam::View;
  using Bound = typename View::Bound;
  Spread<View> spread(0.2f);
  const World<View> world = spread.Objects(40'000);
  Bvh<View> bvh(world);
  EXPECT_EQ(bvh.CostRatio(), 1.0);
  EXPECT_EQ(bvh.RebuildPartial(100'000), 0u);
  // The first tenth in the world's order change places with each other.
  const Ids first(bvh.ids().begin(), bvh.ids().begin() + 4096);
  for (std::size_t i = 0; i < first.size(); ++i) {
    const Bound bound = world.Get(first[(i * 1021) % first.size()]);
    bvh.Set(first[i], bound);
  }
  const double decayed = bvh.CostRatio();
  EXPECT_GT(decayed, 1.2);
  EXPECT_EQ(bvh.RebuildPartial(4096), 4096u);
  EXPECT_LT(bvh.CostRatio(), 1.05);
  bvh.Refit(spread.Objects(40'000).view());
  EXPECT_GT(bvh.CostRatio(), 5.0);
  bvh.Rebuild();
  EXPECT_EQ(bvh.CostRatio(), 1.0);
}

// With and without nodes, by the object's own floats and by those of a node.
TYPED_TEST(BvhChangesTest, BoundsOfANaNAreInfinite) {
  using Bound = typename TypeParam::View::Bound;
  for (std::size_t size : {1, 64, 65, 5000}) {
    Bvh<typename TypeParam::View> bvh;
    EXPECT_EQ(detail::Planes(bvh.Bounds()), detail::Planes(Bound::Empty()));
    for (std::size_t i = 0; i < size; ++i) {
      bvh.Insert(Spread<typename TypeParam::View>(1.0f, i).NextObject());
    }
    auto planes = detail::Planes(bvh.Bounds());
    auto values = planes;
    for (std::size_t p = 0; p < values.size(); ++p) {
      values[p] = std::numeric_limits<float>::quiet_NaN();
      planes[p] = (p < Bound::kAxes ? -1.0f : 1.0f) *
                  std::numeric_limits<float>::infinity();
      if (p == 1) break;  // The other planes stay as they are.
    }
    bvh.Insert(detail::BoundOf<Bound>(values));
    EXPECT_EQ(detail::Planes(bvh.Bounds()), planes) << size;
  }
}

TEST(BvhThreadsTest, ShareRefitsAndBuilds) {
  Spread<AabbView3> spread(1.0f);
  AabbBvh3 bvh(spread.Objects(40'000));
  AabbBvh3 same(bvh);
  const AabbWorld3 bounds = spread.Objects(40'000);
  const auto run = [](std::size_t count, const auto& part) {
    std::vector<std::thread> threads;
    for (std::size_t t = 0; t < 3; ++t) {
      threads.emplace_back([=, &part] {
        for (std::size_t i = t; i < count; i += 3) part(i);
      });
    }
    for (std::thread& thread : threads) thread.join();
  };
  bvh.Refit(bounds, run);
  same.Refit(bounds.view());
  EXPECT_EQ(bvh.CostRatio(), same.CostRatio());
  for (const Aabb3& query : SomeQueries<AabbView3>(1)) {
    EXPECT_EQ(CountSurvivors(bvh, query), CountSurvivors(bounds, query));
  }
  // And builds, which are the same then.
  for (BuildQuality quality : {BuildQuality::kHigh, BuildQuality::kFast}) {
    const AabbBvh3 built(bounds, {.quality = quality, .run = run});
    const AabbBvh3 alone(bounds.view(), {.quality = quality});
    EXPECT_TRUE(std::equal(built.ids().begin(), built.ids().end(),
                           alone.ids().begin()));
    EXPECT_EQ(built.CostRatio(), 1.0);
    bvh.Rebuild({.quality = quality, .run = run});
    EXPECT_EQ(CountSurvivors(bvh, Aabb3::Everything()), 40'000u);
  }
}

void RunBackwards(std::size_t count, Runner::Part part) {
  while (count-- > 0) part(count);
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
  count_all(&RunBackwards);
  count_all([&runs](std::size_t count, const Runner::Part& part) {
    ++runs;
    RunBackwards(count, part);
  });
  EXPECT_EQ(calls, std::vector<int>(5, 5));
  EXPECT_EQ(runs, 3);
}

// A temporary in the options lives until the constructor returns.
TEST(RunnerTest, CanBeATemporaryOfTheCall) {
  const AabbWorld3 world = Spread<AabbView3>(1.0f).Objects(10'000);
  std::size_t parts = 0;
  const AabbBvh3 bvh(world,
                     {.run = [&parts, in_turn = std::function(RunBackwards)](
                                 std::size_t count, const auto& part) {
                       parts += count;
                       in_turn(count, part);
                     }});
  EXPECT_GE(parts, 3u);
  const AabbBvh3 alone(world);
  EXPECT_TRUE(
      std::equal(bvh.ids().begin(), bvh.ids().end(), alone.ids().begin()));
}

TEST(BvhRefitTest, RefusesOtherNumbersOfBounds) {
  Spread<AabbView3> spread(1.0f);
  AabbBvh3 bvh(spread.Objects(100));
  EXPECT_TRUE(Refuses([&] { bvh.Refit(spread.Objects(99).view()); },
                      {"Refit", "100", "99"}));
  bvh.Erase(7);
  EXPECT_TRUE(Refuses([&] { bvh.Erase(7); }, {"Erase", "id", "7"}));
  EXPECT_TRUE(
      Refuses([&] { bvh.Set(100, Aabb3::Empty()); }, {"Set", "id", "100"}));
  Ids ids(1);
  const std::vector<Aabb3> two(2, Aabb3::Empty());
  EXPECT_TRUE(Refuses([&] { bvh.Insert(two, ids); }, {"Insert", "ids", "2"}));
  EXPECT_TRUE(Refuses([&] { bvh.Set(ids, two); }, {"Set", "bounds", "1", "2"}));
  // Nothing has changed.
  const Aabb3 before = bvh.Get(3);
  EXPECT_TRUE(Refuses([&] { bvh.Set(Ids{3, 7}, two); }, {"Set", "id", "7"}));
  EXPECT_TRUE(Refuses([&] { bvh.Erase(Ids{3, 7}); }, {"Erase", "id", "7"}));
  const std::vector<Aabb3> by_id(100, Aabb3::Empty());
  EXPECT_TRUE(Refuses(
      [&] {
        bvh.Refit(Ids{3, 7}, by_id);
      },
      {"Refit", "id", "7"}));
  EXPECT_TRUE(
      Refuses([&] { bvh.Refit(ids, two); }, {"Refit", "bounds", "100", "2"}));
  EXPECT_EQ(bvh.Get(3), before);
  EXPECT_TRUE(Refuses([&] { std::ignore = bvh.Get(7); }, {"Get", "id", "7"}));
  EXPECT_TRUE(Refuses([&] { bvh.Reserve(std::size_t{1} << 31); },
                      {"Reserve", "objects", "2147483648"}));
}

TEST(BvhOwnIdsTest, RefusesIdsThatAreNotFree) {
  AabbBvh3 bvh(Spread<AabbView3>(1.0f).Objects(100));
  bvh.Erase(7);
  const std::vector<std::byte> before(bvh.Blob().begin(), bvh.Blob().end());
  const std::byte* const block = bvh.Blob().data();
  struct Wrong {
    Ids ids;
    const char* given;
  };
  for (const Wrong& wrong :
       {Wrong{{7, 200, 3}, "got 3"}, Wrong{{7, 200, 7}, "got 7 twice"},
        Wrong{{300, 300, 7}, "got 300 twice"}, Wrong{{99, 7, 8}, "got 99"},
        Wrong{{500, 0xFFFFFFFF, 7}, "got 4294967295"},
        Wrong{{7, 8, 200}, "got 8"}}) {
    EXPECT_TRUE(Refuses(
        [&] { bvh.InsertAs(wrong.ids, std::vector<Aabb3>(3)); },
        {"InsertAs", "ids", "below 4294967295, each once", wrong.given}));
  }
  EXPECT_TRUE(Refuses([&] { bvh.InsertAs(Ids{7}, std::vector<Aabb3>(2)); },
                      {"InsertAs", "bounds", "1", "2"}));
  EXPECT_TRUE(Refuses(
      [&] {
        bvh.InsertAs({nullptr, 1}, std::vector<Aabb3>(1));
      },
      {"InsertAs", "ids", "null"}));
  bvh.InsertAs({}, std::vector<Aabb3>());
  EXPECT_EQ(bvh.Blob().data(), block);
  EXPECT_TRUE(std::ranges::equal(bvh.Blob(), before));
}

// Any history of ids, of few objects and of many, in a world and in its copies
// and blobs, which go on as it does.
TEST(BvhOwnIdsTest, InsertTakesTheLeastFreeId) {
  for (std::size_t round = 0; round < 4 + Scaled(20); ++round) {
    SCOPED_TRACE(round);
    Random random(round);
    Spread<AabbView3> spread(1.0f, round);
    std::map<std::uint32_t, Aabb3> model;
    AabbBvh3 bvh;
    const std::size_t far = round % 4 == 0 ? 300'000 : 3000;
    for (std::size_t step = 0; step < 40; ++step) {
      std::vector<Aabb3> bounds(random() % (round % 4 == 1 ? 3000 : 60));
      for (Aabb3& bound : bounds) bound = spread.NextObject();
      Ids ids;
      const std::size_t what = random() % 6;
      if (what < 2) {
        for (std::size_t i = 0; i < bounds.size(); ++i) {
          const auto id = static_cast<std::uint32_t>(random() % far);
          if (model.emplace(id, bounds[ids.size()]).second) ids.push_back(id);
        }
        bounds.resize(ids.size());
        bvh.InsertAs(ids, bounds);
      } else if (what < 4) {
        Ids expected;
        std::uint32_t free = 0;
        for (const Aabb3& bound : bounds) {
          while (model.contains(free)) ++free;
          model[free] = bound;
          expected.push_back(free);
        }
        ids.resize(bounds.size());
        if (what == 2) {
          bvh.Insert(bounds, ids);
        } else {
          for (std::size_t i = 0; i < ids.size(); ++i) {
            ids[i] = bvh.Insert(bounds[i]);
          }
        }
        ASSERT_EQ(ids, expected);
      } else if (what == 4) {
        for (const auto& [id, bound] : model) {
          if (random() % 3 == 0) ids.push_back(id);
        }
        bvh.Erase(ids);
        for (const std::uint32_t id : ids) model.erase(id);
      } else if (random() % 4 == 0) {
        bvh.Clear();
        model.clear();
      } else if (random() % 2 == 0) {
        bvh.Rebuild();
        ASSERT_EQ(bvh.id_limit(),
                  model.empty() ? 0 : std::prev(model.end())->first + 1u);
      } else if (!model.empty()) {
        // Each goes on as the others do, with the same places and ids.
        AabbBvh3 copy =
            random() % 2 == 0 ? AabbBvh3::FromBlob(bvh.Blob()) : AabbBvh3(bvh);
        for (AabbBvh3* same : {&bvh, &copy}) {
          Random changes(step);
          Spread<AabbView3> objects(1.0f, step);
          for (int i = 0; i < 300; ++i) {
            if (changes() % 3 == 0) {
              const auto id =
                  static_cast<std::uint32_t>(far + changes() % 5000);
              const std::vector one(1, objects.NextObject());
              if (!same->Has(id)) same->InsertAs({&id, 1}, one);
            } else {
              const std::uint32_t id = same->Insert(Aabb3::Everything());
              if (changes() % 2 == 0) same->Erase(id);
            }
          }
          same->Refit(std::vector(same->id_limit(), Aabb3{}));
        }
        ASSERT_TRUE(std::ranges::equal(bvh.ids(), copy.ids()));
        Ids found(bvh.size());
        Ids same(bvh.size());
        ASSERT_EQ(Survivors(bvh, Aabb3{}, found), bvh.size());
        ASSERT_EQ(Survivors(copy, Aabb3{}, same), bvh.size());
        ASSERT_EQ(found, same);
        model.clear();
        for (const std::uint32_t id : found) model[id] = {};
      }
      ASSERT_EQ(bvh.size(), model.size());
      for (const auto& [id, bound] : model) ASSERT_EQ(bvh.Get(id), bound);
    }
  }
}

// Few objects with great ids take 4.13 bytes for each id below, and ids that
// grow one by one move the block rarely.
TEST(BvhOwnIdsTest, MemoryFollowsTheGreatestId) {
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

// More than are changed one by one.
Ids TenIds() {
  Ids ids(10);
  std::iota(ids.begin(), ids.end(), 3);
  return ids;
}

// Each change, with less memory than it needs, of a world that owns its block
// and of a blob in place. What was taken from the world stays valid.
TEST(BvhChangesMemoryTest, AWorldIsAsItWasWhereThereIsNoMemory) {
  using Change = void (*)(AabbBvh3&);
  constexpr Change kChanges[] = {
      [](AabbBvh3& world) { world.Set(3, Aabb3::Everything()); },
      [](AabbBvh3& world) { world.Insert(Aabb3::Everything()); },
      [](AabbBvh3& world) { world.Erase(3); },
      [](AabbBvh3& world) { world.Reserve(20'000); },
      [](AabbBvh3& world) {
        world.Set(TenIds(), std::vector(10, Aabb3::Everything()));
      },
      [](AabbBvh3& world) {
        world.Refit(TenIds(), std::vector(9256, Aabb3::Everything()));
      },
      [](AabbBvh3& world) { world.Erase(TenIds()); },
      [](AabbBvh3& world) {
        Ids ids(300);
        world.Insert(std::vector(300, Aabb3::Everything()), ids);
      },
      [](AabbBvh3& world) {
        world.Set(TenIds(), std::vector(10, Aabb<3, double>::Everything()));
      },
      [](AabbBvh3& world) {
        Ids ids(300);
        world.Insert(std::vector(300, Aabb<3, double>::Everything()), ids);
      },
      [](AabbBvh3& world) {
        world.Refit(std::vector(9256, Aabb<3, double>::Everything()));
      },
      [](AabbBvh3& world) {
        world.InsertAs(Ids{10'000, 9999}, std::vector<Aabb3>(2));
      },
      [](AabbBvh3& world) {
        Ids ids(300);
        std::iota(ids.begin(), ids.end(), 50'000);
        world.InsertAs(ids, std::vector(300, Aabb<3, double>::Everything()));
      },
      [](AabbBvh3& world) { world.SetMasks(3, 1); },
      [](AabbBvh3& world) { world.SetMasks(Ids(9256)); },
      [](AabbBvh3& world) { world.Rebuild(); },
      [](AabbBvh3& world) { world.RebuildPartial(9000); }};
  CountingMemory memory;
  Spread<AabbView3> spread(2.0f);
  const AabbWorld3 objects = spread.Objects(9000);
  Model<AabbView3> model;
  AabbBvh3 first(objects, {.memory = memory.resource()});
  const AabbWorld3 moved = spread.Objects(9000);
  first.Refit(moved.view());  // so that there is something to sort
  for (std::uint32_t i = 0; i < 9000; ++i) model.objects[i] = {moved.Get(i)};
  // As many insertions as are due to be sorted.
  for (std::uint32_t i = 0; i < 256; ++i) {
    model.objects[first.Insert(moved.Get(i))] = {moved.Get(i)};
  }
  const auto queries = SomeQueries<AabbView3>(1);
  const auto blob = first.Blob();
  for (bool is_in_place : {false, true}) {
    for (Change change : kChanges) {
      bool is_done = false;
      for (std::size_t left = 0; !is_done; ++left) {
        AabbBvh3 world = is_in_place
                             ? AabbBvh3::InPlace(blob, memory.resource())
                             : AabbBvh3(first, memory.resource());
        const std::uint32_t* const ids = world.ids().data();
        const Ids were(world.ids().begin(), world.ids().end());
        memory.left = left;
        try {
          change(world);
          is_done = true;
        } catch (const std::bad_alloc&) {
          memory.left = CountingMemory::kNoLimit;
          ASSERT_EQ(world.ids().data(), ids);
          ASSERT_TRUE(std::equal(were.begin(), were.end(), ids));
          ExpectIsModel<AabbView3>(world, model, queries, ChosenTarget());
        }
        memory.left = CountingMemory::kNoLimit;
      }
    }
  }
}

// Leaves that queries visit, as a count of work.
template <typename View>
std::size_t LeavesVisited(const Bvh<View>& bvh,
                          std::span<const typename View::Query> queries) {
  const detail::BvhLevel& level = detail::TreeOf(bvh).levels().level[1];
  World<View> leaves;
  for (std::size_t n = 0; n < level.size; ++n) {
    typename View::Bound leaf;
    for (std::size_t p = 0; p < kPlanes<View>; ++p) {
      StoredValue<View>(leaf, p) = level.Value(p, n);
    }
    leaves.Push(leaf);
  }
  std::size_t visited = 0;
  for (const auto& query : queries) visited += CountSurvivors(leaves, query);
  return visited;
}

TYPED_TEST(BvhChangesTest, AWorldSortsItselfAsItChanges) {
  using View = typename TypeParam::View;
  constexpr std::size_t kSize = 20'000;
  Spread<View> spread(0.2f);
  const World<View> bounds = spread.Objects(kSize);
  const auto queries = spread.Queries(500);
  const Bvh<View> built(bounds);
  const std::size_t least = LeavesVisited<View>(built, queries);
  Bvh<View> bvh;
  for (std::size_t i = 0; i < kSize; ++i) bvh.Insert(bounds.Get(i));
  // The same objects in batches, none of them a multiple of what is sorted.
  Bvh<View> batched;
  for (std::size_t i = 0; i < kSize;) {
    std::vector<typename View::Bound> batch;
    for (; batch.size() < 1 + i / 7 && i < kSize; ++i) {
      batch.push_back(bounds.Get(i));
    }
    Ids of_batch(batch.size());
    batched.Insert(batch, of_batch);
  }
  EXPECT_LE(LeavesVisited<View>(batched, queries),
            3 * least + 8 * queries.size());
  // Up to four blocks and a few runs have no place in the order yet.
  EXPECT_LE(LeavesVisited<View>(bvh, queries), 3 * least + 8 * queries.size());
  Random random(1);
  std::vector<std::uint32_t> ids(kSize);
  for (std::uint32_t i = 0; i < kSize; ++i) ids[i] = i;
  for (std::size_t i = 0; i < 3 * kSize / 2; ++i) {
    std::uint32_t& id = ids[random() % kSize];
    bvh.Erase(id);
    id = bvh.Insert(spread.NextObject());
  }
  EXPECT_LE(LeavesVisited<View>(bvh, queries), 3 * least + 8 * queries.size());
}

// In lists of a few, as bodies of a simulation do. The new ones take the places
// of those that went, and partial rebuilds do not spread them over the world.
TYPED_TEST(BvhChangesTest, AWorldWhoseObjectsComeAndGoStaysSorted) {
  using View = typename TypeParam::View;
  constexpr std::size_t kSize = 20'000;
  constexpr std::size_t kList = 16;
  Spread<View> spread(0.2f);
  const auto queries = spread.Queries(500);
  Bvh<View> bvh(spread.Objects(kSize));
  const std::size_t least = LeavesVisited<View>(bvh, queries);
  Random random(1);
  for (std::size_t i = 0; i < kSize * 19 / 20 / kList; ++i) {
    Ids ids;
    for (std::size_t k = 0; k < kList; ++k) {
      ids.push_back(static_cast<std::uint32_t>(random() % kSize));
    }
    std::sort(ids.begin(), ids.end());
    ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
    bvh.Erase(ids);
    std::vector<typename View::Bound> bounds(ids.size());
    for (auto& bound : bounds) bound = spread.NextObject();
    bvh.InsertAs(ids, bounds);
    if (i % 64 == 0) bvh.RebuildPartial(2048);
  }
  EXPECT_LE(LeavesVisited<View>(bvh, queries), 4 * least + 2 * queries.size());
}

// A partial rebuild cuts the end of the world, in front of where it ended when
// all were sorted. Then a list crosses that place.
TEST(BvhRebuildPartialTest, AListAfterTheEndWasCutIsFound) {
  constexpr std::uint32_t kSize = 2048;
  Spread<AabbView3> spread(0.2f);
  AabbBvh3 bvh(spread.Objects(kSize));
  const Ids places(bvh.ids().begin(), bvh.ids().end());
  Ids erased(places.end() - 700, places.end() - 1);
  bvh.Erase(erased);
  for (std::size_t i = 0; i < 600; ++i) bvh.Set(places[i], spread.NextObject());
  EXPECT_GT(bvh.RebuildPartial(kSize), 0u);
  ASSERT_LT(bvh.ids().size(), kSize - 600u);
  std::vector<Aabb3> bounds(1000);
  for (Aabb3& bound : bounds) bound = spread.NextObject();
  Ids ids(bounds.size());
  bvh.Insert(bounds, ids);
  EXPECT_EQ(CountSurvivors(bvh, Aabb3::Everything()), bvh.size());
}

TEST(BvhRebuildPartialTest, AWorldWithoutObjectsHasNoParts) {
  AabbBvh3 bvh(Spread<AabbView3>(1.0f).Objects(100));
  bvh.Clear();
  EXPECT_EQ(bvh.RebuildPartial(100), 0u);
}

// All objects cross the world. A part of the order that kept its objects would
// end up with some from everywhere.
TYPED_TEST(BvhChangesTest, PartialRebuildsExchangeObjects) {
  using View = typename TypeParam::View;
  constexpr std::size_t kSize = 12'000;
  constexpr std::size_t kFrames = 200;
  const World<View> from = Spread<View>(0.2f, 1).Objects(kSize);
  const World<View> to = Spread<View>(0.2f, 2).Objects(kSize);
  Bvh<View> bvh(from);
  std::vector<typename View::Bound> bounds(kSize);
  for (std::size_t frame = 1; frame <= kFrames; ++frame) {
    const float share = static_cast<float>(frame) / kFrames;
    for (std::size_t i = 0; i < kSize; ++i) {
      const auto a = detail::Planes(from.Get(i));
      auto values = detail::Planes(to.Get(i));
      for (std::size_t p = 0; p < values.size(); ++p) {
        values[p] = a[p] * (1 - share) + values[p] * share;
      }
      bounds[i] = detail::BoundOf<typename View::Bound>(values);
    }
    bvh.Refit(bounds);
    EXPECT_LE(bvh.RebuildPartial(kSize / 16), 2048u);
  }
  const auto queries = Spread<View>(0.2f, 3).Queries(500);
  EXPECT_LE(LeavesVisited<View>(bvh, queries),
            3 * LeavesVisited<View>(Bvh<View>(bounds), queries));
}

// An object that is very far away costs the others none of their order.
TYPED_TEST(BvhChangesTest, OneFarObjectLeavesTheOrder) {
  using View = typename TypeParam::View;
  Spread<View> spread(0.2f);
  World<View> bounds = spread.Objects(20'000);
  const auto queries = spread.Queries(500);
  for (BuildQuality quality : {BuildQuality::kHigh, BuildQuality::kFast}) {
    const std::size_t near =
        LeavesVisited<View>(Bvh<View>(bounds, {.quality = quality}), queries);
    World<View> with_far(bounds);
    auto far = bounds.Get(7);
    far.min[0] += 1e30f;
    if constexpr (HasMaxima<View>) far.max[0] += 1e30f;
    with_far.Set(7, far);
    EXPECT_LE(
        LeavesVisited<View>(Bvh<View>(with_far, {.quality = quality}), queries),
        near + near / 5)
        << static_cast<int>(quality);
  }
}

// Of a stream, whose oldest object is erased for each that comes further along
// an axis, and of a world that is emptied and filled.
TYPED_TEST(BvhChangesTest, MemoryFollowsTheObjects) {
  using View = typename TypeParam::View;
  Spread<View> spread(1.0f);
  const auto bytes_of = [&](std::size_t size) {
    return Bvh<View>(spread.Objects(size)).bytes();
  };
  Bvh<View> bvh;
  Model<View> model;
  std::deque<std::uint32_t> alive;
  for (std::size_t i = 0; i < 20'000; ++i) {
    auto bound = spread.NextObject();
    bound.min[0] += static_cast<float>(i);
    if constexpr (HasMaxima<View>) bound.max[0] += static_cast<float>(i);
    alive.push_back(bvh.Insert(bound));
    model.objects[alive.back()] = {bound};
    if (alive.size() > 500) {
      bvh.Erase(alive.front());
      model.objects.erase(alive.front());
      alive.pop_front();
    }
    ASSERT_LE(bvh.ids().size(), 2 * bvh.size() + 64);
  }
  EXPECT_LE(bvh.bytes(), 2 * bytes_of(1000));
  EXPECT_LT(bvh.CostRatio(), 2.0);
  for (int round = 0; round < 5; ++round) {
    for (std::uint32_t id : alive) bvh.Erase(id);
    model.objects.clear();
    alive.clear();
    EXPECT_EQ(bvh.ids().size(), 0u);
    for (std::size_t i = 0; i < 5000; ++i) {
      const auto bound = spread.NextObject();
      alive.push_back(bvh.Insert(bound));
      model.objects[alive.back()] = {bound};
    }
    ASSERT_EQ(bvh.ids().size(), 5000u);
  }
  EXPECT_LE(bvh.bytes(), 2 * bytes_of(5000));
  // The first 100 remain, and with them the least ids.
  while (alive.size() > 100) {
    bvh.Erase(alive.back());
    model.objects.erase(alive.back());
    alive.pop_back();
  }
  bvh.Rebuild();
  EXPECT_LE(bvh.bytes(), bytes_of(100) + 512);
  ExpectIsModel<View>(bvh, model, SomeQueries<View>(1), ChosenTarget());
  EXPECT_EQ(bvh.Insert(View::Bound::Everything()), 100u);
}

TEST(BvhDecayTest, IsInfiniteOnlyBeforeTheFirstOrder) {
  constexpr double kInf = std::numeric_limits<double>::infinity();
  AabbBvh3 bvh;
  Spread<AabbView3> spread(1.0f);
  for (std::size_t size = 1; size <= 300; ++size) {
    bvh.Insert(spread.NextObject());
    const double decay = bvh.CostRatio();
    if (size <= 64) {
      EXPECT_EQ(decay, 1.0);
    } else if (size < 256) {
      EXPECT_EQ(decay, kInf);
    } else {
      EXPECT_LT(decay, 3.0);
    }
  }
  for (std::uint32_t id = 0; id < 295; ++id) bvh.Erase(id);
  EXPECT_EQ(bvh.CostRatio(), 1.0);
  // The newest objects are sorted, and the others have moved.
  AabbBvh3 moved(spread.Objects(3000));
  for (std::uint32_t id = 0; id < 3000; ++id)
    moved.Set(id, spread.NextObject());
  const double decay = moved.CostRatio();
  for (int i = 0; i < 257; ++i) moved.Insert(spread.NextObject());
  EXPECT_GT(moved.CostRatio(), decay / 2);
  // Half of the objects in as many leaves.
  AabbBvh3 half(spread.Objects(10'000));
  for (std::uint32_t id = 0; id < 10'000; id += 2) half.Erase(id);
  EXPECT_NEAR(half.CostRatio(), 2.0, 0.2);
  EXPECT_EQ(half.RebuildPartial(12'288), 5000u);
  EXPECT_EQ(half.CostRatio(), 1.0);
  EXPECT_EQ(half.ids().size(), 5000u);
}

}  // namespace
}  // namespace halfspace::testing

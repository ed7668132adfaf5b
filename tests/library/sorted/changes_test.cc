// A sorted world that changes answers as a scan of a list of its objects does,
// after any history; and its blob is that world, or is refused.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <map>
#include <memory>
#include <new>
#include <random>
#include <span>
#include <stdexcept>
#include <thread>
#include <vector>

#include "halfspace/halfspace.h"
#include "kernels/sorted/block.h"
#include "tests/library/sorted/spread.h"
#include "tests/library/support/counting_memory.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/expect_invalid.h"

namespace halfspace::testing {
namespace {

// What a world should have: the bound and the categories of each id.
template <typename View>
struct Model {
  struct Object {
    typename View::Bound bound;
    std::uint32_t categories = 0xFFFFFFFF;
  };
  std::map<std::uint32_t, Object> objects;

  Ids Expected(const typename View::Query& query,
               std::uint32_t categories) const {
    World<View> world;
    Ids of_world;
    for (const auto& [id, object] : objects) {
      world.Push(object.bound);
      of_world.push_back(id);
    }
    Ids ids(world.size());
    ids.resize(Survivors(world, query, ids));
    Ids expected;
    for (std::uint32_t i : ids) {
      const Object& object = objects.at(of_world[i]);
      if (~categories == 0 || (object.categories & categories) != 0) {
        expected.push_back(of_world[i]);
      }
    }
    return expected;
  }
};

template <typename View>
void ExpectIsModel(const SortedWorld<View>& sorted, const Model<View>& model,
                   std::span<const typename View::Query> queries, Target target,
                   std::uint32_t categories = 0xFFFFFFFF) {
  ASSERT_EQ(sorted.size(), model.objects.size());
  const SortedOptions options = {.categories = categories, .target = target};
  for (const auto& query : queries) {
    const Ids expected = model.Expected(query, categories);
    Ids ids(sorted.size());
    ASSERT_EQ(Survivors(sorted, query, ids, options), expected.size());
    ids.resize(expected.size());
    ASSERT_EQ(Sorted(ids), expected);
    ASSERT_EQ(CountSurvivors(sorted, query, options), expected.size());
    ASSERT_EQ(AnySurvivor(sorted, query, options).has_value(),
              !expected.empty());
  }
}

template <typename Case>
class SortedChangesTest : public ::testing::Test {};
TYPED_TEST_SUITE(SortedChangesTest, SortedCases, CaseNames);

// Queries small and large, and one around everything, where empty slots and
// nodes that are counted without a visit would show.
template <typename View>
std::vector<typename View::Query> SomeQueries(std::uint64_t seed) {
  std::vector<typename View::Query> queries = {View::Query::Everything()};
  for (float radius : {1.0f, 8.0f, 35.0f, 200.0f}) {
    queries.push_back(Spread<View>(radius, seed).NextQuery());
  }
  return queries;
}

TYPED_TEST(SortedChangesTest, AnyHistoryIsThatOfTheModel) {
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
    SortedWorld<View> sorted(world,
                             round % 2 == 0 ? Order::kTight : Order::kFast);
    std::size_t ids_ever = size;
    const auto any_id = [&] {
      auto it = model.objects.lower_bound(
          static_cast<std::uint32_t>(random() % (sorted.size() + 1)));
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
      const std::size_t what = random() % 10;
      if (what < 4 || model.objects.empty()) {
        for (std::size_t i = random() % 300; i-- > 0;) {
          const Bound bound = any_bound();
          const std::uint32_t id = sorted.Insert(bound);
          ASSERT_TRUE(
              model.objects.emplace(id, typename Model<View>::Object{bound})
                  .second);
          ASSERT_TRUE(sorted.Has(id));
          ids_ever = std::max<std::size_t>(ids_ever, id + 1u);
        }
      } else if (what == 4) {
        for (std::size_t i = random() % 400; i-- > 0 && sorted.size() > 0;) {
          const std::uint32_t id = any_id();
          sorted.Erase(id);
          model.objects.erase(id);
          ASSERT_FALSE(sorted.Has(id));
        }
      } else if (what == 5) {
        for (std::size_t i = random() % 200; i-- > 0;) {
          const std::uint32_t id = any_id();
          model.objects[id].bound = any_bound();
          sorted.Set(id, model.objects[id].bound);
        }
      } else if (what == 6) {
        std::vector<Bound> bounds(ids_ever, Bound::Everything());
        for (auto& [id, object] : model.objects) {
          bounds[id] = object.bound = any_bound();
        }
        if (random() % 2 == 0) {
          sorted.Refit(std::span<const Bound>(bounds));
        } else {
          World<View> in_order;
          for (std::uint32_t id : sorted.ids()) {
            in_order.Push(id == 0xFFFFFFFF ? Bound::Everything() : bounds[id]);
          }
          sorted.RefitInOrder(in_order.view());
        }
      } else if (what == 7) {
        sorted.RebuildWorst(random() % 9000);
      } else if (what == 8) {
        sorted.Rebuild(random() % 2 == 0 ? Order::kTight : Order::kFast);
      } else if (random() % 2 == 0) {
        for (std::size_t i = random() % 50; i-- > 0;) {
          const std::uint32_t id = any_id();
          model.objects[id].categories = 1u << random() % 3;
          sorted.SetCategories(id, model.objects[id].categories);
        }
      } else {
        Ids categories;
        for (auto& [id, object] : model.objects) {
          categories.resize(id + 1u);
          object.categories = static_cast<std::uint32_t>(random() % 8);
          categories[id] = object.categories;
        }
        sorted.SetCategories(categories);
      }
      const auto queries = SomeQueries<View>(random());
      for (std::uint32_t categories : {0xFFFFFFFFu, 1u, 6u}) {
        ExpectIsModel<View>(sorted, model, queries,
                            targets[random() % targets.size()], categories);
        if (this->HasFatalFailure()) {
          FAIL() << "round " << round << ", step " << step << ", " << what;
        }
      }
    }
  }
}

// Nodes are as tight as those of a new world with the same order, whatever
// changed: the blocks of both are equal.
TYPED_TEST(SortedChangesTest, LevelsStayAsTightAsAfterARefit) {
  using View = typename TypeParam::View;
  Spread<View> spread(1.0f);
  SortedWorld<View> changed(spread.Objects(9000));
  World<View> bounds = spread.Objects(9000);
  SortedWorld<View> refitted(changed);
  for (std::uint32_t i = 0; i < 9000; ++i) changed.Set(i, bounds.Get(i));
  refitted.Refit(bounds.view());
  EXPECT_GT(changed.Decay(), 2.0);
  EXPECT_EQ(changed.Decay(), refitted.Decay());
  const auto& a = changed.tree().levels();
  const auto& b = refitted.tree().levels();
  ASSERT_EQ(a.count, b.count);
  for (std::size_t l = 0; l < a.count; ++l) {
    const std::size_t bytes =
        (a.level[l].size + 63) / 64 * detail::BlockBytes(kPlanes<View>);
    EXPECT_TRUE(std::equal(a.level[l].blocks, a.level[l].blocks + bytes,
                           b.level[l].blocks))
        << l;
  }
}

TYPED_TEST(SortedChangesTest, RebuildsMendWhatDecayed) {
  using View = typename TypeParam::View;
  using Bound = typename View::Bound;
  Spread<View> spread(0.2f);
  const World<View> world = spread.Objects(40'000);
  SortedWorld<View> sorted(world);
  EXPECT_EQ(sorted.Decay(), 1.0);
  EXPECT_EQ(sorted.RebuildWorst(100'000), 0u);
  // The first tenth in the world's order change places with each other.
  const Ids first(sorted.ids().begin(), sorted.ids().begin() + 4096);
  for (std::size_t i = 0; i < first.size(); ++i) {
    const Bound bound = world.Get(first[(i * 1021) % first.size()]);
    sorted.Set(first[i], bound);
  }
  const double decayed = sorted.Decay();
  EXPECT_GT(decayed, 1.2);
  EXPECT_EQ(sorted.RebuildWorst(4096), 4096u);
  EXPECT_LT(sorted.Decay(), 1.05);
  sorted.Refit(spread.Objects(40'000).view());
  EXPECT_GT(sorted.Decay(), 5.0);
  sorted.Rebuild();
  EXPECT_EQ(sorted.Decay(), 1.0);
}

TEST(SortedThreadsTest, ShareRefitsAndBuilds) {
  Spread<AabbView3> spread(1.0f);
  SortedAabbWorld3 sorted(spread.Objects(40'000));
  SortedAabbWorld3 same(sorted);
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
  sorted.Refit(bounds.view(), run);
  same.Refit(bounds.view());
  EXPECT_EQ(sorted.Decay(), same.Decay());
  for (const Aabb3& query : SomeQueries<AabbView3>(1)) {
    EXPECT_EQ(CountSurvivors(sorted, query), CountSurvivors(bounds, query));
  }
  // And builds, which are the same then.
  for (Order order : {Order::kTight, Order::kFast}) {
    const SortedAabbWorld3 built(bounds.view(), order, {}, run);
    const SortedAabbWorld3 alone(bounds.view(), order);
    EXPECT_TRUE(std::equal(built.ids().begin(), built.ids().end(),
                           alone.ids().begin()));
    EXPECT_EQ(built.Decay(), 1.0);
    sorted.Rebuild(order, run);
    EXPECT_EQ(CountSurvivors(sorted, Aabb3::Everything()), 40'000u);
  }
}

TEST(SortedRefitTest, RefusesOtherNumbersOfBounds) {
  Spread<AabbView3> spread(1.0f);
  SortedAabbWorld3 sorted(spread.Objects(100));
  EXPECT_TRUE(Refuses([&] { sorted.Refit(spread.Objects(99).view()); },
                      {"Refit", "100", "99"}));
  sorted.Erase(7);
  EXPECT_TRUE(Refuses([&] { sorted.Erase(7); }, {"Erase", "id", "7"}));
  EXPECT_TRUE(
      Refuses([&] { sorted.Set(100, Aabb3::Empty()); }, {"Set", "id", "100"}));
}

// Each change, with less memory than it needs.
TEST(SortedChangesMemoryTest, AWorldIsAsItWasWhereThereIsNoMemory) {
  using Change = void (*)(SortedAabbWorld3&);
  constexpr Change kChanges[] = {
      [](SortedAabbWorld3& world) { world.Set(3, Aabb3::Everything()); },
      [](SortedAabbWorld3& world) { world.Insert(Aabb3::Everything()); },
      [](SortedAabbWorld3& world) { world.Erase(3); },
      [](SortedAabbWorld3& world) { world.SetCategories(3, 1); },
      [](SortedAabbWorld3& world) { world.Rebuild(); },
      [](SortedAabbWorld3& world) { world.RebuildWorst(9000); }};
  CountingMemory memory;
  Spread<AabbView3> spread(2.0f);
  const AabbWorld3 objects = spread.Objects(9000);
  Model<AabbView3> model;
  SortedAabbWorld3 first(objects, Order::kTight, memory.resource());
  const AabbWorld3 moved = spread.Objects(9000);
  first.Refit(moved.view());  // so that there is something to sort
  for (std::uint32_t i = 0; i < 9000; ++i) model.objects[i] = {moved.Get(i)};
  const auto queries = SomeQueries<AabbView3>(1);
  for (Change change : kChanges) {
    bool is_done = false;
    for (std::size_t left = 0; !is_done; ++left) {
      SortedAabbWorld3 world(first, memory.resource());
      memory.left = left;
      try {
        change(world);
        is_done = true;
        EXPECT_GT(left, 0u);
      } catch (const std::bad_alloc&) {
        memory.left = CountingMemory::kNoLimit;
        ExpectIsModel<AabbView3>(world, model, queries, ChosenTarget());
      }
      memory.left = CountingMemory::kNoLimit;
    }
  }
}

// 64-byte aligned bytes.
class AlignedCopy {
 public:
  explicit AlignedCopy(Span<const std::byte> bytes)
      : memory_(bytes.size() + 64) {
    void* begin = memory_.data();
    std::size_t room = memory_.size();
    std::align(64, bytes.size(), begin, room);
    bytes_ = {static_cast<std::byte*>(begin), bytes.size()};
    std::copy(bytes.begin(), bytes.end(), bytes_.begin());
  }
  std::span<std::byte> bytes() const { return bytes_; }

 private:
  std::vector<std::byte> memory_;
  std::span<std::byte> bytes_;
};

TYPED_TEST(SortedChangesTest, ABlobIsTheWorld) {
  using View = typename TypeParam::View;
  for (std::size_t size : {0u, 1u, 64u, 5000u}) {
    Spread<View> spread(2.0f);
    const World<View> world = spread.Objects(size);
    Model<View> model;
    for (std::uint32_t i = 0; i < size; ++i) model.objects[i] = {world.Get(i)};
    SortedWorld<View> sorted(world);
    if (size == 5000) {
      sorted.Erase(17);
      model.objects.erase(17);
      sorted.SetCategories(5, 4);
      model.objects[5].categories = 4;
    }
    const AlignedCopy blob(sorted.Blob());
    const AlignedCopy untouched(sorted.Blob());
    SortedWorld<View> copy = SortedWorld<View>::FromBlob(blob.bytes());
    SortedWorld<View> in_place = SortedWorld<View>::InPlace(blob.bytes());
    const auto queries = SomeQueries<View>(size);
    for (Target target : TargetsUnderTest()) {
      ExpectIsModel<View>(copy, model, queries, target, 4);
      ExpectIsModel<View>(in_place, model, queries, target);
    }
    // A change leaves the bytes alone.
    const auto bound = spread.NextObject();
    const std::uint32_t id = in_place.Insert(bound);
    EXPECT_EQ(id, size == 5000 ? 17 : size);
    model.objects[id] = {bound};
    ExpectIsModel<View>(in_place, model, queries, ChosenTarget());
    EXPECT_TRUE(std::equal(blob.bytes().begin(), blob.bytes().end(),
                           untouched.bytes().begin()));
    EXPECT_EQ(copy.Insert(bound), id);
    ExpectIsModel<View>(copy, model, queries, ChosenTarget());
  }
}

// A blob may leave the process, so nothing of what its memory held before does.
TYPED_TEST(SortedChangesTest, ABlobHasNothingElseInIt) {
  using View = typename TypeParam::View;
  struct Filled {
    int byte;
    void* allocate(std::size_t bytes, std::size_t alignment) const {
      void* block = ::operator new (bytes, std::align_val_t{alignment});
      std::memset(block, byte, bytes);
      return block;
    }
    void deallocate(void* block, std::size_t, std::size_t alignment) const {
      ::operator delete (block, std::align_val_t{alignment});
    }
  };
  Filled zeros{0};
  Filled ones{255};
  Spread<View> spread(2.0f);
  const World<View> world = spread.Objects(4500);
  SortedWorld<View> a(world, Order::kTight, MemoryFrom(zeros));
  SortedWorld<View> b(world, Order::kTight, MemoryFrom(ones));
  for (int step = 0; step < 4; ++step) {
    const auto of_a = a.Blob();
    EXPECT_TRUE(std::equal(of_a.begin(), of_a.end(), b.Blob().begin())) << step;
    for (SortedWorld<View>* changed : {&a, &b}) {
      if (step == 0) changed->Erase(17);
      if (step == 1) changed->SetCategories(5, 4);
      if (step == 2) {
        for (std::uint32_t i = 0; i < 100; ++i) changed->Insert(world.Get(i));
      }
    }
  }
}

// Any byte of what a blob says of itself, and any number of them: the blob is
// refused, or calls read nothing beside it, which sanitizers see.
TYPED_TEST(SortedChangesTest, ACorruptBlobIsRefusedOrHarmless) {
  using View = typename TypeParam::View;
  using Sorted = SortedWorld<View>;
  const World<View> objects = Spread<View>(2.0f).Objects(300);
  const Sorted fresh(objects);
  Sorted sorted(fresh);
  sorted.Erase(5);
  sorted.SetCategories(6, 2);
  const auto queries = SomeQueries<View>(1);
  Random random(1);
  std::size_t refused = 0;
  for (std::size_t round = 0; round < Scaled(3000); ++round) {
    const AlignedCopy blob((round % 3 == 0 ? fresh : sorted).Blob());
    const std::size_t changes = 1 + random() % 64;
    // The first bytes are the header.
    const std::size_t most = round % 2 == 0 ? 64 : blob.bytes().size();
    for (std::size_t c = 0; c < changes; ++c) {
      blob.bytes()[random() % most] = static_cast<std::byte>(random());
      if (round % 4 == 0) break;
    }
    try {
      Sorted world = Sorted::InPlace(blob.bytes());
      Ids ids(10);
      for (const auto& query : queries) {
        (void)Survivors(world, query, ids, {.categories = 3});
        (void)CountSurvivors(world, query);
      }
      std::array<std::uint32_t, 3> near;
      (void)NearestObjects(world, {}, near, {});
      (void)CountSurvivors(world, Sphere<View::Bound::kDimensions>{{}, 9.0f});
      (void)CountSurvivors(world, Segment<View::Bound::kDimensions>{{}, {}});
      if constexpr (HasMaxima<View>) {
        (void)Pairs(world, {});
        (void)PairsOf(world, Span<const std::uint32_t>(near), {});
      }
    } catch (const std::invalid_argument&) {
      ++refused;
    }
    try {
      Sorted world = Sorted::InPlace(blob.bytes());
      switch (random() % 6) {
        case 0:
          world.Refit(objects.view());
          break;
        case 1:
          world.SetCategories(7, 1);
          break;
        case 2:
          world.RebuildWorst(1000);
          break;
        default:
          world.Set(7, View::Bound::Everything());
          world.Erase(9);
      }
      for (int i = 0; i < 5; ++i) world.Insert(View::Bound::Empty());
      world.RebuildWorst(1000);
      world.Rebuild();
    } catch (const std::invalid_argument&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 0u);
  for (std::size_t size : {1u, 63u, 64u, 1000u}) {
    const AlignedCopy blob(sorted.Blob());
    EXPECT_TRUE(Refuses([&] { Sorted::FromBlob(blob.bytes().first(size)); },
                        {"FromBlob", "blob"}));
  }
}

}  // namespace
}  // namespace halfspace::testing

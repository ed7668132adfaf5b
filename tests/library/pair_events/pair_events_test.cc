// Pairs, and the events of their changes, against sets of all pairs, after any
// history of a world and however it was told.
#include "halfspace/pair_events.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <map>
#include <new>
#include <random>
#include <set>
#include <stdexcept>
#include <utility>
#include <vector>

#include "halfspace/halfspace.h"
#include "tests/library/bvh/history.h"
#include "tests/library/bvh/spread.h"
#include "tests/library/support/counting_memory.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/expect_invalid.h"

namespace halfspace::testing {
namespace {

// The pairs that a search of the world finds.
template <typename View>
PairList FoundIn(const Bvh<View>& world, const PairOptions& options = {}) {
  std::vector<IdPair> pairs(Pairs(world, Span<IdPair>(), options));
  EXPECT_EQ(Pairs(world, pairs, options), pairs.size());
  return InOrder(pairs, true);
}

template <typename Events>
PairList SortedPairsOf(const Events& events) {
  return InOrder(events.pairs(), false);
}

template <typename Events>
void ExpectIs(const Events& events, const PairList& before,
              const PairList& now) {
  ASSERT_EQ(SortedPairsOf(events), now);
  ASSERT_EQ(PairsFrom(events.began()), Difference(now, before));
  ASSERT_EQ(PairsFrom(events.ended()), Difference(before, now));
}

class PairEventsTest : public ::testing::TestWithParam<Layout> {};
INSTANTIATE_TEST_SUITE_P(Of, PairEventsTest,
                         ::testing::ValuesIn(LayoutsOf(true)), LayoutName());

// One is told of all pairs or of some, as it comes; one always of all; one is
// a copy of the first, and one is loaded with its pairs, before each step.
TEST_P(PairEventsTest, AreTheDifferenceOfAllPairs) {
  Random random(1);
  for (std::uint64_t seed = 0; seed < Scaled(12); ++seed) {
    constexpr std::size_t kSizes[] = {0, 40, 150, 400};
    Choices choices(GetParam(), random);
    BvhHistory history(GetParam(), choices, kSizes[seed % 4], 40,
                       FpMode::kDefault);
    using Events = detail::PairEventsCore;
    Events mixed{MemoryResource()};
    Events all = mixed;
    PairList before;
    for (int step = 0; step < 40; ++step) {
      for (std::size_t i = random() % 4; i > 0; --i) history.Change();
      Events copy = mixed;
      std::vector<IdPair> pairs(mixed.pairs().begin(), mixed.pairs().end());
      std::shuffle(pairs.begin(), pairs.end(), random);
      Events loaded{MemoryResource()};
      loaded.Load(pairs);
      const PairList now = PairsIn(GetParam(), history.objects());
      // In any order, some twice, and some that no object ever had.
      Ids ids = history.TakeChanged();
      for (std::uint32_t id : {7u, 5000u, 0xFFFFFFFFu}) {
        if (random() % 3 == 0) ids.push_back(id);
      }
      std::shuffle(ids.begin(), ids.end(), random);
      const Span<const std::uint32_t> changed = ids;
      all.Update(PairSourcesOf(history.bvh()), {});
      for (Events* events : {&mixed, &copy, &loaded}) {
        events->Update(PairSourcesOf(history.bvh(), nullptr,
                                     step % 5 == 4 ? nullptr : &changed),
                       {});
      }
      for (const Events* events : {&mixed, &all, &copy, &loaded}) {
        ExpectIs(*events, before, now);
        if (HasFailure()) FAIL() << "seed " << seed << ' ' << step;
      }
      before = now;
    }
  }
}

// So many that lists are sorted by digits, are matched far from their places,
// and are found in parts. A few objects have most of the pairs.
struct Crowd {
  Crowd() { bvh.Reserve(bvh.size()); }

  static std::vector<Aabb3> Boxes() {
    std::vector<Aabb3> boxes = Spread(1.2f).Some(6000);
    for (std::size_t i = 5; i < boxes.size(); i += 1700) {
      boxes[i] = {{-50, -50, -50}, {50, 0, 50}};
    }
    return boxes;
  }
  void Move(const Ids& ids) {
    std::uniform_real_distribution<float> step(-0.3f, 0.3f);
    for (const std::uint32_t id : ids) {
      for (std::size_t k = 0; k < 3; ++k) {
        const float way = step(random);
        all[id].min[k] += way;
        all[id].max[k] += way;
      }
    }
    bvh.Refit(ids, all);
    std::ignore = bvh.RebuildPartial(400);
  }
  Ids Some(std::size_t share) {
    Ids ids;
    for (std::uint32_t id = 0; id < all.size(); ++id) {
      if (random() % 100 < share) ids.push_back(id);
    }
    return ids;
  }

  Random random{3};
  std::vector<Aabb3> all = Boxes();
  AabbBvh3 bvh{all};
};

// In the same order on any threads. Whatever allocation fails, pairs and events
// are as before, and the next call returns what it would have.
TEST(PairEventsOfManyTest, AreTheDifferenceOfAllPairsOnAnyThreads) {
  auto run = RunOnThreads;
  std::vector<PairList> in_order;
  for (const bool on_threads : {false, true}) {
    for (const Failure failure : {Failure::kThrows, Failure::kReturnsNull}) {
      Crowd crowd;
      CountingMemory memory(failure);
      PairEvents events(memory.resource());
      PairEventOptions options;
      if (on_threads) options.run = run;
      PairList before;
      std::size_t step = 0;
      for (const std::size_t share :
           {100u, 0u, 100u, 10u, 20u, 24u, 24u, 1u, 50u, 10u}) {
        Ids ids = crowd.Some(share);
        crowd.Move(ids);
        ids.push_back(100000);  // none of the world's
        const PairList now = FoundIn(crowd.bvh);
        ASSERT_GT(now.size(), 10000u);
        const PairList pairs = SortedPairsOf(events);
        const PairList began = PairsFrom(events.began());
        const PairList ended = PairsFrom(events.ended());
        const std::size_t failures = FailuresOf(
            memory, [&] { events.Update(crowd.bvh, ids, options); },
            [&] {
              ASSERT_EQ(SortedPairsOf(events), pairs);
              ASSERT_EQ(PairsFrom(events.began()), began);
              ASSERT_EQ(PairsFrom(events.ended()), ended);
            });
        EXPECT_GT(failures, share > 1 ? 2u : 0u);
        ExpectIs(events, before, now);
        if (step == in_order.size()) {
          in_order.push_back(PairsFrom(events.pairs()));
        }
        ASSERT_EQ(PairsFrom(events.pairs()), in_order[step++]);
        if (::testing::Test::HasFatalFailure()) FAIL() << share;
        before = now;
      }
    }
  }
}

TEST(PairEventsOfManyTest, OptionsAreThoseOfTheSearch) {
  Crowd crowd;
  std::vector<std::uint32_t> masks;
  for (std::uint32_t i = 0; i < 6000; ++i) masks.push_back(1 + i % 3);
  crowd.bvh.SetMasks(masks);
  for (Target target : TargetsUnderTest()) {
    PairEvents events;
    events.Update(crowd.bvh, {.target = target});
    const PairList all = FoundIn(crowd.bvh);
    ExpectIs(events, {}, all);
    events.Update(crowd.bvh, {.mask = 2, .margin = 0.5f, .target = target});
    ExpectIs(events, all, FoundIn(crowd.bvh, {.mask = 2, .margin = 0.5f}));
    if (::testing::Test::HasFatalFailure()) FAIL() << target.name();
  }
}

// A part that had no memory runs again.
TEST(PairEventsMemoryTest, AnAllocationThatFailsOnceLosesNothing) {
  struct FailsOnce {
    std::size_t left;
    void* allocate(std::size_t bytes, std::size_t alignment) {
      if (left-- == 0) throw std::bad_alloc();
      return ::operator new (bytes, std::align_val_t{alignment});
    }
    void deallocate(void* block, std::size_t, std::size_t alignment) {
      ::operator delete (block, std::align_val_t{alignment});
    }
  };
  Crowd crowd;
  auto run = RunOnThreads;
  const PairList pairs = FoundIn(crowd.bvh);
  std::size_t thrown = 0;
  for (std::size_t left = 0; left < 60; ++left) {
    FailsOnce memory{left};
    PairEvents events(MemoryFrom(memory));
    try {
      events.Update(crowd.bvh, {.run = run});
    } catch (const std::bad_alloc&) {
      ++thrown;
      EXPECT_TRUE(events.empty());
      events.Update(crowd.bvh, {.run = run});
    }
    ExpectIs(events, {}, pairs);
    if (::testing::Test::HasFatalFailure()) FAIL() << left;
  }
  EXPECT_GT(thrown, 0u);
  EXPECT_LT(thrown, 20u);
}

TEST(PairEventsMemoryTest, EachOwnerKeepsItsResource) {
  Crowd crowd;
  CountingMemory memory;
  CountingMemory other;
  PairEvents events(memory.resource());
  events.Update(crowd.bvh);
  EXPECT_LT(events.bytes(), events.size() * 24 + 100000);
  // Those that began are gone.
  events.Update(crowd.bvh);
  EXPECT_LE(events.bytes(), events.size() * 12 + 10000);
  EXPECT_GE(events.bytes(), events.size() * 8);
  const PairList pairs = PairsFrom(events.pairs());
  PairEvents copy(events, other.resource());
  EXPECT_EQ(PairsFrom(copy.pairs()), pairs);
  PairEvents assigned;
  assigned = copy;
  EXPECT_EQ(PairsFrom(assigned.pairs()), pairs);
  EXPECT_EQ(assigned.memory(), MemoryResource());
  const std::size_t allocations = other.allocations;
  PairEvents moved = std::move(copy);
  EXPECT_EQ(other.allocations, allocations);
  EXPECT_EQ(moved.memory(), other.resource());
  EXPECT_TRUE(copy.empty());  // NOLINT(bugprone-use-after-move)
  assigned = std::move(moved);
  EXPECT_EQ(PairsFrom(assigned.pairs()), pairs);
  EXPECT_EQ(assigned.memory(), MemoryResource());
  swap(assigned, copy);
  EXPECT_EQ(PairsFrom(copy.pairs()), pairs);
  EXPECT_EQ(assigned.memory(), other.resource());
  other.left = 0;
  EXPECT_THROW(PairEvents(events, other.resource()), std::bad_alloc);
  memory.left = 0;
  EXPECT_THROW(events.Load(copy.pairs()), std::bad_alloc);
  EXPECT_EQ(PairsFrom(events.pairs()), pairs);
  events.Clear();
  EXPECT_EQ(events.bytes(), 0u);
  EXPECT_EQ(memory.blocks, 0u);
}

TEST(PairEventsErrorsTest, NameTheArgument) {
  AabbBvh3 bvh(std::vector<Aabb3>(20, Aabb3{{0, 0, 0}, {1, 1, 1}}));
  PairEvents events;
  events.Update(bvh);
  const PairList pairs = PairsFrom(events.pairs());
  ASSERT_EQ(pairs.size(), 190u);
  const std::array<std::uint32_t, 2> ids = {1, 2};
  const auto refuses = [&](const auto& call,
                           std::initializer_list<std::string_view> parts) {
    EXPECT_TRUE(Refuses(call, parts));
    EXPECT_EQ(PairsFrom(events.pairs()), pairs);
    EXPECT_EQ(events.began().size(), pairs.size());
  };
  const auto load = [&](const std::vector<IdPair>& list) {
    return [&events, list] { events.Load(list); };
  };
  refuses([&] { events.Update(bvh, Span(Misaligned(ids.data()), 2), {}); },
          {"PairEvents::Update", "changed", "aligned"});
  refuses([&] { events.Update(bvh, Ids(), {.margin = kInf}); },
          {"PairEvents::Update", "options.margin"});
  refuses(load({{0, 1}, {2, 2}}),
          {"PairEvents::Load", "pairs[1]", "a < b < 4294967295", "2 and 2"});
  refuses(load({{0, 0xFFFFFFFF}}), {"pairs[0]", "0 and 4294967295"});
  refuses(load({{0, 1}, {5, 6}, {0, 1}}),
          {"PairEvents::Load", "pairs", "each pair once", "0 and 1 twice"});
  const IdPair* const none = nullptr;
  refuses(
      [&] {
        events.Load({none, 3});
      },
      {"PairEvents::Load", "pairs", "3", "null"});
}

// Ids that are not in the world: a set of these takes no memory.
TEST(PairEventsLoadTest, PairsOfNoObjectsEnd) {
  std::vector<Aabb3> boxes;
  for (const float x : {0.0f, 1.0f, 10.0f, 20.0f, 30.0f, 40.0f, 50.0f, 60.0f}) {
    boxes.push_back({{x, 0, 0}, {x + 1, 1, 1}});
  }
  const AabbBvh3 bvh(boxes);
  CountingMemory memory;
  PairEvents events(memory.resource());
  for (const std::uint32_t id : {9u, 0x7FFFFFFFu}) {
    const std::vector<IdPair> pairs = {{3, id}, {0, 1}, {1, id - 1}};
    events.Load(pairs);
    EXPECT_EQ(PairsFrom(events.pairs()), PairsFrom(pairs));
    events.Update(bvh, Ids{});
    EXPECT_TRUE(events.began().empty());
    EXPECT_EQ(events.ended().size(), id == 9 ? 0u : 2u);
    events.Update(bvh, Ids{id});
    EXPECT_EQ(events.ended().size(), id == 9 ? 1u : 0u);
    events.Update(bvh);
    EXPECT_TRUE(events.began().empty());
    EXPECT_EQ(events.ended().size(), id == 9 ? 1u : 0u);
    EXPECT_EQ(PairsFrom(events.pairs()), (PairList{{0, 1}}));
  }
}

TEST(PairEventsRunnerTest, ARunnerThatThrowsChangesNothing) {
  Crowd crowd;
  PairEvents events;
  events.Update(crowd.bvh);
  const PairList pairs = PairsFrom(events.pairs());
  crowd.Move(crowd.Some(100));
  auto run = [](std::size_t, const Runner::Part& part) {
    part(0);
    throw std::runtime_error("no threads");
  };
  EXPECT_THROW(events.Update(crowd.bvh, {.run = run}), std::runtime_error);
  EXPECT_EQ(PairsFrom(events.pairs()), pairs);
  EXPECT_EQ(events.began().size(), pairs.size());
}

// Subnormals would be 0, or trap. The filter runs in the mode of the caller.
TEST(PairEventsCoreTest, TheModeOfTheCallerDoesNotMatter) {
  std::vector<Aabb3> boxes;
  for (int i = 0; i < 200; ++i) {
    const float x = static_cast<float>(i) * 0x1p-140f;
    boxes.push_back({{x, 0, 0}, {x + 0x1p-141f, 1, 1}});  // alone
    boxes.push_back({{x, 0, 0}, {x + 0x1p-140f, 2, 2}});
  }
  const AabbBvh3 bvh{Span<const Aabb3>(boxes)};
  const PairList expected = FoundIn(bvh);
  const std::vector<std::uint32_t> some = {7, 8, 300};
  const Span<const std::uint32_t> changed(some);
  for (const FpMode mode : {FpMode::kFlushes, FpMode::kTraps}) {
    bool flushes = false;
    detail::PairListFilter filter;
    if (mode == FpMode::kFlushes) {
      filter = {[](void* context, Span<IdPair> pairs) {
                  *static_cast<bool*>(context) = FlushDenormals::IsOn();
                  return pairs.size();
                },
                &flushes};
    }
    detail::PairEventsCore core{MemoryResource()};
    RunIn(mode, [&] {
      core.Update(detail::PairsIn(bvh), {}, filter);
      core.Update(detail::PairsIn<AabbView3>(bvh, nullptr, &changed), {},
                  filter);
    });
    EXPECT_EQ(flushes, mode == FpMode::kFlushes);
    EXPECT_EQ(SortedPairsOf(core), expected);
    EXPECT_TRUE(core.began().empty());
    EXPECT_TRUE(core.ended().empty());
  }
}

// The order of pairs that PairEvents rely on (bvh_pairs.h): of leaves, and
// first the object that is first in the tree. In a set, `a` is always of it.
TEST(PairOrderTest, IsThatOfTheTree) {
  Crowd crowd;
  std::size_t both = 0;
  for (Target target : TargetsUnderTest()) {
    for (const std::size_t share : {1u, 10u, 70u, 100u}) {
      SCOPED_TRACE(::testing::Message() << target.name() << ", " << share);
      AabbBvh3 bvh = crowd.bvh;
      for (const std::uint32_t id : crowd.Some(share / 3)) bvh.Erase(id);
      std::map<std::uint32_t, std::size_t> place;
      for (std::size_t i = 0; i < bvh.ids().size(); ++i) {
        place[bvh.ids()[i]] = i;
      }
      std::pair<std::size_t, std::size_t> last;
      ForEachPair(bvh,
                  [&](Span<const IdPair> pairs) {
                    for (const auto& [a, b] : pairs) {
                      ASSERT_LT(place.at(a), place.at(b));
                      const std::pair leaves(place.at(a) / 64,
                                             place.at(b) / 64);
                      ASSERT_GE(leaves, last);
                      last = leaves;
                    }
                  },
                  {.target = target});
      Ids ids = crowd.Some(share);
      std::erase_if(ids, [&](std::uint32_t id) { return !bvh.Has(id); });
      const std::set<std::uint32_t> set(ids.begin(), ids.end());
      ForEachPairOf(bvh, ids,
                    [&](Span<const IdPair> pairs) {
                      for (const auto& [a, b] : pairs) {
                        ASSERT_TRUE(set.contains(a));
                        if (!set.contains(b)) continue;
                        ++both;
                        ASSERT_LT(place.at(a), place.at(b));
                      }
                    },
                    {.target = target});
      if (HasFatalFailure()) return;
    }
  }
  EXPECT_GT(both, 1000u);
}

// Bytes that nobody verifies. No id is read behind a table of ids.
TEST(PairEventsOfBlobTest, AnAlteredIdIsHarmless) {
  std::vector<Aabb2> boxes;
  for (int i = 0; i < 300; ++i) {
    const auto x = static_cast<float>(i);
    boxes.push_back({{x, 0}, {x + 1, 1}});
  }
  const AabbBvh2 tree(boxes);
  const Span<const std::byte> blob = tree.Blob();
  std::vector<std::byte> bytes(blob.begin(), blob.end());
  const auto* const ids = reinterpret_cast<const std::byte*>(tree.ids().data());
  const std::uint32_t large = 900'000;
  std::memcpy(bytes.data() + (ids - blob.data()) + 17 * sizeof(large), &large,
              sizeof(large));
  const AabbBvh2 altered = AabbBvh2::FromBlob(bytes);
  PairEvents events;
  events.Update(altered);
  EXPECT_EQ(events.size(), 299u);
  events.Update(altered, std::vector<std::uint32_t>{0, 1});
  EXPECT_EQ(events.size(), 299u);
}

}  // namespace
}  // namespace halfspace::testing

// Wrong arguments, no memory, and how much memory a broad phase takes.
#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include "halfspace/halfspace.h"
#include "tests/library/broad_phase/bodies.h"
#include "tests/library/support/counting_memory.h"
#include "tests/library/support/expect_invalid.h"

namespace halfspace::testing {
namespace {

constexpr Aabb3 kUnit = {{0, 0, 0}, {1, 1, 1}};
constexpr std::uint64_t kAll = ~std::uint64_t{0};

TEST(BroadPhaseTest, FindsWhatItWasTold) {
  AabbBroadPhase3 bodies(8);
  bodies.Insert(3, kUnit);
  bodies.Insert(5, {{0.5f, 0, 0}, {2, 1, 1}}, {.category = 2});
  bodies.Insert(7, {{9, 9, 9}, {10, 10, 10}});
  Ids found;
  const auto list = [&](std::uint32_t id, const Aabb3&) {
    found.push_back(id);
  };
  bodies.ForEach(kUnit, kAll, list);
  EXPECT_EQ(InOrder(found), (Ids{3, 5}));
  found.clear();
  bodies.ForEach(kUnit, 2, list);
  EXPECT_EQ(found, Ids{5});
  std::vector<std::string> events;
  const auto update = [&] {
    bodies.UpdatePairs(
        [&](std::uint32_t a, std::uint32_t b) {
          events.push_back("began " + std::to_string(a) + std::to_string(b));
        },
        [&](std::uint32_t a, std::uint32_t b) {
          events.push_back("ended " + std::to_string(a) + std::to_string(b));
        });
    return std::exchange(events, {});
  };
  EXPECT_EQ(update(), std::vector<std::string>{"began 35"});
  EXPECT_TRUE(update().empty());
  bodies.Move(5, {{9, 9, 9}, {9.5f, 9.5f, 9.5f}});
  bodies.Update();
  EXPECT_EQ(update(), (std::vector<std::string>{"ended 35", "began 57"}));
  bodies.Erase(7);
  EXPECT_EQ(update(), std::vector<std::string>{"ended 57"});
  bodies.SetMasks(5, {.category = 2, .collides_with = 0});
  bodies.Move(5, kUnit);
  EXPECT_TRUE(update().empty());
}

// Box2D's rule of groups: the same negative group never, the same positive
// group always.
TEST(BroadPhaseTest, AFilterReplacesTheMasks) {
  std::array<int, 4> groups = {-1, -1, 1, 1};
  BroadPhaseOptions options;
  options.filter.context = &groups;
  options.filter.keep = [](void* context, std::uint32_t a, std::uint32_t b,
                           bool masks_match) {
    const auto& of = *static_cast<std::array<int, 4>*>(context);
    return of[a] != 0 && of[a] == of[b] ? of[a] > 0 : masks_match;
  };
  AabbBroadPhase3 bodies(4, options);
  const BodyMasks none = {.category = 1, .collides_with = 0};
  bodies.Insert(0, kUnit);
  bodies.Insert(1, kUnit);
  bodies.Insert(2, kUnit, none);
  bodies.Insert(3, kUnit, none);
  PairsByEvents pairs;
  pairs.Update(bodies);
  EXPECT_EQ(pairs.pairs(), (IdPairs{{2, 3}}));
  groups = {};
  bodies.SetMasks(1, BodyMasks());
  bodies.SetMasks(2, none);
  pairs.Update(bodies);
  EXPECT_EQ(pairs.pairs(), (IdPairs{{0, 1}}));
}

TEST(BroadPhaseErrorsTest, SayWhatWasWrong) {
  AabbBroadPhase3 bodies(10);
  bodies.Insert(1, kUnit);
  const Ids ids = {1, 2};
  const std::vector<Aabb3> boxes(2, kUnit);
  const std::vector<BodyMasks> masks(2);
  EXPECT_TRUE(Refuses(
      [&] {
        bodies.Insert(Ids{2, 10}, boxes);
      },
      {"BroadPhase::Insert", "ids[1]", "below max_ids, 10", "got 10"}));
  EXPECT_TRUE(Refuses(
      [&] {
        bodies.Insert(Ids{2, 1}, boxes);
      },
      {"BroadPhase::Insert", "ids[1]", "no body has", "got 1"}));
  EXPECT_TRUE(Refuses(
      [&] {
        bodies.Insert(Ids{2, 2}, boxes);
      },
      {"BroadPhase::Insert", "ids[1]", "once in the list", "got 2"}));
  EXPECT_TRUE(Refuses([&] { bodies.Insert(Ids{2}, boxes); },
                      {"BroadPhase::Insert", "bounds", "1", "got 2"}));
  EXPECT_TRUE(Refuses(
      [&] {
        bodies.Insert(Ids{2}, {&kUnit, 1}, masks);
      },
      {"BroadPhase::Insert", "masks", "1", "got 2"}));
  EXPECT_TRUE(Refuses([&] { bodies.Move(ids, boxes); },
                      {"BroadPhase::Move", "ids[1]", "a body", "got 2"}));
  EXPECT_TRUE(Refuses([&] { bodies.Move(ids, {}); },
                      {"BroadPhase::Move", "bounds", "2", "got 0"}));
  EXPECT_TRUE(Refuses([&] { bodies.Erase(ids); },
                      {"BroadPhase::Erase", "ids[1]", "a body", "got 2"}));
  EXPECT_TRUE(Refuses([&] { bodies.Erase(4'000'000'000u); },
                      {"BroadPhase::Erase", "ids[0]", "got 4000000000"}));
  EXPECT_TRUE(Refuses(
      [&] {
        bodies.Erase({nullptr, 3});
      },
      {"BroadPhase::Erase", "ids", "3", "a null pointer"}));
  EXPECT_TRUE(Refuses([&] { bodies.SetMasks(ids, masks); },
                      {"BroadPhase::SetMasks", "ids[1]", "a body", "got 2"}));
  EXPECT_TRUE(Refuses([&] { (void)bodies.Get(2); },
                      {"BroadPhase::Get", "a body", "got 2"}));
  EXPECT_TRUE(Refuses([&] { (void)bodies.MasksOf(10); },
                      {"BroadPhase::MasksOf", "a body", "got 10"}));
  const auto no_pair = [](std::uint32_t, std::uint32_t) {};
  EXPECT_TRUE(
      Refuses([&] { bodies.ForEachPairOf(ids, 0, no_pair); },
              {"BroadPhase::ForEachPairOf", "ids[1]", "a body", "got 2"}));
  EXPECT_TRUE(Refuses(
      [&] {
        bodies.ForEachPairOf(Ids{1}, Span<const std::uint64_t>(), 0, no_pair);
      },
      {"BroadPhase::ForEachPairOf", "masks", "1", "got 0"}));
  EXPECT_TRUE(
      Refuses([&] { bodies.ForEachPairOf(Ids{1}, -1, no_pair); },
              {"BroadPhase::ForEachPairOf", "margin", "not negative", "-1"}));
  EXPECT_TRUE(Refuses(
      [&] {
        bodies.ForEach(Sphere3{{0, 0, 0}, -1}, 1, [](auto...) {});
      },
      {"BroadPhase::ForEach", "radius", "-1"}));
  EXPECT_TRUE(Refuses(
      [&] {
        bodies.ForEachCast(kUnit, {1, 0, 0}, -1, 1, [](auto...) {});
      },
      {"BroadPhase::ForEachCast", "max_t", "-1"}));
  BroadPhaseOptions options;
  options.margin = std::numeric_limits<float>::infinity();
  EXPECT_TRUE(Refuses([&] { AabbBroadPhase3(1, options); },
                      {"BroadPhase", "options.margin", "finite", "inf"}));
  EXPECT_TRUE(Refuses([&] { AabbBroadPhase3(std::size_t{1} << 30); },
                      {"BroadPhase", "max_ids", "2^29", "1073741824"}));

  BodyModel<AabbView3> model;
  model.objects[1] = {kUnit, {}};
  ExpectIsModel(bodies, model, 1);
  bodies.Insert(2, kUnit);  // no mark of a call that failed is left
  EXPECT_TRUE(bodies.Has(2));
}

// Each call with memory for 0, 1, 2, ... allocations, until it is enough. Until
// then nothing has changed, and afterwards all has.
TEST(BroadPhaseMemoryTest, NothingChangesWithoutMemory) {
  using Model = BodyModel<AabbView3>;
  using Bodies = AabbBroadPhase3;
  CountingMemory memory;
  BroadPhaseOptions options;
  options.memory = memory.resource();
  options.margin = 0.5f;
  BodyMaker<AabbView3> maker(1);
  Model model;
  Bodies bodies(2000, options);
  PairsByEvents pairs;
  const auto change = [&](const std::function<void()>& call) {
    std::size_t tries = 0;
    for (;; ++tries) {
      memory.left = tries;
      bool is_done = true;
      try {
        call();
      } catch (const std::bad_alloc&) {
        is_done = false;
      }
      memory.left = CountingMemory::kNoLimit;
      if (is_done) return tries;
      ExpectIsModel(bodies, model, tries);
    }
  };
  const auto insert = [&](std::uint32_t first, std::uint32_t count) {
    Ids ids;
    std::vector<Aabb3> boxes;
    for (std::uint32_t id = first; id < first + count; ++id) {
      ids.push_back(id);
      boxes.push_back(maker.Next());
    }
    const std::size_t tries = change([&] { bodies.Insert(ids, boxes); });
    for (std::size_t i = 0; i < ids.size(); ++i) {
      model.objects[ids[i]] = {boxes[i], {}};
    }
    ExpectIsModel(bodies, model, tries);
    return tries;
  };
  const auto update_pairs = [&] { pairs.Update(bodies); };
  EXPECT_GT(insert(0, 700), 0u);
  EXPECT_EQ(insert(700, 200), 0u);  // in the list of new bodies
  EXPECT_GT(change(update_pairs), 0u);
  EXPECT_EQ(pairs.pairs(), model.Pairs());
  EXPECT_EQ(change([&] {
              Ids ids;
              for (auto& [id, object] : model.objects) {
                if (id % 3 != 0) continue;
                object.bound = maker.Moved(object.bound);
                bodies.Move(id, object.bound);
                ids.push_back(id);
                bodies.SetMasks(id, {});
              }
              bodies.Erase(ids[0]);
              model.objects.erase(ids[0]);
            }),
            0u);
  EXPECT_GT(change([&] { bodies.Update(); }), 0u);
  EXPECT_GT(change(update_pairs), 0u);
  EXPECT_EQ(pairs.pairs(), model.Pairs());
  EXPECT_GT(change([&] { bodies.Rebuild(); }), 0u);
}

TEST(BroadPhaseMemoryTest, TakesWhatTheHeaderSays) {
  CountingMemory memory;
  BroadPhaseOptions options;
  options.memory = memory.resource();
  constexpr std::uint32_t kCount = 20'000;
  AabbBroadPhase3 bodies(kCount, options);
  Spread<AabbView3> spread(0.1f);
  Ids ids;
  std::vector<Aabb3> boxes;
  for (std::uint32_t id = 0; id < kCount; ++id) {
    ids.push_back(id);
    boxes.push_back(spread.NextObject());
  }
  bodies.Insert(ids, boxes);
  constexpr std::size_t kMostBytes = (64 + sizeof(Aabb3)) * kCount;
  EXPECT_LT(bodies.Statistics().bytes, kMostBytes);
  for (std::size_t frame = 0; frame < 3; ++frame) {
    for (Aabb3& box : boxes) {
      for (std::size_t k = 0; k < 3; ++k) {
        box.min[k] += 0.1f;
        box.max[k] += 0.1f;
      }
    }
    const std::size_t before = memory.allocations;
    bodies.Move(ids, boxes);
    bodies.ForEach(kUnit, kAll, [](auto...) {});
    bodies.ForEach(Sphere3{{0, 0, 0}, 9}, kAll, [](auto...) {});
    bodies.ForEachCast(kUnit, {5, 5, 5}, 1, kAll, [](auto...) {});
    EXPECT_EQ(memory.allocations, before);
    bodies.Update();
    EXPECT_EQ(bodies.Statistics().trees, 1u);
    EXPECT_LT(bodies.Statistics().bytes, kMostBytes);
  }
}

}  // namespace
}  // namespace halfspace::testing

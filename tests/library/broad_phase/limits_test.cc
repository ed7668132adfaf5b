// Wrong arguments, no memory, and how much memory a broad phase takes.
#include <gtest/gtest.h>

#include <array>
#include <bit>
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
#include "tests/library/support/fp_modes.h"

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
  const auto list = [&](std::uint32_t id, auto& /*bound*/) {
    found.push_back(id);
  };
  bodies.ForEach(kUnit, kAll, list);
  EXPECT_EQ(InOrder(found), (Ids{3, 5}));
  found.clear();
  bodies.ForEach(kUnit, 2, list);
  EXPECT_EQ(found, Ids{5});
  found.clear();
  bodies.ForEachCast(kUnit, {1, 0, 0}, 1, 2,
                     [&](std::uint32_t id, float) { found.push_back(id); });
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

// A list of bodies that are all in the tree, or all not yet.
Ids InsertAll(AabbBroadPhase3& bodies, const std::vector<Aabb3>& boxes,
              bool into_tree) {
  Ids ids;
  for (std::uint32_t id = 0; id < boxes.size(); ++id) ids.push_back(id);
  bodies.Insert(ids, boxes);
  if (into_tree) bodies.Rebuild();
  return ids;
}

constexpr auto kNothing = [](auto...) {};

TEST(BroadPhaseTest, HasRoomForNoBody) {
  AabbBroadPhase3 bodies(0);
  bodies.Insert(Ids{}, std::vector<Aabb3>{});
  bodies.Move(Ids{}, std::vector<Aabb3>{});
  bodies.Erase(Ids{});
  bodies.Update();
  bodies.Rebuild();
  bodies.UpdatePairs(kNothing, kNothing);
  bodies.ForEachPairOf(Ids{}, 1, kNothing);
  ExpectIsModel(bodies, BodyModel<AabbView3>(), 1);
  EXPECT_EQ(bodies.Bounds(), Aabb3::Empty());
  EXPECT_TRUE(
      Refuses([&] { bodies.Insert(0, kUnit); }, {"below max_ids, 0", "got 0"}));
}

TEST(BroadPhaseTest, BoundsAreTightAfterARebuild) {
  AabbBroadPhase3 bodies(300);
  std::vector<Aabb3> boxes(300, kUnit);
  const Ids ids = InsertAll(bodies, boxes, true);
  boxes[7].max[1] = 5;
  bodies.Move(ids, boxes);
  EXPECT_EQ(bodies.Bounds(), (Aabb3{{0, 0, 0}, {1, 5, 1}}));
  bodies.Move(7, kUnit);
  bodies.Rebuild();
  EXPECT_EQ(bodies.Bounds(), kUnit);
  bodies.Erase(ids);
  bodies.Rebuild();
  EXPECT_EQ(bodies.Bounds(), Aabb3::Empty());
  EXPECT_EQ(bodies.Statistics().bodies, 0u);
}

// A few bounds may stay loose until the eighth update, and more only until the
// next one.
TEST(BroadPhaseTest, BoundsAreTightInTime) {
  struct Case {
    std::uint32_t bodies;
    std::uint32_t moved;
    std::size_t most_updates;
  };
  for (const Case& c : {Case{10, 10, 8}, Case{100, 64, 8}, Case{100, 65, 1},
                        Case{2000, 125, 8}, Case{2000, 126, 1}}) {
    AabbBroadPhase3 bodies(c.bodies);
    Ids ids;
    for (std::uint32_t id = 0; id < c.bodies; ++id) ids.push_back(id);
    bodies.Insert(ids, std::vector<Aabb3>(c.bodies, kUnit));
    bodies.Update();
    for (std::uint32_t id = 0; id < c.moved; ++id) {
      bodies.Move(id, {{0, 0, 0}, {1, 1, 9}});
      bodies.Move(id, kUnit);
    }
    ASSERT_NE(bodies.Bounds(), kUnit);
    for (std::size_t i = 0; i < c.most_updates; ++i) bodies.Update();
    EXPECT_EQ(bodies.Bounds(), kUnit) << c.moved << " of " << c.bodies;
  }
}

// In the list of new bodies, in the tree, and in more than one leaf.
TEST(BroadPhaseTest, PairsOfCoincidentBodiesAreAllFoundOnce) {
  for (const auto& [count, into_tree] :
       {std::pair{200u, false}, std::pair{200u, true}, std::pair{700u, true}}) {
    AabbBroadPhase3 bodies(count);
    const Ids ids =
        InsertAll(bodies, std::vector<Aabb3>(count, kUnit), into_tree);
    EXPECT_EQ(bodies.Statistics().pending, into_tree ? 0 : count);
    std::size_t pairs = 0;
    const auto add = [&](auto...) { ++pairs; };
    bodies.UpdatePairs(add, kNothing);
    EXPECT_EQ(pairs, count * (count - 1) / 2);
    pairs = 0;
    bodies.ForEachPairOf(ids, 0, add);
    EXPECT_EQ(pairs, count * (count - 1) / 2);
  }
}

// 2^106 + 1 is 2^106 in double, but is farther.
TEST(BroadPhaseTest, TheMarginOfPairsIsExact) {
  constexpr float kFar = 0x1p106f;
  const std::vector<Aabb3> boxes = {{{-kFar, 0, 0}, {-kFar, 1, 1}},
                                    {{0, 0, 0}, {0, 1, 1}},
                                    {{1, 0, 0}, {1, 1, 1}}};
  for (const bool into_tree : {false, true}) {
    AabbBroadPhase3 bodies(3);
    InsertAll(bodies, boxes, into_tree);
    IdPairs pairs;
    bodies.ForEachPairOf(Ids{0}, kFar, [&](std::uint32_t a, std::uint32_t b) {
      pairs.emplace_back(a, b);
    });
    EXPECT_EQ(pairs, (IdPairs{{0, 1}})) << into_tree;
  }
}

// With subnormals flushed, the margin would be 0, and three times it on D too.
TEST(BroadPhaseTest, TheMarginOfPairsCanBeSubnormal) {
  constexpr float kMargin = 0x1p-140f;
  constexpr std::array kNear = {kMargin, kMargin, kMargin, 3 * kMargin};
  for (const bool into_tree : {false, true}) {
    AaboBroadPhase3 bodies(2);
    const Aabo3 bounds[] = {{{0, 0, 0, 0}, {0, 0, 0, 0}}, {kNear, kNear}};
    bodies.Insert(Ids{0, 1}, bounds);
    if (into_tree) bodies.Rebuild();
    const FlushDenormals flush;
    for (const float margin : {0.0f, kMargin}) {
      std::size_t pairs = 0;
      bodies.ForEachPairOf(Ids{0}, margin, [&](auto...) { ++pairs; });
      EXPECT_EQ(pairs, std::bit_cast<std::uint32_t>(margin) != 0 ? 1u : 0u)
          << into_tree;
    }
  }
}

// What queries, casts, pairs and events call may change the bodies.
TEST(BroadPhaseTest, EachFunctionMayChangeTheBodies) {
  constexpr std::uint32_t kCount = 600;
  using Calls = std::function<void(AabbBroadPhase3&, const Ids&,
                                   const std::function<void()>&)>;
  const Calls calls[] = {
      [](auto& bodies, auto&, auto& change) {
        bodies.ForEach(kUnit, kAll, [&](auto...) { change(); });
      },
      [](auto& bodies, auto&, auto& change) {
        bodies.ForEach(Sphere3{{0, 0, 0}, 1}, 1, [&](auto...) { change(); });
      },
      [](auto& bodies, auto&, auto& change) {
        bodies.ForEachCast(kUnit, {1, 0, 0}, 1, 1, [&](auto...) { change(); });
      },
      [](auto& bodies, auto& ids, auto& change) {
        bodies.ForEachPairOf({&ids[5], 1}, 0, [&](auto...) { change(); });
      },
      [](auto& bodies, auto&, auto& change) {
        bodies.UpdatePairs([&](auto...) { change(); }, kNothing);
      }};
  for (const Calls& call : calls) {
    AabbBroadPhase3 bodies(2 * kCount);
    const Ids ids = InsertAll(bodies, std::vector<Aabb3>(kCount, kUnit), true);
    std::size_t changes = 0;
    call(bodies, ids, [&] {
      const auto id = static_cast<std::uint32_t>(++changes % kCount);
      if (bodies.Has(kCount + id)) {
        bodies.Erase(kCount + id);
      } else {
        bodies.Insert(kCount + id, kUnit);
      }
      bodies.Move(id, kUnit);
      bodies.SetMasks(id, {});
      if (changes % 100 == 0) bodies.Rebuild();
      if (changes % 100 == 50) bodies.Update();
      if (changes == 150) bodies.UpdatePairs(kNothing, kNothing);
    });
    EXPECT_GE(changes, kCount - 1);
    bodies.Update();
    EXPECT_TRUE(bodies.Validate());
    EXPECT_EQ(bodies.Statistics().trees, 1u);
  }
}

// Exceptions pass through, and the next call works.
TEST(BroadPhaseTest, FunctionsMayThrow) {
  struct Thrown {};
  constexpr std::uint32_t kCount = 600;
  AabbBroadPhase3 bodies(kCount);
  BodyModel<AabbView3> model;
  for (std::uint32_t id = 0; id < kCount; ++id) model.objects[id] = {kUnit, {}};
  const Ids ids = InsertAll(bodies, std::vector<Aabb3>(kCount, kUnit), true);
  for (const int calls : {0, 1, 300}) {
    int left = calls;
    const auto function = [&](auto...) {
      if (left-- == 0) throw Thrown();
    };
    const auto expect = [&](const auto& call) {
      left = calls;
      EXPECT_THROW(call(), Thrown);
    };
    expect([&] { bodies.ForEach(kUnit, kAll, function); });
    expect([&] { bodies.ForEach(Sphere3{{0, 0, 0}, 1}, 1, function); });
    expect([&] { bodies.ForEachCast(kUnit, {1, 0, 0}, 1, 1, function); });
    expect([&] { bodies.ForEachPairOf({&ids[0], 1}, 0, function); });
    expect([&] {
      bodies.SetMasks(ids, std::vector<BodyMasks>(kCount, {1, 0}));
      bodies.UpdatePairs(kNothing, kNothing);
      bodies.SetMasks(ids, std::vector<BodyMasks>(kCount));
      bodies.UpdatePairs(function, kNothing);
    });
    EXPECT_EQ(bodies.Statistics().pairs, kCount * (kCount - 1) / 2);
    if (calls < 2) {
      expect([&] {
        bodies.Rebuild([&](std::size_t parts, const Runner::Part& part) {
          function();
          while (parts-- > 0) part(parts);
        });
      });
    }
    ExpectIsModel(bodies, model, 1);
    bodies.Update();
    EXPECT_EQ(bodies.Statistics().trees, 1u);
  }
}

// Bodies of the tree in its order.
Ids OrderOf(const AabbBroadPhase3& bodies) {
  Ids ids;
  bodies.ForEach(Aabb3::Everything(), kAll,
                 [&](std::uint32_t id, const Aabb3&) { ids.push_back(id); });
  return ids;
}

TEST(BroadPhaseBudgetTest, LimitsHowManyAreSortedAgain) {
  constexpr std::uint32_t kCount = 40'000;
  AabbBroadPhase3 bodies(kCount);
  Spread<AabbView3> spread(0.5f);
  std::vector<Aabb3> boxes(kCount);
  for (Aabb3& box : boxes) box = spread.NextObject();
  const Ids ids = InsertAll(bodies, boxes, true);
  EXPECT_EQ(bodies.Statistics().cost_ratio, 1);
  for (Aabb3& box : boxes) box = spread.NextObject();
  bodies.Move(ids, boxes);
  const Ids sorted = OrderOf(bodies);
  const auto differ = [](const Ids& a, const Ids& b) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < a.size(); ++i) count += a[i] != b.at(i) ? 1 : 0;
    return count;
  };
  UpdateOptions options;
  options.budget = 0;
  bodies.Update(options);
  EXPECT_EQ(OrderOf(bodies), sorted);
  double ratio = bodies.Statistics().cost_ratio;
  EXPECT_GT(ratio, 2);
  for (const std::size_t budget :
       {std::size_t{1}, std::size_t{12'000}, UpdateOptions::kAutomatic}) {
    const Ids before = OrderOf(bodies);
    options.budget = budget;
    bodies.Update(options);
    const std::size_t moved = differ(before, OrderOf(bodies));
    EXPECT_GT(moved, 0u);
    EXPECT_LE(moved, budget == 12'000 ? budget : 4096u);
    EXPECT_LT(bodies.Statistics().cost_ratio, ratio);
    ratio = bodies.Statistics().cost_ratio;
  }
  options.budget = kCount;
  bodies.Update(options);
  EXPECT_EQ(bodies.Statistics().cost_ratio, 1);
  const Ids before = OrderOf(bodies);
  bodies.Update(options);  // has nothing to do
  EXPECT_EQ(OrderOf(bodies), before);
}

// Ten times as many erasures and insertions as bodies.
TEST(BroadPhaseBudgetTest, TheOrderDoesNotDecay) {
  constexpr std::uint32_t kCount = 10'000;
  AabbBroadPhase3 bodies(kCount);
  Spread<AabbView3> spread(0.5f);
  std::vector<Aabb3> boxes(kCount);
  for (Aabb3& box : boxes) box = spread.NextObject();
  const Ids ids = InsertAll(bodies, boxes, true);
  Random random(1);
  for (std::size_t frame = 0; frame < 200; ++frame) {
    Ids some;
    std::vector<Aabb3> others;
    for (std::size_t first = random() % 20; first < kCount; first += 20) {
      some.push_back(ids[first]);
      others.push_back(spread.NextObject());
    }
    bodies.Erase(some);
    bodies.Insert(some, others);
    bodies.Update();
  }
  EXPECT_LT(bodies.Statistics().cost_ratio, 1.3);
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

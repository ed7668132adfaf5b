// A broad phase answers as a Bvh of its bodies does, after any history. What
// histories do not show: wrong arguments and times, saved bytes that were
// altered, how well it is sorted, and how much memory it takes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <initializer_list>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "dispatch/broad_phase/state.h"
#include "halfspace/halfspace.h"
#include "tests/library/broad_phase/history.h"
#include "tests/library/bvh/history.h"
#include "tests/library/support/counting_memory.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/expect_invalid.h"

namespace halfspace::testing {
namespace {

class BroadPhaseHistoryTest : public ::testing::TestWithParam<Layout> {};
INSTANTIATE_TEST_SUITE_P(Of, BroadPhaseHistoryTest,
                         ::testing::ValuesIn(LayoutsOf(true)), LayoutName());

TEST_P(BroadPhaseHistoryTest, AnyHistoryIsThatOfTheModel) {
  const std::size_t rounds = std::max<std::size_t>(8, Scaled(12));
  for (std::size_t round = 0; round < rounds + 6; ++round) {
    constexpr FpMode kModes[] = {FpMode::kDefault, FpMode::kDefault,
                                 FpMode::kTraps, FpMode::kFlushes};
    const FpMode mode = kModes[round / 2 % 4];
    Random random(round);
    Choices choices(GetParam(), random, mode != FpMode::kDefault);
    // One with three levels of nodes: 63 % of so many bodies are more than
    // 64^2. It takes nine tenths of the time, so it is short at a small scale.
    const bool is_large = round == 1;
    // The last ones with too little memory at first, for each change.
    const bool is_short = round >= rounds;
    constexpr std::uint32_t kStrides[] = {1, 3, 700, 64, 5000};
    const std::uint32_t stride = kStrides[round % 5];
    // Far ids take memory, which queries copy.
    const bool is_small = round % 3 == 0 || stride == 5000 || is_short;
    const std::size_t most_bodies = is_large ? 7000 : is_small ? 200 : 1500;
    BroadPhaseOptions options;
    options.moves_are_seen_at_once = round % 2 == 0;
    options.caller_locks = round % 4 > 1;
    if (round % 3 == 0 || is_large) options.filter.keep = &KeepsSome;
    CountingMemory memory;
    if (is_short) options.memory = memory.resource();
    BodyHistory history(GetParam(), choices, most_bodies, stride, options,
                        is_short ? FpMode::kDefault : mode,
                        is_short ? &memory : nullptr);
    if (is_large) {
      // Pairs in several parts, on threads of a copy.
      history.Insert(most_bodies);
      history.Copy();
      history.UpdatePairs();
    }
    // Two dimensions are the same code.
    const std::size_t large = GetParam().dims == 3 ? 3 + Scaled(9) : 3;
    const std::size_t steps = is_large ? large : 10 + Scaled(20);
    for (std::size_t step = 0; step < steps; ++step) {
      const std::size_t what = history.Change();
      history.ExpectIsModel(random());
      if (HasFailure()) {
        FAIL() << "round " << round << ", step " << step << ", " << what;
      }
    }
  }
}

using Bodies = AabbBroadPhase3;
constexpr Aabb3 kUnit = {{0, 0, 0}, {1, 1, 1}};
constexpr Aabb3 kFar = {{90, 90, 90}, {91, 91, 91}};

Ids IdsUpTo(std::uint32_t count) {
  Ids ids(count);
  for (std::uint32_t id = 0; id < count; ++id) ids[id] = id;
  return ids;
}

template <typename Query>
Ids FoundIn(const Bodies& bodies, const Query& query) {
  Ids ids(bodies.size());
  ids.resize(Survivors(bodies, query, ids));
  return InOrder(ids);
}

// Calls change() while a query of another thread could run, so that no query
// copies moves into the tree.
void Inside(const Bodies& bodies, const std::function<void()>& change) {
  const detail::Reading other(CoreOf(bodies).state());
  change();
}

// A body that moves to its own bound has not changed, in any way that costs.
TEST(BroadPhaseTest, AMoveToTheSameBoundChangesNothing) {
  CountingMemory memory;
  struct Calls {
    std::size_t count = 0;
  } calls;
  BroadPhaseOptions options;
  options.memory = memory.resource();
  options.filter.context = &calls;
  options.filter.keep = [](void* context, auto, auto, bool matches) {
    ++static_cast<Calls*>(context)->count;
    return matches;
  };
  Bodies bodies(options);
  const Ids ids = IdsUpTo(500);
  const std::vector<Aabb3> boxes(500, kUnit);
  bodies.Insert(ids, boxes);
  bodies.UpdatePairs();
  calls.count = 0;
  const std::size_t before = memory.allocations;
  Inside(bodies, [&] {
    bodies.Move(ids, boxes);
    // These would copy the tree if a body were late.
    Ids nearest(5);
    EXPECT_EQ(KNearest(bodies, Point<3>{}, nearest, {}), 5u);
  });
  EXPECT_EQ(memory.allocations, before);
  bodies.UpdatePairs();
  EXPECT_EQ(calls.count, 0u);  // no pair was searched
  bodies.Move(7, kFar);
  bodies.UpdatePairs();
  EXPECT_EQ(PairsFrom(bodies.ended()).size(), 499u);
}

// The function of a query may make any call. Each body that is there all the
// time is reported once.
TEST(BroadPhaseTest, TheFunctionOfAQueryMayChangeBodies) {
  constexpr std::uint32_t kCount = 1400;
  for (const bool caller_locks : {false, true}) {
    for (std::size_t c = 0; c < 11u; ++c) {
      BroadPhaseOptions options;
      options.caller_locks = caller_locks;
      options.moves_are_seen_at_once = c % 2 == 0;
      Bodies bodies(options);
      const auto box_of = [](std::uint32_t id) {
        const auto x = static_cast<float>(id);
        return Aabb3{{x, 0, 0}, {x + 0.5f, 1, 1}};
      };
      for (std::uint32_t id = 0; id < kCount; ++id) {
        if (id != 100) bodies.Insert(id, box_of(id));
      }
      const auto [name, call] = CallsThatRunAlone(bodies)[c];
      SCOPED_TRACE(name);
      for (const bool is_cast : {false, true}) {
        std::vector<int> times(kCount);
        std::size_t calls = 0;
        const auto on_body = [&](std::uint32_t id) {
          ++times[id];
          // Erase() and Insert() work once.
          if (calls++ == 3 && (!is_cast || c > 1)) call();
          bodies.Move(7, kFar);
        };
        if (is_cast) {
          RayCast(bodies, Ray3{{-1, 0.5f, 0.5f}, {1, 0, 0}, kInf},
                  [&](std::uint32_t id, float, const Aabb3& box) {
                    if (id != 7) {
                      EXPECT_EQ(box, box_of(id));
                    }
                    on_body(id);
                  });
        } else {
          ForEachSurvivor(bodies, Aabb3::Everything(),
                          [&](Span<const std::uint32_t> ids) {
                            for (std::uint32_t id : ids) on_body(id);
                          });
        }
        for (std::uint32_t id = 0; id < kCount; ++id) {
          const bool may_miss = id == 2 || id == 7 || id == 100;
          EXPECT_TRUE(times[id] == 1 || (may_miss && times[id] == 0))
              << id << " " << times[id];
        }
        bodies.Move(7, box_of(7));
        bodies.Update();
      }
      if (c > 1) {
        ForEachPairOf(bodies, Ids{1}, [&](Span<const IdPair>) { call(); });
      }
      EXPECT_TRUE(bodies.Validate());
    }
  }
}

// Exceptions pass through, and the next call works.
TEST(BroadPhaseErrorsTest, FunctionsMayThrow) {
  struct Thrown {};
  constexpr std::uint32_t kCount = 600;
  Bodies bodies;
  BodyModel model;
  const Ids ids = IdsUpTo(kCount);
  bodies.Insert(ids, std::vector<Aabb3>(kCount, kUnit));
  for (const std::uint32_t id : ids) model.Insert(id, PlanesOf(kUnit));
  const auto run = [](std::size_t parts, const Runner::Part& part) {
    part(parts - 1);
    throw Thrown();
  };
  const auto function = [](auto...) { throw Thrown(); };
  const auto expect = [&] {
    EXPECT_THROW(ForEachSurvivor(bodies, kUnit, function), Thrown);
    EXPECT_THROW(BoxCast(bodies, kUnit, {1, 0, 0}, 1, function), Thrown);
    EXPECT_THROW(ForEachPairOf(bodies, Ids{1}, function), Thrown);
  };
  expect();
  Inside(bodies, [&] {
    for (std::uint32_t id = 0; id < 200; ++id) {
      bodies.Move(id, kFar);
      model.Move(id, PlanesOf(kFar));
    }
    expect();
  });
  EXPECT_THROW(bodies.Save(function), Thrown);
  EXPECT_THROW(bodies.Rebuild(run), Thrown);
  ExpectIsModel(CoreOf(bodies), model, 1);
  bodies.UpdatePairs();
  EXPECT_EQ(bodies.pairs().size(), 400u * 399 / 2 + 200u * 199 / 2);
}

struct Many {
  explicit Many(std::uint32_t count, float radius = 0.5f,
                const BroadPhaseOptions& options = {})
      : spread(radius),
        ids(IdsUpTo(count)),
        boxes(spread.Some(count)),
        bodies(options) {
    bodies.Insert(ids, boxes);
  }
  Spread<> spread;
  Ids ids;
  std::vector<Aabb3> boxes;
  Bodies bodies;
};

// Bodies of the tree in its order.
Ids OrderOf(const Bodies& bodies) {
  Ids ids(bodies.size());
  EXPECT_EQ(Survivors(bodies, Aabb3::Everything(), ids), ids.size());
  return ids;
}

// How much Update() sorts, and where Insert() puts bodies, depends on the
// bodies that changed, and not on how often they were copied into the tree.
TEST(BroadPhaseBudgetTest, TheOrderDependsOnChangesAlone) {
  constexpr std::uint32_t kCount = 6'000;
  Many many(kCount, 0.2f, {.moves_are_seen_at_once = true});
  auto& [spread, ids, boxes, with_updates_alone] = many;
  Bodies with_queries(with_updates_alone);
  Bodies saved(with_updates_alone);
  for (int frame = 0; frame < 60; ++frame) {
    const Ids some = {ids.begin() + frame * 40, ids.begin() + frame * 40 + 400};
    for (int pass = 0; pass < 2; ++pass) {
      const std::vector<Aabb3> moved = spread.Some(some.size());
      for (Bodies* bodies : {&with_updates_alone, &with_queries, &saved}) {
        bodies->Move(some, moved);
      }
      EXPECT_EQ(CountSurvivors(with_queries, Aabb3::Everything()), kCount);
      saved.Load(BytesOf(CoreOf(saved)));
      // Others come and go, into leaves that have moved.
      const Ids others = {ids.end() - 50, ids.end()};
      const std::vector<Aabb3> new_boxes = spread.Some(others.size());
      for (Bodies* bodies : {&with_updates_alone, &with_queries, &saved}) {
        bodies->Erase(others);
        bodies->Insert(others, new_boxes);
      }
    }
    for (Bodies* bodies : {&with_updates_alone, &with_queries, &saved}) {
      bodies->Update();
    }
    ASSERT_EQ(OrderOf(with_queries), OrderOf(with_updates_alone)) << frame;
    ASSERT_EQ(OrderOf(saved), OrderOf(with_updates_alone)) << frame;
  }
}

TEST(BroadPhaseBudgetTest, LimitsHowManyAreSortedAgain) {
  constexpr std::uint32_t kCount = 40'000;
  Many many(kCount);
  auto& [spread, ids, boxes, bodies] = many;
  EXPECT_EQ(bodies.Statistics().cost_ratio, 1);
  bodies.Move(ids, spread.Some(kCount));
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

// All bodies move in each frame, up to this share of the world's side, or to
// any place. The order of fast bodies is sorted as often as it decays, and that
// of slow ones seldom.
TEST(BroadPhaseBudgetTest, TheOrderOfFastBodiesKeepsUp) {
  constexpr std::uint32_t kCount = 20'000;
  struct Speed {
    float step;
    double most_ratio;
    std::size_t least_sorts;  // of all, in 40 frames
    std::size_t most_sorts;
  };
  for (const auto& [step, most_ratio, least_sorts, most_sorts] :
       {Speed{1e-4f, 1.1, 0, 0}, Speed{1e-3f, 1.6, 0, 2},
        Speed{1e-2f, 2.5, 1, 10}, Speed{3e-2f, 3.5, 8, 20},
        Speed{1, 1.1, 39, 40}}) {
    SCOPED_TRACE(step);
    Many many(kCount);
    auto& [spread, ids, boxes, bodies] = many;
    const Aabb3 world = bodies.Bounds();
    const float side = world.max[0] - world.min[0];
    Random random(1);
    std::uniform_real_distribution<float> way(-step * side, step * side);
    std::vector<std::array<float, 3>> ways(kCount);
    for (auto& its_way : ways) {
      for (float& x : its_way) x = way(random);
    }
    std::size_t sorts = 0;
    double ratio = 2;
    for (std::size_t frame = 0; frame < 40; ++frame) {
      if (step == 1) boxes = spread.Some(kCount);
      for (std::uint32_t id = 0; id < kCount && step < 1; ++id) {
        for (std::size_t k = 0; k < 3; ++k) {
          float& way_of = ways[id][k];
          if (boxes[id].min[k] + way_of < world.min[k] ||
              boxes[id].max[k] + way_of > world.max[k]) {
            way_of = -way_of;
          }
          boxes[id].min[k] += way_of;
          boxes[id].max[k] += way_of;
        }
      }
      bodies.Move(ids, boxes);
      bodies.Update();
      const double now = bodies.Statistics().cost_ratio;
      sorts += now == 1 && (step == 1 || ratio != 1) ? 1 : 0;
      ratio = now;

      EXPECT_LE(now, most_ratio) << frame;
    }
    EXPECT_GE(sorts, least_sorts);
    EXPECT_LE(sorts, most_sorts);
  }
}

// Ten times as many erasures and insertions as bodies.
TEST(BroadPhaseBudgetTest, TheOrderDoesNotDecay) {
  constexpr std::uint32_t kCount = 10'000;
  Many many(kCount);
  auto& [spread, ids, boxes, bodies] = many;
  Random random(1);
  for (std::size_t frame = 0; frame < 200; ++frame) {
    Ids some;
    std::vector<Aabb3> others;
    for (std::size_t first = random() % 20; first < kCount; first += 20) {
      some.push_back(ids[first]);
      others.push_back(spread.Next());
    }
    bodies.Erase(some);
    bodies.Insert(some, others);
    bodies.Update();
  }
  EXPECT_LT(bodies.Statistics().cost_ratio, 1.3);
}

// Too few to be looked at while others move. An update without moves mends the
// order, and so do the next ones, although one body moves before each of them.
TEST(BroadPhaseBudgetTest, AFewFarMovesAreSortedInTheEnd) {
  constexpr std::uint32_t kCount = 40'000;
  Many many(kCount);
  auto& [spread, ids, boxes, bodies] = many;
  bodies.Update();
  for (std::uint32_t id = 0; id < 600; ++id) {
    bodies.Move(id, boxes[kCount - 1 - id]);
  }
  bodies.Update();
  const double before = bodies.Statistics().cost_ratio;
  ASSERT_GT(before, 2.5);
  bodies.Update();
  const double after = bodies.Statistics().cost_ratio;
  EXPECT_LT(after, before);
  ASSERT_GT(after, 2);
  for (std::uint32_t id = 0; id < 60; ++id) {
    bodies.Move(id, boxes[id]);
    bodies.Update();
  }
  EXPECT_LT(bodies.Statistics().cost_ratio, 2);
}

// The C API passes on what most calls refuse: tests/c/errors_test.c.
TEST(BroadPhaseErrorsTest, SayWhatWasWrong) {
  Bodies bodies;
  bodies.Insert(1, kUnit);
  const Ids ids = {1, 2};
  const std::vector<Aabb3> boxes(2, kUnit);
  const std::vector<BodyMasks> masks(2);
  const std::vector<std::byte> of_others = BytesOf(CoreOf(AaboBroadPhase3()));
  EXPECT_REFUSED((bodies.Insert(Ids{2, 1}, boxes)), "BroadPhase::Insert",
                 "ids[1]", "no body has", "got 1");
  EXPECT_REFUSED((bodies.Insert(Ids{2}, boxes)), "BroadPhase::Insert", "bounds",
                 "1", "got 2");
  EXPECT_REFUSED((bodies.Insert(Ids{2}, {&kUnit, 1}, masks)),
                 "BroadPhase::Insert", "masks", "1", "got 2");
  EXPECT_REFUSED((bodies.Move(ids, boxes)), "BroadPhase::Move", "ids[1]",
                 "a body", "got 2");
  EXPECT_REFUSED((bodies.Move(ids, {})), "BroadPhase::Move", "bounds", "2",
                 "got 0");
  EXPECT_REFUSED((bodies.Erase(ids)), "BroadPhase::Erase", "ids[1]", "a body",
                 "got 2");
  EXPECT_REFUSED((bodies.Erase(4'000'000'000u)), "BroadPhase::Erase", "ids[0]",
                 "got 4000000000");
  EXPECT_REFUSED((bodies.Erase({nullptr, 3})), "BroadPhase::Erase", "ids", "3",
                 "a null pointer");
  EXPECT_REFUSED((bodies.Get(2)), "BroadPhase::Get", "a body", "got 2");
  EXPECT_REFUSED((bodies.MasksOf(10)), "BroadPhase::MasksOf", "a body",
                 "got 10");
  EXPECT_REFUSED((KNearest(bodies, Point<3>{}, {}, {}, -1)), "KNearest",
                 "max_distance", "-1");
  EXPECT_REFUSED((bodies.Load(of_others)), "BroadPhase::Load", "bytes",
                 "of this type");
  // With a handler of errors, right calls are right.
  EXPECT_EQ(ToldBy([&] {
              EXPECT_EQ(PairsOf(bodies, Ids{1}, {}), 0u);
              EXPECT_EQ(FoundIn(bodies, kUnit), Ids{1});
            }),
            "");

  BodyModel model;
  model.Insert(1, PlanesOf(kUnit));
  ExpectIsModel(CoreOf(bodies), model, 1);
  bodies.Insert(2, kUnit);  // no mark of a call that failed is left
  EXPECT_TRUE(bodies.Has(2));
}

// Bytes that were cut are refused, and others may be, but do no harm.
TEST(BroadPhaseSaveTest, AlteredBytesDoNoHarm) {
  constexpr Layout kLayout(3, 3, true);
  Random random(1);
  Choices maker(kLayout, random);
  Bodies bodies;
  for (std::uint32_t id = 0; id < 150; ++id) {
    const Planes b = maker.Next();
    bodies.Insert(3 * id, {{b[0], b[1], b[2]}, {b[3], b[4], b[5]}},
                  maker.Masks());
  }
  bodies.UpdatePairs();
  bodies.Erase(Ids{3, 9, 27});
  bodies.Move(6, kUnit);
  const std::vector<std::byte> bytes = BytesOf(CoreOf(bodies));
  for (std::size_t size = 0; size < bytes.size(); size += 1 + size / 64) {
    EXPECT_FALSE(LoadAltered(kLayout, {bytes.data(), size}, random)) << size;
  }
  std::size_t accepted = 0;
  for (std::size_t i = 0; i < 3000; ++i) {
    std::vector<std::byte> altered = bytes;
    for (std::size_t n = 1 + random() % 3; n-- > 0;) {
      const std::size_t at =
          random() % (random() % 4 == 0 ? 256 : altered.size());
      altered[at] = static_cast<std::byte>(random() % 4 == 0 ? 0 : random());
    }
    accepted += LoadAltered(kLayout, altered, random) ? 1 : 0;
  }
  EXPECT_GT(accepted, 0u);
}

// Bytes without a body that list changed ids, each of which takes a record.
TEST(BroadPhaseSaveTest, ChangedIdsTakeTheMemoryThatTheHeaderSays) {
  std::vector<std::byte> bytes = BytesOf(CoreOf(Bodies()));
  ASSERT_EQ(bytes.size(), 128u);
  bytes.resize(256);
  constexpr std::uint64_t kCount = 16;  // in each of two lists
  std::memcpy(&bytes[48], &kCount, sizeof(std::uint64_t));
  std::memcpy(&bytes[56], &kCount, sizeof(std::uint64_t));
  constexpr std::uint32_t kLast = 0x7FFFFFFF;
  constexpr std::uint32_t kInGroup = 4096;
  for (const auto id_of : std::initializer_list<std::uint32_t (*)(unsigned)>{
           [](unsigned i) { return kLast / kInGroup / 32 * i * kInGroup; },
           [](unsigned i) { return kLast - i * kInGroup; },
           [](unsigned i) { return kLast - (31 - i) * kInGroup; },
           [](unsigned i) { return kLast >> i; },
           [](unsigned i) { return kLast >> (31 - i); }}) {
    for (unsigned i = 0; i < 2 * kCount; ++i) {
      const std::uint32_t id = id_of(i);
      std::memcpy(&bytes[128 + sizeof(id) * i], &id, sizeof(id));
    }
    const std::size_t most = 2200 * bytes.size() + 4'000'000;
    CountingMemory memory;
    BroadPhaseOptions options;
    options.memory = memory.resource();
    Bodies loaded(options);
    loaded.Load(bytes);
    EXPECT_LT(memory.allocated_bytes, most);
    EXPECT_LT(Bodies(loaded).Statistics().bytes, most);
  }
}

// The operators of the classes that callers see.
template <typename Owner>
constexpr bool kCopiesMayThrow = !std::is_nothrow_copy_assignable_v<Owner> &&
                                 !std::is_nothrow_copy_constructible_v<Owner> &&
                                 std::is_nothrow_move_constructible_v<Owner> &&
                                 std::is_nothrow_swappable_v<Owner>;
static_assert(kCopiesMayThrow<Bodies> &&
              std::is_nothrow_move_assignable_v<Bodies>);
// These copy if the resources differ.
static_assert(kCopiesMayThrow<AabbBvh3> &&
              !std::is_nothrow_move_assignable_v<AabbBvh3> &&
              kCopiesMayThrow<PairEvents> &&
              !std::is_nothrow_move_assignable_v<PairEvents>);

TEST(BroadPhaseMemoryTest, AssignmentsThatFailChangeNothing) {
  CountingMemory memory;
  BroadPhaseOptions options;
  options.memory = memory.resource();
  Bodies from(options);
  from.Insert(Ids{1, 2}, std::vector<Aabb3>(2, kUnit));
  from.UpdatePairs();
  Bodies to;
  to.Insert(3, kFar);
  EXPECT_GT(FailuresOf(
                memory, [&] { to = from; },
                [&] {
                  EXPECT_EQ(FoundIn(to, Aabb3::Everything()), Ids{3});
                  EXPECT_EQ(FoundIn(from, kUnit), (Ids{1, 2}));
                }),
            3u);
  const Bodies& itself = to;
  to = itself;
  EXPECT_EQ(FoundIn(to, kUnit), (Ids{1, 2}));
  EXPECT_EQ(to.pairs().size(), 1u);
  from = std::move(to);
  to = from;
  // Into the memory that is there.
  to.Move(Ids{1, 2}, std::vector<Aabb3>(2, kFar));
  to.Update();
  const std::size_t allocations = memory.allocations;
  to = from;
  EXPECT_EQ(memory.allocations, allocations);
  EXPECT_EQ(FoundIn(to, kUnit), (Ids{1, 2}));
  // With equal options, into memory that is too small.
  Ids more = IdsUpTo(5000);
  more.erase(more.begin(), more.begin() + 10);
  from.Insert(more, std::vector<Aabb3>(more.size(), kUnit));
  EXPECT_GT(FailuresOf(
                memory, [&] { to = from; },
                [&] {
                  EXPECT_EQ(FoundIn(to, kUnit), (Ids{1, 2}));
                  EXPECT_EQ(to.pairs().size(), 1u);
                  EXPECT_TRUE(to.Validate());
                }),
            2u);
  EXPECT_EQ(to.size(), from.size());
  to.Erase(1);
  EXPECT_TRUE(from.Has(1));
}

// In a query, beside a body that moved since the last update.
TEST(BroadPhaseMemoryTest, QueriesCopyTheTreeOnce) {
  CountingMemory memory;
  BroadPhaseOptions options;
  options.memory = memory.resource();
  options.moves_are_seen_at_once = true;
  Bodies bodies(options);
  for (std::uint32_t id = 0; id < 300; ++id) {
    const auto x = static_cast<float>(id);
    bodies.Insert(id, {{x, 0, 0}, {x + 0.5f, 1, 1}});
  }
  bodies.Update();
  Inside(bodies, [&] {
    bodies.Move(7, kFar);
    const std::vector<Point3> points(3);
    const std::vector<Aabb3> boxes(3, kUnit);
    Ids ids(3);
    // Without one of them it throws.
    const auto allocations_of = [&](const auto& call) {
      return FailuresOf(memory, call, [] {});
    };
    const std::size_t once =
        allocations_of([&] { (void)KNearest(bodies, points[0], ids, {}); });
    EXPECT_GT(once, 0u);
    EXPECT_EQ(
        allocations_of([&] { KNearestOfEach(bodies, points, 1, ids, {}); }),
        once);
    EXPECT_EQ(
        allocations_of([&] { KNearestOfEach(bodies, boxes, 1, ids, {}); }),
        once);
    EXPECT_GT(allocations_of([&] { (void)PairsOf(bodies, Ids{1}, {}); }), 0u);
    EXPECT_GT(allocations_of([&] { (void)bodies.Bounds(); }), 0u);
  });
}

TEST(BroadPhaseMemoryTest, TakesWhatTheHeaderSays) {
  CountingMemory memory;
  BroadPhaseOptions options;
  options.memory = memory.resource();
  constexpr std::uint32_t kCount = 20'000;
  Bodies bodies(options);
  EXPECT_LT(bodies.Statistics().bytes, 7000u);
  Spread spread(0.1f);
  const Ids ids = IdsUpTo(kCount);
  std::vector<Aabb3> boxes = spread.Some(kCount);
  bodies.Insert(ids, boxes);
  const auto expect = [&](std::size_t most) {
    const BroadPhaseStatistics statistics = bodies.Statistics();
    EXPECT_LT(statistics.bytes - 8 * statistics.pairs,
              7000 + (most + sizeof(Aabb3)) * kCount);
  };
  expect(56);
  for (std::size_t frame = 0; frame < 3; ++frame) {
    for (Aabb3& box : boxes) {
      for (std::size_t k = 0; k < 3; ++k) {
        box.min[k] += 0.1f;
        box.max[k] += 0.1f;
      }
    }
    const std::size_t before = memory.allocations;
    bodies.Move(ids, boxes);
    (void)FoundIn(bodies, kUnit);
    (void)FoundIn(bodies, Sphere3{{0, 0, 0}, 9});
    BoxCast(bodies, kUnit, {5, 5, 5}, 1, [](auto...) {});
    EXPECT_EQ(memory.allocations, before);
    bodies.Update();
    bodies.UpdatePairs();
    expect(56);
  }
  bodies.SetMasks(ids, std::vector<BodyMasks>(kCount, {2, 2}));
  bodies.Rebuild();
  expect(64);
  // Ids without bodies.
  const std::size_t before = bodies.Statistics().bytes;
  bodies.Insert(kCount + 1'000'000, kUnit);
  bodies.Rebuild();
  EXPECT_LT(bodies.Statistics().bytes, before + 20 * 1'000'000);
}

}  // namespace
}  // namespace halfspace::testing

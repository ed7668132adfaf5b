// Builders and calls allocate nothing, as they say: there is no memory left.
// And calls take no more stack than they say.
#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "halfspace/halfspace.h"
#include "tests/library/fit/builders.h"
#include "tests/library/fit/random_shapes.h"
#include "tests/library/fit_many/bulk.h"
#include "tests/library/fit_many/bulk_answers.h"
#include "tests/library/support/answers.h"
#include "tests/library/support/calls.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/limited_memory.h"
#include "tests/library/support/owners.h"
#include "tests/library/support/quantized_cases.h"
#include "tests/library/support/sanitized.h"

#if defined(__unix__)
#include <pthread.h>
#endif

namespace halfspace::testing {
namespace {

// Every call on `world`, for one query and for many, with every target and
// schedule.
void VisitCalls(const AnyWorld& world, const AnyQueries& queries,
                const NamedCall& one, const NamedCall& many) {
  CallOutputs outputs;
  std::vector<std::uint64_t> masks(MaskWords(world.size()) * queries.count);
  for (Target target : TargetsUnderTest()) {
    for (Schedule schedule : kSchedules) {
      const Options options{.schedule = schedule, .target = target};
      ForEachCall(world, world.One(queries), options, outputs, one);
      ForEachManyCall(world, queries, options, outputs, many);
    }
    if (world.HasUnchecked()) {
      one("kernels.h", [&] {
        world.UncheckedMasks(world.One(queries), true, masks, target);
      });
      many("kernels.h, many",
           [&] { world.UncheckedMasks(queries, false, masks, target); });
    }
  }
}

TEST(NoAllocationTest, Builders) {
  Random random(61);
  for (const Builder& builder : BuildersAndChanges()) {
    for (PointKind kind : kPointKinds) {
      const Shape shape = RandomShape(builder, kind, random);
      kWithoutMemory([&] { return builder.Build(shape); });
    }
  }
}

TEST(NoAllocationTest, BuildersOfMany) {
  Random random(62);
  for (const Bulk& bulk : Bulks()) {
    const BulkShapes shapes =
        RandomShapes(bulk, PointKind::kUniform, 70, random);
    Arena arena;
    BulkSource source(bulk, shapes);
    for (BulkLayout layout : kBulkLayouts) {
      source.Place(arena, layout);
      const BulkOutput built(bulk, shapes.size(), arena);
      for (Target target : TargetsUnderTest()) {
        kWithoutMemory(
            [&] { return source.Bound(built.output(), {.target = target}); });
      }
    }
  }
}

// In this frame no pair begins or ends.
TEST(NoAllocationTest, FramesOfFewBodies) {
  std::vector<Aabb2> boxes;
  std::vector<std::uint32_t> ids;
  for (std::uint32_t i = 0; i < 100; ++i) {
    const auto x = static_cast<float>(i);
    boxes.push_back({{x, 0}, {x + 1, 1}});
    ids.push_back(i);
  }
  AabbBroadPhase2 bodies;
  bodies.Insert(ids, boxes);
  bodies.Update();
  bodies.UpdatePairs();
  for (Aabb2& box : boxes) box.max[1] = 2;
  kWithoutMemory([&] {
    bodies.Move({ids.data(), 10}, {boxes.data(), 10});
    bodies.Update();
    bodies.UpdatePairs();
  });
  EXPECT_EQ(bodies.pairs().size(), 99u);
}

class NoAllocationOfCallsTest : public ::testing::TestWithParam<QuantizedRow> {
 protected:
  // The same on floats, on quantized bounds and on both; of many objects, whose
  // planes are in no first-level cache, with one query, for which there is
  // room.
  static void VisitWorlds(const NamedCall& one, const NamedCall& many) {
    Random random(62);
    for (const auto& [objects, count] :
         {std::pair(1000, 9), std::pair(15000, 1)}) {
      const auto values =
          MakeQuantizedValues(GetParam().layout, QuantizedInputKind::kUniform,
                              static_cast<std::size_t>(objects), random);
      const AnyQuantized all = GetParam().Make(values);
      const auto queries = MakeQuantizedQueries(
          GetParam().layout, values, static_cast<std::size_t>(count), random);
      for (const AnyWorld& world :
           {all.floats(), all.quantized(), all.refined(), all.world()}) {
        VisitCalls(world, {queries.data(), static_cast<std::size_t>(count)},
                   one, many);
      }
    }
  }
};

TEST_P(NoAllocationOfCallsTest, OnFloatsAndQuantized) {
  const auto visit = [](auto, const auto& call) { kWithoutMemory(call); };
  VisitWorlds(visit, visit);
}

INSTANTIATE_TEST_SUITE_P(, NoAllocationOfCallsTest,
                         ::testing::ValuesIn(QuantizedRows()),
                         ::testing::PrintToStringParamName());

// Of more objects than one level has nodes for.
void VisitBvh(
    const std::function<void(const char* name, std::size_t most,
                             const std::function<void()>& call)>& visit) {
  AaboWorld3 floats;
  for (int i = 0; i < 5000; ++i) {
    const auto x = static_cast<float>(i);
    floats.Push(BoundSphere(Sphere3{{x, x, x}, 100.0f}));
  }
  // Bytes of stack.
  constexpr std::size_t kQuery = 8 * 1024;
  constexpr std::size_t kShape = kQuery + 6 * 1024;
  constexpr std::size_t kNearest = 24 * 1024;
  constexpr std::size_t kPairs = 16 * 1024;
  AaboBvh3 world(floats);
  world.Reserve(world.size());
  const std::vector<Aabo3> queries(70, floats.Get(2500));
  std::vector<std::uint32_t> ids(100'000);
  std::vector<std::size_t> offsets(queries.size() + 1);
  const Sphere3 sphere{{2500, 2500, 2500}, 50};
  const std::vector<Point3> points(4, sphere.center);
  const std::vector<HalfSpace3> half_space = {{{1, 0, 0}, -2500}};
  std::array<std::uint32_t, 4000> nearest;
  std::vector<IdPair> pairs(100);
  const std::vector<std::uint32_t> set(63, 2500);
  const auto on_ids = [](Span<const std::uint32_t>) {};
  const auto on_hit = [](std::uint32_t, float) {};
  for (Target target : TargetsUnderTest()) {
    const QueryOptions query = {.target = target};
    const SearchOptions search = {.target = target};
    visit("Survivors", kQuery,
          [&] { (void)Survivors(world, queries[0], ids, query); });
    visit("CountSurvivors", kQuery,
          [&] { (void)CountSurvivors(world, queries[0], query); });
    visit("AnySurvivor", kQuery,
          [&] { (void)AnySurvivor(world, queries[0], query); });
    visit("ForEachSurvivor", kQuery,
          [&] { ForEachSurvivor(world, queries[0], on_ids, query); });
    visit("SurvivorsOfEach", kQuery,
          [&] { (void)SurvivorsOfEach(world, queries, ids, offsets, query); });
    visit("Survivors of a sphere", kShape,
          [&] { (void)Survivors(world, sphere, ids, query); });
    visit("Survivors of a half-space in a scan", kShape + 3 * 1024, [&] {
      (void)Survivors(floats, half_space, ids, {.target = target});
    });
    visit("KNearest", kNearest, [&] {
      (void)KNearest(world, sphere.center, nearest, {}, 1e9f, search);
    });
    visit("RayCast", kNearest, [&] {
      RayCast(world, Ray3{{}, {1, 1, 1}, 1000}, on_hit, search);
    });
    visit("BoxCast", kNearest, [&] {
      BoxCast(world, Aabb3{{}, {1, 1, 1}}, {1, 1, 1}, 1000, on_hit, search);
    });
    visit("KNearestOfEach", kNearest, [&] {
      KNearestOfEach(world, points, nearest.size() / 4, nearest, {}, 1e9f,
                     search);
    });
    visit("Pairs", kPairs,
          [&] { (void)Pairs(world, pairs, {.target = target}); });
    visit("PairsOf", kPairs, [&] {
      (void)PairsOf(world, set, pairs, {.wanted = set, .target = target});
    });
  }
}

TEST(NoAllocationOfBvhTest, Calls) {
  VisitBvh([](auto, std::size_t, const auto& call) { kWithoutMemory(call); });
}

#if defined(__unix__) && defined(__OPTIMIZE__) && !defined(HALFSPACE_SANITIZED)
// Twice as much as a thread must have on ARM.
alignas(4096) std::array<std::byte, 256 * 1024> painted_stack;

// From a thread's frame to the lowest byte of its stack that call() changes.
template <typename Call>
std::size_t StackUse(const Call& call) {
  constexpr std::byte kPaint{0xa5};
  struct Job {
    const Call& call;
    std::size_t used;
  } job = {call, 0};
  call();  // what is done once, such as to bind symbols, is not counted
  painted_stack.fill(kPaint);
  const auto run = [](void* argument) -> void* {
    Job& its = *static_cast<Job*>(argument);
    const auto* frame = static_cast<std::byte*>(__builtin_frame_address(0));
    its.call();
    const std::byte* lowest = painted_stack.data();
    while (*lowest == kPaint) ++lowest;
    its.used = static_cast<std::size_t>(frame - lowest);
    return nullptr;
  };
  pthread_attr_t attributes;
  pthread_t thread;
  pthread_attr_init(&attributes);
  EXPECT_EQ(pthread_attr_setstack(&attributes, painted_stack.data(),
                                  painted_stack.size()),
            0);
  const int error = pthread_create(&thread, &attributes, run, &job);
  EXPECT_EQ(error, 0);
  if (error == 0) pthread_join(thread, nullptr);
  pthread_attr_destroy(&attributes);
  return job.used;
}

TEST(NoAllocationOfBvhTest, TakeTheStackThatHeadersState) {
  VisitBvh([](auto name, std::size_t most, const auto& call) {
    EXPECT_LE(StackUse(call), most) << name;
  });
}

TEST_P(NoAllocationOfCallsTest, TakeTheStackThatHeadersState) {
  const auto most = [](std::size_t bytes) {
    return [bytes](auto name, const auto& call) {
      EXPECT_LE(StackUse(call), bytes) << name;
    };
  };
  VisitWorlds(most(8 * 1024), most(32 * 1024));
}
#endif

}  // namespace
}  // namespace halfspace::testing

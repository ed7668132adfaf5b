// The program's own handler of errors. That it is told what would be thrown, of
// every error there is, is checked by Refuses() (expect_invalid.h).
#include <gtest/gtest.h>

#include <algorithm>
#include <cfenv>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "halfspace/error.h"
#include "halfspace/halfspace.h"
#include "tests/library/bvh/aligned_copy.h"
#include "tests/library/support/counting_memory.h"
#include "tests/library/support/expect_invalid.h"
#include "tests/library/support/fp_modes.h"

namespace halfspace::testing {
namespace {

void GetFromNothing() { AabbWorld3().Get(7); }
constexpr const char kText[] =
    "halfspace: World::Get: index: expected less than the size, 0, got 7";

void Return(const Error&) {}
void ReturnToo(const Error&) {}

TEST(ErrorHandlerTest, TheOneBeforeIsReturned) {
  EXPECT_EQ(SetErrorHandler(&Return), nullptr);
  EXPECT_EQ(SetErrorHandler(&ReturnToo), &Return);
  EXPECT_EQ(SetErrorHandler(nullptr), &ReturnToo);
  EXPECT_THROW(GetFromNothing(), std::invalid_argument);
  EXPECT_TRUE(Refuses(&GetFromNothing, {kText}));
}

// The parts of an error, of which the last is its index.
using Parts = std::tuple<std::string_view, std::string_view, std::string_view,
                         std::string_view, std::size_t>;

TEST(ErrorTest, HasTheParts) {
  const auto expect = [](const auto& call, const Parts& parts) {
    try {
      call();
      ADD_FAILURE() << "nothing was thrown";
    } catch (const Error& thrown) {
      const Error error = thrown;
      EXPECT_EQ(parts, Parts(error.call(), error.argument(), error.expected(),
                             error.given(), error.index()));
      EXPECT_STREQ(error.what(), thrown.what());
    }
  };
  expect(&GetFromNothing, {"World::Get", "index", "less than the size, 0", "7",
                           Error::kNoIndex});
  AabbBvh3 bvh(std::vector<Aabb3>(2));
  const std::vector<std::uint32_t> ids = {0, 12};
  expect([&] { bvh.Erase(ids); },
         {"Bvh::Erase", "ids", "the id of an object", "12", 1});
  EXPECT_TRUE(Refuses([&] { bvh.Erase(ids); },
                      {"halfspace: Bvh::Erase: ids[1]: expected the id of an "
                       "object, got 12"}));
}

TEST(ErrorHandlerDeathTest, IsNotToReturn) {
  EXPECT_EXIT(
      {
        SetErrorHandler(&Return);
        GetFromNothing();
      },
      ::testing::KilledBySignal(SIGABRT), "");
}

struct Thrown {};
void Throw(const Error&) { throw Thrown(); }

// Builders look at floats in a mode of their own.
TEST(ErrorHandlerTest, TheFloatingPointModeOfTheCallerIsRestored) {
  const RoundingMode upward(FE_UPWARD);
  const FlushDenormals flush;
  SetErrorHandler(&Throw);
  EXPECT_THROW(BoundSphere(Sphere3{{0, 0, 0}, -1}), Thrown);
  SetErrorHandler(nullptr);
  EXPECT_EQ(std::fegetround(), FE_UPWARD);
  EXPECT_EQ(FlushDenormals::IsOn(), FlushDenormals::kAvailable);
}

// Makes calls of which each is wrong. After each, check().
void ExpectNothingIsHeld(const std::vector<std::function<void()>>& calls,
                         const std::function<void()>& check) {
  for (std::size_t i = 0; i < calls.size(); ++i) {
    SCOPED_TRACE(i);
    SetErrorHandler(&Throw);
    EXPECT_THROW(calls[i](), Thrown);
    SetErrorHandler(nullptr);
    check();
  }
}

using Ids = std::vector<std::uint32_t>;
using Doubles = std::vector<Aabb<3, double>>;
const Ids kIds = {0, 1, 2, 3, 4, 99};  // the last is none

TEST(ErrorHandlerTest, ABroadPhaseHoldsNothingAfterAnError) {
  CountingMemory memory;
  BroadPhaseOptions options;
  options.memory = memory.resource();
  options.moves_are_seen_at_once = true;
  AabbBroadPhase3 bodies(options);
  for (std::uint32_t id = 0; id < 5; ++id) bodies.Insert(id, {});
  bodies.Rebuild();
  // Room for the bodies of an Insert() that fails stays.
  EXPECT_THROW(bodies.Insert(kIds, std::vector<Aabb3>(6)), Error);
  const std::size_t blocks = memory.blocks;
  const auto none = [](auto...) {};
  const Sphere3 sphere = {{0, 0, 0}, -1};
  const std::vector<HalfSpace3> half_spaces(1000);
  const Span<const std::uint32_t> five(kIds.data(), 5);
  const std::vector<std::uint32_t> four_masks(4);
  PairOptions pair_options;
  std::size_t checks = 0;
  const std::vector<std::function<void()>> calls = {
      [&] { ForEachSurvivor(bodies, sphere, none); },
      [&] { (void)CountSurvivors(bodies, half_spaces); },
      [&] { (void)AnySurvivor(bodies, sphere); },
      [&] {
        (void)Survivors(bodies, Aabb3(), {nullptr, 5});
      },
      [&] {
        SphereCast(bodies, sphere, {1, 0, 0}, 1, none);
      },
      [&] { (void)KNearest(bodies, Point<3>(), {}, {}, -1); },
      [&] { (void)PairsOf(bodies, kIds, {}); },
      [&] {
        pair_options.margin = -1;
        ForEachPairOf(bodies, five, none, pair_options);
      },
      [&] {
        pair_options.margin = 0;
        pair_options.wanted = four_masks;
        ForEachPairOf(bodies, five, none, pair_options);
      },
      [&] { bodies.Insert(kIds, std::vector<Aabb3>(6)); },
      [&] { bodies.Insert(kIds, std::vector<Aabb3>(5)); },
      [&] { bodies.Move(kIds, std::vector<Aabb3>(6)); },
      [&] { bodies.SetMasks(kIds, std::vector<BodyMasks>(6)); },
      [&] { bodies.Erase(kIds); },
      [&] { (void)bodies.Get(99); },
      [&] { (void)bodies.MasksOf(99); }};
  const auto check = [&] {
    ++checks;
    EXPECT_EQ(memory.blocks, blocks);
    // A lock that is still held would be waited for.
    bodies.Update();
  };
  ExpectNothingIsHeld(calls, check);
  // The same where the body of a query has moved.
  bool is_first = true;
  ForEachSurvivor(bodies, Aabb3::Everything(), [&](Span<const std::uint32_t>) {
    if (!std::exchange(is_first, false)) return;
    bodies.Move(1, Aabb3{{1, 1, 1}, {2, 2, 2}});
    ExpectNothingIsHeld(calls, [&] {
      EXPECT_EQ(memory.blocks, blocks);
      EXPECT_EQ(AnySurvivor(bodies, Aabb3{{1, 1, 1}, {1, 1, 1}}), 1u);
    });
  });
  EXPECT_EQ(checks, calls.size());
}

TEST(ErrorHandlerTest, ABvhAndItsPairEventsHoldNothingAfterAnError) {
  CountingMemory memory;
  BuildOptions options;
  options.memory = memory.resource();
  BuildOptions bad = options;
  bad.quality = static_cast<BuildQuality>(2);
  const std::vector<Aabb3> bounds(90);
  AabbBvh3 bvh(bounds, options);
  AabbBvh3 with_slots(bounds, options);
  with_slots.Reserve(90);
  // By its header, it has fewer objects than lanes with one.
  const AlignedCopy open(bvh.Blob());
  const std::uint32_t fewer[] = {89, 89, 89};
  std::memcpy(&open.bytes()[40], fewer, sizeof(fewer));
  // Has an id twice.
  const auto alter = [](const AabbBvh3& of, const AlignedCopy& copy) {
    const auto* const ids = reinterpret_cast<const std::byte*>(of.ids().data());
    std::byte* const to = copy.bytes().data() + (ids - of.Blob().data());
    std::memcpy(to, to + sizeof(std::uint32_t), sizeof(std::uint32_t));
  };
  const AlignedCopy altered(bvh.Blob());
  const AlignedCopy altered_with_slots(with_slots.Blob());
  alter(bvh, altered);
  alter(with_slots, altered_with_slots);
  PairEvents events(memory.resource());
  events.Update(bvh);
  const std::vector<IdPair> twice = {{1, 2}, {3, 4}, {1, 2}};
  const std::size_t blocks = memory.blocks;
  Ids ids(5);
  const Span<const std::uint32_t> five(kIds.data(), 5);
  const std::vector<Aabb3> five_bounds(5);
  const auto in_place = [&](const AlignedCopy& blob) {
    return AabbBvh3::InPlace(blob.bytes(), memory.resource());
  };
  ExpectNothingIsHeld(
      {[&] { bvh.Set(kIds, Doubles(6)); },
       [&] { bvh.Set(five, Doubles(6)); },
       [&] { bvh.Insert(Doubles(6), ids); },
       [&] { bvh.Set(kIds, std::vector<Aabb3>(6)); },
       [&] { bvh.Insert(std::vector<Aabb3>(6), ids); },
       [&] { bvh.Erase(kIds); },
       [&] { bvh.Rebuild(bad); },
       [&] { bvh.Refit(Doubles(6)); },
       [&] { bvh.RefitInOrder(Doubles(6)); },
       [&] { bvh.SetMasks(kIds); },
       [&] {
         (void)PairsOf(bvh, Ids{0, 999}, {});
       },
       [&] {
         (void)CountSurvivors(bvh, Sphere3{{0, 0, 0}, -1});
       },
       [&] { events.Update(bvh, {.margin = -1}); },
       [&] { events.Update(bvh, Ids{9999}, {.margin = -1}); },
       [&] { events.Load(twice); },
       [&] { const AabbBvh3 made(bounds, bad); },
       [&] { const AabbBvh3 made(Doubles(90), bad); },
       [&] {
         (void)AabbBvh3::Fitted(
             9, [](auto&&) {}, bad);
       },
       [&] { (void)AabbBvh3::FromBlob(open.bytes(), memory.resource()); },
       [&] { in_place(altered).Set(five, Doubles(5)); },
       [&] { in_place(altered).Insert(Doubles(5), ids); },
       [&] { in_place(altered).Refit(Doubles(90)); },
       [&] { in_place(altered).Rebuild(); },
       [&] { in_place(altered_with_slots).Set(five, five_bounds); },
       [&] { in_place(altered_with_slots).Erase(five); }},
      [&] { EXPECT_EQ(memory.blocks, blocks); });
}

}  // namespace
}  // namespace halfspace::testing

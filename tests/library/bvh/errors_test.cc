// What calls of BVHs refuse, of which nothing is written or changed, and what
// searches for pairs do without memory. Histories make changes without it.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "tests/library/bvh/answers.h"
#include "tests/library/bvh/spread.h"
#include "tests/library/support/canaries.h"
#include "tests/library/support/counting_memory.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/expect_invalid.h"

namespace halfspace::testing {
namespace {

using Boxes3 = Span<const Aabb3>;
using DoubleBoxes = Span<const Aabb<3, double>>;
using HalfSpaces = Span<const HalfSpace3>;

// Lists of half-spaces that no call takes, and what is wrong with each.
std::vector<std::pair<HalfSpaces, const char*>> BadHalfSpaces() {
  static const std::vector<HalfSpace3> many(65);
  return {{many, "65"},
          {HalfSpaces(nullptr, 1), "null"},
          {HalfSpaces(Misaligned(many.data()), 1), "misaligned"}};
}

// Copies of a world of 100 objects without id 7.
class BvhErrorsTest : public ::testing::Test {
 protected:
  BvhErrorsTest() {
    bvh_.Erase(7);
    before_.assign(bvh_.Blob().begin(), bvh_.Blob().end());
    block_ = bvh_.Blob().data();
  }
  ~BvhErrorsTest() override {
    EXPECT_EQ(bvh_.Blob().data(), block_);
    EXPECT_TRUE(std::ranges::equal(bvh_.Blob(), before_));
  }

  // made(null) and made(misaligned) of a list of three elements.
  template <typename T, typename Made>
  static void ExpectMemoryRefused(std::string_view call,
                                  std::string_view argument,
                                  const std::vector<T>& list,
                                  const Made& made) {
    const T* const none = nullptr;
    EXPECT_REFUSED((made(Span<const T>(none, 3))), call, argument,
                   "expected memory for 3 elements", "got a null pointer");
    EXPECT_REFUSED((made(Span<const T>(Misaligned(list.data()), 3))), call,
                   argument, "expected a pointer aligned to ",
                   "got a misaligned one");
  }

  AabbBvh3 bvh_{Spread(1.0f).Some(100)};
  std::vector<std::byte> before_;
  const std::byte* block_;
  const std::vector<Aabb3> two_ = std::vector<Aabb3>(2, Aabb3::Empty());
  const std::vector<Aabb3> three_ = std::vector<Aabb3>(3, Aabb3::Empty());
  Ids one_ = Ids(1);
  Ids three_ids_ = {1, 2, 3};
};

TEST_F(BvhErrorsTest, OptionsAreChecked) {
  const AabbWorld3 world(Spread(1.0f).Some(100));
  for (const BuildOptions& options :
       {BuildOptions{.quality = static_cast<BuildQuality>(2)},
        BuildOptions{.target = Target::FromHighwayBit(3)}}) {
    const std::string_view name =
        options.target == Target() ? "quality" : "target";
    EXPECT_REFUSED((AabbBvh3(world, options)), "Bvh: ", name);
    EXPECT_REFUSED((bvh_.Rebuild(options)), "Bvh: ", name);
  }
  for (float wrong : {-1.0f, std::numeric_limits<float>::quiet_NaN()}) {
    const BuildOptions options{.query_extents = {{0, wrong, 0}}};
    EXPECT_REFUSED((AabbBvh3(world, options)), "Bvh: ", "query_extents");
    EXPECT_REFUSED((bvh_.Rebuild(options)), "Bvh: ", "query_extents");
  }
  AabbView3 view = world.view();
  view.max[1] = nullptr;
  EXPECT_REFUSED((AabbBvh3(view)), "Bvh", "world.max[1]", "null");
  Boxes<3, double> boxes = BoxesOf(std::vector<Aabb<3, double>>(3));
  boxes.stride = std::numeric_limits<std::size_t>::max() / 8;
  EXPECT_REFUSED((AabbBvh3(boxes)), "Bvh: ", "bounds.stride");
  AabbView<3, double> no_planes;
  no_planes.size = 3;
  EXPECT_REFUSED((AabbBvh3(no_planes)), "Bvh: ", "world.min[0]", "3 elements",
                 "null");
}

// The C API passes on what most calls refuse: tests/c/errors_test.c.
TEST_F(BvhErrorsTest, ChangesCheckTheirLists) {
  const Aabb3 box = bvh_.Get(3);
  const std::vector<Aabb3> by_id(100, Aabb3::Empty());
  const std::vector<Aabb<3, double>> doubles(2);
  const Ids with_missing = {3, 7};
  EXPECT_REFUSED((bvh_.Refit(with_missing, by_id)), "Refit", "id", "7");
  EXPECT_REFUSED((bvh_.Refit(one_, two_)), "Refit", "bounds", "100", "2");
  EXPECT_REFUSED((bvh_.Erase(7)), "Erase", "id", "7");
  EXPECT_REFUSED((bvh_.Set(100, box)), "Set", "id", "100");
  EXPECT_REFUSED((bvh_.Set(one_, two_)), "Set", "bounds", "1", "2");
  EXPECT_REFUSED((bvh_.Set(one_, DoubleBoxes(doubles))), "Set", "1", "2");
  EXPECT_REFUSED((bvh_.Insert(two_, one_)), "Insert", "ids", "2");
  EXPECT_REFUSED((bvh_.Insert(doubles, one_)), "Insert", "ids", "2");
  EXPECT_REFUSED((bvh_.InsertAs(Ids{7}, two_)), "InsertAs", "bounds", "1", "2");
  EXPECT_REFUSED((bvh_.Get(7)), "Get", "id", "7");
  const std::tuple<Ids, const char*> wrong_ids[] = {
      {{7, 200, 3}, "got 3"},
      {{7, 200, 7}, "got 7 twice"},
      {{300, 300, 7}, "got 300 twice"},
      {{99, 7, 8}, "got 99"},
      {{500, 0xFFFFFFFF, 7}, "got 4294967295"},
      {{7, 8, 200}, "got 8"}};
  for (const auto& [ids, given] : wrong_ids) {
    const Ids& its = ids;
    EXPECT_REFUSED((bvh_.InsertAs(its, three_)), "InsertAs", "ids",
                   "below 4294967295, each once", given);
  }
  bvh_.InsertAs({}, std::vector<Aabb3>());
  EXPECT_TRUE(AabbBvh3(Boxes3(nullptr, 0)).empty());
  AabbBvh3().SetMasks({});
}

TEST_F(BvhErrorsTest, ListsAreInMemory) {
  const auto expect_all = [&](const auto& bounds) {
    using Bound = std::decay_t<decltype(bounds[0])>;
    using List = Span<const Bound>;
    AabbBvh3 few(three_);
    Ids ids = {0, 1, 2};
    ExpectMemoryRefused("Bvh: ", "bounds: ", bounds,
                        [&](List list) { AabbBvh3 bad(list); });
    ExpectMemoryRefused("Bvh::Refit: ", "bounds: ", bounds,
                        [&](List list) { few.Refit(list); });
    ExpectMemoryRefused("Bvh::RefitInOrder: ", "bounds: ", bounds,
                        [&](List list) { few.RefitInOrder(list); });
    ExpectMemoryRefused("Bvh::Set: ", "bounds: ", bounds,
                        [&](List list) { few.Set(ids, list); });
    ExpectMemoryRefused("Bvh::Insert: ", "bounds: ", bounds,
                        [&](List list) { few.Insert(list, ids); });
    ExpectMemoryRefused("Bvh::InsertAs: ", "ids: ", Ids(4),
                        [&](Span<const std::uint32_t> given) {
                          few.InsertAs(given, List(bounds));
                        });
  };
  expect_all(three_);
  expect_all(std::vector<Aabb<3, double>>(3));
  ExpectMemoryRefused("Bvh::SetMasks: ", "masks: ", Ids(4),
                      [&](Span<const std::uint32_t> masks) {
                        AabbBvh3(three_).SetMasks(masks);
                      });
}

TEST_F(BvhErrorsTest, QueriesCheckTheirArguments) {
  const auto ignore = [](std::uint32_t, float) {};
  const std::vector<Aabb3> queries(3, Aabb3::Everything());
  const std::vector<Point3> points(3);
  const std::vector<HalfSpace3> many(65);
  std::vector<std::size_t> offsets(3);
  Ids ids(10);
  std::vector<float> distances(9);
  std::uint32_t* const no_ids = nullptr;
  EXPECT_REFUSED(
      (CountSurvivorsOfEach(bvh_, Boxes3(queries), {offsets.data(), 2})),
      "CountSurvivorsOfEach", "counts", "3", "2");
  EXPECT_REFUSED((AnySurvivor(bvh_, many)), "AnySurvivor", "half-spaces", "64",
                 "65");
  EXPECT_REFUSED((AnySurvivor(bvh_, HalfSpaces(nullptr, 1))), "AnySurvivor",
                 "half-spaces", "null");
  EXPECT_REFUSED((KNearest(bvh_, {}, ids, distances)), "KNearest", "distances",
                 "10", "9");
  EXPECT_REFUSED(
      (KNearestOfEach(bvh_, Span<const Point3>(nullptr, 3), 0, {}, {})),
      "KNearestOfEach: queries", "null");
  EXPECT_REFUSED((KNearest(bvh_, {}, {no_ids, 4}, {})), "KNearest", "ids",
                 "null");
  EXPECT_REFUSED((BoxCast(bvh_, Aabb3{}, {1, 0, 0}, 1, ignore,
                          {.target = Target::FromHighwayBit(3)})),
                 "BoxCast", "options.target", "no target");
  for (std::size_t k : {0u, 3u, 4u, 10u}) {
    EXPECT_REFUSED((KNearestOfEach(bvh_, points, k, ids, {})),
                   "KNearestOfEach: ids", "3 queries", "10");
  }
  for (float bad : {-1.0f, -kInf, kNan}) {
    EXPECT_REFUSED((ForEachNearest(bvh_, {}, bad, ignore)), "ForEachNearest",
                   "max_distance");
    EXPECT_REFUSED((RayCast(bvh_, Ray3{{}, {}, bad}, ignore)), "RayCast",
                   "max_t");
    EXPECT_REFUSED((BoxCast(bvh_, Aabb3{}, {1, 0, 0}, bad, ignore)), "BoxCast",
                   "max_t");
    EXPECT_REFUSED((Survivors(bvh_, Sphere3{{}, bad}, ids)), "Survivors",
                   "radius");
    EXPECT_REFUSED((CountSurvivors(bvh_, Capsule3{{}, {1, 1, 1}, bad})),
                   "CountSurvivors", "radius");
    EXPECT_REFUSED((AnySurvivor(bvh_, RoundedBox3{Aabb3{}, bad})),
                   "AnySurvivor", "radius");
  }
  BoxCast(bvh_, Aabb3{}, {1, 0, 0}, -0.0f, ignore);
}

// Whatever is wrong, and also where the shapes before it are right.
TEST_F(BvhErrorsTest, NothingIsWrittenBeforeAllIsChecked) {
  Canaried<std::uint32_t> canaried_ids;
  Canaried<std::size_t> canaried_offsets;
  const Span<std::uint32_t> ids = canaried_ids.Reset(100);
  const Span<std::size_t> offsets = canaried_offsets.Reset(4);
  const auto refused = [&](const auto& queries, Span<std::uint32_t> to_ids,
                           Span<std::size_t> to_offsets,
                           std::string_view argument, std::string_view given,
                           const QueryOptions& options = {}) {
    EXPECT_REFUSED(
        (SurvivorsOfEach(bvh_, queries, to_ids, to_offsets, options)),
        "SurvivorsOfEach: ", argument, "expected", "got", given);
    EXPECT_TRUE(canaried_ids.IntactBut(0)) << argument << ", " << given;
    EXPECT_TRUE(canaried_offsets.IntactBut(0)) << argument << ", " << given;
  };
  const auto queries_refused = [&](const auto& queries,
                                   std::string_view argument,
                                   std::string_view given) {
    refused(queries, ids, offsets, argument, given);
  };
  const Sphere3 sphere = {{0, 0, 0}, 100};
  const Capsule3 capsule = {{0, 0, 0}, {1, 1, 1}, 100};
  for (float radius : {-1.0f, kNan}) {
    const char* const given = radius < 0 ? "-1" : "nan";
    queries_refused(std::array{sphere, Sphere3{{}, radius}}, "radius", given);
    queries_refused(std::array{capsule, capsule, Capsule3{{}, {}, radius}},
                    "radius", given);
  }
  const std::vector<HalfSpace3> many(65);
  for (const auto& [bad, given] : BadHalfSpaces()) {
    queries_refused(std::array{HalfSpaces(), HalfSpaces(many.data(), 1), bad},
                    "half-spaces", given);
  }
  const auto lists_refused = [&](const auto& queries) {
    using Query = std::decay_t<decltype(queries[0])>;
    const Span<const Query> good(queries);
    const Query* const no_queries = nullptr;
    queries_refused(Span<const Query>(no_queries, 3), "queries", "null");
    queries_refused(Span<const Query>(Misaligned(queries.data()), 2), "queries",
                    "misaligned");
    std::uint32_t* const no_ids = nullptr;
    refused(good, {no_ids, 9}, offsets, "ids", "null");
    refused(good, {Misaligned(ids.data()), 9}, offsets, "ids", "misaligned");
    std::size_t* const no_offsets = nullptr;
    refused(good, ids, {no_offsets, 4}, "offsets", "null");
    refused(good, ids, {Misaligned(offsets.data()), 4}, "offsets",
            "misaligned");
    refused(good, ids, {offsets.data(), 3}, "offsets", "3");
    refused(good, ids, offsets, "options.target", "no target",
            {.target = Target::FromHighwayBit(3)});
  };
  lists_refused(std::array{sphere, sphere, sphere});
  lists_refused(std::array{HalfSpaces(), HalfSpaces(), HalfSpaces()});
  lists_refused(three_);
  // Aligned to its floats is not enough for a list of lists.
  const std::array<HalfSpaces, 3> lists;
  const auto* const shifted = reinterpret_cast<const HalfSpaces*>(
      reinterpret_cast<const float*>(lists.data()) + 1);
  queries_refused(Span<const HalfSpaces>(shifted, 2), "queries", "misaligned");
}

TEST_F(BvhErrorsTest, PairsCheckTheirArguments) {
  constexpr IdPair kCanary{0xABABABAB, 0xCDCDCDCD};
  std::vector<IdPair> pairs(10, kCanary);
  const auto refuses = [&](Span<const std::uint32_t> ids,
                           std::string_view expected, std::string_view given,
                           const PairOptions& options = {}) {
    EXPECT_REFUSED((PairsOf(bvh_, ids, pairs, options)), "PairsOf: ", expected,
                   "got", given);
    EXPECT_REFUSED((ForEachPairOf(
                       bvh_, ids, [](Span<const IdPair>) { FAIL(); }, options)),
                   "ForEachPairOf: ", expected, "got", given);
  };
  const std::string_view in_world = "ids[1]: expected the id of an object";
  refuses(Ids{1, 100}, in_world, "100");
  refuses(Ids{1, 0xFFFFFFFF}, in_world, "4294967295");
  refuses(Ids{1, 7}, in_world, "7");
  const Ids& ids = three_ids_;
  refuses({static_cast<const std::uint32_t*>(nullptr), 3},
          "ids: expected memory for 3 elements", "a null pointer");
  refuses({Misaligned(ids.data()), 2}, "ids: expected a pointer aligned",
          "a misaligned one");
  refuses(ids, "options.target", "no target",
          {.target = Target::FromHighwayBit(3)});
  for (float margin : {-1.0f, kInf, kNan}) {
    refuses(ids, "options.margin: expected a finite number", "",
            {.margin = margin});
    refuses(ids, "options.within: expected a finite number", "",
            {.within = margin});
  }
  refuses(ids, "options.within: expected 0 next to a margin", "0.5",
          {.margin = 1, .within = 0.5f});
  const Ids masks(4, 1);
  refuses(ids, "options.wanted: expected 3 masks", "4", {.wanted = masks});
  refuses(ids, "options.wanted: expected 3 masks", "a null pointer",
          {.wanted = {static_cast<const std::uint32_t*>(nullptr), 3}});
  refuses(ids, "options.wanted: expected a pointer aligned", "a misaligned one",
          {.wanted = {Misaligned(masks.data()), 3}});
  IdPair* const none = nullptr;
  EXPECT_REFUSED((Pairs(bvh_, pairs, {.wanted = masks})), "Pairs",
                 "options.wanted: expected no masks", "got", "4");
  EXPECT_REFUSED((Pairs(bvh_, Span<IdPair>(none, 10))), "Pairs", "pairs",
                 "10 pairs", "null");
  EXPECT_REFUSED((PairsOf(bvh_, ids, {Misaligned(pairs.data()), 9})), "PairsOf",
                 "pairs", "aligned", "misaligned");
  EXPECT_EQ(std::count(pairs.begin(), pairs.end(), kCanary), 10);
}

TEST(RejectShapesErrorsTest, RefuseWhatIsWrong) {
  const AabbWorld3 world(Spread(4.0f).Some(100));
  const std::vector<HalfSpace3> many(65);
  Canaried<std::uint32_t> canaried_ids;
  Canaried<std::uint64_t> canaried_mask;
  const Span<std::uint32_t> ids = canaried_ids.Reset(100);
  const Span<std::uint64_t> mask = canaried_mask.Reset(2);
  for (const auto& [bad, given] : BadHalfSpaces()) {
    const HalfSpaces its = bad;
    EXPECT_REFUSED((Survivors(world, its, ids)), "Survivors", "half-spaces",
                   given);
    EXPECT_REFUSED((CountSurvivors(world, its)), "CountSurvivors",
                   "half-spaces", given);
    EXPECT_REFUSED((AnySurvivor(world, its)), "AnySurvivor", "half-spaces",
                   given);
    EXPECT_REFUSED((SurvivorMask(world, its, mask)), "SurvivorMask",
                   "half-spaces", given);
  }
  // What all calls of reject.h refuse.
  const HalfSpaces one(many.data(), 1);
  AabbView3 no_planes = world.view();
  no_planes.max[1] = nullptr;
  EXPECT_REFUSED((SurvivorMask(world, one, {mask.data(), 1})), "SurvivorMask",
                 "mask", "at least 2 words", "got 1");
  EXPECT_REFUSED((Survivors(world, one, ids, {.range = {2, 1}})), "Survivors",
                 "options.range.end");
  EXPECT_REFUSED((CountSurvivors(no_planes, one)), "CountSurvivors",
                 "world.max[1]", "null");
  EXPECT_TRUE(canaried_ids.IntactBut(0));
  EXPECT_TRUE(canaried_mask.IntactBut(0));
}

// What a set takes comes from the world's resource. Without memory nothing is
// written and no function is called.
TEST(BvhPairsMemoryTest, OnlySetsThatAreSearchedOrLargeTakeMemory) {
  constexpr IdPair kCanary{0xABABABAB, 0xCDCDCDCD};
  CountingMemory memory;
  AabbBvh3 world(Spread(4.0f).Some(30000), {.memory = memory.resource()});
  std::size_t calls = 0;
  const auto function = [&](Span<const IdPair>) { ++calls; };
  for (bool is_changed : {false, true}) {
    if (is_changed) world.Set(5, Aabb3::Everything());
    for (std::uint32_t count : {3u, 63u, 200u}) {
      Ids ids(count);
      std::iota(ids.begin(), ids.end(), 0);
      const Ids wanted(count, 1);
      for (const PairOptions& options :
           {PairOptions(), PairOptions{.wanted = wanted}}) {
        std::vector<IdPair> pairs(1000, kCanary);
        const std::size_t taken = FailuresOf(
            memory, [&] { EXPECT_GT(PairsOf(world, ids, pairs, options), 0u); },
            [&] {
              EXPECT_EQ(std::count(pairs.begin(), pairs.end(), kCanary), 1000);
            });
        EXPECT_EQ(taken == 0, is_changed && count < 64) << count;
        calls = 0;
        FailuresOf(
            memory, [&] { ForEachPairOf(world, ids, function, options); },
            [&] { EXPECT_EQ(calls, 0u); });
        EXPECT_EQ(memory.blocks, 1u);
      }
    }
    memory.left = 0;
    ForEachPair(world, function);
    // Before anything is allocated.
    EXPECT_THROW((void)PairsOf(world, Ids{1, 30000}, {}),
                 std::invalid_argument);
    memory.left = CountingMemory::kNoLimit;
  }
}

}  // namespace
}  // namespace halfspace::testing

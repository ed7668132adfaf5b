// The ids that a BVH finds are the indices that a scan of the same
// bounds finds, as sets: of every kind of bounds, order, target and output.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cfenv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <limits>
#include <random>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "dispatch/bvh/tree.h"
#include "halfspace/halfspace.h"
#include "tests/library/bvh/spread.h"
#include "tests/library/support/canaries.h"
#include "tests/library/support/cases.h"
#include "tests/library/support/counting_memory.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/expect_invalid.h"
#include "tests/library/support/fp_modes.h"
#include "tests/library/support/inputs.h"
#include "tests/library/support/misaligned.h"

namespace halfspace::testing {
namespace {

constexpr std::array kOrders = {BuildQuality::kHigh, BuildQuality::kFast};

template <typename View>
Ids Expected(const View& view, const typename View::Query& query) {
  Ids ids(view.size);
  ids.resize(Survivors(view, query, ids));
  return ids;
}

// Every output, for each query by itself and for all in one call.
template <typename View>
void ExpectSame(const Bvh<View>& bvh, const View& view,
                std::span<const typename View::Query> queries, Target target) {
  ASSERT_EQ(bvh.size(), view.size);
  Canaried<std::uint32_t> canaried;
  Ids all;
  std::vector<std::size_t> expected_counts;
  for (const auto& query : queries) {
    const Ids expected = Expected(view, query);
    all.insert(all.end(), expected.begin(), expected.end());
    expected_counts.push_back(expected.size());
    const auto ids = canaried.Reset(view.size);
    ASSERT_EQ(Survivors(bvh, query, ids, {.target = target}), expected.size());
    ASSERT_EQ(InOrder(ids.first(expected.size())), expected);
    EXPECT_TRUE(canaried.IntactBut(view.size));
    EXPECT_EQ(CountSurvivors(bvh, query, {.target = target}), expected.size());
    const auto any = AnySurvivor(bvh, query, {.target = target});
    ASSERT_EQ(any.has_value(), !expected.empty());
    if (any) {
      EXPECT_TRUE(std::binary_search(expected.begin(), expected.end(), *any));
    }
    Ids visited;
    ForEachSurvivor(bvh, query,
                    [&](Span<const std::uint32_t> some) {
                      visited.insert(visited.end(), some.begin(), some.end());
                    },
                    {.target = target});
    EXPECT_EQ(InOrder(visited), expected);
  }
  std::vector<std::size_t> offsets(queries.size() + 1);
  const auto ids = canaried.Reset(all.size());
  ASSERT_EQ(SurvivorsOfEach(bvh, queries, ids, offsets, {.target = target}),
            all.size());
  EXPECT_TRUE(canaried.IntactBut(all.size()));
  for (std::size_t q = 0; q < queries.size(); ++q) {
    std::sort(ids.begin() + static_cast<std::ptrdiff_t>(offsets[q]),
              ids.begin() + static_cast<std::ptrdiff_t>(offsets[q + 1]));
  }
  EXPECT_TRUE(std::equal(ids.begin(), ids.end(), all.begin()));
  std::vector<std::size_t> counts(queries.size(), 99);
  CountSurvivorsOfEach(bvh, queries, counts, {.target = target});
  EXPECT_EQ(counts, expected_counts);
}

template <typename View>
void ExpectSameEverywhere(const View& view,
                          std::span<const typename View::Query> queries) {
  for (BuildQuality quality : kOrders) {
    const Bvh<View> bvh(view, {.quality = quality});
    for (Target target : TargetsUnderTest()) {
      ExpectSame<View>(bvh, view, queries, target);
      if (::testing::Test::HasFatalFailure()) {
        FAIL() << view.size << " objects, quality " << static_cast<int>(quality)
               << ", " << target.name();
      }
    }
  }
}

template <typename Case>
class BvhTest : public ::testing::Test {};
TYPED_TEST_SUITE(BvhTest, BvhCases, CaseNames);

TYPED_TEST(BvhTest, FindsWhatAScanFinds) {
  using View = typename TypeParam::View;
  std::vector<std::size_t> sizes = {0,   1,   2,    63,   64,   65,  127,
                                    128, 129, 4032, 4095, 4096, 4097};
  Random random(7);
  for (std::size_t i = 0; i < Scaled(20); ++i) sizes.push_back(random() % 9000);
  for (std::size_t size : sizes) {
    Spread<View> spread(4.0f, size);
    const World<View> world = spread.Objects(size);
    // More than walk together.
    const auto queries = spread.Queries(70);
    ExpectSameEverywhere<View>(world.view(), queries);
    if (this->HasFatalFailure()) return;
  }
}

// Three levels above the objects, and queries of all sizes.
TYPED_TEST(BvhTest, FindsWhatAScanFindsAmongMany) {
  using View = typename TypeParam::View;
  const World<View> world =
      Spread<View>(0.2f).Objects(64 * 4096 + Scaled(40'000));
  std::vector<typename View::Query> queries;
  for (float radius : {0.0f, 0.5f, 5.0f, 40.0f}) {
    queries.push_back(Spread<View>(radius, 2).NextQuery());
  }
  ExpectSameEverywhere<View>(world.view(), queries);
}

// Planes apart from each other and from any geometry: values that touch, one
// ulp apart, special, inverted.
TYPED_TEST(BvhTest, FindsWhatAScanFindsAmongSpecialValues) {
  using View = typename TypeParam::View;
  Random random(3);
  for (std::size_t round = 0; round < Scaled(60); ++round) {
    for (InputKind kind : kInputKinds) {
      const Input<View> input = MakeInput<View>(kind, 700, random);
      View view = ViewAt(input, 0, 1 + random() % 690, 8);
      std::vector<typename View::Query> queries(3, input.query);
      queries.push_back(MakeInput<View>(kind, 0, random).query);
      // Around all that is finite, and all that is not huge: whose nodes are
      // counted without a visit.
      queries.push_back(View::Query::Everything());
      for (std::size_t p = 0; p < kPlanes<View>; ++p) {
        OpposingValue<View>(queries.back(), p) =
            IsMinPlane<View>(p) ? 300.0f : -300.0f;
      }
      queries.push_back(View::Query::Everything());
      for (std::size_t p = 0; p < kPlanes<View>; ++p) {
        queries.push_back(input.query);
        OpposingValue<View>(queries.back(), p) = SpecialValue<float>(random);
      }
      ExpectSameEverywhere<View>(view, queries);
      if (this->HasFatalFailure()) {
        FAIL() << NameOf(kind) << ", round " << round;
      }
    }
  }
}

// Worlds without an order, with one only on some axes, and skewed by a few
// objects far away or far larger than the others.
TYPED_TEST(BvhTest, FindsWhatAScanFindsInDegenerateWorlds) {
  using View = typename TypeParam::View;
  using Bound = typename View::Bound;
  using Query = typename View::Query;
  Spread<View> spread(3.0f);
  const Bound one = spread.NextObject();
  const auto few_at = [&](float factor) {
    return [&, factor](std::size_t i) {
      Bound bound = spread.NextObject();
      for (std::size_t p = 0; i < 10 && p < kPlanes<View>; ++p) {
        StoredValue<View>(bound, p) *= factor;
      }
      return bound;
    };
  };
  // As long as that on some axes.
  const auto stretched = [&](float half, auto is_long) {
    Bound bound = spread.NextObject();
    for (std::size_t p = 0; p < kPlanes<View>; ++p) {
      if (!is_long(p % Bound::kAxes)) continue;
      StoredValue<View>(bound, p) = IsMinPlane<View>(p) ? -half : half;
    }
    return bound;
  };
  const std::vector<std::function<Bound(std::size_t)>> worlds = {
      [&](std::size_t) { return one; },
      [](std::size_t) { return Bound::Everything(); },
      [](std::size_t) { return Bound::Empty(); },
      [&](std::size_t i) { return i % 3 == 0 ? Bound::Empty() : one; },
      [&](std::size_t i) {
        return i % 50 == 0 ? Bound::Everything() : spread.NextObject();
      },
      [&](std::size_t i) {  // on a line
        Bound bound = one;
        for (std::size_t k = 0; k < Bound::kAxes; ++k) {
          StoredValue<View>(bound, k) = k == 0 ? static_cast<float>(i) : 1.0f;
        }
        return bound;
      },
      [&](std::size_t i) {  // a lattice, where all faces coincide
        Bound bound = one;
        for (std::size_t p = 0; p < kPlanes<View>; ++p) {
          const std::size_t k = p % Bound::kAxes;
          StoredValue<View>(bound, p) = static_cast<float>((i >> 4 * k) % 16) +
                                        (IsMinPlane<View>(p) ? 0.0f : 1.0f);
        }
        return bound;
      },
      few_at(1e4f),
      few_at(1e7f),
      few_at(1e30f),
      [&](std::size_t i) {  // a teapot in a stadium
        Bound bound = spread.NextObject();
        for (std::size_t p = 0; i % 10 != 0 && p < kPlanes<View>; ++p) {
          const std::size_t place = i % 20 * (p % Bound::kAxes + 1) % 20;
          StoredValue<View>(bound, p) *= 1e-3f;
          StoredValue<View>(bound, p) += 5.0f * static_cast<float>(place);
        }
        return bound;
      },
      [&](std::size_t i) {  // ground planes
        return i < 5 ? stretched(50.0f, [](std::size_t k) { return k != 1; })
                     : spread.NextObject();
      },
      [&](std::size_t i) {  // sizes over six decades
        const float decades = static_cast<float>(i % 61) / 10.0f - 4.0f;
        return Spread<View>(std::pow(10.0f, decades), i).NextObject();
      },
      [&](std::size_t) {  // all on one plane
        return stretched(0.0f, [](std::size_t k) { return k == 0; });
      },
      [&](std::size_t i) {  // one long object
        return i == 0 ? stretched(1e6f, [](std::size_t k) { return k == 0; })
                      : spread.NextObject();
      },
  };
  for (std::size_t w = 0; w < worlds.size(); ++w) {
    World<View> world;
    for (std::size_t i = 0; i < 4500; ++i) world.Push(worlds[w](i));
    std::vector<Query> queries = spread.Queries(20);
    queries.push_back(Query::Everything());
    queries.push_back(Query::Empty());
    Random random(w);
    for (std::size_t q = 0; q < 20; ++q) {
      Query query = queries[q];
      for (std::size_t p = 0; p < kPlanes<View>; ++p) {
        OpposingValue<View>(query, p) = static_cast<float>(random() % 16) +
                                        (IsMinPlane<View>(p) ? 1.0f : 0.0f);
      }
      queries.push_back(query);
    }
    // Those that an object just touches, the first ones among them.
    for (std::size_t i : {0, 1, 9, 11, 450, 2222}) {
      Bound object = world.Get(i);
      for (std::size_t p = 0; p < kPlanes<View>; ++p) {
        OpposingValue<View>(queries[i % 20], p) = StoredValue<View>(object, p);
      }
    }
    ExpectSameEverywhere<View>(world.view(), queries);
    if (this->HasFatalFailure()) FAIL() << "world " << w;
  }
}

// One block whose values are at every place of their scale, and queries at each
// of them and one ulp to both sides: a code that decides too much is found. In
// every rounding mode, and with subnormals flushed.
TYPED_TEST(BvhTest, CodesDecideOnlyWhatTheyProve) {
  using View = typename TypeParam::View;
  using Bound = typename View::Bound;
  using Query = typename View::Query;
  const float inf = std::numeric_limits<float>::infinity();
  // With 252.5 the values are at the ends of codes, where rounding tells.
  struct Scale {
    float base;
    float step;
    float last = 63.0f;
  };
  constexpr std::array<Scale, 12> kScales = {{{0.0f, 1.0f},
                                              {1.0f, 0x1p-23f},
                                              {1.0f, 0.1f},
                                              {-100.0f, 3.1f},
                                              {0.0f, 0x1p-149f},
                                              {0x1p-126f, 0x1p-149f},
                                              {-0x1p127f, 0x1.f8p121f},
                                              {1.0f, 0.0f},
                                              {0x1p99f, 0x1p94f},
                                              {0.0f, 3.1f, 252.5f},
                                              {0.3f, 0.7f, 252.5f},
                                              {-40.0f, 0.9f, 252.5f}}};
  for (const Scale& scale : kScales) {
    World<View> world;
    std::vector<float> values;
    for (std::size_t i = 0; i < 64; ++i) {
      values.push_back(scale.base +
                       (i < 63 ? static_cast<float>(i) : scale.last) *
                           scale.step);
    }
    for (std::size_t i = 0; i < 64; ++i) {
      Bound bound{};
      for (std::size_t p = 0; p < kPlanes<View>; ++p) {
        StoredValue<View>(bound, p) = values[(i * 37 + p) % 64];
      }
      world.Push(bound);
    }
    std::vector<Query> queries;
    for (std::size_t p = 0; p < kPlanes<View>; ++p) {
      for (float value : values) {
        for (float at :
             {value, std::nextafter(value, inf), std::nextafter(value, -inf)}) {
          Query query{};
          for (std::size_t other = 0; other < kPlanes<View>; ++other) {
            OpposingValue<View>(query, other) =
                IsMinPlane<View>(other) ? inf : -inf;
          }
          OpposingValue<View>(query, p) = at;
          queries.push_back(query);
        }
      }
    }
    const View view = world.view();
    for (int build_mode : {FE_TONEAREST, FE_UPWARD, FE_DOWNWARD}) {
      std::fesetround(build_mode);
      Bvh<View> bvh(view);
      bvh.Reserve(4097);  // a smaller world has no codes
      ASSERT_NE(detail::TreeOf(bvh).levels().codes, nullptr);
      for (int mode : {FE_TONEAREST, FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO}) {
        std::fesetround(mode);
        for (Target target : TargetsUnderTest()) {
          for (const Query& query : queries) {
            const std::size_t kept =
                CountSurvivors(bvh, query, {.target = target});
            const std::size_t expected = CountSurvivors(view, query);
            if (kept != expected) {
              std::fesetround(FE_TONEAREST);
              FAIL() << kept << " of " << expected << ", from " << scale.base
                     << " by " << scale.step << ", " << target.name();
            }
          }
        }
      }
      std::fesetround(FE_TONEAREST);
    }
    const Bvh<View> bvh(view);
    for (Target target : TargetsUnderTest()) {
      for (const Query& query : queries) {
        const FlushDenormals flush;
        ASSERT_EQ(CountSurvivors(bvh, query, {.target = target}),
                  CountSurvivors(view, query, {.target = target}));
      }
    }
  }
}

TYPED_TEST(BvhTest, IsTheSameWhicheverTargetBuildsIt) {
  using View = typename TypeParam::View;
  World<View> world = Spread<View>(3.0f).Objects(5000);
  // Blocks without a finite value.
  for (int i = 0; i < 200; ++i) world.Push(View::Bound::Empty());
  const std::vector<Target> targets = TargetsUnderTest();
  const Bvh<View> of_first(world, {.target = targets[0]});
  const detail::BvhLevels& first = detail::TreeOf(of_first).levels();
  for (Target target : targets) {
    const Bvh<View> of_other(world, {.target = target});
    const detail::BvhLevels& other = detail::TreeOf(of_other).levels();
    for (std::size_t l = 0; l < first.count; ++l) {
      const detail::BvhLevel& a = first.level[l];
      const detail::BvhLevel& b = other.level[l];
      ASSERT_EQ(a.size, b.size);
      const std::size_t values = (a.size + 63) / 64 * 64 * kPlanes<View>;
      for (std::size_t i = 0; i < values; ++i) {
        // Objects may have a NaN.
        ASSERT_EQ(std::bit_cast<std::uint32_t>(a.floats[i]),
                  std::bit_cast<std::uint32_t>(b.floats[i]))
            << "level " << l << ", " << target.name();
      }
      if (l > 0 || first.count == 1) continue;
      EXPECT_TRUE(std::equal(first.codes, first.codes + values, other.codes))
          << target.name();
    }
  }
}

TYPED_TEST(BvhTest, FillsAShortSpanAndCountsAll) {
  using View = typename TypeParam::View;
  Spread<View> spread(20.0f);
  const World<View> world = spread.Objects(3000);
  const Bvh<View> bvh(world.view());
  const auto queries = spread.Queries(5);
  Canaried<std::uint32_t> canaried;
  for (Target target : TargetsUnderTest()) {
    for (const auto& query : queries) {
      const Ids expected = Expected(world.view(), query);
      for (std::size_t room :
           {std::size_t{0}, std::size_t{1}, std::size_t{63}, std::size_t{200},
            expected.size() / 2, expected.size()}) {
        if (room > expected.size()) continue;
        const auto ids = canaried.Reset(room);
        ASSERT_EQ(Survivors(bvh, query, ids, {.target = target}),
                  expected.size());
        EXPECT_TRUE(canaried.IntactBut(room));
        const Ids written = InOrder(ids);
        EXPECT_TRUE(std::includes(expected.begin(), expected.end(),
                                  written.begin(), written.end()));
        EXPECT_EQ(std::adjacent_find(written.begin(), written.end()),
                  written.end());
      }
    }
  }
}

// A short span at a time, until all is written.
TYPED_TEST(BvhTest, GoesOnWhereASpanWasTooShort) {
  using View = typename TypeParam::View;
  using Query = typename View::Query;
  Spread<View> spread(20.0f);
  const World<View> world = spread.Objects(5000);
  const Bvh<View> bvh(world.view());
  const auto queries = spread.Queries(5);
  Canaried<std::uint32_t> canaried;
  for (Target target : TargetsUnderTest()) {
    const QueryOptions options = {.target = target};
    std::size_t skip = 0;
    std::vector<std::size_t> offsets(queries.size() + 1);
    for (std::size_t room : {7u, 64u, 100u, 1000u}) {
      const auto expect_all = [&](const auto& find, const Ids& expected) {
        Ids found;
        for (skip = 0; found.size() < expected.size(); skip += room) {
          const auto ids = canaried.Reset(room);
          ASSERT_EQ(find(ids), expected.size());
          const std::size_t left = expected.size() - skip;
          EXPECT_TRUE(canaried.IntactBut(room));
          found.insert(found.end(), ids.begin(),
                       ids.begin() + std::min(room, left));
        }
        EXPECT_EQ(InOrder(found), InOrder(expected));
        skip = std::numeric_limits<std::size_t>::max();
        ASSERT_EQ(find(canaried.Reset(room)), expected.size());
        EXPECT_TRUE(canaried.IntactBut(0));
      };
      Ids all;
      for (const Query& query : queries) {
        const Ids expected = Expected(world.view(), query);
        expect_all(
            [&](Span<std::uint32_t> ids) {
              return Survivors(bvh, query, ids, options, skip);
            },
            expected);
        all.insert(all.end(), expected.begin(), expected.end());
      }
      expect_all(
          [&](Span<std::uint32_t> ids) {
            return SurvivorsOfEach(bvh, Span<const Query>(queries), ids,
                                   offsets, options, skip);
          },
          all);
      EXPECT_EQ(offsets.back(), all.size());
    }
  }
}

TYPED_TEST(BvhTest, StopsWhenTheFunctionSaysSo) {
  using View = typename TypeParam::View;
  Spread<View> spread(40.0f);
  const World<View> world = spread.Objects(5000);
  const Bvh<View> bvh(world.view());
  for (Target target : TargetsUnderTest()) {
    std::size_t calls = 0;
    ForEachSurvivor(bvh, View::Query::Everything(),
                    [&](Span<const std::uint32_t> ids) {
                      EXPECT_GT(ids.size(), 0u);
                      return ++calls < 3 ? Visit::kContinue : Visit::kStop;
                    },
                    {.target = target});
    EXPECT_EQ(calls, 3u);
  }
}

// The first survivors are told before a second leaf is read, and statistics say
// so. One query adds to what another one counted.
TYPED_TEST(BvhTest, TellsTheFirstLeafAtOnce) {
  using View = typename TypeParam::View;
  const auto all = View::Query::Everything();
  for (std::size_t size : {64u, 4000u, 20'000u}) {
    const Bvh<View> bvh(Spread<View>(1.0f).Objects(size));
    const std::size_t leaves = (size + 63) / 64;
    for (Target target : TargetsUnderTest()) {
      QueryStatistics read;
      const QueryOptions options = {.target = target, .statistics = &read};
      EXPECT_TRUE(AnySurvivor(bvh, all, options).has_value());
      EXPECT_EQ(read.leaves, 1u);
      ForEachSurvivor(
          bvh, all,
          [](Span<const std::uint32_t> ids) {
            EXPECT_LE(ids.size(), 64u);
            return Visit::kStop;
          },
          options);
      EXPECT_EQ(read.leaves, 2u);
      Ids ids(size);
      EXPECT_EQ(Survivors(bvh, all, ids, options), size);
      EXPECT_EQ(read.leaves, 2 + leaves);
      read = {};
      EXPECT_EQ(Survivors(bvh, View::Query::Empty(), ids, options), 0u);
      EXPECT_EQ(read.node_blocks + read.leaves, 1u);
    }
  }
}

// Also where the codes of all objects are the query's and floats tell.
TEST(BvhKnownTest, TheFirstLeafIsReadAloneIfItsCodesAreUnsure) {
  const std::vector<Aabb3> boxes(10'000, Aabb3{{1, 1, 1}, {1, 1, 1}});
  const AabbBvh3 bvh((Span<const Aabb3>(boxes)));
  for (Target target : TargetsUnderTest()) {
    QueryStatistics read;
    EXPECT_TRUE(
        AnySurvivor(bvh, boxes[0], {.target = target, .statistics = &read})
            .has_value());
    EXPECT_EQ(read.leaves, 1u) << target.name();
  }
}

TYPED_TEST(BvhTest, AMaskOfNothingFindsNothing) {
  using View = typename TypeParam::View;
  constexpr int kDims = View::Bound::kDimensions;
  Bvh<View> bvh(Spread<View>(40.0f).Objects(5000));
  const auto all = View::Query::Everything();
  const QueryOptions options = {.mask = 0};
  for (bool has_masks : {false, true}) {
    if (has_masks) bvh.SetMasks(3, 5);
    Ids ids(bvh.size());
    std::vector<std::size_t> offsets(2, 7);
    EXPECT_EQ(Survivors(bvh, all, ids, options), 0u);
    EXPECT_EQ(CountSurvivors(bvh, all, options), 0u);
    EXPECT_FALSE(AnySurvivor(bvh, all, options).has_value());
    EXPECT_EQ(SurvivorsOfEach(bvh, Span<const typename View::Query>(&all, 1),
                              ids, offsets, options),
              0u);
    EXPECT_EQ(offsets, (std::vector<std::size_t>{0, 0}));
    EXPECT_EQ(CountSurvivors(bvh, Sphere<kDims>{{}, 100}, options), 0u);
    EXPECT_EQ(KNearest(bvh, Point<kDims>{}, ids, {}, 1e9f, {.mask = 0}), 0u);
    RayCast(bvh, Ray<kDims>{{}, {1}, 100},
            [](std::uint32_t id, float) { ADD_FAILURE() << id; }, {.mask = 0});
  }
}

// Objects on a line: each leaf must hold neighbours, for any distances.
TEST(BvhOrderTest, ALeafHasNeighboursOnALine) {
  constexpr std::size_t kObjects = 64 * 64 + 1000;
  constexpr float kMost = std::numeric_limits<float>::max();
  constexpr float kInf = std::numeric_limits<float>::infinity();
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
      {"outliers",
       [&](std::size_t i) {
         return i % 1000 == 0 ? 1e30f * share(i) : share(i);
       }},
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
    const Bvh<AabbView3> bvh(boxes);
    float last = -kInf;
    for (std::size_t first = 0; first < kObjects; first += 64) {
      float least = kInf;
      float greatest = -kInf;
      const std::size_t end = std::min(first + 64, kObjects);
      for (std::size_t s = first; s < end; ++s) {
        const float x = boxes[bvh.ids()[s]].min[0];
        least = std::min(least, x);
        greatest = std::max(greatest, x);
      }
      EXPECT_LE(last, least) << "in leaf " << first / 64;
      last = greatest;
    }
  }
}

// The bytes beyond the planes of floats that a BVH of boxes may have,
// ids and permutation included.
TEST(BvhMemoryTest, IsAtMostThreeQuartersOfTheFloats) {
  const AabbWorld3 world = Spread<AabbView3>(1.0f).Objects(200'000);
  CountingMemory memory;
  std::size_t bytes = 0;
  {
    const Bvh<AabbView3> bvh(world.view(), {.memory = memory.resource()});
    bytes = bvh.bytes();
    EXPECT_EQ(memory.blocks, 1u);
  }
  const double floats = 24.0 * 200'000;
  EXPECT_LE(static_cast<double>(bytes), 1.75 * floats);
}

TEST(BvhMemoryTest, CopiesMovesAndSwaps) {
  Spread<AabbView3> spread(4.0f);
  const AabbWorld3 world = spread.Objects(1000);
  const auto queries = spread.Queries(10);
  const Target target = ChosenTarget();
  Bvh<AabbView3> first(world.view());
  const Bvh<AabbView3> copy(first);
  ExpectSame<AabbView3>(copy, world.view(), queries, target);
  Bvh<AabbView3> second;
  EXPECT_TRUE(second.empty());
  EXPECT_EQ(CountSurvivors(second, queries[0]), 0u);
  swap(first, second);
  EXPECT_TRUE(first.empty());
  ExpectSame<AabbView3>(second, world.view(), queries, target);
  first = std::move(second);
  ExpectSame<AabbView3>(first, world.view(), queries, target);
  second = first;
  ExpectSame<AabbView3>(second, world.view(), queries, target);
}

// Offsets are those of all ids, of which the first are written.
TEST(BvhManyTest, FillsAShortSpan) {
  Spread<AabbView3> spread(20.0f);
  const AabbBvh3 bvh(spread.Objects(3000));
  const std::vector<Aabb3> queries = spread.Queries(70);
  std::vector<std::size_t> offsets(71);
  Ids all(70 * 3000);
  all.resize(SurvivorsOfEach(bvh, queries, all, offsets));
  Canaried<std::uint32_t> canaried;
  std::vector<std::size_t> same(71);
  for (std::size_t room : {std::size_t{0}, std::size_t{100}, all.size() - 1}) {
    const auto ids = canaried.Reset(room);
    EXPECT_EQ(SurvivorsOfEach(bvh, queries, ids, same), all.size());
    EXPECT_TRUE(canaried.IntactBut(room));
    EXPECT_EQ(same, offsets);
    EXPECT_TRUE(std::equal(ids.begin(), ids.end(), all.begin()));
  }
  EXPECT_EQ(SurvivorsOfEach(bvh, Span<const Aabb3>(), all, same), 0u);
  EXPECT_EQ(same[0], 0u);
  EXPECT_EQ(SurvivorsOfEach(AabbBvh3(), queries, all, same), 0u);
  EXPECT_EQ(same, std::vector<std::size_t>(71));
}

// Planes of one value, no numbers, and all that there is.
TEST(BvhFpModesTest, MakingAndChangingAWorldNeverTrap) {
  AabbWorld3 world;
  for (int i = 0; i < 200; ++i) {
    const auto x = static_cast<float>(i);
    world.Push({{x, 0.0f, 1e-40f}, {x + 1.0f, 0.0f, 3e38f}});
  }
  world.Push(Aabb3::Empty());
  world.Push(Aabb3::Everything());
  for (BuildQuality quality : kOrders) {
    const TrapExceptions traps;
    AabbBvh3 bvh(world, {.quality = quality});
    AabbBvh3 of_doubles(AabbWorld<3, double>(
        std::vector<Aabb<3, double>>(200, {{1e-310, -1e300, 0.1}, {}})));
    of_doubles.Insert(Aabb<3, double>::Everything());
    EXPECT_TRUE(traps.IsUntouched());
    // And changing it neither, to the next sorts of the newest and of all.
    for (std::uint32_t i = 0; i < 700; ++i) {
      bvh.Insert(world.Get(i % world.size()));
      bvh.Set(i % 100, world.Get((i + 1) % world.size()));
      if (i % 4 == 0 && bvh.Has(100 + i)) bvh.Erase(100 + i);
    }
    bvh.RebuildPartial(4096);
    bvh.Refit(std::vector<Aabb3>(1000, world.Get(7)));
    bvh.SetMasks(Ids(1000, 3));
    for (std::uint32_t id = 0; id < 800; ++id) {
      if (bvh.Has(id)) bvh.Erase(id);
    }
    (void)bvh.CostRatio();
    bvh.Rebuild({.quality = quality});
    EXPECT_TRUE(traps.IsUntouched());
  }
}

TEST(BvhErrorsTest, RefusesOptionsThatAreNone) {
  const AabbWorld3 world = Spread<AabbView3>(1.0f).Objects(100);
  AabbBvh3 bvh(world);
  const auto refused = [&](const BuildOptions& options,
                           std::initializer_list<std::string_view> parts) {
    EXPECT_TRUE(Refuses([&] { AabbBvh3 bad(world, options); }, parts));
    EXPECT_TRUE(Refuses([&] { bvh.Rebuild(options); }, parts));
  };
  refused({.quality = static_cast<BuildQuality>(2)},
          {"Bvh: ", "quality", "BuildQuality", "2"});
  refused({.target = Target::FromHighwayBit(3)}, {"Bvh: ", "target"});
  EXPECT_EQ(bvh.size(), 100u);
}

TEST(BvhErrorsTest, RefusesAListThatItCannotRead) {
  using List = Span<const Aabb3>;
  const std::vector<Aabb3> bounds(3, Aabb3::Everything());
  AabbBvh3 bvh((List(bounds)));
  bvh.SetMasks(Ids{1, 2, 4});
  const auto refused = [](std::string_view call, std::string_view argument,
                          const auto& made) {
    EXPECT_TRUE(Refuses([&] { made(false); },
                        {call, argument, "expected memory for 3 elements",
                         "got a null pointer"}));
    EXPECT_TRUE(Refuses([&] { made(true); },
                        {call, argument, "expected a pointer aligned to 4",
                         "got a misaligned one"}));
  };
  const Aabb3* const none = nullptr;
  const auto list = [&](bool is_misaligned) {
    return List(is_misaligned ? Misaligned(bounds.data()) : none, 3);
  };
  refused("Bvh: ", "bounds: ", [&](bool is_misaligned) {
    AabbBvh3 bad(list(is_misaligned));
  });
  refused("Bvh::Refit: ", "bounds: ", [&](bool is_misaligned) {
    bvh.Refit(list(is_misaligned));
  });
  const Ids masks(4);
  const std::uint32_t* const no_masks = nullptr;
  refused("Bvh::SetMasks: ", "masks: ", [&](bool is_misaligned) {
    bvh.SetMasks({is_misaligned ? Misaligned(masks.data()) : no_masks, 3});
  });
  EXPECT_EQ(CountSurvivors(bvh, Aabb3::Everything(), {.mask = 2}), 1u);
  EXPECT_TRUE(AabbBvh3(List(none, 0)).empty());
  // An empty list, as an empty vector, changes nothing.
  EXPECT_TRUE(Refuses(
      [&] {
        bvh.SetMasks({no_masks, 0});
      },
      {"Bvh::SetMasks: masks: expected a mask for each id, at "
       "least 3, got 0"}));
  EXPECT_EQ(CountSurvivors(bvh, Aabb3::Everything(), {.mask = 2}), 1u);
  bvh.SetMasks(masks);
  EXPECT_EQ(CountSurvivors(bvh, Aabb3::Everything(), {.mask = 2}), 0u);
  AabbBvh3().SetMasks({no_masks, 0});
}

// Its block has a level of nodes for the others. asan sees what a change of a
// list writes behind its scratch memory.
TEST(BvhTest, FewObjectsWithRoomForManyChangeAsAList) {
  AabbWorld3 world = Spread<AabbView3>(4.0f).Objects(10);
  AabbBvh3 bvh(world.view());
  bvh.Reserve(1000);
  Ids ids;
  std::vector<Aabb3> bounds;
  for (std::uint32_t id = 0; id < 10; ++id) {
    ids.push_back(9 - id);
    bounds.push_back(world.Get(id));
  }
  bvh.Set(ids, bounds);
  for (std::uint32_t id = 0; id < 10; ++id) {
    EXPECT_EQ(bvh.Get(9 - id), bounds[id]);
  }
}

TEST(BvhErrorsTest, RefusesWhatItCannotRead) {
  const AabbWorld3 world = Spread<AabbView3>(4.0f).Objects(100);
  const Bvh<AabbView3> bvh(world.view());
  Ids ids(100);
  std::vector<std::size_t> offsets(3);
  const std::vector<Aabb3> queries(3, Aabb3::Everything());
  EXPECT_TRUE(Refuses(
      [&] {
        (void)SurvivorsOfEach(bvh, std::span<const Aabb3>(queries), ids,
                              offsets);
      },
      {"SurvivorsOfEach", "offsets", "4", "3"}));
  EXPECT_TRUE(Refuses(
      [&] {
        CountSurvivorsOfEach(bvh, std::span<const Aabb3>(queries),
                             Span<std::size_t>(offsets.data(), 2));
      },
      {"CountSurvivorsOfEach", "counts", "3", "2"}));
  AabbView3 view = world.view();
  view.max[1] = nullptr;
  EXPECT_TRUE(Refuses([&] { Bvh<AabbView3> bad(view); },
                      {"Bvh", "world.max[1]", "null"}));
}

}  // namespace
}  // namespace halfspace::testing

// The pairs of BVHs are those that no plane separates, compared one by
// one: of every kind of bounds, order, target and output, after any history.

#include <gtest/gtest.h>

#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <iterator>
#include <limits>
#include <map>
#include <new>
#include <random>
#include <span>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include "halfspace/halfspace.h"
#include "tests/library/bvh/separated.h"
#include "tests/library/bvh/spread.h"
#include "tests/library/support/cases.h"
#include "tests/library/support/counting_memory.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/expect_invalid.h"
#include "tests/library/support/fp_modes.h"
#include "tests/library/support/inputs.h"
#include "tests/library/support/misaligned.h"

namespace halfspace::testing {
namespace {

using PairList = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

// What a world has: the bound and the masks of each id.
template <typename Bound>
struct Object {
  Bound bound;
  std::uint32_t masks = 0xFFFFFFFF;
};
template <typename Bound>
using Objects = std::map<std::uint32_t, Object<Bound>>;

template <typename View>
Objects<typename View::Bound> ObjectsOf(const World<View>& world) {
  Objects<typename View::Bound> objects;
  for (std::uint32_t i = 0; i < world.size(); ++i) {
    objects[i] = {world.Get(i)};
  }
  return objects;
}

template <typename Bound>
bool HavePair(const Object<Bound>& a, const Object<Bound>& b,
              std::uint32_t masks) {
  return (~masks == 0 || ((a.masks & masks) != 0 && (b.masks & masks) != 0)) &&
         !AreSeparated(a.bound, b.bound);
}

// Of one world, the lesser id first.
template <typename Bound>
PairList ExpectedPairs(const Objects<Bound>& objects,
                       std::uint32_t masks = 0xFFFFFFFF) {
  PairList pairs;
  for (auto a = objects.begin(); a != objects.end(); ++a) {
    for (auto b = std::next(a); b != objects.end(); ++b) {
      if (HavePair(a->second, b->second, masks)) {
        pairs.emplace_back(a->first, b->first);
      }
    }
  }
  return pairs;
}

template <typename Bound>
PairList ExpectedPairs(const Objects<Bound>& as, const Objects<Bound>& bs,
                       std::uint32_t masks = 0xFFFFFFFF) {
  PairList pairs;
  for (const auto& [i, a] : as) {
    for (const auto& [j, b] : bs) {
      if (HavePair(a, b, masks)) pairs.emplace_back(i, j);
    }
  }
  return pairs;
}

// What the objects of a set want of the masks of others, by id.
using Wanted = std::map<std::uint32_t, std::uint32_t>;

bool Wants(const Wanted& wanted, std::uint32_t id, std::uint32_t mask) {
  const auto it = wanted.find(id);
  return it != wanted.end() && (~it->second == 0 || (it->second & mask) != 0);
}

PairList InOrder(std::span<const IdPair> pairs, bool is_one_world) {
  PairList sorted;
  for (const IdPair& pair : pairs) {
    sorted.emplace_back(pair.a, pair.b);
    if (is_one_world && pair.a > pair.b) {
      std::swap(sorted.back().first, sorted.back().second);
    }
  }
  std::sort(sorted.begin(), sorted.end());
  return sorted;
}

// The pairs of pairs(span, options) in all ways to ask for them: with room,
// with less, without, some at a time, and in parts.
template <typename Find, typename ForEach>
void ExpectPairs(const PairList& expected, bool is_one_world, std::size_t parts,
                 PairOptions options, const Find& find,
                 const ForEach& for_each) {
  constexpr IdPair kCanary{0xABABABAB, 0xCDCDCDCD};
  for (std::size_t room : {expected.size() + 3, expected.size(),
                           expected.size() / 2, std::size_t{0}}) {
    if (Scaled(10) == 1 && room == expected.size()) continue;
    std::vector<IdPair> pairs(room + 2 * 64, kCanary);
    const auto usable = std::span(pairs).subspan(64, room);
    ASSERT_EQ(find(usable, options), expected.size());
    const std::size_t written = std::min(room, expected.size());
    const PairList got = InOrder(usable.first(written), is_one_world);
    if (written == expected.size()) {
      ASSERT_EQ(got, expected);
    } else {
      ASSERT_TRUE(std::includes(expected.begin(), expected.end(), got.begin(),
                                got.end()));
      ASSERT_EQ(std::adjacent_find(got.begin(), got.end()), got.end());
    }
    for (std::size_t i = 0; i < 64; ++i) {
      ASSERT_EQ(pairs[i], kCanary);
      ASSERT_EQ(pairs[64 + room + i], kCanary);
    }
  }
  // Continued where there was no room for more.
  std::vector<IdPair> continued;
  const std::size_t room = expected.size() / 3 + 1;
  for (options.skip = 0; options.skip < expected.size(); options.skip += room) {
    std::vector<IdPair> pairs(room + 1, kCanary);
    ASSERT_EQ(find(std::span(pairs).first(room), options), expected.size());
    ASSERT_EQ(pairs.back(), kCanary);
    pairs.resize(std::min(room, expected.size() - options.skip));
    continued.insert(continued.end(), pairs.begin(), pairs.end());
    if (options.skip == room) {
      std::size_t left = 0;
      for_each([&](Span<const IdPair> some) { left += some.size(); }, options);
      ASSERT_EQ(left, expected.size() - room);
    }
  }
  ASSERT_EQ(InOrder(continued, is_one_world), expected);
  options.skip = expected.size() + 1;
  for_each([&](Span<const IdPair>) { FAIL(); }, options);
  options.skip = 0;
  std::vector<IdPair> visited;
  for (options.begin = 0; options.begin < parts; options.begin = options.end) {
    options.end = options.begin + 1 + parts / 3;
    for_each(
        [&](Span<const IdPair> some) {
          ASSERT_GT(some.size(), 0u);
          ASSERT_LE(some.size(), 256u);
          visited.insert(visited.end(), some.begin(), some.end());
        },
        options);
  }
  ASSERT_EQ(InOrder(visited, is_one_world), expected);
  options.begin = 0;
  options.end = parts;
  std::size_t calls = 0;
  for_each(
      [&](Span<const IdPair>) {
        return ++calls < 2 ? Visit::kContinue : Visit::kStop;
      },
      options);
  ASSERT_EQ(calls == 0, expected.empty());
  ASSERT_LE(calls, 2u);
  ASSERT_TRUE(calls == 2 || expected.size() <= 256);
}

// Sets of a few, which want all or only some, and of none, one, most and all.
template <typename Bound>
std::vector<Wanted> SetsIn(const Objects<Bound>& objects, bool is_brief) {
  std::vector<Wanted> sets;
  for (std::uint32_t share : {0u, 1u, 7u, 60u, 64u}) {
    if ((is_brief || Scaled(10) == 1) && share != 7) continue;
    Wanted set;
    for (const auto& [id, object] : objects) {
      if (share == 1 ? set.empty() : id * 37 % 64 < share) {
        set[id] = 0xFFFFFFFF;
      }
    }
    sets.push_back(set);
    if (share < 7) continue;
    for (auto& [id, wanted] : set) {
      wanted = id % 5 == 0 ? 0xFFFFFFFF : id % 5 == 1 ? 0 : 1 + id % 7;
    }
    sets.push_back(std::move(set));
  }
  return sets;
}

// The pairs of a set, each id twice, with others: of the same world or of
// another.
template <typename View>
void ExpectPairsOfSet(const PairList& expected, const Bvh<View>& world,
                      const Wanted& set, const Bvh<View>* other,
                      const Objects<typename View::Bound>& others,
                      PairOptions options) {
  Ids ids;
  std::vector<std::uint32_t> wanted;
  bool wants_all = true;
  for (std::uint32_t some : {2u, ~2u}) {
    for (auto it = set.rbegin(); it != set.rend(); ++it) {
      const bool is_all = ~it->second == 0;
      ids.push_back(it->first);
      wanted.push_back(is_all ? it->second : it->second & some);
      wants_all &= is_all;
    }
  }
  if (!wants_all) options.wanted = wanted;
  ExpectPairs(
      expected, other == nullptr, PairParts(world), options,
      [&](Span<IdPair> pairs, const PairOptions& asked) {
        return other == nullptr ? PairsOf(world, ids, pairs, asked)
                                : PairsOf(world, ids, *other, pairs, asked);
      },
      [&](auto function, const PairOptions& asked) {
        const auto visit = [&](Span<const IdPair> some) {
          for (const IdPair& pair : some) {
            EXPECT_TRUE(Wants(set, pair.a, others.at(pair.b).masks));
          }
          return function(some);
        };
        if (other == nullptr) {
          ForEachPairOf(world, ids, visit, asked);
        } else {
          ForEachPairOf(world, ids, *other, visit, asked);
        }
      });
}

template <typename View>
void ExpectPairsOf(const Bvh<View>& world,
                   const Objects<typename View::Bound>& objects,
                   const PairOptions& options) {
  ASSERT_EQ(world.size(), objects.size());
  const PairList expected = ExpectedPairs(objects, options.mask);
  ExpectPairs(
      expected, true, PairParts(world), options,
      [&](Span<IdPair> pairs, const PairOptions& asked) {
        return Pairs(world, pairs, asked);
      },
      [&](auto function, const PairOptions& asked) {
        ForEachPair(world, function, asked);
      });
  for (const Wanted& set : SetsIn(objects, false)) {
    if (::testing::Test::HasFatalFailure()) return;
    PairList of_set;
    for (const auto& [a, b] : expected) {
      if (Wants(set, a, objects.at(b).masks) ||
          Wants(set, b, objects.at(a).masks)) {
        of_set.emplace_back(a, b);
      }
    }
    ExpectPairsOfSet<View>(of_set, world, set, nullptr, objects, options);
  }
}

template <typename View>
void ExpectPairsOf(const Bvh<View>& a,
                   const Objects<typename View::Bound>& of_a,
                   const Bvh<View>& b,
                   const Objects<typename View::Bound>& of_b,
                   const PairOptions& options) {
  const PairList expected = ExpectedPairs(of_a, of_b, options.mask);
  ExpectPairs(
      expected, false, PairParts(a), options,
      [&](Span<IdPair> pairs, const PairOptions& asked) {
        return Pairs(a, b, pairs, asked);
      },
      [&](auto function, const PairOptions& asked) {
        ForEachPair(a, b, function, asked);
      });
  for (const Wanted& set : SetsIn(of_a, true)) {
    if (::testing::Test::HasFatalFailure()) return;
    PairList of_set;
    for (const auto& [i, j] : expected) {
      if (Wants(set, i, of_b.at(j).masks)) of_set.emplace_back(i, j);
    }
    ExpectPairsOfSet<View>(of_set, a, set, &b, of_b, options);
  }
}

// The pairs in a world, and of it and another, in all orders, on all targets.
template <typename View>
void ExpectPairsEverywhere(const World<View>& world, const World<View>& other) {
  const auto objects = ObjectsOf(world);
  const auto others = ObjectsOf(other);
  for (BuildQuality quality : {BuildQuality::kHigh, BuildQuality::kFast}) {
    if (Scaled(10) == 1 && quality == BuildQuality::kFast) continue;
    const Bvh<View> a(world, {.quality = quality});
    const Bvh<View> b(other, {.quality = quality});
    for (Target target : TargetsUnderTest()) {
      ExpectPairsOf(a, objects, {.target = target});
      ExpectPairsOf(a, objects, b, others, {.target = target});
      ExpectPairsOf(b, others, a, objects, {.target = target});
      if (::testing::Test::HasFatalFailure()) {
        FAIL() << world.size() << " objects, quality "
               << static_cast<int>(quality) << ", " << target.name();
      }
    }
  }
}

using PairCases = Tested<::testing::Types<Whole<AabbView2>, Whole<AabbView3>,
                                          Whole<AaboView2>, Whole<AaboView3>>>;
template <typename Case>
class BvhPairsTest : public ::testing::Test {};
TYPED_TEST_SUITE(BvhPairsTest, PairCases, CaseNames);

TYPED_TEST(BvhPairsTest, AreThoseThatNoPlaneSeparates) {
  using View = typename TypeParam::View;
  std::vector<std::size_t> sizes = {0, 1, 2, 63, 64, 65, 128, 129, 700};
  Random random(7);
  for (std::size_t i = 0; i < Scaled(6); ++i) sizes.push_back(random() % 1500);
  for (std::size_t size : sizes) {
    Spread<View> spread(6.0f, size);
    const World<View> world = spread.Objects(size);
    ExpectPairsEverywhere(world, spread.Objects(random() % 300));
    if (this->HasFatalFailure()) return;
  }
}

// Two levels above the objects.
TYPED_TEST(BvhPairsTest, AreThoseThatNoPlaneSeparatesAmongMany) {
  using View = typename TypeParam::View;
  Spread<View> spread(1.0f);
  ExpectPairsEverywhere(spread.Objects(4097), spread.Objects(100));
}

// Bounds made apart from any geometry: values that touch, one ulp apart,
// special, inverted.
TYPED_TEST(BvhPairsTest, AreThoseThatNoPlaneSeparatesAmongSpecialValues) {
  using View = typename TypeParam::View;
  Random random(3);
  for (std::size_t round = 0; round < Scaled(4); ++round) {
    for (InputKind kind : kInputKinds) {
      const Input<View> input = MakeInput<View>(kind, 400, random);
      View view = ViewAt(input, 0, 1 + random() % 390, 8);
      World<View> world;
      World<View> other;
      for (std::size_t i = 0; i < view.size; ++i) {
        typename View::Bound bound{};
        for (std::size_t p = 0; p < kPlanes<View>; ++p) {
          StoredValue<View>(bound, p) = PlaneOf(view, p)[i];
        }
        (i % 3 == 0 ? other : world).Push(bound);
        if (i % 5 == 0) {  // also faces that meet, and inverted bounds
          for (std::size_t k = 0; k < View::Bound::kAxes; ++k) {
            std::swap(bound.min[k], bound.max[k]);
          }
          world.Push(bound);
        }
      }
      ExpectPairsEverywhere(world, other);
      if (this->HasFatalFailure()) {
        FAIL() << NameOf(kind) << ", round " << round;
      }
    }
  }
}

TYPED_TEST(BvhPairsTest, AreThoseThatNoPlaneSeparatesInDegenerateWorlds) {
  using View = typename TypeParam::View;
  using Bound = typename View::Bound;
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  Spread<View> spread(3.0f);
  const Bound one = spread.NextObject();
  const std::vector<std::function<Bound(std::size_t)>> worlds = {
      [&](std::size_t) { return one; },
      [](std::size_t) { return Bound::Everything(); },
      [](std::size_t) { return Bound::Empty(); },
      [&](std::size_t i) { return i % 3 == 0 ? Bound::Empty() : one; },
      [&](std::size_t i) {
        return i % 50 == 0   ? Bound::Everything()
               : i % 50 == 1 ? Bound::Empty()
                             : spread.NextObject();
      },
      [&](std::size_t i) {  // NaN in one plane, or in all
        Bound bound = spread.NextObject();
        for (std::size_t p = 0; p < kPlanes<View>; ++p) {
          if (i % 40 == 7 || i % 90 == p) StoredValue<View>(bound, p) = kNan;
        }
        return bound;
      },
      [&](std::size_t i) {  // a lattice, where all faces coincide
        Bound bound = one;
        for (std::size_t p = 0; p < kPlanes<View>; ++p) {
          const std::size_t k = p % Bound::kAxes;
          StoredValue<View>(bound, p) = static_cast<float>((i >> 3 * k) % 8) +
                                        (IsMinPlane<View>(p) ? 0.0f : 1.0f);
        }
        return bound;
      },
  };
  for (std::size_t w = 0; w < worlds.size(); ++w) {
    World<View> world;
    World<View> other;
    for (std::size_t i = 0; i < 330; ++i) {
      (i % 8 == 3 ? other : world).Push(worlds[w](i));
    }
    other.Push(Bound::Everything());
    other.Push(Bound::Empty());
    ExpectPairsEverywhere(world, other);
    if (this->HasFatalFailure()) FAIL() << "world " << w;
  }
}

// Erased slots are in no pair, also not with what overlaps everything.
TYPED_TEST(BvhPairsTest, AreThoseOfTheObjectsThatThereAre) {
  using View = typename TypeParam::View;
  using Bound = typename View::Bound;
  Random random(5);
  const std::vector<Target> targets = TargetsUnderTest();
  for (std::size_t round = 0; round < std::max<std::size_t>(2, Scaled(4));
       ++round) {
    Spread<View> spread(5.0f, round);
    const World<View> world = spread.Objects(round == 0 ? 0 : 300);
    Objects<Bound> objects = ObjectsOf(world);
    Bvh<View> bvh(world);
    for (std::size_t step = 0; step < 10; ++step) {
      for (std::size_t i = random() % 150; i-- > 0;) {
        const std::size_t what = random() % 8;
        if (what < 3 || objects.empty()) {
          const Bound bound =
              what == 0 ? Bound::Everything() : spread.NextObject();
          objects[bvh.Insert(bound)] = {bound};
          continue;
        }
        auto it = objects.lower_bound(
            static_cast<std::uint32_t>(random() % objects.size()));
        if (it == objects.end()) it = objects.begin();
        if (what < 7) {
          bvh.Erase(it->first);
          objects.erase(it);
        } else if (step > 6) {
          it->second.masks = 1u << random() % 3;
          bvh.SetMasks(it->first, it->second.masks);
        }
      }
      if (step == 8) bvh.Rebuild();
      const Target target = targets[random() % targets.size()];
      const World<View> other = spread.Objects(80);
      for (std::uint32_t masks : {0xFFFFFFFFu, 1u, 6u}) {
        const PairOptions options{.mask = masks, .target = target};
        ExpectPairsOf(bvh, objects, options);
        ExpectPairsOf(bvh, objects, Bvh<View>(other), ObjectsOf(other),
                      options);
        if (this->HasFatalFailure()) {
          FAIL() << "round " << round << ", step " << step;
        }
      }
    }
  }
}

// What is nearer than the margin is found, and nothing that is farther away by
// more than rounding: by all calls.
template <typename View>
void ExpectNearPairs(const World<View>& world, const World<View>& other,
                     float margin) {
  const auto objects = ObjectsOf(world);
  const auto others = ObjectsOf(other);
  const Bvh<View> a(world);
  const Bvh<View> b(other);
  Ids few;
  for (std::uint32_t id = 0; id < world.size(); id += 9) few.push_back(id);
  for (Target target : TargetsUnderTest()) {
    const PairOptions options{.margin = margin, .target = target};
    const auto expect = [&](bool is_one_world, bool is_of_few,
                            const auto& find) {
      std::vector<IdPair> pairs(find(Span<IdPair>()));
      ASSERT_EQ(find(pairs), pairs.size());
      const PairList got = InOrder(pairs, is_one_world);
      ASSERT_EQ(std::adjacent_find(got.begin(), got.end()), got.end());
      for (const auto& [i, a_of_pair] : objects) {
        for (const auto& [j, b_of_pair] : is_one_world ? objects : others) {
          if (is_one_world && j <= i) continue;
          if (is_of_few && i % 9 != 0 && (!is_one_world || j % 9 != 0)) {
            continue;
          }
          const bool is_found =
              std::binary_search(got.begin(), got.end(), std::pair(i, j));
          if (is_found) {
            ASSERT_FALSE(AreSeparated(a_of_pair.bound, b_of_pair.bound, margin,
                                      0x1p-21));
          } else {
            ASSERT_TRUE(AreSeparated(a_of_pair.bound, b_of_pair.bound, margin));
          }
        }
      }
    };
    expect(true, false,
           [&](Span<IdPair> pairs) { return Pairs(a, pairs, options); });
    expect(false, false,
           [&](Span<IdPair> pairs) { return Pairs(a, b, pairs, options); });
    expect(true, true,
           [&](Span<IdPair> pairs) { return PairsOf(a, few, pairs, options); });
    expect(false, true, [&](Span<IdPair> pairs) {
      return PairsOf(a, few, b, pairs, options);
    });
    if (::testing::Test::HasFatalFailure()) {
      FAIL() << world.size() << " objects, margin " << margin << ", "
             << target.name();
    }
  }
}

TYPED_TEST(BvhPairsTest, WithAMarginAreThoseThatAreNear) {
  using View = typename TypeParam::View;
  for (float margin : {0.5f, 7.0f, 1e-30f, 1e-42f, 3e38f}) {
    for (std::size_t size : {50u, 500u}) {
      Spread<View> spread(3.0f, size);
      ExpectNearPairs(spread.Objects(size), spread.Objects(90), margin);
      if (this->HasFatalFailure()) return;
    }
  }
  Random random(8);
  for (InputKind kind : kInputKinds) {
    const Input<View> input = MakeInput<View>(kind, 200, random);
    View view = ViewAt(input, 0, 190, 8);
    World<View> world;
    World<View> other;
    for (std::size_t i = 0; i < view.size; ++i) {
      typename View::Bound bound{};
      for (std::size_t p = 0; p < kPlanes<View>; ++p) {
        StoredValue<View>(bound, p) = PlaneOf(view, p)[i];
      }
      (i % 3 == 0 ? other : world).Push(bound);
    }
    world.Push(View::Bound::Empty());
    for (float margin : {1e-3f, 1.0f, 1e30f}) {
      ExpectNearPairs(world, other, margin);
      if (this->HasFatalFailure()) FAIL() << NameOf(kind);
    }
  }
}

// Sets in a world of more blocks than the sets have room for: near each other,
// far apart, and at distances that are powers of two.
TEST(BvhPairsOfManyTest, AreThoseOfAllPairsThatTouchTheSet) {
  using View = AabbView3;
  const World<View> world = Spread<View>(1.5f).Objects(64 * 1024);
  Bvh<View> bvh(world, {.quality = BuildQuality::kFast});
  std::vector<IdPair> all(Pairs(bvh, Span<IdPair>()));
  ASSERT_EQ(Pairs(bvh, all), all.size());
  for (bool has_slots : {false, true}) {
    if (has_slots) bvh.Set(0, bvh.Get(0));
    for (std::size_t step : {std::size_t{1}, std::size_t{64}, std::size_t{4160},
                             std::size_t{8192}, std::size_t{16384}}) {
      for (std::size_t size : {2u, 5u, 63u, 64u, 200u}) {
        Ids ids;
        for (std::size_t s = 0; s < bvh.ids().size() && ids.size() < size;
             s += step) {
          ids.push_back(bvh.ids()[s]);
        }
        std::vector<bool> is_in(world.size());
        for (std::uint32_t id : ids) is_in[id] = true;
        std::vector<IdPair> expected;
        for (const IdPair& pair : all) {
          if (is_in[pair.a] || is_in[pair.b]) expected.push_back(pair);
        }
        std::vector<IdPair> got(expected.size());
        ASSERT_EQ(PairsOf(bvh, ids, got), got.size()) << step << ' ' << size;
        ASSERT_EQ(InOrder(got, true), InOrder(expected, true));
      }
    }
  }
}

// What a set takes comes from the world's resource. Without memory nothing is
// written and no function is called.
TEST(BvhPairsMemoryTest, OnlySetsThatAreSearchedOrLargeTakeMemory) {
  constexpr IdPair kCanary{0xABABABAB, 0xCDCDCDCD};
  for (Failure failure : {Failure::kThrows, Failure::kReturnsNull}) {
    CountingMemory memory(failure);
    AabbBvh3 world(Spread<AabbView3>(4.0f).Objects(30000).view(),
                   {.memory = memory.resource()});
    for (bool is_changed : {false, true}) {
      if (is_changed) world.Set(5, Aabb3::Everything());
      for (std::uint32_t count : {3u, 63u, 200u}) {
        Ids ids;
        for (std::uint32_t i = 0; i < count; ++i) ids.push_back(i);
        const std::vector<std::uint32_t> wanted(count, 1);
        std::vector<IdPair> pairs(1000, kCanary);
        std::size_t calls = 0;
        const auto function = [&](Span<const IdPair>) { ++calls; };
        for (const PairOptions& options :
             {PairOptions(), PairOptions{.wanted = wanted}}) {
          const std::size_t before = memory.allocations;
          EXPECT_GT(PairsOf(world, ids, Span<IdPair>(), options), 0u);
          const std::size_t taken = memory.allocations - before;
          EXPECT_EQ(taken == 0, is_changed && count < 64) << count;
          EXPECT_EQ(memory.blocks, 1u);
          for (memory.left = 0; memory.left < taken;) {
            const std::size_t left = memory.left;
            EXPECT_THROW((void)PairsOf(world, ids, pairs, options),
                         std::bad_alloc);
            memory.left = left;
            EXPECT_THROW(ForEachPairOf(world, ids, function, options),
                         std::bad_alloc);
            memory.left = left + 1;
          }
          EXPECT_EQ(std::count(pairs.begin(), pairs.end(), kCanary), 1000);
          EXPECT_EQ(calls, 0u);
          // Before anything is allocated.
          memory.left = 0;
          EXPECT_THROW((void)PairsOf(world, Ids{1, 30000}, pairs),
                       std::invalid_argument);
          memory.left = CountingMemory::kNoLimit;
        }
        memory.left = 0;
        ForEachPair(world, function);
        EXPECT_GT(calls, 0u);
        memory.left = CountingMemory::kNoLimit;
      }
    }
  }
}

// Results that are flushed to zero, but not what is read: a bound of a block
// may not lose a subnormal that compares see.
#if defined(__SSE2__)
TEST(BvhPairsFpModesTest, SubnormalResultsMayBeFlushed) {
  const AabbBvh2 a(std::vector<Aabb2>{{{-1e-40f, 0}, {1, 1}}});
  const AabbBvh2 b(std::vector<Aabb2>{{{-2, 0}, {-0.5e-40f, 1}}});
  const AabbBvh2 c(std::vector<Aabb2>{{{-2, 0}, {-1.7e-40f, 1}}});
  constexpr unsigned kFlushToZero = 0x8000;
  for (Target target : TargetsUnderTest()) {
    const unsigned mode = _mm_getcsr();
    _mm_setcsr(mode | kFlushToZero);
    const std::size_t count = Pairs(a, b, Span<IdPair>(), {.target = target});
    const std::size_t near =
        Pairs(a, c, Span<IdPair>(), {.margin = 0.8e-40f, .target = target});
    _mm_setcsr(mode);
    EXPECT_EQ(count, 1u) << target.name();
    EXPECT_EQ(near, 1u) << target.name();
  }
}
#endif

TEST(BvhPairsErrorsTest, RefusesWhatItCannotReadAndWritesNothing) {
  constexpr IdPair kCanary{0xABABABAB, 0xCDCDCDCD};
  AabbBvh3 world(Spread<AabbView3>(40.0f).Objects(100));
  std::vector<IdPair> pairs(10, kCanary);
  const auto refuses = [&](Span<const std::uint32_t> ids,
                           std::string_view expected, std::string_view given,
                           const PairOptions& options = {}) {
    const auto refused = [&](std::string_view name, const auto& call) {
      EXPECT_TRUE(Refuses(call, {name, ": ", expected, "got", given}));
    };
    refused("PairsOf", [&] { (void)PairsOf(world, ids, pairs, options); });
    refused("ForEachPairOf", [&] {
      ForEachPairOf(
          world, ids, [](Span<const IdPair>) { FAIL(); }, options);
    });
    EXPECT_EQ(std::count(pairs.begin(), pairs.end(), kCanary), 10);
  };
  const std::string_view in_world = "ids[1]: expected the id of an object";
  refuses(Ids{1, 100}, in_world, "100");
  refuses(Ids{1, 0xFFFFFFFF}, in_world, "4294967295");
  world.Erase(7);
  refuses(Ids{1, 7}, in_world, "7");
  const Ids ids = {1, 2, 3};
  refuses({static_cast<const std::uint32_t*>(nullptr), 3},
          "ids: expected memory for 3 elements", "a null pointer");
  refuses({Misaligned(ids.data()), 2}, "ids: expected a pointer aligned",
          "a misaligned one");
  refuses(ids, "options.target", "no target",
          {.target = Target::FromHighwayBit(3)});
  for (float margin : {-1.0f, std::numeric_limits<float>::infinity(),
                       std::numeric_limits<float>::quiet_NaN()}) {
    refuses(ids, "options.margin: expected a finite number", "",
            {.margin = margin});
  }
  const std::vector<std::uint32_t> masks(4, 1);
  refuses(ids, "options.wanted: expected 3 masks", "4", {.wanted = masks});
  refuses(ids, "options.wanted: expected 3 masks", "a null pointer",
          {.wanted = {static_cast<const std::uint32_t*>(nullptr), 3}});
  refuses(ids, "options.wanted: expected a pointer aligned", "a misaligned one",
          {.wanted = {Misaligned(masks.data()), 3}});
  EXPECT_TRUE(
      Refuses([&] { (void)Pairs(world, pairs, {.wanted = masks}); },
              {"Pairs", "options.wanted: expected no masks", "got", "4"}));
  IdPair* const none = nullptr;
  EXPECT_TRUE(Refuses([&] { (void)Pairs(world, Span<IdPair>(none, 10)); },
                      {"Pairs", "pairs", "10 pairs", "null"}));
  EXPECT_TRUE(Refuses(
      [&] {
        (void)PairsOf(world, ids, {Misaligned(pairs.data()), 9});
      },
      {"PairsOf", "pairs", "aligned", "misaligned"}));
  EXPECT_EQ(std::count(pairs.begin(), pairs.end(), kCanary), 10);
}

// On D three times the margin, which is no float here.
TEST(BvhPairsKnownTest, AMarginThatOverflowsOnDMissesNothing) {
  constexpr float kMost = std::numeric_limits<float>::max();
  AaboWorld3 world;
  for (float d : {0.65f * kMost, -0.65f * kMost}) {
    world.Push({{0, 0, 0, d}, {0, 0, 0, d}});
  }
  const AaboBvh3 bvh(world);
  EXPECT_EQ(Pairs(bvh, {}, {.margin = kMost / 2}), 1u);
  EXPECT_EQ(Pairs(bvh, {}, {.margin = kMost / 4}), 0u);
}

TEST(BvhPairsKnownTest, ASubnormalMarginIsOneThoughSubnormalsAreFlushed) {
  constexpr float kLeast = std::numeric_limits<float>::min();
  const float next = std::nextafter(kLeast, 1.0f);
  AabbWorld3 world;
  world.Push({{0, 0, 0}, {kLeast, 0, 0}});
  world.Push({{next, 0, 0}, {1, 0, 0}});
  const AabbBvh3 bvh(world);
  const FlushDenormals flush;
  EXPECT_EQ(Pairs(bvh, {}, {.margin = 0x1p-149f}), 1u);
}

}  // namespace
}  // namespace halfspace::testing

// The owning worlds against a plain vector of bounds.
#include "halfspace/world.h"

#include <gtest/gtest.h>

#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <new>
#include <random>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "halfspace/reject.h"
#include "tests/library/support/cases.h"
#include "tests/library/support/counting_memory.h"
#include "tests/library/support/dims.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/expect_invalid.h"
#include "tests/library/support/inputs.h"
#include "tests/library/support/misaligned.h"
#include "tests/library/support/sanitized.h"

namespace halfspace::testing {
namespace {

template <typename Case>
class WorldTest : public ::testing::Test {
 protected:
  using View = typename Case::View;
  using AWorld = World<View>;
  using Bound = typename AWorld::Bound;
  using Query = typename AWorld::Query;
  using Model = std::vector<Bound>;
  using Scalar = ScalarOf<View>;

  static Scalar& Value(Bound& bound, std::size_t p) {
    return StoredValue<View>(bound, p);
  }

  // Any values: a world stores, and does not judge.
  Bound RandomBound() {
    Bound bound;
    for (std::size_t p = 0; p < kPlanes<View>; ++p) {
      Value(bound, p) =
          OneIn(8, random_)
              ? SpecialValue<Scalar>(random_)
              : std::uniform_real_distribution<Scalar>(-9, 9)(random_);
    }
    return bound;
  }

  Model RandomBounds(std::size_t count) {
    Model bounds(count);
    for (Bound& bound : bounds) bound = RandomBound();
    return bounds;
  }

  // Bits, since a NaN differs from itself and 0 from nothing but its sign.
  static bool SameBits(Scalar a, Scalar b) {
    return std::bit_cast<BitsOf<Scalar>>(a) == std::bit_cast<BitsOf<Scalar>>(b);
  }
  static bool Same(Bound a, Bound b) {
    for (std::size_t p = 0; p < kPlanes<View>; ++p) {
      if (!SameBits(Value(a, p), Value(b, p))) return false;
    }
    return true;
  }

  // Size, values, and what view() promises: alignment and padding.
  static void ExpectHolds(const AWorld& world, const Model& model) {
    ASSERT_EQ(world.size(), model.size());
    ASSERT_EQ(world.empty(), model.empty());
    ASSERT_GE(world.capacity(), world.size());
    for (std::size_t i = 0; i < model.size(); ++i) {
      ASSERT_TRUE(Same(world.Get(i), model[i])) << i;
    }
    View view = world.view();
    ASSERT_EQ(view.size, model.size());
    if (model.empty()) return;
    Bound empty = Bound::Empty();
    for (std::size_t p = 0; p < kPlanes<View>; ++p) {
      const Scalar* plane = PlaneOf(view, p);
      ASSERT_EQ(reinterpret_cast<std::uintptr_t>(plane) % 64, 0u) << p;
      for (std::size_t i = 0; i < model.size(); ++i) {
        Bound bound = model[i];
        ASSERT_TRUE(SameBits(plane[i], Value(bound, p))) << p << ", " << i;
      }
      for (std::size_t i = model.size(); i % 64 != 0; ++i) {
        ASSERT_EQ(plane[i], Value(empty, p)) << p << ", padding " << i;
      }
    }
  }

  Random random_{3};
};

// A world knows its planes by number: few and many, of floats and of doubles.
using WorldCases = Tested<
    ::testing::Types<Whole<SimplexView3>, Whole<AabbView2>, Whole<AaboView3>,
                     Whole<AaboView4>, Whole<AabbView<3, double>>>>;
TYPED_TEST_SUITE(WorldTest, WorldCases, CaseNames);

TYPED_TEST(WorldTest, RandomOperationsFollowTheModel) {
  CountingMemory memory;
  typename TestFixture::AWorld world(memory.resource());
  typename TestFixture::Model model;
  const std::size_t steps = Scaled(3000);
  for (std::size_t step = 0; step < steps; ++step) {
    const std::uint64_t operation = this->random_() % 100;
    const auto bound = this->RandomBound();
    const std::size_t at = model.empty() ? 0 : this->random_() % model.size();
    SCOPED_TRACE(::testing::Message()
                 << "step " << step << ", operation " << operation);
    if (operation < 60 || model.empty()) {
      ASSERT_EQ(world.Push(bound), model.size());
      model.push_back(bound);
    } else if (operation < 70) {
      world.Set(at, bound);
      model[at] = bound;
    } else if (operation < 92) {
      world.EraseBySwap(at);
      model[at] = model.back();
      model.pop_back();
    } else if (operation < 94) {
      world.Reserve(this->random_() % 400);
    } else if (operation < 95) {
      const std::size_t capacity = world.capacity();
      world.Clear();
      model.clear();
      ASSERT_EQ(world.capacity(), capacity);
    } else if (operation < 97) {
      model = this->RandomBounds(this->random_() % 300);
      world.Assign(model);
    } else if (operation < 98) {
      auto copy = world;
      world = copy;
      this->ExpectHolds(copy, model);
    } else {
      auto moved = std::move(world);
      world = std::move(moved);
    }
    this->ExpectHolds(world, model);
    if (this->HasFatalFailure()) return;
  }
}

TYPED_TEST(WorldTest, ReserveMakesRoomAndNeverShrinks) {
  typename TestFixture::AWorld world;
  world.Reserve(100);
  const std::size_t capacity = world.capacity();
  EXPECT_GE(capacity, 100u);
  const auto model = this->RandomBounds(100);
  for (const auto& bound : model) world.Push(bound);
  EXPECT_EQ(world.capacity(), capacity);
  world.Reserve(0);
  EXPECT_EQ(world.capacity(), capacity);
  this->ExpectHolds(world, model);
}

TYPED_TEST(WorldTest, CopiesAreApart) {
  const auto model = this->RandomBounds(70);
  typename TestFixture::AWorld world(model);
  auto copy = world;
  copy.Set(3, this->RandomBound());
  copy.EraseBySwap(0);
  this->ExpectHolds(world, model);
  copy = world;
  world.Clear();
  this->ExpectHolds(copy, model);
}

TYPED_TEST(WorldTest, SelfAssignmentChangesNothing) {
  const auto model = this->RandomBounds(70);
  typename TestFixture::AWorld world(model);
  auto& same = world;
  world = same;
  this->ExpectHolds(world, model);
  world = std::move(same);
  this->ExpectHolds(world, model);
}

TYPED_TEST(WorldTest, MovedFromWorldIsEmptyAndUsable) {
  const auto model = this->RandomBounds(70);
  typename TestFixture::AWorld from(model);
  const auto to = std::move(from);
  this->ExpectHolds(to, model);
  this->ExpectHolds(from, {});
  from.Assign(model);
  this->ExpectHolds(from, model);
}

TYPED_TEST(WorldTest, GrowthMovesNoObject) {
  const auto model = this->RandomBounds(1000);
  typename TestFixture::AWorld world;
  for (const auto& bound : model) world.Push(bound);
  this->ExpectHolds(world, model);
}

TYPED_TEST(WorldTest, IndexPastTheEndIsRefused) {
  const auto model = this->RandomBounds(70);
  typename TestFixture::AWorld world(model);
  const auto bound = this->RandomBound();
  for (std::size_t index : {std::size_t{70}, ~std::size_t{0}}) {
    const std::string given = "got " + std::to_string(index);
    const char* expected = "index: expected less than the size, 70";
    EXPECT_TRUE(
        Refuses([&] { world.Get(index); }, {"World::Get", expected, given}));
    EXPECT_TRUE(Refuses([&] { world.Set(index, bound); },
                        {"World::Set", expected, given}));
    EXPECT_TRUE(Refuses([&] { world.EraseBySwap(index); },
                        {"World::EraseBySwap", expected, given}));
  }
  this->ExpectHolds(world, model);
}

TYPED_TEST(WorldTest, ListThatCannotBeReadIsRefused) {
  using NewWorld = typename TestFixture::AWorld;
  using List = Span<const typename TestFixture::Bound>;
  const auto model = this->RandomBounds(70);
  NewWorld world(model);
  const auto refused = [&](List bounds, std::string_view expected,
                           std::string_view given) {
    const auto parts = {std::string_view("World::Assign: bounds: expected"),
                        expected, std::string_view("got"), given};
    EXPECT_TRUE(Refuses([&] { NewWorld bad(bounds); }, parts));
    EXPECT_TRUE(Refuses([&] { world.Assign(bounds); }, parts));
    this->ExpectHolds(world, model);
  };
  refused({nullptr, 3}, "memory for 3 elements", "a null pointer");
  refused({Misaligned(model.data()), 3}, "a pointer aligned to",
          "a misaligned one");
  this->ExpectHolds(NewWorld(List(nullptr, 0)), {});
  world.Assign(List(nullptr, 0));
  this->ExpectHolds(world, {});
}

TYPED_TEST(WorldTest, SizeThatCannotExistIsRefused) {
  const auto model = this->RandomBounds(70);
  typename TestFixture::AWorld world(model);
  const std::size_t most = std::numeric_limits<std::size_t>::max();
  EXPECT_TRUE(Refuses([&] { world.Reserve(most); },
                      {"World", "size: expected at most", "objects",
                       "got " + std::to_string(most)}));
  EXPECT_TRUE(Refuses(
      [&] {
        world.Assign({model.data(), most});
      },
      {"World", "size: expected at most", "objects",
       "got " + std::to_string(most)}));
  this->ExpectHolds(world, model);
}

TYPED_TEST(WorldTest, MemoryThatCannotBeHadIsBadAlloc) {
#if defined(HALFSPACE_SANITIZED)
  GTEST_SKIP() << "the sanitizer ends the process instead";
#else
  const auto model = this->RandomBounds(70);
  typename TestFixture::AWorld world(model);
  EXPECT_THROW(world.Reserve(std::size_t{1} << 50), std::bad_alloc);
  this->ExpectHolds(world, model);
#endif
}

// The same bounds as an octahedron world, seen as a simplex and a box world,
// and as worlds of their own.
template <typename Dims>
class AaboWorldViewsTest : public ::testing::Test {};

TYPED_TEST_SUITE(AaboWorldViewsTest, AllDims, DimsNames);

TYPED_TEST(AaboWorldViewsTest, AnswerAsSeparateWorldsDo) {
  constexpr int kDims = TypeParam::value;
  Random random(4);
  std::uniform_real_distribution<float> coordinate(-2.f, 2.f);
  const auto random_bound = [&] {
    Aabo<kDims> bound;
    for (float& v : bound.min) v = coordinate(random);
    for (float& v : bound.max) v = coordinate(random) + 1.f;
    return bound;
  };
  AaboWorld<kDims> aabos;
  SimplexWorld<kDims> simplices;
  AabbWorld<kDims> boxes;
  for (int i = 0; i < 500; ++i) {
    const Aabo<kDims> bound = random_bound();
    aabos.Push(bound);
    simplices.Push(bound.up());
    boxes.Push(bound.aabb());
  }
  std::size_t survivors = 0;
  std::vector<std::uint64_t> seen(MaskWords(500));
  std::vector<std::uint64_t> own(MaskWords(500));
  for (int i = 0; i < 50; ++i) {
    const Aabo<kDims> query = random_bound();
    SurvivorMask(aabos.view().simplex(), query.down(), seen);
    SurvivorMask(simplices, query.down(), own);
    ASSERT_EQ(seen, own);
    survivors += CountSurvivors(simplices, query.down());
    SurvivorMask(aabos.view().aabb(), query.aabb(), seen);
    SurvivorMask(boxes, query.aabb(), own);
    ASSERT_EQ(seen, own);
    survivors += CountSurvivors(boxes, query.aabb());
  }
  EXPECT_GT(survivors, 0u);
  EXPECT_LT(survivors, 2u * 50 * 500);
}

}  // namespace
}  // namespace halfspace::testing

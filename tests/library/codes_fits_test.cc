// Fits() says when the objects have left their map, and worlds that grow learn.
#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "halfspace/codes.h"
#include "halfspace/reject.h"
#include "tests/library/coded_cases.h"

namespace halfspace::testing {
namespace {

template <typename Case>
class CodesFitsTest : public ::testing::Test {
 protected:
  using FloatView = typename Case::View;
  using Code = typename Case::Code;
  using Bound = typename FloatView::Bound;
  using Coded = CodedWorld<FloatView, Code>;

  std::vector<Bound> RandomBounds(
      std::size_t count, CodedInputKind kind = CodedInputKind::kUniform) {
    return MakeCodedBounds<FloatView>(kind, count, random_);
  }

  static Coded WorldOf(const std::vector<Bound>& bounds) {
    return Coded(std::span(bounds));
  }

  // Every object's plane p is squeezed to a thousandth, around zero.
  static void Squeeze(Coded& world, std::size_t p) {
    for (std::size_t i = 0; i < world.size(); ++i) {
      Bound bound = world.Get(i);
      StoredValue<FloatView>(bound, p) *= 1e-3f;
      world.Set(i, bound);
    }
  }

  Random random_{29};
};

TYPED_TEST_SUITE(CodesFitsTest, FewCodedCases, CodedCaseNames);

TYPED_TEST(CodesFitsTest, WhatWasJustLearntFits) {
  for (CodedInputKind kind : kCodedInputKinds) {
    for (std::size_t size : {0u, 1u, 2u, 63u, 1000u, 5000u}) {
      EXPECT_TRUE(this->WorldOf(this->RandomBounds(size, kind)).Fits())
          << NameOf(kind) << ", " << size;
    }
  }
  EXPECT_TRUE(typename TestFixture::Coded().Fits());
}

TYPED_TEST(CodesFitsTest, MoreOfTheSameFits) {
  auto world = this->WorldOf(this->RandomBounds(5000));
  for (const auto& bound : this->RandomBounds(5000)) {
    world.Set(this->random_() % 5000, bound);
  }
  EXPECT_TRUE(world.Fits());
}

// One plane is enough, whichever it is.
TYPED_TEST(CodesFitsTest, ObjectsThatShrankFitNoMore) {
  for (std::size_t p = 0; p < kPlanes<typename TypeParam::View>; ++p) {
    auto world = this->WorldOf(this->RandomBounds(5000));
    this->Squeeze(world, p);
    EXPECT_FALSE(world.Fits()) << p;
    EXPECT_FALSE(world.codes().Fits()) << p;
    world.Recode();
    EXPECT_TRUE(world.Fits()) << p;
  }
}

TYPED_TEST(CodesFitsTest, ObjectsThatMovedAwayFitNoMore) {
  using View = typename TypeParam::View;
  auto world = this->WorldOf(this->RandomBounds(5000));
  for (std::size_t i = 0; i < world.size(); ++i) {
    auto bound = world.Get(i);
    for (std::size_t p = 0; p < kPlanes<View>; ++p) {
      StoredValue<View>(bound, p) += 1000.f;
    }
    world.Set(i, bound);
  }
  EXPECT_FALSE(world.Fits());
  world.Recode();
  EXPECT_TRUE(world.Fits());
}

// All objects count, not the first of them only.
TYPED_TEST(CodesFitsTest, LastObjectsCountToo) {
  using View = typename TypeParam::View;
  auto world = this->WorldOf(this->RandomBounds(2047));
  for (std::size_t i = 1024; i < world.size(); ++i) {
    auto bound = world.Get(i);
    for (std::size_t p = 0; p < kPlanes<View>; ++p) {
      StoredValue<View>(bound, p) = 1000.f;
    }
    world.Set(i, bound);
  }
  EXPECT_FALSE(world.Fits());
}

// Worlds that are pushed object by object reject nearly as well as one that is
// made of all at once: grown, with room from the start, or in memory that was
// moved from.
TYPED_TEST(CodesFitsTest, GrowingWorldsLearn) {
  using View = typename TypeParam::View;
  using Grown = typename TestFixture::Coded;
  auto bounds = this->RandomBounds(5000);
  const auto made = this->WorldOf(bounds);
  std::array<Grown, 3> worlds;
  worlds[1].Reserve(bounds.size());
  worlds[2] = made;
  const Grown moved_to = std::move(worlds[2]);
  for (Grown& grown : worlds) {
    for (const auto& bound : bounds) {
      grown.Push(bound);
      // There is nothing to learn from in the first 64.
      if (grown.size() > 64 && grown.size() % 32 == 1) {
        ASSERT_TRUE(grown.Fits()) << grown.size();
      }
    }
    std::size_t of_grown = 0;
    std::size_t of_made = 0;
    for (int i = 0; i < 50; ++i) {
      const auto query = MakeCodedQuery<View>(bounds, this->random_);
      of_grown += CountSurvivors(grown.codes(), query);
      of_made += CountSurvivors(made.codes(), query);
    }
    EXPECT_GT(of_made, 0u);
    EXPECT_LT(of_grown, of_made + of_made / 5);
  }
  EXPECT_EQ(moved_to.size(), bounds.size());
}

}  // namespace
}  // namespace halfspace::testing

// Fits() says when the objects have left their map, and worlds that grow train.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "halfspace/quantized.h"
#include "halfspace/reject.h"
#include "tests/library/support/quantized_cases.h"

namespace halfspace::testing {
namespace {

template <typename Case>
class QuantizedFitsTest : public ::testing::Test {
 protected:
  using FloatView = typename Case::View;
  using Element = typename Case::Element;
  using Bound = typename FloatView::Bound;
  using TheWorld = QuantizedWorld<FloatView, Element>;

  std::vector<Bound> RandomBounds(
      std::size_t count,
      QuantizedInputKind kind = QuantizedInputKind::kUniform) {
    return MakeQuantizedBounds<FloatView>(kind, count, random_);
  }

  static TheWorld WorldOf(const std::vector<Bound>& bounds) {
    return TheWorld(std::span(bounds));
  }

  // The world is pushed to once more; its map fits all the while, as there is
  // enough to train from.
  static void PushAll(const std::vector<Bound>& bounds, TheWorld& world) {
    for (const Bound& bound : bounds) {
      world.Push(bound);
      if (world.size() > 64 && world.size() % 32 == 1) {
        ASSERT_TRUE(world.Fits()) << world.size();
      }
    }
    EXPECT_TRUE(bounds.size() <= 64 || world.Fits());
  }

  // The quantized bounds keep at most `more` times as many as those of a world
  // that is constructed from all bounds at once.
  void ExpectNearlyAsGood(const TheWorld& world, std::vector<Bound>& bounds,
                          double more) {
    const TheWorld made = WorldOf(bounds);
    std::size_t of_world = 0;
    std::size_t of_made = 0;
    for (int i = 0; i < 50; ++i) {
      const auto query = MakeQuantizedQuery<FloatView>(bounds, random_);
      of_world += CountSurvivors(world.quantized(), query);
      of_made += CountSurvivors(made.quantized(), query);
    }
    EXPECT_GT(of_made, 0u);
    EXPECT_LT(static_cast<double>(of_world),
              more * static_cast<double>(of_made));
  }

  // Every object's plane p is squeezed to a thousandth, around zero.
  static void Squeeze(TheWorld& world, std::size_t p) {
    for (std::size_t i = 0; i < world.size(); ++i) {
      Bound bound = world.Get(i);
      StoredValue<FloatView>(bound, p) *= 1e-3f;
      world.Set(i, bound);
    }
  }

  Random random_{29};
};

TYPED_TEST_SUITE(QuantizedFitsTest, FewQuantizedCases, QuantizedCaseNames);

TYPED_TEST(QuantizedFitsTest, WhatWasJustTrainedFits) {
  for (QuantizedInputKind kind : kQuantizedInputKinds) {
    for (std::size_t size : {0u, 1u, 2u, 63u, 1000u, 5000u}) {
      EXPECT_TRUE(this->WorldOf(this->RandomBounds(size, kind)).Fits())
          << NameOf(kind) << ", " << size;
    }
  }
  EXPECT_TRUE(typename TestFixture::TheWorld().Fits());
}

TYPED_TEST(QuantizedFitsTest, MoreOfTheSameFits) {
  auto world = this->WorldOf(this->RandomBounds(5000));
  for (const auto& bound : this->RandomBounds(5000)) {
    world.Set(this->random_() % 5000, bound);
  }
  EXPECT_TRUE(world.Fits());
}

// One plane is enough, whichever it is.
TYPED_TEST(QuantizedFitsTest, ObjectsThatShrankFitNoMore) {
  for (std::size_t p = 0; p < kPlanes<typename TypeParam::View>; ++p) {
    auto world = this->WorldOf(this->RandomBounds(5000));
    this->Squeeze(world, p);
    EXPECT_FALSE(world.Fits()) << p;
    EXPECT_FALSE(world.quantized().Fits()) << p;
    world.Requantize();
    EXPECT_TRUE(world.Fits()) << p;
  }
}

TYPED_TEST(QuantizedFitsTest, ObjectsThatMovedAwayFitNoMore) {
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
  world.Requantize();
  EXPECT_TRUE(world.Fits());
}

// All objects count, not the first of them only.
TYPED_TEST(QuantizedFitsTest, LastObjectsCountToo) {
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
TYPED_TEST(QuantizedFitsTest, GrowingWorldsTrain) {
  using Grown = typename TestFixture::TheWorld;
  auto bounds = this->RandomBounds(5000);
  std::array<Grown, 3> worlds;
  worlds[1].Reserve(bounds.size());
  worlds[2] = this->WorldOf(bounds);
  const Grown moved_to = std::move(worlds[2]);
  for (Grown& grown : worlds) {
    this->PushAll(bounds, grown);
    this->ExpectNearlyAsGood(grown, bounds, 1.2);
  }
  EXPECT_EQ(moved_to.size(), bounds.size());
}

// The last objects that came are then all beyond what the map was trained from.
TYPED_TEST(QuantizedFitsTest, WorldsInSpatialOrderTrain) {
  using View = typename TypeParam::View;
  for (std::size_t p : {std::size_t{0}, kPlanes<View> - 1}) {
    auto bounds = this->RandomBounds(2000);
    std::sort(bounds.begin(), bounds.end(), [p](auto a, auto b) {
      return StoredValue<View>(a, p) < StoredValue<View>(b, p);
    });
    for (int i = 0; i < 2; ++i) {
      SCOPED_TRACE(::testing::Message() << p << (i == 0 ? ", up" : ", down"));
      typename TestFixture::TheWorld world;
      this->PushAll(bounds, world);
      this->ExpectNearlyAsGood(world, bounds, 1.5);
      std::reverse(bounds.begin(), bounds.end());
    }
  }
}

// A period of the objects must not be taken for what all of them are like.
TYPED_TEST(QuantizedFitsTest, GridsInOrderTrain) {
  using View = typename TypeParam::View;
  typename TestFixture::TheWorld world;
  constexpr std::size_t kSide = 32;
  for (std::size_t i = 0; i < kSide * kSide * kSide; ++i) {
    typename TestFixture::Bound bound;
    const std::array cell = {i % kSide, i / kSide % kSide, i / kSide / kSide};
    for (std::size_t p = 0; p < kPlanes<View>; ++p) {
      StoredValue<View>(bound, p) = static_cast<float>(cell[p % 3]);
    }
    world.Push(bound);
    if (world.size() > 64 && world.size() % 256 == 0) {
      ASSERT_TRUE(world.Fits()) << world.size();
    }
  }
}

// As a world that is filled afresh for each frame.
TYPED_TEST(QuantizedFitsTest, ClearedWorldsTrainAnew) {
  using View = typename TypeParam::View;
  auto world = this->WorldOf(this->RandomBounds(5000));
  for (float scale : {1e-3f, 1e3f, 0.3f}) {
    SCOPED_TRACE(scale);
    auto bounds = this->RandomBounds(1000);
    for (auto& bound : bounds) {
      for (std::size_t p = 0; p < kPlanes<View>; ++p) {
        StoredValue<View>(bound, p) *= scale;
      }
    }
    world.Clear();
    this->PushAll(bounds, world);
    this->ExpectNearlyAsGood(world, bounds, 1.2);
  }
}

}  // namespace
}  // namespace halfspace::testing

// Quantized bounds of every kind of world, on every target, schedule and output
// form: what floats keep they keep, and refined they give the floats' answer,
// bit for bit.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <vector>

#include "halfspace/quantized.h"
#include "tests/library/quantized/quantized_answers.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/quantized_cases.h"
#include "tests/library/support/sizes.h"

namespace halfspace::testing {
namespace {

template <typename Case>
class QuantizedDifferentialTest : public ::testing::Test {
 protected:
  using FloatView = typename Case::View;
  using Element = typename Case::Element;

  // A world of its own for each size, and several queries.
  void Check(QuantizedInputKind kind, std::size_t size, std::size_t queries) {
    SCOPED_TRACE(::testing::Message()
                 << NameOf(kind) << ", " << size << " objects");
    auto bounds = MakeQuantizedBounds<FloatView>(kind, size, random_);
    const World<FloatView> world(bounds);
    const QuantizedBounds<FloatView, Element> quantized(world.view());
    ASSERT_EQ(quantized.size(), size);
    ASSERT_EQ(quantized.empty(), size == 0);
    EXPECT_TRUE(quantized.Fits());
    for (std::size_t q = 0; q < queries; ++q) {
      const auto query = MakeQuantizedQuery<FloatView>(bounds, random_);
      ASSERT_TRUE(
          QuantizedAnswersEverywhere(quantized, world.view(), query, targets_));
      objects_ += size;
      survivors_ += ReferenceAnswer(world.view(), query).survivors().size();
    }
  }

  // An input without both answers would test little.
  void ExpectBothAnswers() const {
    EXPECT_GT(survivors_, objects_ / 100);
    EXPECT_LT(survivors_, objects_);
  }

  Random random_{17};
  std::vector<Target> targets_ = TargetsUnderTest();

 private:
  std::size_t objects_ = 0;
  std::size_t survivors_ = 0;
};

TYPED_TEST_SUITE(QuantizedDifferentialTest, QuantizedCases, QuantizedCaseNames);

TYPED_TEST(QuantizedDifferentialTest, EverySmallSize) {
  std::size_t turn = 0;
  for (std::size_t size = 0; size <= 130; ++size) {
    for (std::size_t i = 0; i < Scaled(3); ++i) {
      this->Check(kQuantizedInputKinds[turn++ % kQuantizedInputKinds.size()],
                  size, 1);
      if (this->HasFatalFailure()) return;
    }
  }
  this->ExpectBothAnswers();
}

TYPED_TEST(QuantizedDifferentialTest, EveryKindAroundTiles) {
  const std::vector<std::size_t> sizes = SizesAroundTiles();
  std::size_t turn = 0;
  for (QuantizedInputKind kind : kQuantizedInputKinds) {
    for (std::size_t i = 0; i < Scaled(2); ++i) {
      this->Check(kind, sizes[turn++ % sizes.size()], 2);
      if (this->HasFatalFailure()) return;
    }
  }
  this->ExpectBothAnswers();
}

TYPED_TEST(QuantizedDifferentialTest, FromAfar) {
  using Bound = typename TypeParam::View::Bound;
  const std::size_t record_bytes =
      sizeof(Bound) / sizeof(float) * sizeof(typename TypeParam::Element);
  // The largest first.
  std::vector<std::size_t> sizes = SizesFromMemory(record_bytes);
  for (std::size_t left = Scaled(sizes.size()); left != 0; --left) {
    this->Check(QuantizedInputKind::kClustered, sizes.back(), 4);
    sizes.pop_back();
    if (this->HasFatalFailure()) return;
  }
  this->ExpectBothAnswers();
}

// Few objects make few thresholds, so each size is a map of its own.
TYPED_TEST(QuantizedDifferentialTest, WhatTouchesIsKept) {
  using View = typename TypeParam::View;
  for (QuantizedInputKind kind : kQuantizedInputKinds) {
    for (std::size_t size : {1u, 2u, 3u, 7u, 8u, 254u, 255u, 256u, 700u}) {
      SCOPED_TRACE(::testing::Message()
                   << NameOf(kind) << ", " << size << " objects");
      const auto bounds = MakeQuantizedBounds<View>(kind, size, this->random_);
      const World<View> world(bounds);
      const QuantizedBounds<View, typename TypeParam::Element> quantized(
          world.view());
      const std::size_t step = std::max<std::size_t>(1, size / Scaled(size));
      for (std::size_t i = 0; i < size; i += step) {
        const auto query = TouchingQuery<View>(bounds[i]);
        const Answer quantized_world =
            AnswerByMask(quantized, size, query, this->targets_[0]);
        ASSERT_TRUE(
            KeepsAllOf(ReferenceAnswer(world.view(), query), quantized_world));
        ASSERT_EQ(quantized_world.survivor_mask()[i / 64] >> (i % 64) & 1, 1u)
            << i;
      }
    }
  }
}

}  // namespace
}  // namespace halfspace::testing

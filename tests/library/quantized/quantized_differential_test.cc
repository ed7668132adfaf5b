// Quantized bounds of every kind of world, on every target, schedule and output
// form: what floats keep they keep, and refined they give the floats' answer,
// bit for bit.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "tests/library/quantized/quantized_answers.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/quantized_rows.h"
#include "tests/library/support/sizes.h"

namespace halfspace::testing {
namespace {

class QuantizedDifferentialTest
    : public ::testing::TestWithParam<QuantizedRow> {
 protected:
  // A world of its own for each size, and several queries.
  void Check(QuantizedInputKind kind, std::size_t size,
             std::size_t query_count) {
    SCOPED_TRACE(::testing::Message()
                 << NameOf(kind) << ", " << size << " objects");
    const auto values =
        MakeQuantizedValues(GetParam().layout, kind, size, random_);
    const auto all = GetParam().make(values);
    const AnyWorld floats = all->floats();
    const AnyWorld quantized = all->quantized();
    ASSERT_EQ(quantized.size(), size);
    EXPECT_TRUE(all->Fits());
    const QuantizedQueries queries(GetParam(), values, query_count, random_);
    for (std::size_t q = 0; q < query_count; ++q) {
      const AnyQueries query = queries.Some(q, 1);
      Answer exact;
      exact.AssignReference(floats, query);
      ASSERT_TRUE(QuantizedAnswersEverywhere(quantized, all->refined(), exact,
                                             query, targets_));
      objects_ += size;
      survivors_ += exact.survivors().size();
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

TEST_P(QuantizedDifferentialTest, EverySmallSize) {
  std::size_t turn = 0;
  for (std::size_t size = 0; size <= 130; ++size) {
    for (std::size_t i = 0; i < Scaled(3); ++i) {
      Check(kQuantizedInputKinds[turn++ % kQuantizedInputKinds.size()], size,
            1);
      if (HasFatalFailure()) return;
    }
  }
  ExpectBothAnswers();
}

TEST_P(QuantizedDifferentialTest, EveryKindAroundTiles) {
  const std::vector<std::size_t> sizes = SizesAroundTiles();
  std::size_t turn = 0;
  for (QuantizedInputKind kind : kQuantizedInputKinds) {
    for (std::size_t i = 0; i < Scaled(2); ++i) {
      Check(kind, sizes[turn++ % sizes.size()], 2);
      if (HasFatalFailure()) return;
    }
  }
  ExpectBothAnswers();
}

TEST_P(QuantizedDifferentialTest, FromAfar) {
  // The largest first.
  std::vector<std::size_t> sizes =
      SizesFromMemory(GetParam().planes() * GetParam().element_bytes);
  for (std::size_t left = Scaled(sizes.size()); left != 0; --left) {
    Check(QuantizedInputKind::kClustered, sizes.back(), 4);
    sizes.pop_back();
    if (HasFatalFailure()) return;
  }
  ExpectBothAnswers();
}

// Few objects make few thresholds, so each size is a map of its own.
TEST_P(QuantizedDifferentialTest, WhatTouchesIsKept) {
  const std::size_t planes = GetParam().planes();
  for (QuantizedInputKind kind : kQuantizedInputKinds) {
    for (std::size_t size : {1u, 2u, 3u, 7u, 8u, 254u, 255u, 256u, 700u}) {
      SCOPED_TRACE(::testing::Message()
                   << NameOf(kind) << ", " << size << " objects");
      const auto values =
          MakeQuantizedValues(GetParam().layout, kind, size, random_);
      const auto all = GetParam().make(values);
      const AnyWorld floats = all->floats();
      const AnyWorld quantized = all->quantized();
      const std::size_t step = std::max<std::size_t>(1, size / Scaled(size));
      for (std::size_t i = 0; i < size; i += step) {
        // It touches object i in every plane.
        std::array<float, 10> query{};
        for (std::size_t p = 0; p < planes; ++p) {
          query[OpposingValue(GetParam().layout, p)] = values[i * planes + p];
        }
        Answer exact;
        exact.AssignReference(floats, {query.data(), 1});
        const Answer of_quantized =
            AnswerByMask(quantized, {query.data(), 1}, targets_[0]);
        ASSERT_TRUE(KeepsAllOf(exact, of_quantized));
        ASSERT_EQ(of_quantized.survivor_mask()[i / 64] >> (i % 64) & 1, 1u)
            << i;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(, QuantizedDifferentialTest,
                         ::testing::ValuesIn(QuantizedRows()),
                         QuantizedRowName);

}  // namespace
}  // namespace halfspace::testing

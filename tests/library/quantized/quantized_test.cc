// Quantized bounds of every kind of world, on every target, schedule and call:
// what floats keep they keep, and refined they give the floats' answers, bit
// for bit.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <memory>
#include <vector>

#include "tests/library/support/answers.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/quantized_rows.h"
#include "tests/library/support/sizes.h"

namespace halfspace::testing {
namespace {

class QuantizedTest : public ::testing::TestWithParam<QuantizedRow> {
 protected:
  // An input without both answers would test little.
  void TearDown() override {
    EXPECT_GT(survivors_, tests_ / 1000);
    EXPECT_LT(survivors_, tests_);
  }

  void Make(QuantizedInputKind kind, std::size_t size, std::size_t queries) {
    const auto values =
        MakeQuantizedValues(GetParam().layout, kind, size, random_);
    all_ = GetParam().make(values);
    queries_ = QuantizedQueries(GetParam(), values, queries, random_);
    EXPECT_TRUE(all_->Fits());
  }

  void Check(std::size_t queries, const Range& range = {}) {
    const AnyQueries some = queries_.Some(0, queries);
    const Answers exact = Answers::OfReference(all_->floats(), some, range);
    SCOPED_TRACE(::testing::Message()
                 << exact.objects() << " objects, " << queries
                 << " queries, range " << range.begin << ", " << range.end);
    ASSERT_TRUE(QuantizedAnswersEverywhere(all_->quantized(), all_->refined(),
                                           exact, some, targets_));
    ASSERT_TRUE(AnswersEverywhere(exact, all_->world(), some, targets_));
    tests_ += 64 * exact.rejected().size();
    survivors_ += exact.survivors().size();
  }

  void CheckSizes(const std::vector<std::size_t>& sizes, std::size_t rounds,
                  std::size_t queries) {
    std::size_t turn = 0;
    for (std::size_t size : sizes) {
      for (std::size_t i = 0; i < rounds; ++i) {
        const auto kind =
            kQuantizedInputKinds[turn++ % kQuantizedInputKinds.size()];
        SCOPED_TRACE(NameOf(kind));
        Make(kind, size, queries);
        Check(queries);
        if (HasFatalFailure()) return;
      }
    }
  }

  std::unique_ptr<AnyQuantized> all_;
  Random random_{17};

 private:
  std::vector<Target> targets_ = TargetsUnderTest();
  QuantizedQueries queries_;
  std::size_t tests_ = 0;
  std::size_t survivors_ = 0;
};

// Few objects make few thresholds, so each size is a map of its own.
TEST_P(QuantizedTest, EverySmallSize) {
  CheckSizes(EverySmallSize(), Scaled(2), 1);
  CheckSizes({254, 255, 256, 700}, 4, 5);
}

TEST_P(QuantizedTest, AroundTiles) {
  CheckSizes(SizesAroundTiles(), Scaled(3), 2);
}

// The largest first.
TEST_P(QuantizedTest, FromAfar) {
  std::vector<std::size_t> sizes =
      SizesFromMemory(GetParam().planes() * GetParam().element_bytes);
  std::reverse(sizes.begin(), sizes.end());
  sizes.resize(std::min(Scaled(sizes.size()), sizes.size()));
  CheckSizes(sizes, 1, 4);
}

// Around the queries that share a load (2 or 4), the rows of a tile (16), and
// the queries that are encoded at a time (256).
TEST_P(QuantizedTest, EveryNumberOfQueries) {
  Make(QuantizedInputKind::kAnyValues, 2 * 64 + 37, 600);
  for (std::size_t queries : {0, 1, 2, 3, 4, 5, 9, 16, 17, 256, 257, 600}) {
    Check(queries);
    if (HasFatalFailure()) return;
  }
}

TEST_P(QuantizedTest, Ranges) {
  constexpr std::size_t kSize = 4096 + 3 * 64 + 37;
  Make(QuantizedInputKind::kUniform, kSize, 7);
  constexpr Range kRanges[] = {{0, 0},
                               {0, 64},
                               {64, 64},
                               {63, 192},
                               {4001, 4096},
                               {64, 4096 + 64},
                               {4096 + 192, kSize},
                               {128, ~std::size_t{0}},
                               {8192, ~std::size_t{0}}};
  for (const Range& range : kRanges) {
    for (std::size_t queries : {1u, 7u}) {
      Check(queries, range);
      if (HasFatalFailure()) return;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(, QuantizedTest, ::testing::ValuesIn(QuantizedRows()),
                         QuantizedRowName);

}  // namespace
}  // namespace halfspace::testing

// What the calls leave of their outputs: long masks, short index lists, none.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <random>
#include <span>
#include <stdexcept>
#include <vector>

#include "halfspace/halfspace.h"
#include "tests/library/support/answers.h"
#include "tests/library/support/canaries.h"
#include "tests/library/support/environment.h"

namespace halfspace::testing {
namespace {

// Calls `check` with every target and schedule.
template <typename Check>
void Everywhere(Check check) {
  for (Target target : TargetsUnderTest()) {
    for (Schedule schedule : kSchedules) {
      SCOPED_TRACE(::testing::Message() << target.name() << ", schedule "
                                        << static_cast<int>(schedule));
      check(Options{.schedule = schedule, .target = target});
    }
  }
}

// Object i of n lies at x = i, apart from multiples of three, which are empty.
// The query sees what is empty as rejected, and all else as touched.
AaboWorld2 TwoOfThree(std::size_t n) {
  AaboWorld2 world;
  for (std::size_t i = 0; i < n; ++i) {
    const auto x = static_cast<float>(i);
    world.Push(i % 3 == 0 ? Aabo2::Empty()
                          : BoundAabb<2>({{x, 0.f}, {x, 0.f}}));
  }
  return world;
}
const Aabo2 kAll = Aabo2::Everything();

class OutputsTest : public ::testing::TestWithParam<std::size_t> {};

TEST_P(OutputsTest, MaskWordsPastTheWorldAreNotTouched) {
  const AaboWorld2 world = TwoOfThree(GetParam());
  Canaried<std::uint64_t> mask;
  Everywhere([&](const Options& options) {
    RejectMask(world, kAll, mask.Reset(MaskWords(world.size()) + 5), options);
    EXPECT_TRUE(mask.IntactBut(MaskWords(world.size())));
    SurvivorMask(world, kAll, mask.Reset(MaskWords(world.size()) + 5), options);
    EXPECT_TRUE(mask.IntactBut(MaskWords(world.size())));
  });
}

TEST_P(OutputsTest, BitsPastTheWorldNeverShowASurvivor) {
  const AaboWorld2 world = TwoOfThree(GetParam());
  if (world.size() % 64 == 0) return;
  const std::uint64_t past = ~std::uint64_t{0} << (world.size() % 64);
  std::vector<std::uint64_t> mask(MaskWords(world.size()));
  Everywhere([&](const Options& options) {
    RejectMask(world, kAll, mask, options);
    EXPECT_EQ(mask.back() & past, past);
    SurvivorMask(world, kAll, mask, options);
    EXPECT_EQ(mask.back() & past, 0u);
  });
}

TEST_P(OutputsTest, WhatFitsIsWrittenAndAllAreCounted) {
  const AaboWorld2 world = TwoOfThree(GetParam());
  std::vector<std::uint32_t> all;
  for (std::uint32_t i = 0; i < world.size(); ++i) {
    if (i % 3 != 0) all.push_back(i);
  }
  std::vector<std::size_t> capacities = {0, 1, all.size(), all.size() + 1,
                                         all.size() + 70};
  if (!all.empty()) capacities.push_back(all.size() - 1);
  Canaried<std::uint32_t> indices;
  Everywhere([&](const Options& options) {
    for (std::size_t capacity : capacities) {
      const auto out = indices.Reset(capacity);
      EXPECT_EQ(Survivors(world, kAll, out, options), all.size());
      const std::size_t written = std::min(capacity, all.size());
      EXPECT_TRUE(std::equal(all.begin(),
                             all.begin() + static_cast<std::ptrdiff_t>(written),
                             out.begin()))
          << capacity;
      EXPECT_TRUE(indices.IntactBut(written)) << capacity;
    }
  });
}

// Pieces of any length make the whole list.
TEST_P(OutputsTest, SkippedSurvivorsAreCountedAndNotWritten) {
  const AaboWorld2 world = TwoOfThree(GetParam());
  const QuantizedWorld<AaboView2> quantized(world);
  std::vector<std::uint32_t> all(world.size());
  all.resize(Survivors(world, kAll, all));
  Canaried<std::uint32_t> indices;
  const auto check = [&](const auto& any_world, const Options& options) {
    for (std::size_t skip :
         {std::size_t{1}, all.size() / 2, all.size(), ~std::size_t{0}}) {
      const std::size_t left = all.size() - std::min(skip, all.size());
      for (std::size_t capacity : {left / 2, left, left + 70}) {
        const auto out = indices.Reset(capacity);
        EXPECT_EQ(Survivors(any_world, kAll, out, options, skip), all.size());
        const std::size_t written = std::min(capacity, left);
        EXPECT_TRUE(std::equal(
            out.begin(), out.begin() + static_cast<std::ptrdiff_t>(written),
            all.end() - static_cast<std::ptrdiff_t>(left)))
            << skip << ", " << capacity;
        EXPECT_TRUE(indices.IntactBut(written)) << skip << ", " << capacity;
      }
    }
  };
  Everywhere([&](const Options& options) {
    check(world, options);
    check(quantized, options);
  });
}

INSTANTIATE_TEST_SUITE_P(Sizes, OutputsTest,
                         ::testing::Values(0, 1, 2, 63, 64, 65, 127, 128, 200,
                                           4096, 4161));

TEST(MaskWordsTest, RoundsUpWithoutOverflow) {
  EXPECT_EQ(MaskWords(0), 0u);
  EXPECT_EQ(MaskWords(1), 1u);
  EXPECT_EQ(MaskWords(64), 1u);
  EXPECT_EQ(MaskWords(65), 2u);
  EXPECT_EQ(MaskWords(~std::size_t{0}), (~std::size_t{0} >> 6) + 1);
}

TEST(SetBitsTest, AreThoseOfEveryMask) {
  std::mt19937_64 random(3);
  for (std::size_t words : {0u, 1u, 2u, 5u}) {
    // Sparse words, dense ones, and words of 0 at either end.
    for (int ands = 0; ands < 9; ++ands) {
      std::vector<std::uint64_t> mask(words, ands == 0 ? ~std::uint64_t{0} : 0);
      for (std::size_t w = 0; w < words && ands != 0; ++w) {
        mask[w] = random();
        for (int a = 1; a < ands; ++a) mask[w] &= random();
      }
      std::vector<std::size_t> expected;
      for (std::size_t i = 0; i < 64 * words; ++i) {
        if ((mask[i / 64] >> i % 64 & 1) != 0) expected.push_back(i);
      }
      std::vector<std::size_t> bits;
      for (std::size_t i : SetBits(mask)) bits.push_back(i);
      EXPECT_EQ(bits, expected);
      EXPECT_EQ(CountBits(mask), expected.size());
    }
  }
}

// In pieces of at most 256, and no more than were asked for.
TEST(ForEachSurvivorTest, CallsUntilItIsStopped) {
  const AaboWorld2 world = TwoOfThree(20000);
  std::vector<std::uint32_t> all(world.size());
  all.resize(Survivors(world, kAll, all));
  for (std::size_t most : {std::size_t{1}, std::size_t{3}, ~std::size_t{0}}) {
    std::vector<std::uint32_t> seen;
    std::size_t calls = 0;
    ForEachSurvivor(world, kAll, [&](Span<const std::uint32_t> some) {
      EXPECT_TRUE(0 < some.size() && some.size() <= 256);
      seen.insert(seen.end(), some.begin(), some.end());
      return ++calls == most ? Visit::kStop : Visit::kContinue;
    });
    EXPECT_TRUE(most == calls || seen == all);
    EXPECT_TRUE(std::equal(seen.begin(), seen.end(), all.begin()));
  }
  EXPECT_THROW(
      ForEachSurvivor(world, kAll,
                      [](const auto&) { throw std::runtime_error(""); }),
      std::runtime_error);
}

}  // namespace
}  // namespace halfspace::testing

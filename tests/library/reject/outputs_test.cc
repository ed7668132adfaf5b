// What calls leave of their outputs: short lists, none; and what the functions
// that they call may do. Masks, and whole lists, are compared bit by bit
// wherever tests compare answers (support/answers.h).
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
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

// Object i is a point at x = i, but every third is empty; query q is all points
// with x <= 3 q, and query 0 is everything.
AabbWorld3 PointsOnX(std::size_t n) {
  AabbWorld3 world;
  for (std::size_t i = 0; i < n; ++i) {
    const auto x = static_cast<float>(i);
    world.Push(i % 3 == 0 ? Aabb3::Empty() : Aabb3{{x, 0, 0}, {x, 0, 0}});
  }
  return world;
}
std::vector<Aabb3> LongerAndLonger(std::size_t count) {
  std::vector<Aabb3> queries(count, Aabb3{});
  for (std::size_t q = 0; q < count; ++q) {
    queries[q].max[0] = static_cast<float>(3 * q);
  }
  if (count != 0) queries[0] = Aabb3::Everything();
  return queries;
}

class OutputsTest : public ::testing::TestWithParam<std::size_t> {};

// Pieces of any length make the whole list.
TEST_P(OutputsTest, ListsHaveWhatFitsFromWhereTheySkip) {
  const AabbWorld3 floats = PointsOnX(GetParam());
  const QuantizedWorld<AabbView3> quantized(floats);
  const std::vector<Aabb3> queries = LongerAndLonger(20);
  const AnyQueries asked(queries.data(), queries.size());
  Canaried<std::uint32_t> memory[2];
  // list(outputs, skip) is a call that writes one list or two; `all` is what it
  // writes at most.
  using Lists = std::vector<std::vector<std::uint32_t>>;
  using Spans = std::array<std::span<std::uint32_t>, 2>;
  const auto check = [&](const auto& list, const Lists& all) {
    const std::size_t count = all[0].size();
    for (std::size_t skip :
         {std::size_t{0}, std::size_t{1}, count / 2, count, ~std::size_t{0}}) {
      const std::size_t left = count - std::min(skip, count);
      const std::size_t lengths[] = {
          0, 1, left / 2, left == 0 ? 0 : left - 1, left, left + 70};
      for (std::size_t first : lengths) {
        for (std::size_t second : {first, left / 3, left + 1}) {
          const Spans out = {memory[0].Reset(first), memory[1].Reset(second)};
          ASSERT_EQ(list(out, skip), count);
          const std::size_t written =
              std::min({left, first, all.size() == 1 ? first : second});
          for (std::size_t l = 0; l < all.size(); ++l) {
            const std::span expected = std::span(all[l]).last(left);
            ASSERT_TRUE(std::ranges::equal(expected.first(written),
                                           out[l].first(written)) &&
                        memory[l].IntactBut(written))
                << skip << ", " << first << ", " << second;
          }
          if (all.size() == 1) break;
        }
      }
    }
  };
  Everywhere([&](const Options& options) {
    for (const AnyWorld& world : {AnyWorld(floats), AnyWorld(quantized)}) {
      const auto survivors = [&](const Spans& out, std::size_t skip) {
        return detail::Survivors(world.Asked(world.One(asked)), out[0], options,
                                 skip);
      };
      Lists all(1);
      for (std::uint32_t i = 0; i < world.size(); ++i) {
        if (i % 3 != 0) all[0].push_back(i);
      }
      check(survivors, all);
      const auto pairs = [&](const Spans& out, std::size_t skip) {
        return detail::SurvivorPairs(world.Asked(asked), out[0], out[1],
                                     options, skip);
      };
      all.assign(2, std::vector<std::uint32_t>(20 * world.size()));
      const std::size_t count = pairs({all[0], all[1]}, 0);
      for (auto& list : all) list.resize(count);
      if (count != 0) check(pairs, all);
    }
  });
}

INSTANTIATE_TEST_SUITE_P(Sizes, OutputsTest,
                         ::testing::Values(0, 1, 2, 63, 64, 65, 127, 128, 200,
                                           4096, 4161));

// Scans cannot tell them from other views.
TEST(AaboViewTest, HasThePlanesOfSimplicesAndOfBoxes) {
  const AaboWorld3 world(std::vector<Aabo3>(1));
  const AaboView3 view = world.view();
  const SimplexView3 simplices = view.simplex();
  const AabbView3 boxes = view.aabb();
  EXPECT_EQ(simplices.min, view.min);
  EXPECT_TRUE(std::ranges::equal(boxes.min, std::span(view.min).first(3)));
  EXPECT_TRUE(std::ranges::equal(boxes.max, std::span(view.max).first(3)));
  EXPECT_EQ(simplices.size, 1u);
  EXPECT_EQ(boxes.size, 1u);
}

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
  const AabbWorld3 world = PointsOnX(20000);
  const Aabb3 query = Aabb3::Everything();
  std::vector<std::uint32_t> all(world.size());
  all.resize(Survivors(world, query, all));
  for (std::size_t most : {std::size_t{1}, std::size_t{3}, ~std::size_t{0}}) {
    std::vector<std::uint32_t> seen;
    std::size_t calls = 0;
    ForEachSurvivor(world, query, [&](Span<const std::uint32_t> some) {
      EXPECT_TRUE(0 < some.size() && some.size() <= 256);
      seen.insert(seen.end(), some.begin(), some.end());
      return ++calls == most ? Visit::kStop : Visit::kContinue;
    });
    EXPECT_TRUE(most == calls || seen == all);
    EXPECT_TRUE(std::equal(seen.begin(), seen.end(), all.begin()));
  }
  EXPECT_THROW(
      ForEachSurvivor(world, query,
                      [](const auto&) { throw std::runtime_error(""); }),
      std::runtime_error);
}

}  // namespace
}  // namespace halfspace::testing

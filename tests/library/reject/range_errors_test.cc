// Ranges that are none: each call names what is wrong, and writes nothing.
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "halfspace/reject_many.h"
#include "halfspace/world.h"
#include "tests/library/support/calls.h"
#include "tests/library/support/expect_invalid.h"
#include "tests/library/support/many_calls.h"

namespace halfspace::testing {
namespace {

class RangeErrorsTest : public ::testing::Test {
 protected:
  static AabbWorld3 WorldOf(std::size_t size) {
    return AabbWorld3(std::vector<Aabb3>(size, Aabb3::Everything()));
  }

  void ExpectAllRefuse(std::size_t size, const Range& range,
                       std::string_view argument, std::string_view expected,
                       std::string_view given) {
    const AabbWorld3 world = WorldOf(size);
    const auto check = [&](std::string_view name, auto call) {
      EXPECT_TRUE(Refuses(call, {"halfspace: ", name, ": ", argument,
                                 ": expected ", expected, "got ", given}));
    };
    const Options options{.range = range};
    ForEachCall(world, queries_[0], options, outputs_, check);
    EXPECT_TRUE(outputs_.Untouched());
    ForEachManyCall(world, queries_, options, many_outputs_, check);
    EXPECT_TRUE(many_outputs_.Untouched());
  }

  std::vector<Aabb3> queries_ = std::vector<Aabb3>(3, Aabb3::Everything());
  CallOutputs outputs_;
  ManyCallOutputs many_outputs_;
};

TEST_F(RangeErrorsTest, EndBeforeBegin) {
  const auto expect_refused = [&](std::size_t size, const Range& range) {
    ExpectAllRefuse(size, range, "options.range.end",
                    "not less than its begin, " + std::to_string(range.begin),
                    std::to_string(range.end));
  };
  expect_refused(1000, {128, 64});
  expect_refused(1000, {64, 0});
  expect_refused(1000, {8, 7});
  // Also past the world, and at its last word.
  expect_refused(130, {320, 256});
  expect_refused(130, {192, 130});
  expect_refused(0, {64, 0});
}

TEST_F(RangeErrorsTest, TheRangeIsNoExcuseForABadWorld) {
  const AabbView3 world{{}, {}, 1000};
  const auto check = [](std::string_view name, auto call) {
    EXPECT_TRUE(Refuses(call, {name, "world.min[0]", "a null pointer"}));
  };
  const Options options{.range = {64, 64}};
  ForEachCall(world, queries_[0], options, outputs_, check);
  ForEachManyCall(world, queries_, options, many_outputs_, check);
}

TEST_F(RangeErrorsTest, RowsThatOverlap) {
  const AabbWorld3 world = WorldOf(1000);
  std::vector<std::uint64_t> rows(100, 7);
  EXPECT_TRUE(Refuses(
      [&] {
        SurvivorMasks(world, queries_, rows, {.range = {0, 129}}, 2);
      },
      {"SurvivorMasks: row_words: expected 0, or at least the 3 words",
       "got 2"}));
  // Two rows of 3 words, and the 3 words of the last.
  const Options options{.range = {1, 130}};
  EXPECT_TRUE(Refuses(
      [&] {
        SurvivorMasks(world, queries_, std::span(rows).first(42), options, 20);
      },
      {"SurvivorMasks: rows: expected", "at least 3 rows of 3 words, 20 words",
       "42 words"}));
  EXPECT_EQ(rows, std::vector<std::uint64_t>(100, 7));
  SurvivorMasks(world, queries_, std::span(rows).first(43), options, 20);
  EXPECT_EQ(rows[42], 1u);
  EXPECT_EQ(rows[43], 7u);
  EXPECT_EQ(rows[3], 7u);
}

// Indices are the world's, so a range does not make them fit.
TEST_F(RangeErrorsTest, MoreObjectsOrQueriesThanIndices) {
  constexpr std::size_t kTooMany = (std::size_t{1} << 32) + 1;
  const float plane[1] = {};
  const SimplexView2 world{{plane, plane, plane}, kTooMany};
  const DownSimplex2 query = DownSimplex2::Everything();
  std::uint32_t first = 7;
  std::uint32_t second = 7;
  const Options options{.range = {0, 64}};
  EXPECT_TRUE(Refuses(
      [&] {
        (void)Survivors(world, query, {&first, 1}, options);
      },
      {"Survivors: world.size: expected at most 2^32", "got 4294967297"}));
  EXPECT_TRUE(Refuses(
      [&] {
        (void)SurvivorPairs(world, {&query, 1}, {&first, 1}, {&second, 1},
                            options);
      },
      {"SurvivorPairs: world.size: expected at most 2^32", "got 4294967297"}));
  const SimplexView2 small{{plane, plane, plane}, 1};
  EXPECT_TRUE(Refuses(
      [&] {
        (void)SurvivorPairs(small, {&query, kTooMany}, {&first, 1},
                            {&second, 1});
      },
      {"SurvivorPairs: queries: expected at most 2^32", "got 4294967297"}));
  EXPECT_EQ(first, 7u);
  EXPECT_EQ(second, 7u);
}

}  // namespace
}  // namespace halfspace::testing

// Where the crossover lies, from rows of known ratios.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <vector>

#include "bench/sections/sections.h"

namespace halfspace::bench {
namespace {

// Rows of gates 16, 32, 64, ... with these ratios of simplex to AABB.
std::vector<CrossoverRow> RowsOf(const std::vector<double>& ratios) {
  std::vector<CrossoverRow> rows;
  std::size_t w = 16;
  for (double ratio : ratios) {
    rows.push_back(
        {"AVX3", 16, "L2", "every-plane", w, {}, Ratio{ratio, ratio, ratio}});
    w *= 2;
  }
  return rows;
}

TEST(WStarTest, IsInterpolatedOverTheLogarithmOfTheWidth) {
  const WStar star = FindWStar(RowsOf({1.4, 1.2, 0.8, 0.7}));
  ASSERT_TRUE(star.w_star.has_value());
  EXPECT_DOUBLE_EQ(*star.w_star, 32.0 * std::sqrt(2.0));
  EXPECT_FALSE(star.is_at_most);
  EXPECT_EQ(star.target, "AVX3");
  EXPECT_EQ(star.lanes, 16u);
}

TEST(WStarTest, IsNothingWhereTheBoxWinsAtTheEnd) {
  EXPECT_FALSE(FindWStar(RowsOf({1.4, 1.2, 1.1})).w_star.has_value());
  EXPECT_FALSE(FindWStar(RowsOf({0.9, 0.8, 1.1})).w_star.has_value());
}

TEST(WStarTest, IsTheNarrowestGateWhereTheSimplexAlwaysLeads) {
  const WStar star = FindWStar(RowsOf({0.9, 0.8, 0.7}));
  ASSERT_TRUE(star.w_star.has_value());
  EXPECT_DOUBLE_EQ(*star.w_star, 16.0);
  EXPECT_TRUE(star.is_at_most);
}

TEST(WStarTest, IsTheLastCrossing) {
  const WStar star = FindWStar(RowsOf({0.9, 1.5, 1.5, 0.5}));
  ASSERT_TRUE(star.w_star.has_value());
  EXPECT_DOUBLE_EQ(*star.w_star, 64.0 * std::sqrt(2.0));
}

TEST(WStarTest, OfNoRowsIsNothing) {
  EXPECT_FALSE(FindWStar({}).w_star.has_value());
}

}  // namespace
}  // namespace halfspace::bench

// The arithmetic of the cost model, and the exact tests that it is applied to,
// against values computed by hand.
#include "bench/measure/cost_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <vector>

#include "bench/baselines/exact_tests.h"
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

TEST(WStarTest, HasTheQuartilesOfTheRatios) {
  std::vector<CrossoverRow> rows = RowsOf({1.4, 1.2, 0.8, 0.7});
  for (CrossoverRow& row : rows) {
    row.simplex_over_aabb->low -= 0.4;
    row.simplex_over_aabb->high += 0.4;
  }
  const WStar star = FindWStar(rows);
  EXPECT_EQ(star.low, 16.0);           // 1.0 0.8 0.4 0.3
  EXPECT_EQ(star.high, std::nullopt);  // 1.8 1.6 1.2 1.1
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

TEST(CostModelTest, ExpectsTheSumOfWhatIsReached) {
  EXPECT_DOUBLE_EQ(ExpectedHalfSpaces(0.0, 6), 6.0);
  EXPECT_DOUBLE_EQ(ExpectedHalfSpaces(1.0, 6), 1.0);
  EXPECT_DOUBLE_EQ(ExpectedHalfSpaces(0.5, 4), 1.0 + 0.5 + 0.25 + 0.125);
}

TEST(CostModelTest, BreaksEvenWhereExtraCandidatesCostWhatIsSaved) {
  // 0.1 ns saved an object, 1 more candidate in 1000: 100 ns.
  const auto ns = BreakEvenNanoseconds(0.1, 0.001);
  ASSERT_TRUE(ns.has_value());
  EXPECT_NEAR(*ns, 100.0, 1e-9);
  EXPECT_FALSE(BreakEvenNanoseconds(-0.1, 0.001));
  EXPECT_FALSE(BreakEvenNanoseconds(0.1, 0.0));
}

TEST(ExactTestsTest, KnowWhatTouches) {
  const Triangle flat = {{{0, 0, 0}, {2, 0, 0}, {0, 2, 0}}};
  const auto moved = [&flat](float x, float y, float z) {
    Triangle t = flat;
    for (Vector3& corner : t) {
      corner = {corner[0] + x, corner[1] + y, corner[2] + z};
    }
    return t;
  };
  EXPECT_TRUE(Touch(flat, flat));
  EXPECT_TRUE(Touch(flat, moved(2, 0, 0)));  // a corner
  EXPECT_FALSE(Touch(flat, moved(2.1f, 0, 0)));
  // In one plane, their boxes overlap.
  EXPECT_FALSE(Touch(flat, moved(1.1f, 1.1f, 0)));
  EXPECT_FALSE(Touch(flat, moved(0, 0, 0.1f)));
  // Through it, and past its long side.
  const Triangle through = {{{0.5f, 0.5f, -1}, {0.5f, 0.5f, 1}, {3, 3, 0}}};
  const Triangle past = {{{1.2f, 1.2f, -1}, {1.2f, 1.2f, 1}, {3, 3, 0}}};
  EXPECT_TRUE(Touch(flat, through));
  EXPECT_FALSE(Touch(flat, past));

  EXPECT_TRUE(Touch(Sphere3{{0, 0, 0}, 1}, Sphere3{{2, 0, 0}, 1}));
  EXPECT_FALSE(Touch(Sphere3{{0, 0, 0}, 1}, Sphere3{{1.5f, 1.5f, 0}, 1}));

  const OrientedBox box{
      {0, 0, 0}, {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, {1, 1, 1}};
  // Turned by an eighth, with a corner at 1.414 on X.
  const float h = std::sqrt(0.5f);
  const auto turned = [h](float x) {
    return OrientedBox{
        {x, 0, 0}, {{{h, h, 0}, {-h, h, 0}, {0, 0, 1}}}, {1, 1, 1}};
  };
  EXPECT_TRUE(Touch(box, turned(2.4f)));
  EXPECT_FALSE(Touch(box, turned(2.42f)));
  // Edge against edge, which no face separates: both turned, about Z and Y.
  const OrientedBox other{
      {2.1f, 0, 2.1f}, {{{h, 0, h}, {0, 1, 0}, {-h, 0, h}}}, {1, 1, 1}};
  EXPECT_FALSE(Touch(box, other));
}

}  // namespace
}  // namespace halfspace::bench

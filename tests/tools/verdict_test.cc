// The rule of the verdict: what a range of groups promises, where a ratio
// crosses 1, and the lines that say so.
#include "bench/sections/verdict.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "bench/measure/groups.h"
#include "bench/worlds/random.h"

namespace halfspace::bench {
namespace {

TEST(VerdictTest, ClaimsAWinnerOnlyOutsideTheRange) {
  EXPECT_EQ(WinnerOf(RangeOf({1.2, 1.01, 1.3})), Winner::kSimplex);
  EXPECT_EQ(WinnerOf(RangeOf({0.9, 0.8, 0.99})), Winner::kBox);
  EXPECT_EQ(WinnerOf(RangeOf({1.2, 1.3, 0.99})), Winner::kNone);
  EXPECT_EQ(WinnerOf(RangeOf({1.0, 1.0, 1.0})), Winner::kNone);
}

TEST(VerdictTest, ChoosesAScheduleInOneHalfOfTheRepetitions) {
  struct Row {
    std::vector<std::vector<double>> samples;
    double expected;
  };
  for (const Row& row : std::vector<Row>{
           {{{1.0}}, 1.0},
           {{{3.0}, {2.0}}, 2.0},
           // The second one is better in both halves.
           {{{2.0, 2.0, 2.0, 2.0}, {1.0, 1.5, 1.0, 1.5}}, 1.25},
           // Two runs of one kernel. The luckier of the two medians is 2.0.
           {{{1.0, 3.0}, {3.0, 1.0}}, 3.0},
           // The median of a half leaves out what disturbed one repetition.
           {{{9.0, 1.0, 1.0, 1.0, 1.0, 1.0}}, 1.0}}) {
    EXPECT_EQ(BestTime(row.samples), row.expected);
  }
}

TEST(VerdictTest, BothBoundsChooseFromEquallyManySchedules) {
  std::array<std::set<Schedule>, 3> schedules;
  for (const Contender& contender : kContenders) {
    EXPECT_TRUE(schedules[static_cast<std::size_t>(contender.shape)]
                    .insert(contender.how)
                    .second);
  }
  EXPECT_EQ(schedules[0], schedules[1]);
  EXPECT_EQ(schedules[0].size(), 3u);
}

TEST(VerdictTest, ComparesShapesGroupByGroup) {
  VerdictWorld world;
  world.objects = 100;
  world.survivors.assign(3, {.aabb = 1.0, .simplex = 2.0, .aabo = 1.0});
  world.times = {{{{}, 1.0, 2.0}, {{}, 2.0, 3.0}, {{}, 1.0, 1.5}}};
  const Ratio ratio = world.BoxOverSimplex(0, 0.0);
  EXPECT_EQ(ratio.low, 1.5);
  EXPECT_EQ(ratio.median, 1.5);
  EXPECT_EQ(ratio.high, 2.0);
  // Exact tests of 100 ns: 1 ns an object more for the box, 2 for the simplex.
  EXPECT_NEAR(world.BoxOverSimplex(0, 100.0).median, 1.0, 1e-12);
  EXPECT_DOUBLE_EQ(world.MeanSurvivors().simplex, 2.0);
}

// What a range promises, for groups that differ in nothing but chance.
TEST(GroupsTest, RangesKeepTheirPromise) {
  struct Row {
    std::vector<double> groups;
    Ratio expected;
  };
  for (const Row& row :
       std::vector<Row>{{{2.0}, {2.0, 2.0, 2.0}},
                        {{3.0, 1.0}, {2.0, 1.0, 3.0}},
                        {{5.0, 1.0, 2.0}, {2.0, 1.0, 5.0}},
                        // Of ten groups one on each side is left out.
                        {{9.0, 1.0, 2.0, 2.0, 2.0, 2.0, 3.0, 3.0, 3.0, 0.5},
                         {2.0, 1.0, 3.0}},
                        {{kInfinity, 1.0, kInfinity, kInfinity},
                         {kInfinity, 1.0, kInfinity}},
                        {{0.0, 0.0, 0.0, kInfinity}, {0.0, 0.0, kInfinity}}}) {
    const Ratio range = GroupRange(row.groups);
    EXPECT_EQ(range.median, row.expected.median);
    EXPECT_EQ(range.low, row.expected.low);
    EXPECT_EQ(range.high, row.expected.high);
  }
  // The tables of `--details verdict`: 7 sizes, 5 columns, with and without
  // exact tests.
  EXPECT_LT(2 * 7 * 5 * kFalseWinnerChance, 0.05);
  Random random(1);
  const auto run = [&random] {
    std::vector<double> groups(kGroups);
    for (double& group : groups) group = random.Signed();
    return GroupRange(groups);
  };
  constexpr int kRuns = 10'000;
  int covered = 0;
  int excluded = 0;
  for (int i = 0; i < kRuns; ++i) {
    const Ratio range = run();
    const double median = run().median;
    covered += range.low <= median && median <= range.high ? 1 : 0;
    excluded += range.low > 0.0 || range.high < 0.0 ? 1 : 0;
  }
  EXPECT_NEAR(covered / double{kRuns}, 0.99, 0.005);
  EXPECT_NEAR(excluded / double{kRuns}, kFalseWinnerChance, 0.0005);
}

// A ratio of straight lines between logarithms, as its points say.
struct Curve {
  std::vector<std::pair<double, double>> points;
  double operator()(double size) const {
    for (std::size_t i = 1; i < points.size(); ++i) {
      if (size > points[i].first) continue;
      const double part = std::log(size / points[i - 1].first) /
                          std::log(points[i].first / points[i - 1].first);
      return points[i - 1].second *
             std::pow(points[i].second / points[i - 1].second, part);
    }
    return points.back().second;
  }
};

TEST(CrossingTest, FindsWhereARatioIsAboveOne) {
  struct Row {
    const char* what;
    Curve curve;
    SizeSpan expected;
  };
  const std::vector<double> sizes = {0.1, 1.0, 10.0, 30.0};
  for (const Row& row : std::vector<Row>{
           {"crosses once", {{{0.1, 0.5}, {10.0, 2.0}}}, {1.0, kInfinity}},
           // A line between the rows 1 and 10 would say 3.4.
           {"is steep beside a row",
            {{{0.1, 0.5}, {1.0, 0.8}, {1.2, 1.25}, {10.0, 1.5}, {30.0, 1.5}}},
            {std::sqrt(1.2), kInfinity}},
           {"is above at all sizes",
            {{{0.1, 1.1}, {30.0, 1.5}}},
            {0.0, kInfinity}},
           {"is above at no size",
            {{{0.1, 0.5}, {30.0, 1.0}}},
            {kInfinity, 0.0}},
           {"ends, as with exact tests",
            {{{0.1, 0.5}, {10.0, 2.0}, {30.0, 0.5}}},
            {1.0, std::sqrt(10.0 * 30.0)}},
           {"falls", {{{0.1, 2.0}, {10.0, 0.5}}}, {0.0, 1.0}},
           {"is above twice: the greater one counts",
            {{{0.1, 1.1}, {1.0, 0.5}, {10.0, 2.0}, {30.0, 2.0}}},
            {std::sqrt(10.0), kInfinity}}}) {
    const SizeSpan span = FindSpan(sizes, row.curve);
    const auto expect_near = [&](double value, double expected) {
      if (std::isfinite(expected)) {
        EXPECT_NEAR(value, expected, 0.02 * expected) << row.what;
      } else {
        EXPECT_EQ(value, expected) << row.what;
      }
    };
    expect_near(span.from, row.expected.from);
    expect_near(span.to, row.expected.to);
  }
}

TEST(CrossingTest, MeasuresMoreSizesNearIt) {
  std::vector<double> measured;
  const Curve curve{{{0.1, 0.5}, {10.0, 2.0}}};
  const std::vector<double> sizes = {0.1, 0.9, 3.0, 30.0};
  FindSpan(sizes, [&](double size) {
    measured.push_back(size);
    return curve(size);
  });
  ASSERT_EQ(measured.size(), sizes.size() + 4);
  for (std::size_t i = sizes.size(); i < measured.size(); ++i) {
    EXPECT_GT(measured[i], 0.9);
    EXPECT_LT(measured[i], 3.0);
  }
  EXPECT_NEAR(measured.back(), 1.0, 0.1);
}

const std::vector<double> kLeadSizes = {0.1, 1.0, 30.0};
const Ratio kAbove = {kInfinity, kInfinity, kInfinity};  // beyond 30 %
const Ratio kBelow = {0.0, 0.0, 0.0};                    // below 0.1 %

TEST(LeadTest, NamesTheSizesOfATarget) {
  const Ratio one = {1.0, 0.9, 1.1};
  struct Row {
    Crossings crossings;
    std::string simplex;
    std::string box_again;
  };
  const std::string of = " of the world's side";
  const std::string every = "(at every size measured, 0.1 to 30 %)";
  const std::string none = "(at no size measured, 0.1 to 30 %)";
  for (const Row& row : std::vector<Row>{
           {{{3.41, 3.06, 3.8}, kAbove}, "3.4 % [3.1, 3.8]" + of, none},
           {{{0.842, 0.7, 1.0}, kAbove}, "0.84 % [0.7, 1]" + of, none},
           {{{0.15, 0.0, 0.2}, kAbove}, "0.15 % [< 0.1, 0.2]" + of, none},
           {{{0.0, 0.0, 0.2}, kAbove}, "< 0.1 % [< 0.1, 0.2]" + of, none},
           {{{12.3, 9.9, kInfinity}, kAbove}, "12 % [9.9, > 30]" + of, none},
           {{one, {20.0, 15.0, 25.0}},
            "1 % [0.9, 1.1]" + of + ", up to 20 % [15, 25]",
            "20 % [15, 25]" + of},
           {{one, {6.04, 5.2, 7.1}},
            "1 % [0.9, 1.1]" + of + ", up to 6 % [5.2, 7.1]",
            "6 % [5.2, 7.1]" + of},
           {{kBelow, kAbove}, every, none},
           {{kAbove, kBelow}, none, every}}) {
    EXPECT_EQ(SimplexText(row.crossings, kLeadSizes), row.simplex);
    EXPECT_EQ(BoxAgainText(row.crossings, kLeadSizes), row.box_again);
  }
}

// 24 runs differed in one cell of a table, near the size at which both bounds
// take the same time, and their first line said "on no target", "from 4 lanes
// on", "from 8" or "from 16". Now a cell that is a tie, or that is not, moves
// the size by a few per cent.
TEST(CrossingTest, MovesLittleWithOneCell) {
  const std::vector<double> sizes = {0.1, 0.3, 1.0, 3.0, 10.0, 30.0};
  for (double ratio_at_1_percent : {0.995, 1.005}) {
    const Curve curve{{{0.1, 0.8},
                       {0.3, 0.9},
                       {1.0, ratio_at_1_percent},
                       {3.0, 1.4},
                       {30.0, 1.5}}};
    EXPECT_NEAR(FindSpan(sizes, curve).from, 1.0, 0.1) << ratio_at_1_percent;
  }
}

// "The simplex wins on no target" stood above "AVX2: the simplex wins".
TEST(LeadTest, OfAFileSaysWhatItsRowsSay) {
  EXPECT_EQ(RatioText({0.7, 0.65, 0.8}),
            "0.70 [0.65, 0.80]: the box is faster");
  EXPECT_EQ(RatioText({1.01, 0.98, 1.03}), "1.01 [0.98, 1.03]: no difference");
  EXPECT_EQ(RatioText({1.15, 1.11, 1.16}),
            "1.15 [1.11, 1.16]: the simplex is faster");
}

}  // namespace
}  // namespace halfspace::bench

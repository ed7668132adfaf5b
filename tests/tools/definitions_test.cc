// The quantities of the paper's sections 2.4 and 2.5, and the rule of the
// verdict, on a small scene with loops of the test's own.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "bench/measure/cost_model.h"
#include "bench/measure/counts.h"
#include "bench/measure/crossing.h"
#include "bench/measure/groups.h"
#include "bench/sections/verdict.h"
#include "bench/worlds/scene.h"
#include "halfspace/fit.h"

namespace halfspace::bench {
namespace {

// 12 objects of 1 x 1 x 1 at (0, 1, ... 11, 0, 0), and three queries.
struct Line {
  AaboWorld3 objects;
  std::vector<Aabo3> queries;

  Line() {
    const auto cube = [](float x, float side) {
      return BoundAabb(Aabb3{{x, 0, 0}, {x + side, side, side}});
    };
    for (int i = 0; i < 12; ++i) {
      objects.Push(cube(static_cast<float>(i), 0.5f));
    }
    // Their right ends are at 0.25, 5.25 and 11.25: p is 11/12, 6/12 and 0.
    for (float x : {0.0f, 5.0f, 11.0f}) queries.push_back(cube(x, 0.25f));
  }
};

TEST(DefinitionsTest, EarlyOutByHand) {
  const Line line;
  std::vector<float> maxima;
  for (const Aabo3& query : line.queries) maxima.push_back(query.max[0]);
  const AaboView3 view = line.objects.view();
  const auto at = [&](std::size_t w) {
    return EarlyOutOf({view.min[0], view.size}, maxima, w);
  };
  const double p = (11.0 + 6.0 + 0.0) / 36.0;
  EXPECT_DOUBLE_EQ(at(1).of_mean_p, p);
  EXPECT_DOUBLE_EQ(at(1).mean_of_p_w.median, p);
  EXPECT_DOUBLE_EQ(at(1).counted.median, p);
  // An object that touches is not rejected.
  const std::vector<float> minima = {1.0f, 2.0f};
  EXPECT_DOUBLE_EQ(EarlyOutOf(minima, {{1.0f}}, 1).counted.median, 0.5);
  // Batches of 4: the first query rejects the last two, the second the last one
  // whole, and objects 6 and 7 of the second.
  EXPECT_NEAR(at(4).of_mean_p, std::pow(17.0 / 36.0, 4), 1e-12);
  EXPECT_NEAR(at(4).mean_of_p_w.median,
              (std::pow(11.0 / 12.0, 4) + std::pow(0.5, 4)) / 3.0, 1e-12);
  EXPECT_DOUBLE_EQ(at(4).counted.median, (2.0 / 3.0 + 1.0 / 3.0) / 3.0);
}

// A seeded scene, and everything about it by loops over pairs.
TEST(DefinitionsTest, OfASceneByLoops) {
  const Workload scene = MakeScene(
      512, 64, /*seed=*/9, [](double) {}, 8.0f);
  std::size_t boxes = 0;
  std::size_t simplices = 0;
  double sum_p = 0.0;
  double sum_p4 = 0.0;
  std::size_t whole = 0;
  for (const Aabo3& query : scene.queries) {
    std::size_t first = 0;
    for (std::size_t i = 0; i < 512; i += 4) {
      std::size_t of_batch = 0;
      for (std::size_t j = i; j < i + 4; ++j) {
        const Aabo3 object = scene.objects.Get(j);
        bool in_box = true;
        for (std::size_t k = 0; k < 3; ++k) {
          in_box &= object.min[k] <= query.max[k];
          in_box &= object.max[k] >= query.min[k];
        }
        bool in_simplex = true;
        for (std::size_t k = 0; k < 4; ++k) {
          in_simplex &= object.min[k] <= query.max[k];
        }
        boxes += in_box ? 1 : 0;
        simplices += in_simplex ? 1 : 0;
        of_batch += object.min[0] > query.max[0] ? 1 : 0;
      }
      first += of_batch;
      whole += of_batch == 4 ? 1 : 0;
    }
    const double p = static_cast<double>(first) / 512.0;
    sum_p += p / 64.0;
    sum_p4 += p * p * p * p / 64.0;
  }
  PerShape<std::size_t> survivors;
  std::vector<float> maxima;
  for (const Aabo3& query : scene.queries) {
    AddSurvivors(scene.objects.view(), query, survivors);
    maxima.push_back(query.max[0]);
  }
  EXPECT_EQ(survivors.aabb, boxes);
  EXPECT_EQ(survivors.simplex, simplices);
  const EarlyOut shares =
      EarlyOutOf({scene.objects.view().min[0], 512}, maxima, 4);
  EXPECT_NEAR(shares.of_mean_p, std::pow(sum_p, 4.0), 1e-12);
  EXPECT_NEAR(shares.mean_of_p_w.median, sum_p4, 1e-12);
  EXPECT_NEAR(shares.counted.median,
              static_cast<double>(whole) / (64.0 * 128.0), 1e-12);
  // The paper's p^w is too small: p differs between queries.
  EXPECT_GT(shares.counted.low, 1.2 * shares.of_mean_p);
}

TEST(DefinitionsTest, CubesAreAsLooseAsTheirVolumes) {
  // Points against the simplex of a unit cube, whose legs are 3 long: volume
  // 27 / 6 = 4.5.
  AaboWorld3 points;
  for (int x = -40; x < 40; ++x) {
    for (int y = -40; y < 40; ++y) {
      for (int z = -40; z < 40; ++z) {
        const auto at = [](int i) {
          return (static_cast<float>(i) + 0.5f) / 10.0f;
        };
        points.Push(BoundPoint<3>({at(x), at(y), at(z)}));
      }
    }
  }
  PerShape<double> survivors;
  AddSurvivors(points.view(), BoundAabb(Aabb3{{0, 0, 0}, {1, 1, 1}}),
               survivors);
  EXPECT_EQ(survivors.aabb, 1000.0);
  EXPECT_NEAR(survivors.simplex / survivors.aabb, 4.5, 0.3);
}

// c of equal balls in a world without an edge is the ratio of the volumes of
// where their centers may be: (6 + 2 sqrt(3))^3 / 6 over 4^3, for any radius.
TEST(DefinitionsTest, BallsAreAsLooseAtEverySize) {
  const double c = std::pow(6.0 + 2.0 * std::sqrt(3.0), 3.0) / 6.0 / 64.0;
  for (float radius : {0.01f, 30.0f}) {
    AaboWorld3 balls;
    for (int i = 0; i < 80 * 80 * 80; ++i) {
      const auto at = [radius](int j) {
        return (static_cast<float>(j) - 39.5f) * radius / 6.0f;
      };
      balls.Push(BoundSphere<3>(
          {{at(i % 80), at(i / 80 % 80), at(i / 6400)}, radius}));
    }
    PerShape<double> survivors;
    AddSurvivors(balls.view(), BoundSphere<3>({{0, 0, 0}, radius}), survivors);
    EXPECT_NEAR(survivors.simplex / survivors.aabb, c, 0.1) << radius;
  }
}

TEST(DefinitionsTest, AverageAndItsErrorByHand) {
  const Ratio mean = MeanOf({1.0, 2.0, 3.0});
  EXPECT_DOUBLE_EQ(mean.median, 2.0);
  EXPECT_NEAR(mean.high, 2.0 + 2.0 / std::sqrt(3.0), 1e-12);
  EXPECT_NEAR(mean.low, 2.0 - 2.0 / std::sqrt(3.0), 1e-12);
}

TEST(DefinitionsTest, TheFormulaOfThePaperByHand) {
  // Half of all objects reach the second half-space, a quarter the third.
  const std::vector<double> reached = {1.0, 0.5, 0.25};
  EXPECT_DOUBLE_EQ(HalfSpacesByFormula(reached, 1.0), 1.75);
  EXPECT_DOUBLE_EQ(HalfSpacesByFormula(reached, 2.0),
                   1.0 + (1.0 - 0.25) + (1.0 - 0.5625));
  EXPECT_NEAR(HalfSpacesByFormula(reached, 4096.0), 3.0, 1e-12);
  EXPECT_EQ(WidthFrom(64, [](double w) { return w - 6.5; }), 7u);
  EXPECT_EQ(WidthFrom(64, [](double w) { return 6.5 - w; }), std::nullopt);
  EXPECT_EQ(WidthFrom(64, [](double) { return 1.0; }), 1u);
}

TEST(DefinitionsTest, AdvantageAndLimitsByHand) {
  // Six half-spaces of 0.02 ns and 1 survivor in 100, against four and 2.
  EXPECT_NEAR(Advantage({6.0, 0.01}, {4.0, 0.02}, 0.02, 3.0), 0.04 - 0.03,
              1e-12);
  EXPECT_NEAR(Advantage({1.56, 0.01}, {1.87, 0.02}, 0.02, 0.0), -0.0062, 1e-12);
  // Where Adv is 0: kappa_box / N = 2 w_cmp / ((c - 1) w_full).
  EXPECT_NEAR(DensityLimit(2.0, 0.02, 4.0), 0.01, 1e-12);
  EXPECT_NEAR(Advantage({6.0, 0.01}, {4.0, 0.02}, 0.02, 4.0), 0.0, 1e-12);
  EXPECT_EQ(DensityLimit(1.0, 0.02, 4.0),
            std::numeric_limits<double>::infinity());
  EXPECT_NEAR(BreakEven(0.04, 0.01), 4.0, 1e-12);
  EXPECT_EQ(BreakEven(-0.01, 0.01), 0.0);
  EXPECT_EQ(BreakEven(0.01, 0.0), std::numeric_limits<double>::infinity());
}

TEST(DefinitionsTest, FindsEveryCrossing) {
  const std::vector<double> widths = {1, 4, 16, 64};
  EXPECT_TRUE(CrossingsOf(widths, std::vector{0.5, 0.9, 0.6, 0.7}).empty());
  const std::vector<double> twice =
      CrossingsOf(widths, std::vector{0.5, 1.5, 1.25, 0.75});
  ASSERT_EQ(twice.size(), 2u);
  EXPECT_NEAR(twice[0], 2.0, 1e-12);
  EXPECT_NEAR(twice[1], 32.0, 1e-12);
}

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
  EXPECT_EQ(schedules[0].size() + schedules[1].size(), kContenders.size());
  // The verdict is timed for two bounds and each target: kAuto chooses it where
  // it is the fastest.
  EXPECT_FALSE(schedules[0].contains(Schedule::kStagedByAxis));
}

TEST(VerdictTest, ComparesShapesGroupByGroup) {
  VerdictWorld world;
  world.objects = 100;
  world.group_survivors = {{.aabb = 1.0, .simplex = 2.0, .aabo = 1.0},
                           {.aabb = 1.0, .simplex = 2.0, .aabo = 1.0},
                           {.aabb = 1.0, .simplex = 2.0, .aabo = 1.0}};
  world.cells.resize(1);
  world.cells[0].simplex = {1.0, 2.0, 1.0};
  world.cells[0].box = {2.0, 3.0, 1.5};
  const Ratio ratio = world.OverSimplex(ShapeKind::kAabb, 0, 0.0);
  EXPECT_EQ(ratio.low, 1.5);
  EXPECT_EQ(ratio.median, 1.5);
  EXPECT_EQ(ratio.high, 2.0);
  // Exact tests of 100 ns: 1 ns an object more for the box, 2 for the simplex.
  EXPECT_NEAR(world.OverSimplex(ShapeKind::kAabb, 0, 100.0).median, 1.0, 1e-12);
  EXPECT_EQ(
      world.cells[0].Difference(ShapeKind::kAabb, ShapeKind::kSimplex).median,
      1.0);
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
  // Five groups without one left out, as computed by hand: 2 of 32 signs, and
  // 10 of 120 places of the three least of ten.
  EXPECT_DOUBLE_EQ(FalseWinnerChance(5), 2.0 / 32.0);
  EXPECT_DOUBLE_EQ(MissedMedianChance(5), 2.0 * 10.0 / 120.0);
  EXPECT_DOUBLE_EQ(FalseWinnerChance(kGroups), 2.0 * 18.0 / 131072.0);
  EXPECT_LT(MissedMedianChance(kGroups), 0.05);
  // The tables of `--details verdict`: 7 sizes, 5 columns, with and without
  // exact tests.
  EXPECT_LT(2 * 7 * 5 * FalseWinnerChance(kGroups), 0.05);
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

using Lines = std::vector<std::string>;
const std::vector<double> kLeadSizes = {0.1, 1.0, 30.0};
const Ratio kAbove = {kInfinity, kInfinity, kInfinity};  // beyond 30 %
const Ratio kBelow = {0.0, 0.0, 0.0};                    // below 0.1 %

TEST(LeadTest, NamesTheSizeOfEachTarget) {
  struct Row {
    Crossings sizes;
    std::string expected;
  };
  for (const Row& row : std::vector<Row>{
           {{{3.41, 3.06, 3.8}, kAbove},
            "3.4 % [3.1, 3.8] of the world's side"},
           {{{0.842, 0.7, 1.0}, kAbove}, "0.84 % [0.7, 1] of the world's side"},
           {{{0.15, 0.0, 0.2}, kAbove},
            "0.15 % [< 0.1, 0.2] of the world's side"},
           {{{0.0, 0.0, 0.2}, kAbove},
            "< 0.1 % [< 0.1, 0.2] of the world's side"},
           {{{12.3, 9.9, kInfinity}, kAbove},
            "12 % [9.9, > 30] of the world's side"},
           {{{1.0, 0.9, 1.1}, {20.0, 15.0, 25.0}},
            "1 % [0.9, 1.1] of the world's side, up to 20 % [15, 25]"},
           {{kBelow, kAbove}, "(at every size measured, 0.1 to 30 %)"},
           {{kAbove, kBelow}, "(at no size measured, 0.1 to 30 %)"}}) {
    EXPECT_EQ(SizeLead({{"AVX2, 8", row.sizes}}, kLeadSizes),
              (Lines{"The simplex scan is faster than the box scan for objects "
                     "larger than",
                     "  AVX2, 8       " + row.expected}));
  }
}

// 24 runs differed in one cell of a table, near the size at which both bounds
// take the same time, and their first line said "on no target", "from 4 lanes
// on", "from 8" or "from 16". Now a cell that is a tie, or that is not, moves
// the size by a few per cent and changes no word.
TEST(LeadTest, DoesNotFlipWithOneCell) {
  const auto lead = [](double ratio_at_1_percent) {
    const Curve curve{{{0.1, 0.8},
                       {0.3, 0.9},
                       {1.0, ratio_at_1_percent},
                       {3.0, 1.4},
                       {30.0, 1.5}}};
    const std::vector<double> sizes = {0.1, 0.3, 1.0, 3.0, 10.0, 30.0};
    const double from = FindSpan(sizes, curve).from;
    EXPECT_NEAR(from, 1.0, 0.1) << ratio_at_1_percent;
    return SizeLead({{"AVX2, 8", {{1.0, 0.9, 1.1}, kAbove}}}, sizes);
  };
  EXPECT_EQ(lead(0.995), lead(1.005));
}

TEST(LeadTest, SaysFromWhereTheBoxIsFasterAgain) {
  struct Row {
    Crossings sizes;
    double exact_ns;
    Lines expected;
  };
  const Ratio one = {1.0, 0.9, 1.1};
  for (const Row& row : std::vector<Row>{
           {{one, {6.04, 5.2, 7.1}},
            30.2,
            {"With an exact test of 30 ns for each survivor, the box is faster "
             "again",
             "from 6 % [5.2, 7.1] on (AVX2, 8)."}},
           {{one, kAbove},
            2.34,
            {"With an exact test of 2.3 ns for each survivor, the box is not "
             "faster again",
             "up to 30 % (AVX2, 8)."}},
           {{kAbove, kBelow},
            500.0,
            {"With an exact test of 500 ns for each survivor, the box is "
             "faster",
             "at every size measured, 0.1 to 30 % (AVX2, 8)."}}}) {
    EXPECT_EQ(ExactLead({"AVX2, 8", row.sizes}, kLeadSizes, row.exact_ns),
              row.expected);
  }
}

// "The simplex wins on no target" stood above "AVX2: the simplex wins".
TEST(LeadTest, OfAFileSaysWhatItsRowsSay) {
  EXPECT_EQ(
      RatioLead({{"scalar", {0.7, 0.65, 0.8}},
                 {"SSE4.2, 4", {1.01, 0.98, 1.03}},
                 {"AVX2, 8", {1.15, 1.11, 1.16}}}),
      (Lines{"The box scan takes so many times as long as the simplex scan:",
             "  scalar        0.70 [0.65, 0.80]: the box is faster",
             "  SSE4.2, 4     1.01 [0.98, 1.03]: no difference",
             "  AVX2, 8       1.15 [1.11, 1.16]: the simplex is faster"}));
  EXPECT_EQ(ExactRatioLead({"AVX2, 8", {0.9, 0.85, 0.95}}, 9.0),
            (Lines{"With an exact test of 9.0 ns for each survivor, it takes",
                   "0.90 [0.85, 0.95] times as long: the box is faster (AVX2, "
                   "8)."}));
}

}  // namespace
}  // namespace halfspace::bench

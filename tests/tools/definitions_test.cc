// The quantities of the paper's sections 2.4 and 2.5, and the rule of the
// verdict, on a small scene with loops of the test's own.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "bench/measure/cost_model.h"
#include "bench/measure/counts.h"
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

TEST(VerdictTest, ComparesTheBestScheduleOfEachShapeGroupByGroup) {
  VerdictWorld world;
  world.objects = 100;
  world.survivors = {.aabb = 1.0, .simplex = 2.0, .aabo = 1.0};
  world.cells.resize(1);
  // Simplex, AABB flat, staged and by axis, AABO.
  world.cells[0].ns = {{{1.0, 2.0, 1.0},
                        {3.0, 6.0, 3.0},
                        {2.0, 3.0, 1.5},
                        {1.0, 9.0, 9.0},
                        {1.1, 2.2, 1.2}}};
  EXPECT_EQ(world.cells[0].BestOf(ShapeKind::kAabb), 2u);
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

}  // namespace
}  // namespace halfspace::bench

// The experiments of the paper: what they count, by loops of the tests' own and
// against the paper's figures, and their loops on every target.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <span>
#include <vector>

#include "bench/paper/loops.h"
#include "bench/paper/model.h"
#include "bench/paper/points.h"
#include "bench/paper/volume_set.h"
#include "bench/paper/work_count.h"
#include "bench/worlds/moved_clouds.h"
#include "bench/worlds/random.h"
#include "bench/worlds/workload.h"
#include "halfspace/fit.h"
#include "tests/library/support/environment.h"

namespace halfspace::bench {
namespace {

// ---- Table 1.

Workload SmallScene(std::size_t objects, std::size_t queries) {
  return MakeScene(objects, queries, /*seed=*/7);
}

WorkCounter Counted(const Workload& scene) {
  WorkCounter counter(scene.objects.view());
  for (const Aabo3& query : scene.queries) counter.Add(query);
  return counter;
}

// Objects 0, 64 and 300 of 320.
TEST(WorkCountTest, TheLastBatchMayBeShort) {
  const std::array<std::uint64_t, 5> kept = {1, 1, 0, 0,
                                             std::uint64_t{1} << 44};
  const std::array<std::size_t, 7> batches = {3, 3, 3, 3, 2, 1, 1};
  for (std::size_t i = 0; i < kWorkWidths.size(); ++i) {
    EXPECT_EQ(BatchesLeft(kept, kWorkWidths[i]), batches[i]) << kWorkWidths[i];
  }
}

TEST(WorkCountTest, AddsUpToTheHalfSpacesOfSingleObjects) {
  // The last batch of 4096 is short.
  const WorkCounter counter = Counted(SmallScene(4096 + 64, 6));
  const WorkCount work = counter.Average();
  for (ShapeKind shape : kShapes) {
    const std::vector<double> reached = counter.Reached(shape);
    ASSERT_EQ(reached.size(), PlaneCountOf(shape));
    EXPECT_EQ(reached[0], 1.0);
    EXPECT_TRUE(std::is_sorted(reached.rbegin(), reached.rend()));
    EXPECT_NEAR(std::accumulate(reached.begin(), reached.end(), 0.0),
                work.Of(shape)[0], 1e-12);
    EXPECT_LE(work.Of(shape).back(), static_cast<double>(PlaneCountOf(shape)));
  }
}

TEST(WorkCountTest, ReproducesThePaper) {
  // Many queries: the narrow widths depend on where they lie.
  const Workload scene = SmallScene(1 << 14, 1024);
  const WorkCount work = Counted(scene).Average();
  for (ShapeKind shape : kShapes) {
    for (std::size_t i = 0; i < kWorkWidths.size(); ++i) {
      EXPECT_NEAR(work.Of(shape)[i], kPaperWork.Of(shape)[i], 0.1)
          << NameOf(shape) << ", " << kWorkWidths[i];
    }
  }
}

TEST(SceneTest, SurvivorsAreAsLooseAsInThePaper) {
  const Workload scene = SmallScene(1 << 18, 128);
  PerShape<std::size_t> survivors;
  for (const Aabo3& query : scene.queries) {
    AddSurvivors(scene.objects.view(), query, survivors);
  }
  const auto looseness = [&](std::size_t count) {
    return static_cast<double>(count) / static_cast<double>(survivors.aabb);
  };
  EXPECT_NEAR(looseness(survivors.simplex), 2.18, 0.15);
  EXPECT_NEAR(looseness(survivors.aabo), 0.92, 0.03);
}

// ---- The model.

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

TEST(ModelTest, EarlyOutByHand) {
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

TEST(ModelTest, AverageAndItsErrorByHand) {
  const Ratio mean = MeanOf({1.0, 2.0, 3.0});
  EXPECT_DOUBLE_EQ(mean.median, 2.0);
  EXPECT_NEAR(mean.high, 2.0 + 2.0 / std::sqrt(3.0), 1e-12);
  EXPECT_NEAR(mean.low, 2.0 - 2.0 / std::sqrt(3.0), 1e-12);
}

TEST(ModelTest, TheFormulaOfThePaperByHand) {
  // Half of all objects reach the second half-space, a quarter the third.
  const std::vector<double> reached = {1.0, 0.5, 0.25};
  EXPECT_DOUBLE_EQ(HalfSpacesByFormula(reached, 1.0), 1.75);
  EXPECT_DOUBLE_EQ(HalfSpacesByFormula(reached, 2.0),
                   1.0 + (1.0 - 0.25) + (1.0 - 0.5625));
  EXPECT_NEAR(HalfSpacesByFormula(reached, 4096.0), 3.0, 1e-12);
}

TEST(ModelTest, AdvantageAndLimitsByHand) {
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

// ---- Axes.

TEST(RegularBoundsTest, AreThoseOfAPointByHand) {
  const std::array<float, 3> point = {1, 2, 4};
  const Aabo3 bound = BoundOnRegularAxes(point);
  const std::array<float, 4> along = {7, -5, -3, 1};
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_LE(bound.min[k], along[k]);
    EXPECT_GE(bound.max[k], along[k]);
    EXPECT_FLOAT_EQ(bound.min[k], along[k]);
    EXPECT_FLOAT_EQ(bound.max[k], along[k]);
  }
}

// Twice 2^-30 beside 2^24: neither floats nor doubles hold the sum.
TEST(RegularBoundsTest, EncloseWhatRounds) {
  const std::array<float, 3> point = {0x1p24f, 0x1p-30f, 0x1p-30f};
  const Aabo3 bound = BoundOnRegularAxes(point);
  EXPECT_GT(bound.max[0], 0x1p24f);
  EXPECT_LE(bound.min[0], 0x1p24f);
  EXPECT_LT(bound.min[1], 0x1p24f);
}

// ---- Volumes.

// The 64 points with coordinates 0 .. 3, and one segment.
NextPoints GridAnd(const std::array<float, 6>& segment) {
  return [segment, next = std::size_t{0},
          point = std::array<float, 3>{}]() mutable -> std::span<const float> {
    if (next == 64) return segment;
    for (std::size_t k = 0; k < 3; ++k) {
      point[k] = static_cast<float>(next >> (2 * k) & 3);
    }
    ++next;
    return point;
  };
}

// Survivors of each volume, in the order of Volume.
void ExpectSurvivors(const std::array<float, 6>& segment,
                     const std::array<std::size_t, kVolumes>& expected) {
  VolumeSet set(GridAnd(segment), 64, 1);
  for (std::size_t v = 0; v < kVolumes; ++v) {
    const auto volume = static_cast<Volume>(v);
    EXPECT_EQ(set.Survivors(volume, 1), expected[v]) << NameOf(volume);
  }
}

// From (1, 2, 1) to (2, 1, 1). Boxes keep x, y in {1, 2} with z = 1; the AABO
// and the prism those of them with x + y = 3. Half of the prism keeps x, y <=
// 2, z <= 1 and x + y >= 3: 3 with z = 0, 3 with z = 1. The simplex keeps x, y
// <= 2, z <= 1 and x + y + z >= 4: 3 with z = 1, and (2, 2, 0). The sphere
// around (1.5, 1.5, 1) touches the four of the box.
TEST(VolumesTest, AreCountedByHandAcrossADiagonal) {
  ExpectSurvivors({1, 2, 1, 2, 1, 1}, {4, 4, 2, 2, 6, 4});
}

// From (1, 1, 0) to (1, 1, 3). Boxes, the prism, its half (x, y <= 1 and x + y
// >= 2 for all z <= 3) and the AABO keep the 4 points
// of the column. The simplex keeps x, y <= 1 and x + y + z >= 2: 4 of the
// column, (0, 1, z) and (1, 0, z) for z = 1, 2, 3, and (0, 0, z) for z = 2, 3.
// The sphere around (1, 1, 1.5) with radius 1.5 keeps of z = 0 and 3 the column
// alone, and of z = 1 and 2 what is within sqrt(2) of it, all 3 x 3 columns.
TEST(VolumesTest, AreCountedByHandAlongAnAxis) {
  ExpectSurvivors({1, 1, 0, 1, 1, 3}, {12, 4, 4, 4, 4, 20});
}

TEST(BoundingSphereTest, EnclosesItsPoints) {
  const NextPoints balls = ScenePoints(/*seed=*/5);
  for (std::size_t i = 0; i < testing::Scaled(200); ++i) {
    const auto points = balls();
    const Sphere<3> sphere = SphereAround(points);
    for (std::size_t p = 0; p < points.size(); p += 3) {
      double square = 0.0;
      for (std::size_t k = 0; k < 3; ++k) {
        const double along = double{points[p + k]} - double{sphere.center[k]};
        square += along * along;
      }
      EXPECT_LE(square, double{sphere.radius} * double{sphere.radius});
    }
    EXPECT_LE(sphere.radius, 1.01f);
  }
}

TEST(BoundingSphereTest, IsThatOfFewPoints) {
  const std::array<float, 6> two = {-3, 0, 0, 3, 0, 0};
  EXPECT_FLOAT_EQ(SphereAround(two).radius, 3.0f);
  EXPECT_EQ(SphereAround(two).center, (Point<3>{0, 0, 0}));
  // Three corners of a square, whose diagonal is a diameter.
  const std::array<float, 9> three = {0, 0, 0, 2, 0, 0, 0, 2, 0};
  EXPECT_FLOAT_EQ(SphereAround(three).radius, std::sqrt(2.0f));
  const std::array<float, 3> one = {4, 5, 6};
  EXPECT_EQ(SphereAround(one).radius, 0.0f);
  EXPECT_EQ(SphereAround(one).center, (Point<3>{4, 5, 6}));
}

// Spheres of all sizes that touch exactly, along (3, 4, 0) or an axis, far from
// the origin: with s a power of two, all values are floats.
TEST(SphereScanTest, NeverRejectsSpheresThatTouch) {
  struct Direction {
    std::array<float, 3> by;
    float length;
  };
  constexpr std::array<Direction, 4> kDirections = {
      {{{3, 4, 0}, 5}, {{1, 0, 0}, 1}, {{2, -3, 6}, 7}, {{-8, 4, 1}, 9}}};
  Random random(7);
  for (Target target : testing::TargetsUnderTest()) {
    const SphereScan scan = PaperLoopsFor(target).spheres;
    for (std::size_t i = 0; i < testing::Scaled(2000); ++i) {
      const Direction& direction = kDirections[i % kDirections.size()];
      const float s =
          std::ldexp(1.0f, static_cast<int>(random.Below(100)) - 70);
      const auto steps = static_cast<float>(1 + random.Below(1 << 18));
      const float reach = s * steps * direction.length;
      const float part = std::floor(steps / 3) * s * direction.length;
      const Sphere<3> query{{s, 2 * s, 3 * s}, reach - part};
      Sphere<3> object{query.center, part};
      for (std::size_t k = 0; k < 3; ++k) {
        object.center[k] += s * steps * direction.by[k];
      }
      const float grown_query = Inflated(query).radius;
      const float grown = Inflated(object).radius;
      alignas(64) std::array<std::array<float, 64>, 4> planes;
      for (std::size_t k = 0; k < 3; ++k) planes[k].fill(object.center[k]);
      planes[3].fill(grown);
      // Twice as far as it may be wrong: by a share of the distance, and by
      // 2^-60, which is added to each radius.
      for (std::size_t k = 0; k < 3; ++k) {
        planes[k][1] += (object.center[k] - query.center[k]) * 0x1p-17f +
                        direction.by[k] / direction.length * 0x1p-58f;
      }
      const std::array<const float*, 4> pointers = {
          planes[0].data(), planes[1].data(), planes[2].data(),
          planes[3].data()};
      const std::array<float, 4> values = {query.center[0], query.center[1],
                                           query.center[2], grown_query};
      std::uint64_t mask = 0;
      scan(pointers.data(), values.data(), 64, &mask);
      EXPECT_EQ(mask, ~std::uint64_t{2})
          << target.name() << ", " << s << ", " << steps;
    }
  }
}

TEST(SceneOfDimensionTest, KeepsAsManyBoxes) {
  const auto survivors = [](const auto& scene) {
    std::size_t count = 0;
    for (const auto& query : scene.queries) {
      count += CountSurvivors(scene.objects.view().aabb(), query.aabb());
    }
    return static_cast<double>(count);
  };
  const double in_3 = survivors(MakeSceneOf<3>(4000, 500, 1, kCloudRadius<3>));
  EXPECT_NEAR(survivors(MakeSceneOf<2>(4000, 500, 1, kCloudRadius<2>)) / in_3,
              1.0, 0.4);
  EXPECT_NEAR(survivors(MakeSceneOf<4>(4000, 500, 1, kCloudRadius<4>)) / in_3,
              1.0, 0.4);
}

}  // namespace
}  // namespace halfspace::bench

// Bounding volumes side by side: against counts by hand, and against scalar
// loops on every target; and that no sphere that touches is rejected.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "bench/inner/target_loops.h"
#include "bench/worlds/bounding_sphere.h"
#include "bench/worlds/point_source.h"
#include "bench/worlds/random.h"
#include "bench/worlds/scene.h"
#include "bench/worlds/scene_of_dimension.h"
#include "bench/worlds/volume_set.h"
#include "halfspace/fit.h"
#include "tests/library/support/environment.h"

namespace halfspace::bench {
namespace {

// The 64 points with coordinates 0 .. 3, and one segment.
VolumeObjects PointGrid(const std::array<float, 6>& segment) {
  std::array<float, 3> point{};
  std::size_t next = 0;
  const PointSource source{"grid", 64,
                           [&] {
                             for (std::size_t k = 0; k < 3; ++k) {
                               point[k] =
                                   static_cast<float>(next >> (2 * k) & 3);
                             }
                             ++next;
                             return std::span<const float>(point);
                           },
                           [&] { return std::span<const float>(segment); }};
  return {source, 1};
}

struct Expected {
  Volume volume;
  std::size_t survivors;
};

void ExpectSurvivors(const std::array<float, 6>& segment,
                     const std::array<Expected, kVolumes>& expected) {
  const VolumeObjects objects = PointGrid(segment);
  VolumeSet set(objects, 64);
  for (const auto& [volume, survivors] : expected) {
    EXPECT_EQ(set.Survivors(volume, 1), survivors) << NameOf(volume);
  }
}

// From (1, 2, 1) to (2, 1, 1). Boxes keep x, y in {1, 2} with z = 1; the AABO
// and the prism those of them with x + y = 3. Half of the prism keeps x, y <=
// 2, z <= 1 and x + y >= 3: 3 with z = 0, 3 with z = 1. The simplex keeps x, y
// <= 2, z <= 1 and x + y + z >= 4: 3 with z = 1, and (2, 2, 0). The sphere
// around (1.5, 1.5, 1) touches the four of the box.
TEST(VolumesTest, AreCountedByHandAcrossADiagonal) {
  ExpectSurvivors({1, 2, 1, 2, 1, 1}, {{{Volume::kSimplex, 4},
                                        {Volume::kAabb, 4},
                                        {Volume::kAabo, 2},
                                        {Volume::kSevenSided, 4},
                                        {Volume::kPrism, 2},
                                        {Volume::kHalfPrism, 6},
                                        {Volume::kSphere, 4}}});
}

// From (1, 1, 0) to (1, 1, 3). Boxes, the prism, its half (x, y <= 1 and x + y
// >= 2 for all z <= 3) and the AABO keep the 4 points
// of the column. The simplex keeps x, y <= 1 and x + y + z >= 2: 4 of the
// column, (0, 1, z) and (1, 0, z) for z = 1, 2, 3, and (0, 0, z) for z = 2, 3.
// The sphere around (1, 1, 1.5) with radius 1.5 keeps of z = 0 and 3 the column
// alone, and of z = 1 and 2 what is within sqrt(2) of it, all 3 x 3 columns.
TEST(VolumesTest, AreCountedByHandAlongAnAxis) {
  ExpectSurvivors({1, 1, 0, 1, 1, 3}, {{{Volume::kSimplex, 12},
                                        {Volume::kAabb, 4},
                                        {Volume::kAabo, 4},
                                        {Volume::kSevenSided, 4},
                                        {Volume::kPrism, 4},
                                        {Volume::kHalfPrism, 4},
                                        {Volume::kSphere, 20}}});
}

// More than a tile of 4096, part of another, and more than the caches that are
// streamed.
TEST(VolumesTest, EveryTargetAgreesWithScalarLoops) {
  const VolumeObjects objects(SceneSource(3000, /*seed=*/3), 20);
  for (std::size_t size : {64, 4096 + 64, 2 * 4096 + 192}) {
    VolumeSet set(objects, size);
    for (Target target : testing::TargetsUnderTest()) {
      for (const VolumeTest& test : kVolumeTests) {
        EXPECT_EQ(set.Check(test, target, 20), "")
            << NameOf(test.volume) << ", " << test.schedule << ", "
            << target.name() << ", " << size;
      }
    }
  }
}

// The check of a benchmark must be able to fail. Neither of the segments'
// octahedra keeps a point of the other: 4 and 2 survivors.
TEST(VolumesTest, FindsAWrongMask) {
  const VolumeObjects objects = PointGrid({1, 1, 0, 1, 1, 3});
  VolumeSet set(objects, 64);
  const VolumeBounds other = PointGrid({1, 2, 1, 2, 1, 1}).queries.front();
  set.Scan({Volume::kAabo, "flat"}, other, ChosenTarget());
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < 64; ++i) {
    const bool is_kept = (set.mask()[0] >> i & 1) != 0;
    wrong += set.Keeps(Volume::kAabo, objects.queries.front(), i,
                       VolumeSet::Reach::kNearer) != is_kept;
  }
  EXPECT_EQ(wrong, 6u);
}

TEST(BoundingSphereTest, EnclosesItsPoints) {
  const PointSource balls = BallSource(1, /*seed=*/5);
  for (std::size_t i = 0; i < testing::Scaled(200); ++i) {
    const auto points = balls.next_object();
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

TEST(BoundingSphereTest, OfWhatIsTooLargeIsInfinite) {
  const std::array<float, 6> far = {-3e38f, 0, 0, 3e38f, 3e38f, 3e38f};
  const Sphere<3> sphere = Inflated(SphereAround(far));
  EXPECT_TRUE(std::isinf(sphere.radius));
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
    const TargetLoops loops = LoopsFor(target);
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
      for (VolumeScan scan : {loops.scan_spheres, loops.scan_spheres_by_axis}) {
        std::uint64_t mask = 0;
        scan(pointers.data(), values.data(), 64, &mask);
        EXPECT_EQ(mask, ~std::uint64_t{2})
            << target.name() << ", " << s << ", " << steps;
      }
    }
  }
}

// Of 64 x 4 = 256 in two dimensions the share of 3 is (2 * 2 / 100)^3 =
// 6.4e-5, whose root is 0.008: sides of 0.4, which is a fifth of 2.
TEST(SceneOfDimensionTest, IsScaledByHand) {
  EXPECT_DOUBLE_EQ(ScaleFor(3, 2.0, 2.0), 1.0);
  EXPECT_NEAR(ScaleFor(2, 2.0, 2.0), 0.2, 1e-12);
  EXPECT_NEAR(ScaleFor(2, 1.0, 2.0), 0.4, 1e-12);
}

TEST(SceneOfDimensionTest, IsTheSceneInThree) {
  const Workload scene = MakeScene(100, 10, /*seed=*/9, [](double) {});
  const SceneOf<3> same = MakeSceneOf<3>(100, 10, /*seed=*/9);
  EXPECT_EQ(same.scale, 1.0);
  for (std::size_t i = 0; i < 100; ++i) {
    EXPECT_EQ(same.objects.Get(i), scene.objects.Get(i));
  }
  EXPECT_EQ(same.queries, scene.queries);
}

TEST(SceneOfDimensionTest, KeepsAsManyBoxes) {
  const auto survivors = [](const auto& scene) {
    std::size_t count = 0;
    for (const auto& query : scene.queries) {
      count += CountSurvivors(scene.objects.view().aabb(), query.aabb());
    }
    return static_cast<double>(count);
  };
  const double in_3 = survivors(MakeSceneOf<3>(4000, 500, /*seed=*/1));
  EXPECT_NEAR(survivors(MakeSceneOf<2>(4000, 500, 1)) / in_3, 1.0, 0.4);
  EXPECT_NEAR(survivors(MakeSceneOf<4>(4000, 500, 1)) / in_3, 1.0, 0.4);
}

}  // namespace
}  // namespace halfspace::bench

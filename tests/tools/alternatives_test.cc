// What the section `axes` bounds, by hand; and the points that volumes and axes
// are made from.
#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "bench/worlds/point_source.h"
#include "bench/worlds/scene.h"
#include "halfspace/fit.h"

namespace halfspace::bench {
namespace {

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

void ExpectObjects(const PointSource& source, const Workload& workload) {
  for (std::size_t i = 0; i < source.objects; ++i) {
    const auto points = source.next_object();
    EXPECT_EQ(BoundPoints(Points3{points.data(), points.size() / 3}),
              workload.objects.Get(i));
  }
}

TEST(PointSourceTest, HasThePointsOfTheScene) {
  const Workload scene = MakeScene(50, 5, /*seed=*/6, [](double) {});
  const PointSource source = SceneSource(50, /*seed=*/6);
  ExpectObjects(source, scene);
  for (const Aabo3& query : scene.queries) {
    const auto points = source.next_query();
    EXPECT_EQ(BoundPoints(Points3{points.data(), points.size() / 3}), query);
  }
}

TEST(PointSourceTest, HasThePointsOfFiles) {
  const Workload boxes = WorkloadOfBoxes(
      "boxes", {{{0, 1, 2}, {3, 4, 5}}, {{-1, -1, -1}, {1, 1, 1}}}, 0);
  ExpectObjects(FileSource(boxes, 10, 1), boxes);
  const Workload mesh = WorkloadOfTriangles(
      "mesh", {0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 3}, {0, 1, 2, 3, 1, 0}, 0);
  ExpectObjects(FileSource(mesh, 10, 1), mesh);
  EXPECT_EQ(FileSource(mesh, 1, 1).objects, 1u);
}

TEST(PointSourceTest, MixesBallsAndBoxes) {
  const PointSource mixed = MixedSource(4, /*seed=*/1);
  EXPECT_EQ(mixed.next_object().size(), 150u);
  EXPECT_EQ(mixed.next_object().size(), 24u);
  EXPECT_EQ(mixed.next_query().size(), 150u);
}

}  // namespace
}  // namespace halfspace::bench

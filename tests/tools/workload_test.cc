// What files are queried with, against values computed by hand.
#include "bench/worlds/workload.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

#include "halfspace/fit.h"

namespace halfspace::bench {
namespace {

Aabb3 Point(float x) { return {{x, 0, 0}, {x, 0, 0}}; }

AaboWorld3 Points(std::size_t count, float first) {
  AaboWorld3 world;
  for (std::size_t i = 0; i < count; ++i) {
    world.Push(BoundAabb(Point(first + static_cast<float>(i))));
  }
  return world;
}

// From (0, 0, -4) to (10, 20, 4), and one that cannot be bounded.
Workload TwoBoxes() {
  Workload workload = WorkloadOfBoxes("boxes",
                                      {{{0, 0, -4}, {1, 1, 1}},
                                       {{9, 19, 0}, {10, 20, 4}},
                                       {{0, 0, 0}, {3e38f, 0, 0}}},
                                      0);
  EXPECT_EQ(workload.objects.Get(2), Aabo3::Everything());
  return workload;
}

TEST(QueryWith, TakesTheBoundsOfTheSource) {
  Workload workload = TwoBoxes();
  QueryWith(workload, Points(10, 100), 5);
  ASSERT_EQ(workload.queries.size(), 5u);
  for (std::size_t i = 0; i < 5; ++i) {
    const float x = 100.0f + 2.0f * static_cast<float>(i);
    EXPECT_EQ(workload.queries[i].aabb(), Point(x));
    EXPECT_EQ(workload.timed_queries[i].aabb(), Point(x));
  }
  QueryWith(workload, Points(600, 0), 0);
  EXPECT_EQ(workload.queries.size(), 300u);
  EXPECT_EQ(workload.queries[1].aabb(), Point(2));
  EXPECT_EQ(workload.timed_queries.size(), 600u);
}

TEST(RandomBoxes, AreWithinTheBoxAroundTheObjects) {
  const Workload workload = TwoBoxes();
  EXPECT_EQ(BoxAround(workload.objects), (Aabb3{{0, 0, -4}, {10, 20, 4}}));
  const AaboWorld3 boxes = RandomBoxes(workload, 50, 4000, 7);
  ASSERT_EQ(boxes.size(), 4000u);
  // A side of 5, 10 and 4 leaves 5, 10 and 4 to place it in.
  std::vector<double> sums(3);
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const Aabb3 box = boxes.Get(i).aabb();
    const Aabb3 around = {{0, 0, -4}, {10, 20, 4}};
    const float sides[] = {5, 10, 4};
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_GE(box.min[k], around.min[k]);
      EXPECT_LE(box.max[k], around.max[k]);
      EXPECT_NEAR(box.max[k] - box.min[k], sides[k], 1e-5);
      sums[k] += box.min[k];
    }
  }
  EXPECT_NEAR(sums[0] / 4000, 2.5, 0.1);
  EXPECT_NEAR(sums[1] / 4000, 5.0, 0.2);
  EXPECT_NEAR(sums[2] / 4000, -2.0, 0.1);
}

TEST(RandomBoxes, AreThoseOfTheirSeed) {
  const Workload workload = TwoBoxes();
  const AaboWorld3 boxes = RandomBoxes(workload, 1, 2, 7);
  EXPECT_EQ(boxes.Get(0), RandomBoxes(workload, 1, 2, 7).Get(0));
  EXPECT_NE(boxes.Get(0), boxes.Get(1));
  EXPECT_NE(boxes.Get(0), RandomBoxes(workload, 1, 2, 8).Get(0));
  EXPECT_EQ(RandomBoxes(workload, 1, 0, 7).size(), kTimedQueries);
  // All of it.
  EXPECT_EQ(RandomBoxes(workload, 100, 1, 7).Get(0).aabb(),
            (Aabb3{{0, 0, -4}, {10, 20, 4}}));
}

}  // namespace
}  // namespace halfspace::bench

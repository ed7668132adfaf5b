// The bulk builders by hand: small whole numbers, whose sums are exact.
#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <cstdint>

#include "halfspace/fit_many.h"
#include "halfspace/world.h"
#include "tests/library/support/environment.h"

namespace halfspace::testing {
namespace {

// build(planes, options) bounds two shapes, tightest, on every target.
template <int kDims, typename Build>
void ExpectBoth(const Aabo<kDims>& first, const Aabo<kDims>& second,
                Build build) {
  for (Target target : TargetsUnderTest()) {
    AaboWorld<kDims> world;
    world.Resize(2);
    build(world.planes(), FitOptions{.tightest = true, .target = target});
    EXPECT_EQ(world.Get(0), first) << target.name();
    EXPECT_EQ(world.Get(1), second) << target.name();
  }
}

TEST(FitManyKnownTest, Boxes) {
  const std::array<Aabb3, 2> boxes = {
      {{{1, 2, 3}, {4, 5, 6}}, {{-1, 0, 0}, {0, 1, 2}}}};
  ExpectBoth<3>({{1, 2, 3, -15}, {4, 5, 6, -6}}, {{-1, 0, 0, -3}, {0, 1, 2, 1}},
                [&](const auto& planes, const FitOptions& options) {
                  BoundBoxes(BoxesOf<3>(boxes), planes, options);
                });
}

#if !defined(HALFSPACE_TEST_ONLY_3D)
// The D axis of boxes that are already a world.
TEST(FitManyKnownTest, BoxesOfAWorld) {
  const std::array<Aabb2, 2> boxes = {{{{1, 2}, {4, 5}}, {{-1, 0}, {0, 1}}}};
  const AabbWorld2 world(boxes);
  for (Target target : TargetsUnderTest()) {
    std::array<float, 2> min;
    std::array<float, 2> max;
    BoundBoxes(BoxesOf(world), DPlanes2{min.data(), max.data(), 2},
               {.tightest = true, .target = target});
    EXPECT_EQ(min, (std::array{-9.f, -1.f}));
    EXPECT_EQ(max, (std::array{-3.f, 1.f}));
  }
}

// The square root of 4 is 2.
TEST(FitManyKnownTest, Spheres) {
  const float x[] = {1, 0};
  const float y[] = {2, 0};
  const float z[] = {3, 0};
  const float w[] = {4, 0};
  const float radius[] = {2, 1};
  ExpectBoth<4>(
      {{-1, 0, 1, 2, -14}, {3, 4, 5, 6, -6}},
      {{-1, -1, -1, -1, -2}, {1, 1, 1, 1, 2}},
      [&](const auto& planes, const FitOptions& options) {
        BoundSpheres(Spheres4{{x, y, z, w}, radius, 2}, planes, options);
      });
}

// One point, and two.
TEST(FitManyKnownTest, PointSets) {
  const float x[] = {1, 4, 0};
  const float y[] = {2, -5, 0};
  const std::array<std::size_t, 2> ends = {1, 3};
  ExpectBoth<2>({{1, 2, -3}, {1, 2, -3}}, {{0, -5, 0}, {4, 0, 1}},
                [&](const auto& planes, const FitOptions& options) {
                  BoundPointSets(PointsSoa2{{x, y}, 3}, ends, planes, options);
                });
}
#endif

TEST(FitManyKnownTest, Triangles) {
  const float coords[] = {0, 0, 0, 1, 0, 0, 0, 2, 0, 4, 2, -1};
  const std::array<std::uint32_t, 6> indices = {0, 1, 2, 3, 0, 0};
  ExpectBoth<3>({{0, 0, 0, -2}, {1, 2, 0, 0}}, {{0, 0, -1, -5}, {4, 2, 0, 0}},
                [&](const auto& planes, const FitOptions& options) {
                  BoundTriangles(Points3{coords, 4}, indices, planes, options);
                });
}

// Of two calls, each with a sphere of no size, the first one says which is
// first.
TEST(FitManyKnownTest, StatusOfTwoCalls) {
  const float center[] = {0, 0};
  const float radii[] = {1, -1, 1};
  const auto bound = [&](const float* radius, FitStatus& status) {
    AaboWorld3 world;
    world.Resize(2);
    BoundSpheres(Spheres3{{center, center, center}, radius, 2}, world.planes(),
                 {}, &status);
  };
  FitStatus status;
  bound(radii, status);
  bound(radii + 1, status);
  EXPECT_EQ(status.results, 4u);
  EXPECT_EQ(status.everything, 2u);
  EXPECT_EQ(status.first_everything, 1u);
}

}  // namespace
}  // namespace halfspace::testing

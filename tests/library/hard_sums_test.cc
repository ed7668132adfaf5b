// Single inputs on which a shortcut in the sums goes wrong, each made by hand:
// random inputs, however hard, miss them.
#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <span>

#include "halfspace/halfspace.h"
#include "tests/library/environment.h"

namespace halfspace::testing {
namespace {

constexpr float kUlp = 0x1p-23f;  // of 1

// 1 + 2^-24 rounds to 1, and so does adding (1 - 2^-24) 2^-24: both errors
// together are 2^-23 - 2^-48, which rounds to 2^-23, and 1 + 2^-23 is a float.
// Only the error of the errors tells that the sum is less than that.
TEST(HardSumsTest, OnlyTheLastErrorIsLeft) {
  const std::array<float, 3> point = {1.f, 0x1p-24f, 0x1.fffffep-25f};
  const Aabo3 expected = {{1.f, 0x1p-24f, 0x1.fffffep-25f, -(1.f + kUlp)},
                          {1.f, 0x1p-24f, 0x1.fffffep-25f, -1.f}};
  EXPECT_EQ(BoundPoint<3>(point), expected);
  const std::array<Aabb3, 100> boxes = [&] {
    std::array<Aabb3, 100> all;
    all.fill({point, point});
    return all;
  }();
  for (Target target : TargetsUnderTest()) {
    SCOPED_TRACE(target.name());
    AaboWorld3 world;
    world.Resize(boxes.size());
    BoundBoxes(BoxesOf(std::span<const Aabb3>(boxes)), world.planes(),
               {.tightest = true, .target = target});
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      ASSERT_EQ(world.Get(i), expected) << i;
    }
  }
}

// All normals in the plane z = 0: a square prism without ends.
TEST(HardSumsTest, PrismWithoutEndsCannotBeBounded) {
  const std::array<HalfSpace3, 6> planes = {{{{1, 0, 0}, 1},
                                             {{-1, 0, 0}, 1},
                                             {{0, 1, 0}, 1},
                                             {{0, -1, 0}, 1},
                                             {{1, 1, 0}, 1},
                                             {{-1, -1, 0}, 1}}};
  EXPECT_EQ(BoundFrustum(planes), Aabo3::Everything());
}

// (1 + u)(1 + 5u)(1 + 6u) and (1 + 2u)(1 + 3u)(1 + 7u) differ by 12 u^3 only,
// which a product in double cannot tell. The determinant of the first three
// normals is that; were it 0, the planes would be open.
TEST(HardSumsTest, AlmostFlatFrustumIsBounded) {
  constexpr float u = kUlp;
  const Point3 a = {1 + u, -(1 + 2 * u), 0};
  const Point3 b = {0, 1 + 5 * u, 1 + 3 * u};
  const Point3 c = {1 + 7 * u, 0, 1 + 6 * u};
  const HalfSpace3 end = {{-1, -1, 1}, 1};
  const HalfSpace3 lid = {{-(1 + u), -3 * u, -(1 + 3 * u)}, 1};  // -(a + b)
  const std::array<HalfSpace3, 6> planes = {
      {{a, 0}, {b, 0}, {c, 0}, end, lid, lid}};
  FitStatus status;
  const Aabo3 bound = BoundFrustum(planes, &status);
  EXPECT_EQ(status.everything, 0u);
  // Its far corners are where c, ever so slowly, has cut the wedge of a and b.
  EXPECT_GT(bound.max[0] - bound.min[0], 0x1p60f);
  EXPECT_LT(bound.max[0] - bound.min[0], 0x1p70f);
  EXPECT_LE(bound.min[0], 0.f);
  EXPECT_GE(bound.max[0], 0.f);
}

}  // namespace
}  // namespace halfspace::testing

// Frusta whose determinants are 0, or nearly.
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cstdint>

#include "halfspace/fit.h"

namespace halfspace::testing {
namespace {

using Planes = std::array<HalfSpace3, 6>;

// A prism without ends: no three planes meet in a point.
TEST(FitFrustumHardTest, NormalsInOnePlaneGiveEverything) {
  const Planes prism = {{{{1, 0, 0}, 1},
                         {{0, 1, 0}, 1},
                         {{-1, 0, 0}, 1},
                         {{0, -1, 0}, 1},
                         {{1, 1, 0}, 1},
                         {{-1, -1, 0}, 1}}};
  EXPECT_EQ(BoundFrustum(prism), Aabo3::Everything());
}

// |p y + z| <= 1 and |y + s z| <= 1, where p s - 1 = -2^-46: a needle, from
// y = -(s + 1) 2^46 to +(s + 1) 2^46 and z = -(p + 1) 2^46 to +(p + 1) 2^46.
// Its determinants are u times -2^-46, the difference of products that take
// more bits than a double has. 0 <= x <= 1, so that D goes from -2^24 - 1 to
// 2^24, of which the first is no float.
TEST(FitFrustumHardTest, NeedleFromProductsThatDoubleCannotHold) {
  constexpr float p = 0x1.000002p0f;
  constexpr float s = 0x1.fffffcp-1f;
  for (std::uint32_t mantissa = 1; mantissa < 0x800000; mantissa += 65'538) {
    const auto u = std::bit_cast<float>(0x3f800000 | mantissa);
    const Planes needle = {{{{u, 0, 0}, 0},
                            {{-u, 0, 0}, u},
                            {{0, p, 1}, 1},
                            {{0, -p, -1}, 1},
                            {{0, 1, s}, 1},
                            {{0, -1, -s}, 1}}};
    const Aabo3 bound = BoundFrustum(needle);
    EXPECT_EQ(bound.min, (std::array{0.f, -0x1.fffffep46f, -0x1.000002p47f,
                                     -0x1.000002p24f}))
        << u;
    EXPECT_EQ(bound.max,
              (std::array{1.f, 0x1.fffffep46f, 0x1.000002p47f, 0x1p24f}))
        << u;
  }
}

// The planes x - 2^-24 y = 65/64 and 2^-24 x + y = 2^-24 meet at
// x = 65/64 - 2^-6 / (2^48 + 1), which double rounds to 65/64. They are ordered
// so that all determinants of that edge have one sign, then the other.
TEST(FitFrustumHardTest, CornersThatDoubleRoundsToAFloat) {
  constexpr HalfSpace3 left = {{1, -0x1p-24f, 0}, -65.f / 64};
  constexpr HalfSpace3 below = {{0x1p-24f, 1, 0}, -0x1p-24f};
  constexpr HalfSpace3 near = {{0, 0, 1}, 0};
  constexpr HalfSpace3 far = {{0, 0, -1}, 1};
  constexpr HalfSpace3 right = {{-1, 0x1p-24f, 0}, 3};
  constexpr HalfSpace3 above = {{-0x1p-24f, -1, 0}, 1};
  for (const Planes& planes : {Planes{left, far, below, near, right, above},
                               Planes{below, far, left, near, right, above}}) {
    EXPECT_EQ(BoundFrustum(planes).min[0], 0x1.03fffep0f);
  }
}

// 0 <= z <= 1, -1 <= y <= 2 and 1 <= x <= 1 - 2^-60 y, which is 1 to a double:
// what is above y = 0 is in front of all but one plane, and not of that.
TEST(FitFrustumHardTest, CornersBehindAPlaneByLessThanDoubleCanTell) {
  Planes planes = {{{{1, 0, 0}, -1},
                    {{-1, -0x1p-60f, 0}, 1},
                    {{0, 1, 0}, 1},
                    {{0, -1, 0}, 2},
                    {{0, 0, 1}, 0},
                    {{0, 0, -1}, 1}}};
  const Aabo3 bound = BoundFrustum(planes);
  EXPECT_EQ(bound.min[1], -1.f);
  EXPECT_EQ(bound.max[1], 0.f);
  // Above y = 0x1p-149 there is nothing.
  planes[2].offset = -0x1p-149f;
  EXPECT_EQ(BoundFrustum(planes), Aabo3::Empty());
}

// Four planes meet in a point, and one of them is there twice.
TEST(FitFrustumHardTest, CornersOfMoreThanThreePlanes) {
  constexpr HalfSpace3 a = {{3, 1, -1}, 1};
  constexpr HalfSpace3 b = {{-3, 1, -1}, 1};
  constexpr HalfSpace3 c = {{0x1.000002p0f, -7, -1}, 1};
  constexpr HalfSpace3 d = {{-0x1.000002p0f, -7, -1}, 1};
  constexpr HalfSpace3 below = {{0, 0, 1}, 0};
  const Aabo3 bound = BoundFrustum(std::array{a, b, c, d, below, a});
  EXPECT_EQ(bound.max[2], 1.f);
  EXPECT_EQ(bound.min[2], 0.f);
}

}  // namespace
}  // namespace halfspace::testing

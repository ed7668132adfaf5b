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

}  // namespace
}  // namespace halfspace::testing

// Bounds of bounds that are no rows of builders.h: intersections, measures, and
// boxes of doubles as boxes of floats.
#include "halfspace/transform.h"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "halfspace/detail/plane_arrays.h"
#include "tests/library/support/fp_modes.h"
#include "tests/library/support/inputs.h"
#include "tests/library/support/special_values.h"

namespace halfspace::testing {
namespace {

constexpr float kMax = detail::kMax<float>;
constexpr float kInfinity = detail::kInf<float>;
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

// The box from (0, 0, 0) to (1, 2, 3), without a corner: x + y + z <= 5.
constexpr Aabo3 kBody{{0, 0, 0, -5}, {1, 2, 3, 0}};

TEST(TransformKnownTest, Intersection) {
  EXPECT_EQ(Intersection(kBody, Aabo3{{-1, 1, 1, -4}, {0, 3, 2, -1}}),
            (Aabo3{{0, 1, 1, -4}, {0, 2, 2, -1}}));
  EXPECT_EQ(Intersection(UpSimplex2{{0, 1, 2}}, UpSimplex2{{1, 0, 3}}),
            (UpSimplex2{{1, 1, 3}}));
  EXPECT_EQ(Intersection(DownSimplex2{{0, 1, 2}}, DownSimplex2{{1, 0, 3}}),
            (DownSimplex2{{0, 0, 2}}));
  // They touch, and they do not.
  EXPECT_EQ(Intersection(Aabb2{{0, 1}, {2, 3}}, Aabb2{{2, 0}, {3, 2}}),
            (Aabb2{{2, 1}, {2, 2}}));
  EXPECT_EQ(Intersection(Aabb2{{0, 1}, {2, 3}}, Aabb2{{2.5f, 0}, {3, 2}}),
            Aabb2::Empty());
  EXPECT_EQ(
      Intersection(Aabo2{{0, 0, -4}, {2, 2, -3}}, Aabo2{{0, 0, -2}, {2, 2, 0}}),
      Aabo2::Empty());
  // A D that the box does not reach stays.
  EXPECT_EQ(
      Intersection(Aabo2{{0, 0, -4}, {2, 2, -3}}, Aabo2{{0, 0, -4}, {1, 1, 0}}),
      (Aabo2{{0, 0, -4}, {1, 1, -3}}));
  constexpr Aabb<2, double> kWide{{0, 0}, {1, 1 + 0x1p-52}};
  static_assert(Intersection(kWide, kWide) == kWide);
}

TEST(TransformKnownTest, Measures) {
  static_assert(Volume(kBody.aabb()) == 6);
  static_assert(HalfArea(kBody.aabb()) == 2 + 6 + 3);
  EXPECT_EQ(Volume(Aabb2{{-1, 0}, {1, 3}}), 6.f);
  EXPECT_EQ(HalfArea(Aabb2{{-1, 0}, {1, 3}}), 5.f);
  EXPECT_EQ(Volume(Aabb<4, double>{{0, 0, 0, 0}, {1, 2, 3, 4}}), 24.0);
  EXPECT_EQ(HalfArea(Aabb<4>{{0, 0, 0, 0}, {1, 2, 3, 4}}), 6.f + 8 + 12 + 24);
  // x, y, z >= 0 and x + y + z <= 6: a sixth of a cube.
  EXPECT_EQ(Volume(UpSimplex3{{0, 0, 0, -6}}), 36.f);
  EXPECT_EQ(Volume(UpSimplex3{{1, 1, 1, -9}}), 36.f);
  EXPECT_EQ(Volume(DownSimplex2{{1, 1, 0}}), 2.f);
  EXPECT_EQ(Volume(DownSimplex<4>{{1, 1, 1, 1, -4}}), 0.f);
  EXPECT_EQ(Volume(UpSimplex2{{1, 1, 1}}), 0.f);
  // A sheet, however wide.
  EXPECT_EQ(Volume(Aabb3{{-kMax, 0, 0}, {kMax, 0, 1}}), 0.f);
  EXPECT_EQ(HalfArea(Aabb3{{0, 0, 0}, {2, 0, 3}}), 6.f);
  EXPECT_EQ(HalfArea(Aabb3{{-kMax, 0, 0}, {kMax, 0, 0}}), 0.f);
  EXPECT_EQ(HalfArea(Aabb3::Empty()), 0.f);
  EXPECT_EQ(HalfArea(Aabb3{{kMax, kMax, kMax}, {-kMax, -kMax, -kMax}}), 0.f);
  EXPECT_EQ(HalfArea(Aabb3::Everything()), kInfinity);
  EXPECT_TRUE(std::isnan(HalfArea(Aabb3{{0, 0, 0}, {1, 1, kNan}})));
  EXPECT_TRUE(std::isnan(Volume(Aabb3{{0, 0, 0}, {1, 1, kNan}})));
  EXPECT_TRUE(std::isnan(Volume(UpSimplex3{{0, kNan, 0, 0}})));
  EXPECT_TRUE(std::isnan(Volume(DownSimplex3{{0, kNan, 0, 0}})));
}

template <typename Test>
void ForEachBound(Test test) {
  test(UpSimplex3());
  test(DownSimplex3());
  test(Aabb3());
  test(Aabo3());
  test(UpSimplex2());
  test(Aabo<4>());
}

// A bound of one point, with `min` or -`min` put into every plane in turn.
template <typename Bound, typename Visit>
void ForEachPlane(float min, Visit visit) {
  detail::PlaneValues<Bound> planes{};
  for (std::size_t p = 0; p < planes.size(); ++p) {
    const bool is_min = detail::HasMin<Bound> && p < Bound::kAxes;
    planes[p] = is_min ? min : -min;
    visit(detail::BoundOf<Bound>(planes));
    planes[p] = 0;
  }
}

// What engines initialise boxes to: Everything() turned over.
template <typename Bound>
Bound Untouched() {
  auto planes = detail::Planes(Bound::Everything());
  for (float& plane : planes) plane = -plane;
  return detail::BoundOf<Bound>(planes);
}

TEST(TransformSpecialTest, VolumesAndIntersectionsOfSpecialValues) {
  ForEachBound([](auto bound_of_type) {
    using Bound = decltype(bound_of_type);
    const Bound point{};
    const Bound none = Bound::Empty();
    const Bound everything = Bound::Everything();
    constexpr bool kHasVolume = requires { Volume(point); };
    if constexpr (kHasVolume) {
      EXPECT_EQ(Volume(none), 0.f);
      EXPECT_EQ(Volume(everything), kInfinity);
    }
    for (const Bound& empty : {none, Untouched<Bound>()}) {
      EXPECT_TRUE(IsEmpty(empty));
      EXPECT_EQ(Intersection(empty, point), none);
      EXPECT_EQ(Intersection(point, empty), none);
      EXPECT_EQ(Intersection(empty, everything), none);
      EXPECT_EQ(Intersection(empty, empty), none);
      ForEachPlane<Bound>(-5.f, [&](const Bound& bound) {
        EXPECT_EQ(Intersection(bound, everything), bound);
        EXPECT_EQ(Intersection(everything, bound), bound);
      });
    }
    // A NaN is no limit, on either side.
    ForEachPlane<Bound>(kNan, [&](const Bound& bound) {
      EXPECT_EQ(Intersection(bound, point), point);
      EXPECT_EQ(Intersection(point, bound), point);
    });
    // Some planes do not make it empty, and a NaN in one does not either.
    ForEachPlane<Bound>(kMax, [&](const Bound& bound) {
      EXPECT_FALSE(IsEmpty(bound));
      auto planes = detail::Planes(Untouched<Bound>());
      planes[0] = std::copysign(kInfinity, planes[0]);
      EXPECT_TRUE(IsEmpty(detail::BoundOf<Bound>(planes)));
      planes[1] = kNan;
      EXPECT_FALSE(IsEmpty(detail::BoundOf<Bound>(planes)));
    });
  });
}

// Special values, those around each float of a few, and any bits.
std::vector<double> SomeDoubles() {
  std::vector<double> values(kSpecialValues<double>.begin(),
                             kSpecialValues<double>.end());
  Random random(1);
  for (std::size_t i = 0; i < 300; ++i) {
    const auto bits = static_cast<std::uint32_t>(random());
    const double value =
        i < 20 ? kSpecialValues<float>[i] : std::bit_cast<float>(bits);
    values.insert(values.end(), {value, std::nextafter(value, kInfinity),
                                 std::nextafter(value, -kInfinity),
                                 std::bit_cast<double>(random())});
  }
  return values;
}

TEST(RoundOutwardTest, IsTheNextFloatInEveryMode) {
  const std::vector<double> values = SomeDoubles();
  for (std::size_t i = 0; i < values.size(); ++i) {
    // Each value is on each plane once.
    detail::PlaneValues<Aabb<3, double>> planes;
    for (std::size_t p = 0; p < planes.size(); ++p) {
      planes[p] = values[(i + 7 * p) % values.size()];
    }
    const auto box = detail::BoundOf<Aabb<3, double>>(planes);
    for (FpMode mode : kFpModes) {
      detail::PlaneValues<Aabb3> rounded;
      RunIn(mode, [&] { rounded = detail::Planes(RoundOutward(box)); });
      for (std::size_t p = 0; p < planes.size(); ++p) {
        auto expected = static_cast<float>(planes[p]);
        if (p < 3 ? expected > planes[p] : expected < planes[p]) {
          expected = std::nextafter(expected, p < 3 ? -kInfinity : kInfinity);
        }
        EXPECT_TRUE(rounded[p] == expected ||
                    (std::isnan(rounded[p]) && std::isnan(expected)))
            << planes[p];
      }
    }
  }
}

}  // namespace
}  // namespace halfspace::testing

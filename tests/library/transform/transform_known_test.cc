// Bounds of bounds by hand: small whole numbers, whose sums are exact.
#include <gtest/gtest.h>

#include <cmath>
#include <type_traits>

#include "halfspace/transform.h"

namespace halfspace::testing {
namespace {

// The box from (0, 0, 0) to (1, 2, 3), without a corner: x + y + z <= 5.
constexpr Aabo3 kBody{{0, 0, 0, -5}, {1, 2, 3, 0}};

constexpr float kMax = detail::kMax<float>;

TEST(TransformKnownTest, Merge) {
  EXPECT_EQ(Merge(kBody, Aabo3{{-1, 1, 1, -4}, {0, 3, 2, -1}}),
            (Aabo3{{-1, 0, 0, -5}, {1, 3, 3, 0}}));
  EXPECT_EQ(Merge(UpSimplex2{{0, 1, 2}}, UpSimplex2{{1, 0, 3}}),
            (UpSimplex2{{0, 0, 2}}));
  EXPECT_EQ(Merge(DownSimplex2{{0, 1, 2}}, DownSimplex2{{1, 0, 3}}),
            (DownSimplex2{{1, 1, 3}}));
  EXPECT_EQ(Merge(Aabb2{{0, 1}, {2, 3}}, Aabb2{{1, 0}, {3, 2}}),
            (Aabb2{{0, 0}, {3, 3}}));
}

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
  EXPECT_EQ(HalfArea(Aabb4{{0, 0, 0, 0}, {1, 2, 3, 4}}), 6.f + 8 + 12 + 24);
  // x, y, z >= 0 and x + y + z <= 6: a sixth of a cube.
  EXPECT_EQ(Volume(UpSimplex3{{0, 0, 0, -6}}), 36.f);
  EXPECT_EQ(Volume(UpSimplex3{{1, 1, 1, -9}}), 36.f);
  EXPECT_EQ(Volume(DownSimplex2{{1, 1, 0}}), 2.f);
  EXPECT_EQ(Volume(DownSimplex4{{1, 1, 1, 1, -4}}), 0.f);
  EXPECT_EQ(Volume(UpSimplex2{{1, 1, 1}}), 0.f);
  // A sheet, however wide.
  EXPECT_EQ(Volume(Aabb3{{-kMax, 0, 0}, {kMax, 0, 1}}), 0.f);
  EXPECT_EQ(HalfArea(Aabb3{{0, 0, 0}, {2, 0, 3}}), 6.f);
  EXPECT_EQ(HalfArea(Aabb3{{-kMax, 0, 0}, {kMax, 0, 0}}), 0.f);
}

template <typename Bound>
void ExpectMeasuresOfSpecialValues() {
  constexpr float kInfinity = detail::kInf<float>;
  const float nan = std::nanf("");
  EXPECT_EQ(Volume(Bound::Empty()), 0.f);
  EXPECT_EQ(Volume(Bound::Everything()), kInfinity);
  Bound bound{};
  if constexpr (std::is_same_v<Bound, Aabb3>) {
    bound = {{0, 0, 0}, {1, 1, nan}};
    EXPECT_EQ(HalfArea(Bound::Empty()), 0.f);
    EXPECT_EQ(HalfArea(Aabb3{{kMax, kMax, kMax}, {-kMax, -kMax, -kMax}}), 0.f);
    EXPECT_EQ(HalfArea(Bound::Everything()), kInfinity);
    EXPECT_TRUE(std::isnan(HalfArea(bound)));
  } else if constexpr (std::is_same_v<Bound, UpSimplex3>) {
    bound.min[1] = nan;
  } else {
    bound.max[1] = nan;
  }
  EXPECT_TRUE(std::isnan(Volume(bound)));
}

TEST(TransformKnownTest, MeasuresOfSpecialValues) {
  ExpectMeasuresOfSpecialValues<Aabb3>();
  ExpectMeasuresOfSpecialValues<UpSimplex3>();
  ExpectMeasuresOfSpecialValues<DownSimplex3>();
}

// In 4 dimensions D moves by twice the radius.
TEST(TransformKnownTest, Inflate) {
  EXPECT_EQ(Inflate(Aabo4{{0, 0, 0, 0, -4}, {1, 1, 1, 1, 0}}, 3.f),
            (Aabo4{{-3, -3, -3, -3, -10}, {4, 4, 4, 4, 6}}));
  EXPECT_EQ(Inflate(kBody.aabb(), 2.f), (Aabb3{{-2, -2, -2}, {3, 4, 5}}));
  // By sqrt(3) = 0x1.bb67ae85... in 3, from a D of 0.
  const float d = Inflate(kBody, 1.f).max[3];
  EXPECT_GE(d, 0x1.bb67b0p0f);
  EXPECT_LE(d, 0x1.bb67b2p0f);
}

TEST(TransformKnownTest, InflateByBox) {
  EXPECT_EQ(InflateByBox(kBody, 2.f), (Aabo3{{-2, -2, -2, -11}, {3, 4, 5, 6}}));
  EXPECT_EQ(InflateByBox(UpSimplex2{{0, 0, -1}}, 1.f),
            (UpSimplex2{{-1, -1, -3}}));
}

TEST(TransformKnownTest, Translate) {
  EXPECT_EQ(Translate(kBody, {1, -2, 3}),
            (Aabo3{{1, -2, 3, -7}, {2, 0, 6, -2}}));
  EXPECT_EQ(Translate(DownSimplex2{{1, 1, 0}}, {1, 2}),
            (DownSimplex2{{2, 3, -3}}));
  // 1 + 2^-60 is no float.
  EXPECT_EQ(Translate(Aabb2{{1, 1}, {1, 1}}, {0x1p-60f, -0x1p-60f}),
            (Aabb2{{1.f, 0x1.fffffep-1f}, {0x1.000002p0f, 1.f}}));
}

// Whole numbers stay exact, but the library cannot know that they were.
TEST(TransformKnownTest, TranslateVertices) {
  const Aabo3 moved = TranslateVertices(kBody, {1, -2, 3});
  EXPECT_EQ(moved.aabb(), (Aabb3{{1, -2, 3}, {2, 0, 6}}));
  EXPECT_LE(moved.min[3], -7.f);
  EXPECT_GE(moved.min[3], -7.f - 0x1p-24f * (2 + 2 + 6) - 0x1p-21f);
  EXPECT_GE(moved.max[3], -2.f);
  EXPECT_LE(moved.max[3], -2.f + 0x1p-24f * (2 + 2 + 6) + 0x1p-21f);
}

// (1, -1) moved by 2^-24 twice: 1 rounds back to 1, so D becomes -2^-24.
TEST(TransformKnownTest, VerticesThatRoundingHoldsBack) {
  const Aabo2 point{{1, -1, 0}, {1, -1, 0}};
  const Point2 by = {0x1p-24f, 0x1p-24f};
  const Aabo2 moved = TranslateVertices(point, by);
  EXPECT_EQ(moved.aabb(), (Aabb2{{1, -0x1.fffffep-1f}, {1, -0x1.fffffep-1f}}));
  EXPECT_GE(moved.max[2], -0x1p-24f);
  EXPECT_EQ(Translate(point, by).max[2], -0x1p-23f);
}

TEST(TransformKnownTest, Scale) {
  EXPECT_EQ(Scale(kBody, 2.f), (Aabo3{{0, 0, 0, -10}, {2, 4, 6, 0}}));
  EXPECT_EQ(Scale(kBody, -1.f), (Aabo3{{-1, -2, -3, 0}, {0, 0, 0, 5}}));
  EXPECT_EQ(Scale(kBody, 0.f), (Aabo3{{0, 0, 0, 0}, {0, 0, 0, 0}}));
  EXPECT_EQ(Scale(UpSimplex2{{1, 2, -5}}, 3.f), (UpSimplex2{{3, 6, -15}}));
}

TEST(TransformKnownTest, Sweep) {
  EXPECT_EQ(Sweep(kBody, {4, 0, -1}), (Aabo3{{0, 0, -1, -8}, {5, 2, 3, 0}}));
  EXPECT_EQ(Sweep(UpSimplex2{{0, 0, -1}}, {1, -2}), (UpSimplex2{{0, -2, -1}}));
}

// x, y >= 0 and x + y <= 1 lies in x, y <= 1 and x + y >= 0.
TEST(TransformKnownTest, Circumscribe) {
  EXPECT_EQ(Circumscribe(UpSimplex2{{0, 0, -1}}), (DownSimplex2{{1, 1, 0}}));
  EXPECT_EQ(Circumscribe(UpSimplex3{{0, 0, 0, -1}}),
            (DownSimplex3{{1, 1, 1, 0}}));
  EXPECT_EQ(Circumscribe(DownSimplex3{{1, 1, 1, 0}}),
            (UpSimplex3{{-2, -2, -2, -3}}));
  // One point stays one.
  EXPECT_EQ(Circumscribe(UpSimplex2{{1, 2, -3}}), (DownSimplex2{{1, 2, -3}}));
}

// Without a bound on Y, only Y's opposite is bounded.
TEST(TransformKnownTest, CircumscribeOpenSimplex) {
  EXPECT_EQ(Circumscribe(UpSimplex2{{0, -kMax, -1}}),
            (DownSimplex2{{kMax, 1, kMax}}));
  EXPECT_EQ(Circumscribe(UpSimplex2{{-kMax, -kMax, -1}}),
            DownSimplex2::Everything());
}

}  // namespace
}  // namespace halfspace::testing

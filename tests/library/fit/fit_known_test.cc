// Bounds of shapes by hand: small whole numbers, whose sums are exact.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "halfspace/fit.h"

namespace halfspace::testing {
namespace {

// By hand: -(1 + 2) = -3 and -(4 - 5) = 1 in 2 dimensions, -6 and 1 in 3, -10
// and -1 in 4.
TEST(FitKnownTest, Points) {
  const float points2[] = {1, 2, 4, -5};
  EXPECT_EQ(BoundPoints<2>({points2, 2}), (Aabo2{{1, -5, -3}, {4, 2, 1}}));
  const float points3[] = {1, 2, 3, 4, -5, 0};
  EXPECT_EQ(BoundPoints<3>({points3, 2}),
            (Aabo3{{1, -5, 0, -6}, {4, 2, 3, 1}}));
  const float points4[] = {1, 2, 3, 4, 4, -5, 0, 2};
  EXPECT_EQ(BoundPoints<4>({points4, 2}),
            (Aabo4{{1, -5, 0, 2, -10}, {4, 2, 3, 4, -1}}));
}

// The box from (1, 2, 3) to (4, 5, 6): D from -(4 + 5 + 6) to -(1 + 2 + 3).
TEST(FitKnownTest, Boxes) {
  EXPECT_EQ(BoundAabb<2>({{1, 2}, {4, 5}}), (Aabo2{{1, 2, -9}, {4, 5, -3}}));
  EXPECT_EQ(BoundAabb<3>({{1, 2, 3}, {4, 5, 6}}),
            (Aabo3{{1, 2, 3, -15}, {4, 5, 6, -6}}));
  EXPECT_EQ(BoundAabb<4>({{1, 2, 3, 4}, {4, 5, 6, 7}}),
            (Aabo4{{1, 2, 3, 4, -22}, {4, 5, 6, 7, -10}}));
}

// -(1 + 2^-60) lies between -1 and the float below it. A double cannot hold the
// sum, so this also shows that the library's own flags left the error-free
// additions alone.
TEST(FitKnownTest, WhatDoubleCannotHoldStillCounts) {
  const float points[] = {1.f, 0x1p-60f};
  const Aabo2 bound = BoundPoints<2>({points, 1});
  EXPECT_EQ(bound.min[2], -0x1.000002p0f);
  EXPECT_EQ(bound.max[2], -1.f);
  const float cancelling[] = {1.f, 0x1p-60f, -0x1p-60f};
  const Aabo3 exact = BoundPoints<3>({cancelling, 1});
  EXPECT_EQ(exact.min[3], -1.f);
  EXPECT_EQ(exact.max[3], -1.f);
}

// The nearest double to 0.1 lies between two floats; -0.1 - 0.1 too.
TEST(FitKnownTest, DoublesAreRoundedOutward) {
  const double points[] = {0.1, 0.1};
  const Aabo2 expected{{0x1.999998p-4f, 0x1.999998p-4f, -0x1.99999ap-3f},
                       {0x1.99999ap-4f, 0x1.99999ap-4f, -0x1.999998p-3f}};
  EXPECT_EQ(BoundPoints(Points<2, double>{points, 1}), expected);
  EXPECT_EQ(BoundPoints(PointsSoa<2, double>{{points, points + 1}, 1}),
            expected);
  EXPECT_EQ(BoundAabb(Box<2, double>{{0.1, 0.1}, {0.1, 0.1}}), expected);
  EXPECT_EQ(BoundSphere(Sphere<2, double>{{0.1, 0.1}, 0.0}), expected);
}

TEST(FitKnownTest, IndexedPoints) {
  const float coords[] = {100, 100, 1, 2, 4, -5};
  const std::array<std::uint32_t, 3> indices = {2, 1, 2};
  const Aabo2 expected{{1, -5, -3}, {4, 2, 1}};
  EXPECT_EQ(BoundPoints<2>({coords, 3}, indices), expected);
  const float x[] = {100, 1, 4};
  const float y[] = {100, 2, -5};
  EXPECT_EQ(BoundPoints<2>(PointsSoa2{{x, y}, 3}, indices), expected);
}

TEST(FitKnownTest, PointSegmentTriangle) {
  EXPECT_EQ(BoundPoint<3>({1, 2, 3}), (Aabo3{{1, 2, 3, -6}, {1, 2, 3, -6}}));
  EXPECT_EQ(BoundSegment<3>({{0, 0, 0}, {4, 2, -1}}),
            (Aabo3{{0, 0, -1, -5}, {4, 2, 0, 0}}));
  EXPECT_EQ(BoundTriangle<3>({{0, 0, 0}, {1, 0, 0}, {0, 2, 0}}),
            (Aabo3{{0, 0, 0, -2}, {1, 2, 0, 0}}));
}

// From (1, 1, 1) to (7, 1, -2).
TEST(FitKnownTest, Ray) {
  EXPECT_EQ(BoundRay<3>({{1, 1, 1}, {2, 0, -1}, 3}),
            (Aabo3{{1, 1, -2, -6}, {7, 1, 1, -3}}));
}

// Piece i goes from (i, 2 i) to (i + 1, 2 i + 2).
TEST(FitKnownTest, SegmentPieces) {
  std::array<Aabo2, 4> pieces;
  BoundSegmentPieces<2>({{0, 0}, {4, 8}}, pieces);
  for (int i = 0; i < 4; ++i) {
    const auto n = static_cast<float>(i);
    EXPECT_EQ(pieces[i],
              (Aabo2{{n, 2 * n, -3 * n - 3}, {n + 1, 2 * n + 2, -3 * n}}));
  }
}

// Arms of (3, 4) and (-8, 6): X reaches 3 + 8, Y 4 + 6, D 7 + 2.
TEST(FitKnownTest, OrientedBoxes) {
  EXPECT_EQ(BoundOrientedBox<2>({{10, 0}, {{{3, 4}, {-4, 3}}}, {1, 2}}),
            (Aabo2{{-1, -10, -19}, {21, 10, -1}}));
  EXPECT_EQ(BoundOrientedBox<3>(
                {{1, 1, 1}, {{{0, 1, 0}, {1, 0, 0}, {0, 0, -1}}}, {2, 1, 3}}),
            (Aabo3{{0, -1, -2, -9}, {2, 3, 4, 3}}));
}

// The square root of 4 is 2.
TEST(FitKnownTest, SpheresIn4D) {
  EXPECT_EQ(BoundSphere<4>({{1, 2, 3, 4}, 2}),
            (Aabo4{{-1, 0, 1, 2, -14}, {3, 4, 5, 6, -6}}));
  EXPECT_EQ(BoundCapsule<4>({{0, 0, 0, 0}, {4, 0, 0, 0}, 1}),
            (Aabo4{{-1, -1, -1, -1, -6}, {5, 1, 1, 1, 2}}));
}

// sqrt(3) = 0x1.bb67ae85..., sqrt(2) = 0x1.6a09e667...
TEST(FitKnownTest, RootsAreRoundedOutward) {
  const Aabo3 sphere3 = BoundSphere<3>({{0, 0, 0}, 1});
  EXPECT_GE(sphere3.max[3], 0x1.bb67b0p0f);
  EXPECT_LE(sphere3.max[3], 0x1.bb67b2p0f);
  EXPECT_EQ(sphere3.min[3], -sphere3.max[3]);
  const Aabo2 sphere2 = BoundSphere<2>({{0, 0}, 1});
  EXPECT_GE(sphere2.max[2], 0x1.6a09e8p0f);
  EXPECT_LE(sphere2.max[2], 0x1.6a09eap0f);
  EXPECT_EQ(sphere2.min[2], -sphere2.max[2]);
}

// -2 <= x <= z and so on, from an eye in the origin: the far end's corners are
// at (+-2, +-2, 2).
TEST(FitKnownTest, Frusta) {
  const std::array<HalfSpace3, 6> frustum = {{{{1, 0, 1}, 0},
                                              {{-1, 0, 1}, 0},
                                              {{0, 1, 1}, 0},
                                              {{0, -1, 1}, 0},
                                              {{0, 0, 1}, -1},
                                              {{0, 0, -1}, 2}}};
  EXPECT_EQ(BoundFrustum(frustum), (Aabo3{{-2, -2, 1, -6}, {2, 2, 2, 2}}));
  // x, y, z >= 0 and x + y + z <= 3.
  const std::array<HalfSpace3, 6> corner = {{{{1, 0, 0}, 0},
                                             {{0, 2, 0}, 0},
                                             {{0, 0, 3}, 0},
                                             {{-1, -1, -1}, 3},
                                             {{-2, -2, -2}, 6},
                                             {{0, 0, 1}, 0}}};
  EXPECT_EQ(BoundFrustum(corner), (Aabo3{{0, 0, 0, -3}, {3, 3, 3, 0}}));
}

// The corner of that frustum shrunk to one point, to nothing, and opened.
TEST(FitKnownTest, FrustaOfOnePointOfNoneAndOfTooMany) {
  std::array<HalfSpace3, 6> planes = {{{{1, 0, 0}, -1},
                                       {{0, 1, 0}, -1},
                                       {{0, 0, 1}, -1},
                                       {{-1, -1, -1}, 3},
                                       {{-1, -1, -1}, 3},
                                       {{-1, -1, -1}, 3}}};
  EXPECT_EQ(BoundFrustum(planes), (Aabo3{{1, 1, 1, -3}, {1, 1, 1, -3}}));
  planes[3].offset = std::nextafter(3.f, 0.f);
  EXPECT_EQ(BoundFrustum(planes), Aabo3::Empty());
  planes[3] = planes[4] = planes[5] = {{-1, -1, 0}, 3};
  EXPECT_EQ(BoundFrustum(planes), Aabo3::Everything());
}

// (x, y) becomes (5 - 2 y, 7 + 3 x): a triangle, and the square around it.
TEST(FitKnownTest, AffineImages) {
  const Affine2 map{{{{0, -2}, {3, 0}}}, {5, 7}};
  const float triangle[] = {0, 0, 1, 0, 0, 1};
  EXPECT_EQ(BoundTransformed(Points2{triangle, 3}, map),
            (Aabo2{{3, 7, -15}, {5, 10, -10}}));
  EXPECT_EQ(BoundTransformed(Aabb2{{0, 0}, {2, 1}}, map),
            (Aabo2{{3, 7, -18}, {5, 13, -10}}));
}

}  // namespace
}  // namespace halfspace::testing

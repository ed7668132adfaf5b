// Bounds by hand: small whole numbers, whose sums are exact.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <vector>

#include "halfspace/fit.h"
#include "tests/library/fit/builders.h"

namespace halfspace::testing {
namespace {

struct Known {
  const char* why;
  const char* builder;          // a name of builders.h
  std::vector<double> numbers;  // of the shape
  std::vector<float> planes;    // minima, then maxima
};

const std::vector<Known> kKnown = {
    {"-(1 + 2) = -3 and -(4 - 5) = 1",
     "BoundPoints2",
     {1, 2, 4, -5, 4, -5},
     {1, -5, -3, 4, 2, 1}},
    {"-(4 + 5 + 6), -(1 + 2 + 3)",
     "BoundAabb3",
     {1, 2, 3, 4, 5, 6},
     {1, 2, 3, -15, 4, 5, 6, -6}},
    // A double cannot hold the sum, so these also show that the library's own
    // flags left the error-free additions alone.
    {"-(1 + 2^-60) lies between -1 and the float below",
     "BoundSegment2",
     {1, 0x1p-60, 1, 0x1p-60},
     {1, 0x1p-60f, -0x1.000002p0f, 1, 0x1p-60f, -1}},
    {"1 + 2^-60 - 2^-60",
     "BoundSegment3",
     {1, 0x1p-60, -0x1p-60, 1, 0x1p-60, -0x1p-60},
     {1, 0x1p-60f, -0x1p-60f, -1, 1, 0x1p-60f, -0x1p-60f, -1}},
    {"the nearest double to 0.1 lies between two floats; -0.1 - 0.1 too",
     "BoundSphere2Double",
     {0.1, 0.1, 0},
     {0x1.999998p-4f, 0x1.999998p-4f, -0x1.99999ap-3f, 0x1.99999ap-4f,
      0x1.99999ap-4f, -0x1.999998p-3f}},
    {"a triangle",
     "BoundTriangle3",
     {0, 0, 0, 1, 0, 0, 0, 2, 0},
     {0, 0, 0, -2, 1, 2, 0, 0}},
    {"from (1, 1, 1) to (7, 1, -2)",
     "BoundRay3",
     {1, 1, 1, 2, 0, -1, 3},
     {1, 1, -2, -6, 7, 1, 1, -3}},
    {"piece i goes from (i, 2 i) to (i + 1, 2 i + 2)",
     "BoundSegmentPieces2",
     {0, 0, 3, 6},
     {0, 0, -3, 1, 2, 0, 1, 2, -6, 2, 4, -3, 2, 4, -9, 3, 6, -6}},
    {"arms of (3, 4) and (-8, 6): X reaches 3 + 8, Y 4 + 6, D 7 + 2",
     "BoundOrientedBox2",
     {10, 0, 3, 4, -4, 3, 1, 2},
     {-1, -10, -19, 21, 10, -1}},
    {"the square root of 4 is 2",
     "BoundSphere4",
     {1, 2, 3, 4, 2},
     {-1, 0, 1, 2, -14, 3, 4, 5, 6, -6}},
    {"the square root of 4 is 2",
     "BoundCapsule4",
     {0, 0, 0, 0, 4, 0, 0, 0, 1},
     {-1, -1, -1, -1, -6, 5, 1, 1, 1, 2}},
    {"-2 <= x <= z and so on, from an eye in the origin: the far end's corners "
     "are at (+-2, +-2, 2)",
     "BoundFrustum3",
     {1, 0,  1, 0, -1, 0, 1, 0,  0, 1, 1,  0,
      0, -1, 1, 0, 0,  0, 1, -1, 0, 0, -1, 2},
     {-2, -2, 1, -6, 2, 2, 2, 2}},
    {"x, y, z >= 0 and x + y + z <= 3",
     "BoundFrustum3",
     {1,  0,  0,  0, 0,  2,  0,  0, 0, 0, 3, 0,
      -1, -1, -1, 3, -2, -2, -2, 6, 0, 0, 1, 0},
     {0, 0, 0, -3, 3, 3, 3, 0}},
    {"(x, y) becomes (5 - 2 y, 7 + 3 x)",
     "BoundTransformed2PointsMap",
     {0, 0, 1, 0, 0, 1, 0, -2, 3, 0, 5, 7},
     {3, 7, -15, 5, 10, -10}},
    {"the square around it",
     "BoundTransformed2BoxMap",
     {0, 0, 2, 1, 0, -2, 3, 0, 5, 7},
     {3, 7, -18, 5, 13, -10}},

    // The box from (0, 0, 0) to (1, 2, 3), without a corner: x + y + z <= 5.
    {"D too",
     "Merge3Aabo",
     {0, 0, 0, -5, 1, 2, 3, 0, -1, 1, 1, -4, 0, 3, 2, -1},
     {-1, 0, 0, -5, 1, 3, 3, 0}},
    {"in 4 dimensions D moves by twice the radius",
     "Inflate4Aabo",
     {0, 0, 0, 0, -4, 1, 1, 1, 1, 0, 3},
     {-3, -3, -3, -3, -10, 4, 4, 4, 4, 6}},
    {"D moves by three times the margin",
     "InflateByBox3Aabo",
     {0, 0, 0, -5, 1, 2, 3, 0, 2},
     {-2, -2, -2, -11, 3, 4, 5, 6}},
    {"by (1, -2, 3)",
     "Translate3Aabo",
     {0, 0, 0, -5, 1, 2, 3, 0, 1, -2, 3},
     {1, -2, 3, -7, 2, 0, 6, -2}},
    {"1 + 2^-60 is no float",
     "Translate2Aabb",
     {1, 1, 1, 1, 0x1p-60, -0x1p-60},
     {1, 0x1.fffffep-1f, 0x1.000002p0f, 1}},
    {"twice",
     "Scale3Aabo",
     {0, 0, 0, -5, 1, 2, 3, 0, 2},
     {0, 0, 0, -10, 2, 4, 6, 0}},
    {"turned over",
     "Scale3Aabo",
     {0, 0, 0, -5, 1, 2, 3, 0, -1},
     {-1, -2, -3, 0, 0, 0, 0, 5}},
    {"D moves by -3",
     "Sweep3Aabo",
     {0, 0, 0, -5, 1, 2, 3, 0, 4, 0, -1},
     {0, 0, -1, -8, 5, 2, 3, 0}},
    {"x, y >= 0 and x + y <= 1 lies in x, y <= 1 and x + y >= 0",
     "Circumscribe2Up",
     {0, 0, -1},
     {1, 1, 0}},
    {"down", "Circumscribe3Down", {1, 1, 1, 0}, {-2, -2, -2, -3}},
};

TEST(FitKnownTest, Rows) {
  std::vector<Builder> builders = Builders({2, 3, 4});
  for (const Builder& change : Changes({2, 3, 4})) builders.push_back(change);
  for (const Known& known : kKnown) {
    SCOPED_TRACE(::testing::Message() << known.builder << ": " << known.why);
    const auto builder = std::find_if(
        builders.begin(), builders.end(),
        [&](const Builder& row) { return row.name == known.builder; });
    ASSERT_NE(builder, builders.end());
    ASSERT_EQ(known.numbers.size(), builder->roles.size());
    Shape shape;
    for (std::size_t i = 0; i < known.numbers.size(); ++i) {
      shape.Set(i, known.numbers[i]);
    }
    Planes expected{};
    std::copy(known.planes.begin(), known.planes.end(), expected.begin());
    EXPECT_EQ(builder->Build(shape), expected);
  }
}

// The wrappers of the calls above.
TEST(FitKnownTest, OnePointAndStrideZero) {
  const Aabo3 bound{{1, 2, 3, -6}, {1, 2, 3, -6}};
  const Point3 point = {1, 2, 3};
  EXPECT_EQ(BoundPoint<3>(point), bound);
  EXPECT_EQ(BoundPoints(Points3{point.data(), 50, 0}), bound);
  EXPECT_EQ((BoundPoint<3, double>({1, 2, 3})), bound);
}

}  // namespace
}  // namespace halfspace::testing

// Shapes that floats cannot bound become Everything(), and are counted.
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <limits>
#include <type_traits>
#include <vector>

#include "halfspace/fit.h"
#include "tests/library/support/dims.h"

namespace halfspace::testing {
namespace {

// The numbers of a shape, in order.
template <typename Shape, typename Scalar>
using Numbers = std::array<Scalar, sizeof(Shape) / sizeof(Scalar)>;

template <typename Scalar>
struct Bad {
  static constexpr Scalar kNan = std::numeric_limits<Scalar>::quiet_NaN();
  static constexpr Scalar kInfinity = std::numeric_limits<Scalar>::infinity();
  static constexpr Scalar kMost = std::numeric_limits<Scalar>::max();
  static Scalar TooLarge() { return std::nextafter(Scalar{0x1p125}, kMost); }

  static std::vector<Scalar> Lengths() {
    return {kInfinity, kMost, TooLarge()};
  }
  static std::vector<Scalar> Coordinates() {
    std::vector<Scalar> all = {kNan, -kNan};
    for (Scalar length : Lengths()) all.insert(all.end(), {length, -length});
    return all;
  }
};

// Puts a bad value in place of each of the numbers first .. end - 1 of a shape
// that is all ones. call(shape, status) must give Everything().
template <typename Shape, typename Scalar, typename Call>
void ExpectEverything(std::size_t first, std::size_t end,
                      const std::vector<Scalar>& bad_values, Call call) {
  using All = Numbers<Shape, Scalar>;
  static_assert(sizeof(All) == sizeof(Shape));
  All numbers;
  numbers.fill(1);
  FitStatus status;
  auto good = call(std::bit_cast<Shape>(numbers), &status);
  using Bound = decltype(good);
  ASSERT_NE(good, Bound::Everything());
  ASSERT_LE(end, numbers.size());
  std::size_t calls = 1;
  for (std::size_t i = first; i < end; ++i) {
    for (Scalar bad : bad_values) {
      numbers[i] = bad;
      EXPECT_EQ(call(std::bit_cast<Shape>(numbers), &status),
                Bound::Everything())
          << bad << " as number " << i;
      ++calls;
    }
    numbers[i] = 1;
  }
  EXPECT_EQ(status.results, calls);
  EXPECT_EQ(status.everything, calls - 1);
  EXPECT_EQ(status.first_everything, 1u);
}

template <typename Dims>
class FitSpecialTest : public ::testing::Test {
 protected:
  static inline const auto kCoordinates = Bad<float>::Coordinates();
  static inline const auto kLengths = Bad<float>::Lengths();
};
TYPED_TEST_SUITE(FitSpecialTest, AllDims, DimsNames);

TYPED_TEST(FitSpecialTest, PointSegmentTriangle) {
  constexpr int kDims = TypeParam::value;
  ExpectEverything<Point<kDims>>(0, kDims, this->kCoordinates,
                                 BoundPoint<kDims>);
  ExpectEverything<Segment<kDims>>(0, 2 * kDims, this->kCoordinates,
                                   BoundSegment<kDims>);
  ExpectEverything<Triangle<kDims>>(0, 3 * kDims, this->kCoordinates,
                                    BoundTriangle<kDims>);
}

// 1e300 is finite, and no float bounds it.
TYPED_TEST(FitSpecialTest, Doubles) {
  constexpr int kDims = TypeParam::value;
  auto bad = Bad<double>::Coordinates();
  bad.push_back(1e300);
  ExpectEverything<Point<kDims, double>>(
      0, kDims, bad, [](const auto& point, FitStatus* status) {
        return BoundPoints(Points<kDims, double>{point.data(), 1}, status);
      });
  ExpectEverything<Sphere<kDims, double>>(
      0, kDims, bad, [](const auto& sphere, FitStatus* status) {
        return BoundSphere(sphere, status);
      });
  ExpectEverything<Sphere<kDims, double>>(
      kDims, kDims + 1, Bad<double>::Lengths(),
      [](const auto& sphere, FitStatus* status) {
        return BoundSphere(sphere, status);
      });
  ExpectEverything<Point<kDims, double>>(0, kDims, bad,
                                         BoundPoint<kDims, double>);
  ExpectEverything<Segment<kDims, double>>(0, 2 * kDims, bad,
                                           BoundSegment<kDims, double>);
  ExpectEverything<Triangle<kDims, double>>(0, 3 * kDims, bad,
                                            BoundTriangle<kDims, double>);
  ExpectEverything<Ray<kDims, double>>(0, 2 * kDims, bad,
                                       BoundRay<kDims, double>);
  ExpectEverything<Capsule<kDims, double>>(0, 2 * kDims, bad,
                                           BoundCapsule<kDims, double>);
  ExpectEverything<OrientedBox<kDims, double>>(0, kDims + kDims * kDims, bad,
                                               BoundOrientedBox<kDims, double>);
  ExpectEverything<Affine<kDims, double>>(
      0, kDims * (kDims + 1), bad, [](const auto& map, FitStatus* status) {
        Aabb<kDims> box;
        box.min.fill(1.f);
        box.max.fill(1.f);
        const Points<kDims> points{box.min.data(), 1};
        EXPECT_EQ(BoundTransformed(points, map),
                  BoundTransformed(box, map, status));
        return BoundTransformed(points, map);
      });
  // What is not told from the products: it may come to anything.
  Affine<kDims, double> map{};
  map.linear[0][0] = std::nextafter(0x1p900, Bad<double>::kMost);
  EXPECT_EQ(BoundTransformed(Aabb<kDims>{}, map), Aabo<kDims>::Everything());
  const std::vector<double> up = {1e300, Bad<double>::kInfinity,
                                  Bad<double>::kNan};
  ExpectEverything<Box<kDims, double>>(kDims, 2 * kDims, up,
                                       [](const auto& box, FitStatus* status) {
                                         return BoundAabb(box, status);
                                       });
}

TYPED_TEST(FitSpecialTest, Spheres) {
  constexpr std::size_t kDims = TypeParam::value;
  const auto sphere = [](const auto& shape, FitStatus* status) {
    return BoundSphere(shape, status);
  };
  ExpectEverything<Sphere<kDims>>(0, kDims, this->kCoordinates, sphere);
  ExpectEverything<Sphere<kDims>>(kDims, kDims + 1, this->kLengths, sphere);
  const auto capsule = [](const auto& shape, FitStatus* status) {
    return BoundCapsule(shape, status);
  };
  ExpectEverything<Capsule<kDims>>(0, 2 * kDims, this->kCoordinates, capsule);
  ExpectEverything<Capsule<kDims>>(2 * kDims, 2 * kDims + 1, this->kLengths,
                                   capsule);
}

// Where a direction or an axis is scaled by 1, what is too large stays so.
TYPED_TEST(FitSpecialTest, RaysAndOrientedBoxes) {
  constexpr std::size_t kDims = TypeParam::value;
  const auto ray = [](const auto& shape, FitStatus* status) {
    return BoundRay(shape, status);
  };
  ExpectEverything<Ray<kDims>>(0, 2 * kDims, this->kCoordinates, ray);
  ExpectEverything<Ray<kDims>>(2 * kDims, 2 * kDims + 1, this->kLengths, ray);
  const auto box = [](const auto& shape, FitStatus* status) {
    return BoundOrientedBox(shape, status);
  };
  constexpr std::size_t kHalves = kDims + kDims * kDims;
  ExpectEverything<OrientedBox<kDims>>(0, kHalves, this->kCoordinates, box);
  ExpectEverything<OrientedBox<kDims>>(kHalves, kHalves + kDims, this->kLengths,
                                       box);
}

// Infinitely far along no direction, as many times as one likes of nothing: no
// number says what that is.
TYPED_TEST(FitSpecialTest, InfinityTimesZero) {
  constexpr int kDims = TypeParam::value;
  constexpr float kInfinity = Bad<float>::kInfinity;
  EXPECT_EQ(BoundRay<kDims>({{}, {}, kInfinity}), Aabo<kDims>::Everything());
  OrientedBox<kDims> box{};
  box.half_extents[0] = kInfinity;
  EXPECT_EQ(BoundOrientedBox(box), Aabo<kDims>::Everything());
  Affine<kDims> map{};
  map.linear[0][0] = kInfinity;
  const Point<kDims> origin{};
  EXPECT_EQ(BoundTransformed(Points<kDims>{origin.data(), 1}, map),
            Aabo<kDims>::Everything());
  EXPECT_EQ(BoundTransformed(Aabb<kDims>{}, map), Aabo<kDims>::Everything());
}

TYPED_TEST(FitSpecialTest, AffineImages) {
  constexpr std::size_t kDims = TypeParam::value;
  const auto of_points = [](const auto& map, FitStatus* status) {
    Point<kDims> point;
    point.fill(1.f);
    return BoundTransformed(Points<kDims>{point.data(), 1}, map, status);
  };
  ExpectEverything<Affine<kDims>>(0, kDims * (kDims + 1), this->kCoordinates,
                                  of_points);
  const auto of_box = [](const auto& map, FitStatus* status) {
    Aabb<kDims> box;
    box.min.fill(1.f);
    box.max.fill(1.f);
    return BoundTransformed(box, map, status);
  };
  ExpectEverything<Affine<kDims>>(0, kDims * (kDims + 1), this->kCoordinates,
                                  of_box);
  const auto of_bad_point = [](const auto& point, FitStatus* status) {
    Affine<kDims> map;
    for (auto& row : map.linear) row.fill(1.f);
    map.translation.fill(0.f);
    return BoundTransformed(Points<kDims>{point.data(), 1}, map, status);
  };
  ExpectEverything<Point<kDims>>(0, kDims, this->kCoordinates, of_bad_point);
}

TYPED_TEST(FitSpecialTest, EachPieceIsCounted) {
  constexpr int kDims = TypeParam::value;
  Segment<kDims> segment{};
  std::vector<Aabo<kDims>> pieces(5, Aabo<kDims>::Empty());
  FitStatus status;
  BoundSegmentPieces<kDims>(segment, pieces, &status);
  EXPECT_EQ(status.results, 5u);
  EXPECT_EQ(status.everything, 0u);
  segment.b[kDims - 1] = Bad<float>::kNan;
  BoundSegmentPieces<kDims>(segment, pieces, &status);
  for (const auto& piece : pieces) {
    EXPECT_EQ(piece, Aabo<kDims>::Everything());
  }
  EXPECT_EQ(status.results, 10u);
  EXPECT_EQ(status.everything, 5u);
  EXPECT_EQ(status.first_everything, 5u);
  BoundSegmentPieces<kDims>(segment, {}, &status);
  EXPECT_EQ(status.results, 10u);
}

TYPED_TEST(FitSpecialTest, NothingGivesEmpty) {
  constexpr int kDims = TypeParam::value;
  constexpr auto kEmpty = Aabo<kDims>::Empty();
  constexpr float kInfinity = Bad<float>::kInfinity;
  FitStatus status;
  EXPECT_EQ(BoundPoints(PointsSoa<kDims>{}, &status), kEmpty);
  EXPECT_EQ(BoundPoints(Points<kDims, double>{}, &status), kEmpty);
  const float unread = Bad<float>::kNan;
  EXPECT_EQ(BoundPoints(Points<kDims>{&unread, 7}, {}, &status), kEmpty);
  EXPECT_EQ(BoundPoints(PointsSoa<kDims>{{}, 7}, {}, &status), kEmpty);
  EXPECT_EQ(BoundTransformed(Points<kDims>{}, Affine<kDims>{}, &status),
            kEmpty);
  EXPECT_EQ(BoundTransformed(Aabb<kDims>::Empty(), Affine<kDims>{}, &status),
            kEmpty);
  Box<kDims, double> box;
  box.min.fill(kInfinity);
  box.max.fill(-kInfinity);
  EXPECT_EQ(BoundAabb(box, &status), kEmpty);
  // As engines initialise boxes.
  box.min.fill(Bad<double>::kMost);
  box.max.fill(-Bad<double>::kMost);
  EXPECT_EQ(BoundAabb(box, &status), kEmpty);
  Aabb<kDims> untouched;
  untouched.min.fill(Bad<float>::kMost);
  untouched.max.fill(-Bad<float>::kMost);
  EXPECT_EQ(BoundAabb(untouched, &status), kEmpty);
  EXPECT_EQ(BoundTransformed(untouched, Affine<kDims>{}, &status), kEmpty);
  EXPECT_EQ(status.results, 10u);
  EXPECT_EQ(status.everything, 0u);
}

TEST(FitFrustumSpecialTest, NumbersThatAreNotFiniteGiveEverything) {
  using Planes = std::array<HalfSpace3, 6>;
  constexpr Planes kCube = {{{{1, 0, 0}, 1},
                             {{-1, 0, 0}, 1},
                             {{0, 1, 0}, 1},
                             {{0, -1, 0}, 1},
                             {{0, 0, 1}, 1},
                             {{0, 0, -1}, 1}}};
  using All = Numbers<Planes, float>;
  const std::vector<float> bad_values = {
      Bad<float>::kNan, Bad<float>::kInfinity, -Bad<float>::kInfinity};
  FitStatus status;
  for (std::size_t i = 0; i < std::tuple_size_v<All>; ++i) {
    for (float bad : bad_values) {
      auto numbers = std::bit_cast<All>(kCube);
      numbers[i] = bad;
      EXPECT_EQ(BoundFrustum(std::bit_cast<Planes>(numbers), &status),
                Aabo3::Everything());
    }
  }
  EXPECT_EQ(status.everything, status.results);
  // Corners too far away; and as far as can be bounded.
  Planes cube = kCube;
  cube[0].offset = 0x1.8p125f;
  EXPECT_EQ(BoundFrustum(cube), Aabo3::Everything());
  cube[0].offset = 0x1p124f;
  EXPECT_EQ(BoundFrustum(cube).min[0], -0x1p124f);
}

TEST(FitFrustumSpecialTest, DoublesFarApart) {
  std::array<HalfSpace<3, double>, 6> cube = {{{{1, 0, 0}, 1},
                                               {{-1, 0, 0}, 1},
                                               {{0, 1, 0}, 1},
                                               {{0, -1, 0}, 1},
                                               {{0, 0, 1}, 1},
                                               {{0, 0, -1}, 1}}};
  constexpr double kInfinity = Bad<double>::kInfinity;
  EXPECT_EQ(BoundFrustum(cube).max[0], 1.f);
  // So long a normal, so short a normal.
  cube[1] = {{-0x1p1023, 0, 0}, 0x1p1023};
  cube[2] = {{0, 0x1p-1074, 0}, 0x1p-1074};
  EXPECT_EQ(BoundFrustum(cube).max[0], 1.f);
  EXPECT_EQ(BoundFrustum(cube).min[1], -1.f);
  cube[1] = {{-1, 0x1p-200, 0}, 1};
  EXPECT_EQ(BoundFrustum(cube).max[0], 0x1.000002p0f);
  for (double bad : {0x1p-201, Bad<double>::kNan, kInfinity, -kInfinity}) {
    cube[1].normal[1] = bad;
    EXPECT_EQ(BoundFrustum(cube), Aabo3::Everything()) << bad;
  }
  cube[1] = {{-1, 0, 0}, 0x1p201};
  EXPECT_EQ(BoundFrustum(cube), Aabo3::Everything());
  // In front of it everywhere, and behind it everywhere.
  cube[1] = {{-1, 0, 0}, 1};
  cube[5] = {{0, 0, -1}, 1};
  cube[0].offset = -0x1p-200;
  EXPECT_EQ(BoundFrustum(cube).min[0], 0.f);
}

}  // namespace
}  // namespace halfspace::testing

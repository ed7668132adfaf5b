// Shapes whose bounds are hard to round, from the points of points.h.
#ifndef HALFSPACE_TESTS_LIBRARY_SUPPORT_RANDOM_SHAPES_H_
#define HALFSPACE_TESTS_LIBRARY_SUPPORT_RANDOM_SHAPES_H_

#include <gmpxx.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "halfspace/shapes.h"
#include "tests/library/support/points.h"

namespace halfspace::testing {

// A double near `value` that uses more bits than a float has, sometimes all.
inline double WithMoreBits(float value, Random& random) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  constexpr std::uint64_t kBitsOfDoublesAlone = (std::uint64_t{1} << 29) - 1;
  switch (random() % 4) {
    case 0:
      return value;
    case 1:
      return std::nextafter(value, RandomSign(random) * kInfinity);
    default:
      return std::bit_cast<double>(std::bit_cast<std::uint64_t>(double{value}) |
                                   (random() & kBitsOfDoublesAlone));
  }
}

template <int kDims, typename Scalar>
Point<kDims, Scalar> RandomPointOf(PointKind kind, Random& random) {
  const auto floats = RandomPoint<std::size_t{kDims}>(kind, random);
  if constexpr (std::is_same_v<Scalar, float>) {
    return floats;
  } else {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    Point<kDims, double> point;
    for (std::size_t k = 0; k < kDims; ++k) {
      point[k] = WithMoreBits(floats[k], random);
      if (kind == PointKind::kSubnormal && OneIn(2, random)) {
        point[k] = std::ldexp(point[k], -RandomExponent(0, 920, random));
      }
      if (kind == PointKind::kCancelling && k % 2 == 1) {
        point[k] = -point[k - 1];
        if (OneIn(2, random)) point[k] = std::nextafter(point[k], kInfinity);
      }
    }
    return point;
  }
}

// Not negative; 0 now and then.
template <typename Scalar>
Scalar RandomLength(PointKind kind, Random& random) {
  if (OneIn(8, random)) return 0;
  return std::fabs(RandomPointOf<2, Scalar>(kind, random)[0]);
}

// To multiply coordinates with: small enough for the largest of them.
template <typename Scalar = float>
Scalar RandomFactor(PointKind kind, Random& random);

template <>
inline float RandomFactor<float>(PointKind kind, Random& random) {
  const float sign = RandomSign(random);
  switch (kind) {
    case PointKind::kUniform:
    case PointKind::kCancelling:
      return sign * RandomMantissa(random);
    case PointKind::kWideExponents:
    case PointKind::kSubnormal:
      return sign * std::ldexp(RandomMantissa(random),
                               RandomExponent(-149, -4, random));
    case PointKind::kPowersOfTwo:
      return std::ldexp(sign, RandomExponent(-100, 1, random));
    case PointKind::kTies:
      return sign * std::nextafter(1.f, RandomSign(random) * 2.f);
  }
  return sign;
}

// Of subnormal points the products are less than any double.
template <>
inline double RandomFactor<double>(PointKind kind, Random& random) {
  const double factor = WithMoreBits(RandomFactor<float>(kind, random), random);
  if (kind != PointKind::kSubnormal || OneIn(2, random)) return factor;
  return std::ldexp(factor, -RandomExponent(0, 920, random));
}

// Lengths of 1 / sqrt(kDims) times the sum of the center's coordinates, or
// coordinates that add up to almost sqrt(kDims) times the radius: D of the
// sphere is next to nothing, on one side.
template <int kDims, typename Scalar>
void MakeCancelling(Sphere<kDims, Scalar>& sphere, Random& random) {
  constexpr Scalar kInfinity = std::numeric_limits<Scalar>::infinity();
  if (OneIn(2, random)) {
    double sum = 0.0;
    for (Scalar x : sphere.center) sum += x;
    sphere.radius = static_cast<Scalar>(std::fabs(sum) / std::sqrt(kDims));
    return;
  }
  const double sign = RandomSign(random);
  mpf_class left(kDims, 500);  // bits enough for all the parts
  left = sqrt(left) * sphere.radius;
  for (Scalar& x : sphere.center) {
    x = static_cast<Scalar>(left.get_d());
    left -= x;
    x *= static_cast<Scalar>(sign);
  }
  if (OneIn(2, random)) {
    Scalar& x = sphere.center[random() % kDims];
    x = std::nextafter(x, RandomSign(random) * kInfinity);
  }
}

template <int kDims, typename Scalar>
Sphere<kDims, Scalar> RandomSphere(PointKind kind, Random& random) {
  Sphere<kDims, Scalar> sphere{RandomPointOf<kDims, Scalar>(kind, random),
                               RandomLength<Scalar>(kind, random)};
  if (kind == PointKind::kCancelling) MakeCancelling(sphere, random);
  return sphere;
}

template <int kDims, typename Scalar = float>
Capsule<kDims, Scalar> RandomCapsule(PointKind kind, Random& random) {
  const auto sphere = RandomSphere<kDims, Scalar>(kind, random);
  Capsule<kDims, Scalar> capsule{
      sphere.center, RandomPointOf<kDims, Scalar>(kind, random), sphere.radius};
  if (OneIn(4, random)) capsule.b = capsule.a;
  return capsule;
}

template <int kDims, typename Scalar>
Box<kDims, Scalar> RandomBox(PointKind kind, Random& random) {
  Box<kDims, Scalar> box{RandomPointOf<kDims, Scalar>(kind, random),
                         RandomPointOf<kDims, Scalar>(kind, random)};
  for (std::size_t k = 0; k < kDims; ++k) {
    if (box.min[k] > box.max[k]) std::swap(box.min[k], box.max[k]);
  }
  return box;
}

template <int kDims, typename Scalar = float>
OrientedBox<kDims, Scalar> RandomOrientedBox(PointKind kind, Random& random) {
  OrientedBox<kDims, Scalar> box;
  box.center = RandomPointOf<kDims, Scalar>(kind, random);
  for (auto& axis : box.axes) axis = RandomPointOf<kDims, Scalar>(kind, random);
  for (Scalar& half : box.half_extents) {
    half = OneIn(8, random) ? 0 : std::fabs(RandomFactor<Scalar>(kind, random));
  }
  return box;
}

template <int kDims, typename Scalar = float>
Ray<kDims, Scalar> RandomRay(PointKind kind, Random& random) {
  return {RandomPointOf<kDims, Scalar>(kind, random),
          RandomPointOf<kDims, Scalar>(kind, random),
          OneIn(8, random) ? 0 : std::fabs(RandomFactor<Scalar>(kind, random))};
}

// kCancelling: the translation takes `point` almost back to the origin.
template <int kDims, typename Scalar = float>
Affine<kDims, Scalar> RandomAffine(PointKind kind,
                                   const Point<kDims, Scalar>& point,
                                   Random& random) {
  Affine<kDims, Scalar> map;
  map.translation = RandomPointOf<kDims, Scalar>(kind, random);
  for (std::size_t i = 0; i < kDims; ++i) {
    Scalar sum = 0;
    for (std::size_t k = 0; k < kDims; ++k) {
      map.linear[i][k] = RandomFactor<Scalar>(kind, random);
      sum += map.linear[i][k] * point[k];
    }
    if (kind == PointKind::kCancelling) map.translation[i] = -sum;
  }
  return map;
}

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_SUPPORT_RANDOM_SHAPES_H_

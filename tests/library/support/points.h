// Points whose sums of coordinates are hard to round.
#ifndef HALFSPACE_TESTS_LIBRARY_SUPPORT_POINTS_H_
#define HALFSPACE_TESTS_LIBRARY_SUPPORT_POINTS_H_

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <random>

#include "tests/library/support/inputs.h"

namespace halfspace::testing {

enum class PointKind {
  kUniform,
  kWideExponents,
  kSubnormal,
  kPowersOfTwo,
  kCancelling,
  kTies,  // sums on or right beside the middle between two floats or doubles
};

inline constexpr std::array kPointKinds = {
    PointKind::kUniform,     PointKind::kWideExponents, PointKind::kSubnormal,
    PointKind::kPowersOfTwo, PointKind::kCancelling,    PointKind::kTies};

inline const char* NameOf(PointKind kind) {
  constexpr std::array kNames = {"uniform",       "wide exponents", "subnormal",
                                 "powers of two", "cancelling",     "ties"};
  return kNames[static_cast<std::size_t>(kind)];
}

inline float RandomSign(Random& random) {
  return OneIn(2, random) ? -1.f : 1.f;
}

inline int RandomExponent(int least, int most, Random& random) {
  return std::uniform_int_distribution(least, most)(random);
}

// In [1, 2), all bits random.
inline float RandomMantissa(Random& random) {
  return std::bit_cast<float>(0x3f800000u |
                              static_cast<std::uint32_t>(random() >> 41));
}

// All magnitudes stay below 2^122, so that no sum leaves what can be bounded.
template <std::size_t kDims>
std::array<float, kDims> RandomPoint(PointKind kind, Random& random) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  std::array<float, kDims> point;
  for (std::size_t k = 0; k < kDims; ++k) {
    const float sign = RandomSign(random);
    switch (kind) {
      case PointKind::kUniform:
        point[k] = std::uniform_real_distribution(-100.f, 100.f)(random);
        break;
      case PointKind::kWideExponents:
        point[k] = sign * std::ldexp(RandomMantissa(random),
                                     RandomExponent(-149, 120, random));
        break;
      case PointKind::kSubnormal:
        point[k] = sign * std::bit_cast<float>(
                              static_cast<std::uint32_t>(random() >> 41));
        break;
      case PointKind::kPowersOfTwo:
        point[k] = std::ldexp(sign, RandomExponent(-70, 20, random));
        break;
      case PointKind::kCancelling:
        // Each coordinate undoes the one before it, but for a few ulps.
        if (k % 2 == 0) {
          point[k] = sign * std::ldexp(RandomMantissa(random),
                                       RandomExponent(-60, 60, random));
        } else {
          point[k] = -point[k - 1];
          for (std::uint64_t n = random() % 3; n > 0; --n) {
            point[k] = std::nextafter(point[k], sign * kInfinity);
          }
        }
        break;
      case PointKind::kTies: {
        constexpr int kExponents[] = {0, 1, -23, -24, -25, -52, -53, -54, -149};
        point[k] = std::ldexp(sign, kExponents[random() % 9]);
        if (OneIn(4, random)) {
          point[k] = std::nextafter(point[k], RandomSign(random) * kInfinity);
        }
        break;
      }
    }
  }
  return point;
}

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_SUPPORT_POINTS_H_

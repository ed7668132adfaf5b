// A radius times the length of D's normal, sqrt(kDims), never too small.
//
// Only for translation units compiled without fast-math and contraction.
#ifndef HALFSPACE_KERNELS_FIT_MANY_ROOT_OF_DIMS_H_
#define HALFSPACE_KERNELS_FIT_MANY_ROOT_OF_DIMS_H_

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

namespace halfspace::kernels {

// sqrt(kDims) in three ways, all at least that. sqrt(3) alone rounds *down*, in
// float as in double, and a radius times that would cut into the sphere.
struct RootOfDims {
  double above;  // the least double that is not too small
  // The nearest double, and what makes the sum not too small: off by less than
  // 2^-106.
  double nearest;
  double rest;
  // Twice 29 bits, which a float can be multiplied by exactly, and the rest:
  // off by less than 2^-110.
  double first;
  double second;
  double third;
};

template <int kDims>
inline constexpr RootOfDims kRootOfDims = {2.0, 2.0, 0.0, 2.0, 0.0, 0.0};
template <>
inline constexpr RootOfDims kRootOfDims<2> = {
    0x1.6a09e667f3bcdp+0, 0x1.6a09e667f3bcdp+0,  -0x1.bdd3413b26455p-54,
    0x1.6a09e66p+0,       0x1.fcef324000000p-30, 0x1.165f626cdd52bp-61};
template <>
inline constexpr RootOfDims kRootOfDims<3> = {
    0x1.bb67ae8584cabp+0, 0x1.bb67ae8584caap+0,  0x1.cec95d0b5c1e3p-54,
    0x1.bb67ae8p+0,       0x1.6132a9c000000p-30, 0x1.d92ba16b83c5dp-59};

inline constexpr std::size_t kRootParts = 3;

// Parts whose exact sum is at least radius * sqrt(kDims), and larger by less
// than 2^-104 of it (or 2^-900, where that is more). `radius` is finite and
// not negative; 0 gives 0.
template <int kDims>
std::array<double, kRootParts> TimesRootOfDims(double radius) {
  if (radius == 0.0) return {};
  // A smaller product would lose its error to underflow; the float that comes
  // out is the same.
  const double r = std::max(radius, 0x1p-900);
  const double product = r * kRootOfDims<kDims>.nearest;
  const double error = std::fma(r, kRootOfDims<kDims>.nearest, -product);
  const double rest = std::nextafter(r * kRootOfDims<kDims>.rest,
                                     std::numeric_limits<double>::infinity());
  return {product, error, kRootOfDims<kDims>.rest == 0.0 ? 0.0 : rest};
}

}  // namespace halfspace::kernels

#endif  // HALFSPACE_KERNELS_FIT_MANY_ROOT_OF_DIMS_H_

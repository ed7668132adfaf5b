// A radius times the length of D's normal, sqrt(kDims), never too small.
//
// Only for translation units compiled without fast-math and contraction.
#ifndef HALFSPACE_KERNELS_ROOT_OF_DIMS_H_
#define HALFSPACE_KERNELS_ROOT_OF_DIMS_H_

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

namespace halfspace::kernels {

// sqrt(kDims) as the double nearest to it plus the least double that makes the
// sum not too small: off by less than 2^-106. sqrt(3) alone rounds *down*, in
// float as in double, and a radius times that would cut into the ball.
struct RootOfDims {
  double nearest;
  double rest;
};

template <int kDims>
constexpr RootOfDims kRootOfDims = {2.0, 0.0};  // 4 dimensions: exact
template <>
inline constexpr RootOfDims kRootOfDims<2> = {0x1.6a09e667f3bcdp+0,
                                              -0x1.bdd3413b26455p-54};
template <>
inline constexpr RootOfDims kRootOfDims<3> = {0x1.bb67ae8584caap+0,
                                              0x1.cec95d0b5c1e3p-54};

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

#endif  // HALFSPACE_KERNELS_ROOT_OF_DIMS_H_

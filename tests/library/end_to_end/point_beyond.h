// Points on one side of another, exactly, as D sees it.
#ifndef HALFSPACE_TESTS_LIBRARY_END_TO_END_POINT_BEYOND_H_
#define HALFSPACE_TESTS_LIBRARY_END_TO_END_POINT_BEYOND_H_

#include <array>
#include <cstddef>
#include <random>

#include "tests/library/support/exact.h"
#include "tests/library/support/points.h"

namespace halfspace::testing {

// A point within `reach` of `from`, whose exact D is not below (sign 1) or not
// above (sign -1) that of `from`.
template <std::size_t kDims>
std::array<float, kDims> PointBeyond(const std::array<float, kDims>& from,
                                     int sign, float reach, Random& random) {
  std::uniform_real_distribution<float> offset(-reach, reach);
  std::array<float, kDims> point;
  do {
    for (std::size_t k = 0; k < kDims; ++k) {
      point[k] = from[k] + offset(random);
    }
  } while (cmp(ExactSumOf(from), ExactSumOf(point)) * sign < 0);
  return point;
}

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_END_TO_END_POINT_BEYOND_H_

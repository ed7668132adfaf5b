// How far the bound of one of many shapes may differ from that of the single
// builder.
#ifndef HALFSPACE_TESTS_LIBRARY_FIT_MANY_BOUND_OF_ONE_H_
#define HALFSPACE_TESTS_LIBRARY_FIT_MANY_BOUND_OF_ONE_H_

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "tests/library/fit/exact_shapes.h"
#include "tests/library/fit_many/bulk.h"

namespace halfspace::testing {

// A bound is that of the single builder. But D is within an ulp of it, if the
// tightest is not asked for, and spheres of floats round D in another way.
inline ::testing::AssertionResult IsBoundOfOne(
    const Bulk& bulk, const Planes& bound, const Planes& single,
    const std::vector<double>& numbers, bool is_tightest) {
  const std::size_t d = bulk.dims;
  const bool is_sphere = bulk.kind == Kind::kSphere;
  const bool is_same = bulk.is_double || (is_tightest && !is_sphere) ||
                       single == bulk.single().Everything() ||
                       single == bulk.single().Empty();
  for (std::size_t p = 0; p < bulk.planes(); ++p) {
    if (bound[p] == single[p]) continue;
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    const float looser =
        std::nextafter(single[p], p <= d ? -kInfinity : kInfinity);
    const bool is_d = p % (d + 1) == d;
    if (is_same || !is_d || (!is_sphere && bound[p] != looser)) {
      return ::testing::AssertionFailure()
             << "plane " << p << " is " << bound[p] << ", and of one shape "
             << single[p];
    }
  }
  if (is_same || !is_sphere) return ::testing::AssertionSuccess();
  double slack = numbers.back() * 0x1p-100;
  if (!is_tightest) {
    slack = numbers.back();
    for (std::size_t k = 0; k < d; ++k) slack += std::fabs(numbers[k]);
    slack *= 0x1p-49;
  }
  Shape shape;
  for (std::size_t i = 0; i < numbers.size(); ++i) shape.Set(i, numbers[i]);
  return HullOf(bulk.single(), shape)
      .IsEnclosedBy(bound.data(), {.d = is_tightest ? 0 : 1, .d_slack = slack});
}

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_FIT_MANY_BOUND_OF_ONE_H_

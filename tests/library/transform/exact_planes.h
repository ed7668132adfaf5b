// The planes of a bound as exact numbers, to be changed exactly, and the bounds
// of bounds compared with them.
#ifndef HALFSPACE_TESTS_LIBRARY_TRANSFORM_EXACT_PLANES_H_
#define HALFSPACE_TESTS_LIBRARY_TRANSFORM_EXACT_PLANES_H_

#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <optional>

#include "halfspace/bounds.h"
#include "tests/library/support/exact.h"
#include "tests/library/support/exact_hull.h"
#include "tests/library/support/random_shapes.h"

namespace halfspace::testing {

// Nothing stands for a plane without a bound.
template <int kDims>
struct ExactPlanes {
  static constexpr std::size_t kAxes = kDims + 1;
  using Planes = std::array<std::optional<ExactValue>, kAxes>;

  Planes min;
  Planes max;

  explicit ExactPlanes(const Aabo<kDims>& bound) {
    constexpr float kUnbounded = detail::kMax<float>;
    for (std::size_t k = 0; k < kAxes; ++k) {
      if (bound.min[k] != -kUnbounded) min[k] = Exact(bound.min[k]);
      if (bound.max[k] != kUnbounded) max[k] = Exact(bound.max[k]);
    }
  }

  // change(value, axis, sign): the sign is -1 for minima and 1 for maxima.
  template <typename Change>
  void ForEach(Change change) {
    for (std::size_t k = 0; k < kAxes; ++k) {
      if (min[k]) change(*min[k], k, -1);
      if (max[k]) change(*max[k], k, 1);
    }
  }

  ::testing::AssertionResult AreTightIn(const Aabo<kDims>& bound,
                                        Looseness loose) const {
    for (std::size_t k = 0; k < kAxes; ++k) {
      const int floats = k == kDims ? loose.d : loose.coordinates;
      const double slack = k == kDims ? loose.d_slack : 0.0;
      auto result = min[k] ? IsBelow(bound.min[k], *min[k], floats, slack)
                           : IsUnbounded(-bound.min[k]);
      if (!result) return result << ": min[" << k << "]";
      result = max[k] ? IsAbove(bound.max[k], *max[k], floats, slack)
                      : IsUnbounded(bound.max[k]);
      if (!result) return result << ": max[" << k << "]";
    }
    return ::testing::AssertionSuccess();
  }

 private:
  static ::testing::AssertionResult IsUnbounded(float max) {
    if (max == detail::kMax<float>) return ::testing::AssertionSuccess();
    return ::testing::AssertionFailure() << max << " bounds the unbounded";
  }
};

// Any numbers in its planes, not those of a shape: bounds of bounds treat each
// plane on its own. Now and then one has no bound.
template <int kDims>
Aabo<kDims> RandomPlanes(PointKind kind, Random& random) {
  constexpr std::size_t kAxes = kDims + 1;
  Aabo<kDims> bound{RandomPoint<kAxes>(kind, random),
                    RandomPoint<kAxes>(kind, random)};
  for (float& min : bound.min) {
    if (OneIn(16, random)) min = -detail::kMax<float>;
  }
  for (float& max : bound.max) {
    if (OneIn(16, random)) max = detail::kMax<float>;
  }
  return bound;
}

// change(part) is the part of change(bound), for the three parts of an AABO.
template <int kDims, typename Change>
::testing::AssertionResult SameOfSimplices(const Aabo<kDims>& bound,
                                           Change change) {
  const Aabo<kDims> whole = change(bound);
  if (change(bound.up()) == whole.up() &&
      change(bound.down()) == whole.down()) {
    return ::testing::AssertionSuccess();
  }
  return ::testing::AssertionFailure() << "simplices differ";
}
template <int kDims, typename Change>
::testing::AssertionResult SameOfParts(const Aabo<kDims>& bound,
                                       Change change) {
  if (change(bound.aabb()) != change(bound).aabb()) {
    return ::testing::AssertionFailure() << "boxes differ";
  }
  return SameOfSimplices(bound, change);
}

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_TRANSFORM_EXACT_PLANES_H_

// The exact extremes of a shape on every axis, and bounds compared with them.
#ifndef HALFSPACE_TESTS_LIBRARY_SUPPORT_EXACT_HULL_H_
#define HALFSPACE_TESTS_LIBRARY_SUPPORT_EXACT_HULL_H_

#include <gmpxx.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>

#include "halfspace/bounds.h"
#include "tests/library/support/exact.h"

namespace halfspace::testing {

template <std::size_t kDims>
using ExactPoint = std::array<mpq_class, kDims>;

template <typename Scalar, std::size_t kDims>
ExactPoint<kDims> ExactPointOf(const std::array<Scalar, kDims>& point) {
  ExactPoint<kDims> exact;
  for (std::size_t k = 0; k < kDims; ++k) exact[k] = Exact(point[k]);
  return exact;
}

// How many floats a bound may be looser than the tightest, for D after it gave
// way by a slack.
struct Looseness {
  int coordinates = 0;
  int d = 0;
  double d_slack = 0.0;
};
inline constexpr Looseness kTightest{};
inline constexpr Looseness kWithinOneUlp{.coordinates = 1, .d = 1};
inline constexpr Looseness kAnyLooseness{.coordinates = kAnyFloats,
                                         .d = kAnyFloats};

// Of spheres: one float, but for the D that all but cancel.
inline Looseness RoundD(double radius) {
  return {.d = 1, .d_slack = std::max(radius * 0x1p-100, 0x1p-800)};
}

// The convex hull of what was added.
template <int kDims>
class ExactHull {
 public:
  using Coords = ExactPoint<kDims>;

  void AddPoint(const Coords& point) { AddSphere(point, 0); }

  void AddSphere(const Coords& center, const mpq_class& radius) {
    mpq_class d = 0;
    for (std::size_t k = 0; k < kDims; ++k) {
      Add(k, mpq_class(center[k] - radius), mpq_class(center[k] + radius));
      d -= center[k];
    }
    Add(kDims, {d, -radius, kDims}, {d, radius, kDims});
  }

  ::testing::AssertionResult IsEnclosedBy(const Aabo<kDims>& bound,
                                          Looseness loose) const {
    for (std::size_t k = 0; k < kAxes; ++k) {
      const int floats = k == kDims ? loose.d : loose.coordinates;
      const double slack = k == kDims ? loose.d_slack : 0.0;
      auto result = IsBelow(bound.min[k], *min_[k], floats, slack);
      if (!result) return result << ": min[" << k << "]";
      result = IsAbove(bound.max[k], *max_[k], floats, slack);
      if (!result) return result << ": max[" << k << "]";
    }
    return ::testing::AssertionSuccess();
  }

 private:
  static constexpr std::size_t kAxes = kDims + 1;

  void Add(std::size_t axis, const ExactValue& low, const ExactValue& high) {
    auto& min = min_[axis];
    auto& max = max_[axis];
    if (!min || Compare(low, *min) < 0) min = low;
    if (!max || Compare(high, *max) > 0) max = high;
  }

  std::array<std::optional<ExactValue>, kAxes> min_;
  std::array<std::optional<ExactValue>, kAxes> max_;
};

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_SUPPORT_EXACT_HULL_H_

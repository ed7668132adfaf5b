// What a shape is, exactly, and what a builder may therefore say about it.
#ifndef HALFSPACE_TESTS_FUZZ_EXACT_SHAPE_H_
#define HALFSPACE_TESTS_FUZZ_EXACT_SHAPE_H_

#include <gmpxx.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "halfspace/bounds.h"
#include "tests/fuzz/exact_real.h"

namespace halfspace::testing {

template <std::size_t kDims>
using ExactPoint = std::array<mpq_class, kDims>;

// The convex hull of the points and spheres that were added.
template <int kDims>
class ExactShape {
 public:
  static constexpr std::size_t kAxes = kDims + 1;
  using Point = ExactPoint<kDims>;

  // Shapes that the builder must refuse.
  void Refuse() { is_refused_ = true; }
  bool is_refused() const { return is_refused_; }

  // Shapes that cannot be bounded, and become everything.
  void BeEverything() { is_everything_ = true; }

  // False, and the shape is everything, if one of the numbers is not finite.
  template <typename Numbers>
  bool Accept(const Numbers& numbers) {
    const bool finite = std::all_of(numbers.begin(), numbers.end(),
                                    [](auto x) { return std::isfinite(x); });
    if (!finite) is_everything_ = true;
    return finite;
  }

  // A sum of magnitudes that decides whether the shape can be bounded.
  void Weigh(const mpq_class& magnitude) {
    weight_ = std::max(weight_, magnitude);
  }

  void AddPoint(const Point& point) { AddSphere(point, 0); }

  void AddSphere(const Point& center, const mpq_class& radius) {
    mpq_class d = 0;
    for (std::size_t k = 0; k < kDims; ++k) {
      values_[k].push_back({center[k] - radius});
      values_[k].push_back({center[k] + radius});
      d -= center[k];
    }
    // D's normal has the length sqrt(kDims).
    const mpq_class reach_squared = kDims * radius * radius;
    const int has_root = sgn(radius) == 0 ? 0 : 1;
    values_[kDims].push_back({d, reach_squared, -has_root});
    values_[kDims].push_back({d, reach_squared, has_root});
  }

  // Of X, Y, ..., and of D.
  void Tolerate(const Tolerance& coordinates, const Tolerance& d) {
    coordinates_ = coordinates;
    d_ = d;
  }

  ::testing::AssertionResult Check(const Aabo<kDims>& bound) const {
    if (is_refused_) {
      return ::testing::AssertionFailure() << "nothing was thrown";
    }
    // The builders may round the weight, so the line itself is blurred.
    const mpq_class most = mpq_class(0x1p125);
    const mpq_class blur = mpq_class(0x1p105);
    const bool is_everything = bound == Aabo<kDims>::Everything();
    if (is_everything_ || weight_ > most + blur) {
      if (is_everything) return ::testing::AssertionSuccess();
      return ::testing::AssertionFailure() << "not everything";
    }
    if (is_everything) {
      if (weight_ > most - blur) return ::testing::AssertionSuccess();
      return ::testing::AssertionFailure() << "everything";
    }
    if (values_[0].empty()) {
      if (bound == Aabo<kDims>::Empty()) return ::testing::AssertionSuccess();
      return ::testing::AssertionFailure() << "not empty";
    }
    return CheckPlanes(
        bound, [this](const auto& values, float minimum, std::size_t axis) {
          return IsMinimumOf(values, minimum, ToleranceOf(axis));
        });
  }

  // Without a look at how tight it is.
  ::testing::AssertionResult CheckEncloses(const Aabo<kDims>& bound) const {
    return CheckPlanes(bound,
                       [](const auto& values, float minimum, std::size_t) {
                         return IsBelowAll(values, minimum);
                       });
  }

  // Only a look at how tight it is.
  ::testing::AssertionResult CheckTight(const Aabo<kDims>& bound) const {
    return CheckPlanes(
        bound, [this](const auto& values, float minimum, std::size_t axis) {
          return IsTight(values, minimum, ToleranceOf(axis));
        });
  }

 private:
  const Tolerance& ToleranceOf(std::size_t axis) const {
    return axis < kDims ? coordinates_ : d_;
  }

  // check(values, minimum, axis) for all minima, and all mirrored maxima.
  template <typename CheckMinimum>
  ::testing::AssertionResult CheckPlanes(const Aabo<kDims>& bound,
                                         CheckMinimum check) const {
    for (std::size_t k = 0; k < kAxes; ++k) {
      auto result = check(values_[k], bound.min[k], k);
      if (!result) return result << ": min[" << k << "]";
      result = check(Mirrored(values_[k]), -bound.max[k], k);
      if (!result) return result << ", mirrored: max[" << k << "]";
    }
    return ::testing::AssertionSuccess();
  }

  bool is_refused_ = false;
  bool is_everything_ = false;
  mpq_class weight_ = 0;
  std::array<std::vector<ExactReal>, kAxes> values_;
  Tolerance coordinates_;
  Tolerance d_;
};

// The exact value of each of the numbers, which are finite.
template <std::size_t kDims, typename Numbers>
ExactPoint<kDims> ExactOf(const Numbers& numbers) {
  ExactPoint<kDims> exact;
  std::copy(numbers.begin(), numbers.end(), exact.begin());
  return exact;
}

template <typename ExactNumbers>
mpq_class SumOfMagnitudes(const ExactNumbers& numbers) {
  mpq_class sum = 0;
  for (const mpq_class& number : numbers) sum += abs(number);
  return sum;
}

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_FUZZ_EXACT_SHAPE_H_

// Inputs of TranslateVertices.
#ifndef HALFSPACE_TESTS_FUZZ_MOVED_VERTICES_H_
#define HALFSPACE_TESTS_FUZZ_MOVED_VERTICES_H_

#include <gmpxx.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <ostream>
#include <vector>

#include "halfspace/fit.h"
#include "tests/fuzz/any_bound.h"
#include "tests/fuzz/bytes.h"
#include "tests/fuzz/caller_mode.h"
#include "tests/fuzz/exact_real.h"
#include "tests/fuzz/print.h"

namespace halfspace::testing {

// Vertices that are moved, and rounded to float.
template <typename Bound>
class MovedVertices {
 public:
  static constexpr int kDims = Bound::kDimensions;

  explicit MovedVertices(Bytes& bytes)
      : mode_(bytes), vertices_(1 + bytes.Below(4)) {
    bytes.Fill(by_);
    for (auto& vertex : vertices_) bytes.Fill(vertex);
  }

  ::testing::AssertionResult Check() const {
    const Bound bound = BoundOf(vertices_);
    return CheckCall<Bound>(
        mode_, false,
        [&](FitStatus* status) {
          return TranslateVertices(bound, by_, status);
        },
        [&](const Bound& result) { return CheckResult(bound, result); });
  }

  friend std::ostream& operator<<(std::ostream& out,
                                  const MovedVertices& input) {
    out << "the vertices";
    for (const auto& vertex : input.vertices_) out << ' ' << Print(vertex);
    return out << " moved by " << Print(input.by_) << " in the mode "
               << input.mode_;
  }

 private:
  using Vertex = Point<kDims>;

  static Bound BoundOf(const std::vector<Vertex>& vertices) {
    const auto bound =
        BoundPoints<kDims>({vertices.front().data(), vertices.size()});
    if constexpr (Bound::kAxes == kDims) {
      return bound.aabb();
    } else {
      return bound;
    }
  }

  ::testing::AssertionResult CheckResult(const Bound& before,
                                         const Bound& result) const {
    const bool is_everything = result == Bound::Everything();
    const bool finite = std::all_of(by_.begin(), by_.end(),
                                    [](float x) { return std::isfinite(x); });
    if (!finite || before == Bound::Everything()) {
      if (is_everything) return ::testing::AssertionSuccess();
      return Wrong("Everything()");
    }
    std::vector<Vertex> moved = vertices_;
    for (auto& vertex : moved) {
      for (std::size_t k = 0; k < kDims; ++k) vertex[k] += by_[k];
    }
    if (is_everything) {
      if (IsLarge(by_) ||
          std::any_of(vertices_.begin(), vertices_.end(), IsLarge)) {
        return ::testing::AssertionSuccess();
      }
      return Wrong("a bound, not Everything()");
    }
    const Bound expected = BoundOf(moved);
    if (expected == Bound::Everything()) return ::testing::AssertionSuccess();
    for (std::size_t k = 0; k < Bound::kAxes; ++k) {
      if (k < kDims ? result.min[k] != expected.min[k]
                    : result.min[k] > expected.min[k]) {
        return Wrong("another minimum") << " on axis " << k;
      }
      if (k < kDims ? result.max[k] != expected.max[k]
                    : result.max[k] < expected.max[k]) {
        return Wrong("another maximum") << " on axis " << k;
      }
    }
    if constexpr (Bound::kAxes == kDims) {
      return ::testing::AssertionSuccess();
    } else {
      return CheckTightD(before, result);
    }
  }

  // D gives way by half an ulp of each coordinate, and no more.
  ::testing::AssertionResult CheckTightD(const Bound& before,
                                         const Bound& result) const {
    mpq_class moved = 0;
    mpq_class slack = 0;
    for (std::size_t k = 0; k < kDims; ++k) {
      moved -= mpq_class(by_[k]);
      slack += std::max(std::fabs(result.min[k]), std::fabs(result.max[k]));
    }
    slack *= mpq_class(0x1p-24);
    const ExactReal min = {mpq_class(before.min[kDims]) + moved - slack};
    const ExactReal max = {mpq_class(-before.max[kDims]) - moved - slack};
    auto tight = IsTight({&min, 1}, result.min[kDims], {});
    if (!tight) return tight << ": min of D";
    return IsTight({&max, 1}, -result.max[kDims], {}) << ", mirrored: max of D";
  }

  // Near to what cannot be bounded.
  static bool IsLarge(const Vertex& vertex) {
    return std::any_of(vertex.begin(), vertex.end(),
                       [](float x) { return std::fabs(x) > 0x1p120f; });
  }

  CallerMode mode_;
  std::vector<Vertex> vertices_;
  Vertex by_;
};

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_FUZZ_MOVED_VERTICES_H_

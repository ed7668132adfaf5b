// Inputs of the calls of transform.h that look at more than one plane at a
// time.
#ifndef HALFSPACE_TESTS_FUZZ_OTHER_TRANSFORMS_H_
#define HALFSPACE_TESTS_FUZZ_OTHER_TRANSFORMS_H_

#include <gmpxx.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <optional>
#include <ostream>
#include <vector>

#include "halfspace/transform.h"
#include "tests/fuzz/any_bound.h"
#include "tests/fuzz/bytes.h"
#include "tests/fuzz/caller_mode.h"
#include "tests/fuzz/exact_real.h"
#include "tests/fuzz/print.h"
#include "tests/library/support/cases.h"

namespace halfspace::testing {

template <typename Bound>
class MergeInput {
 public:
  explicit MergeInput(Bytes& bytes) : mode_(bytes), a_(bytes), b_(bytes) {}

  ::testing::AssertionResult Check() const {
    return CheckCall<Bound>(
        mode_, false,
        [&](FitStatus* status) {
          return Merge(a_.bound(), b_.bound(), status);
        },
        [&](const Bound& result) {
          if (result == Expected()) return ::testing::AssertionSuccess();
          return Wrong("the exact minima and maxima");
        });
  }

  friend std::ostream& operator<<(std::ostream& out, const MergeInput& input) {
    return out << "Merge of " << input.a_ << " and " << input.b_
               << " in the mode " << input.mode_;
  }

 private:
  Bound Expected() const {
    Bound merged = IsEmpty(a_.bound()) ? b_.bound() : a_.bound();
    const Bound& other = IsEmpty(b_.bound()) ? merged : b_.bound();
    if (IsEmpty(merged)) return Bound::Empty();
    if (!IsValid(merged) || !IsValid(other)) return Bound::Everything();
    for (std::size_t k = 0; k < Bound::kAxes; ++k) {
      if constexpr (HasMinima<Bound>) {
        merged.min[k] = std::min(merged.min[k], other.min[k]);
      }
      if constexpr (HasMaxima<Bound>) {
        merged.max[k] = std::max(merged.max[k], other.max[k]);
      }
    }
    return merged;
  }

  CallerMode mode_;
  AnyBound<Bound> a_;
  AnyBound<Bound> b_;
};

// The simplex around a simplex: each plane is minus the sum of the others.
template <typename Simplex, typename Opposing>
class CircumscribeInput {
 public:
  explicit CircumscribeInput(Bytes& bytes) : mode_(bytes), given_(bytes) {}

  ::testing::AssertionResult Check() const {
    return CheckCall<Opposing>(
        mode_, IsRefused(),
        [&](FitStatus* status) { return Circumscribe(given_.bound(), status); },
        [&](const Opposing& result) { return CheckResult(result); });
  }

  friend std::ostream& operator<<(std::ostream& out,
                                  const CircumscribeInput& input) {
    return out << "Circumscribe " << input.given_ << " in the mode "
               << input.mode_;
  }

 private:
  // The given planes but for one, or for none; nothing if one has no bound.
  std::optional<mpq_class> SumWithout(std::size_t left_out) const {
    mpq_class sum = 0;
    const bool all =
        AllMinima(given_.bound(), [&](float minimum, std::size_t axis, int) {
          if (axis == left_out) return true;
          sum += mpq_class(minimum);
          return minimum != kUnbounded;
        });
    if (!all) return std::nullopt;
    return sum;
  }

  bool IsRefused() const {
    if (!IsValid(given_.bound())) return false;
    const auto sum = SumWithout(Simplex::kAxes);
    return sum && *sum > 0;
  }

  ::testing::AssertionResult CheckResult(const Opposing& result) const {
    if (IsEmpty(given_.bound())) {
      if (result == Opposing::Empty()) return ::testing::AssertionSuccess();
      return Wrong("Empty()");
    }
    const bool is_everything = result == Opposing::Everything();
    if (!IsValid(given_.bound())) {
      if (is_everything) return ::testing::AssertionSuccess();
      return Wrong("Everything()");
    }
    auto wrong = ::testing::AssertionSuccess();
    bool may_be_everything = false;
    bool is_unbounded = true;
    AllMinima(result, [&](float minimum, std::size_t axis, int sign) {
      const auto sum = SumWithout(axis);
      if (!sum) {
        if (minimum != kUnbounded) wrong = Wrong("a plane without a bound");
        return static_cast<bool>(wrong);
      }
      is_unbounded = false;
      const std::vector<ExactReal> exact = {{*sum}};
      may_be_everything |= MayOverflow(exact);
      if (is_everything) return true;
      wrong = IsMinimumOf(exact, minimum, {})
              << ": axis " << axis << ", sign " << sign;
      return static_cast<bool>(wrong);
    });
    if (is_everything && !may_be_everything && !is_unbounded) {
      return Wrong("a bound, not Everything()");
    }
    return wrong;
  }

  CallerMode mode_;
  AnyBound<Simplex> given_;
};

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_FUZZ_OTHER_TRANSFORMS_H_

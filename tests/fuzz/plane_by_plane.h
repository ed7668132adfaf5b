// Inputs of the operations in transform_ops.h.
#ifndef HALFSPACE_TESTS_FUZZ_PLANE_BY_PLANE_H_
#define HALFSPACE_TESTS_FUZZ_PLANE_BY_PLANE_H_

#include <gtest/gtest.h>

#include <cstddef>
#include <ostream>

#include "halfspace/transform.h"
#include "tests/fuzz/any_bound.h"
#include "tests/fuzz/bytes.h"
#include "tests/fuzz/caller_mode.h"
#include "tests/fuzz/exact_real.h"
#include "tests/fuzz/transform_ops.h"

namespace halfspace::testing {

template <template <typename> class Op, typename Bound>
class PlaneByPlane {
 public:
  explicit PlaneByPlane(Bytes& bytes)
      : mode_(bytes), op_(bytes), given_(bytes) {}

  ::testing::AssertionResult Check() const {
    return CheckCall<Bound>(
        mode_, op_.IsRefused(),
        [&](FitStatus* status) { return op_.Call(given_.bound(), status); },
        [&](const Bound& result) { return CheckResult(result); });
  }

  friend std::ostream& operator<<(std::ostream& out,
                                  const PlaneByPlane& input) {
    return out << input.op_ << " of " << input.given_ << " in the mode "
               << input.mode_;
  }

 private:
  ::testing::AssertionResult CheckResult(const Bound& result) const {
    if (IsValid(result) || result == Bound::Empty()) {
      return CheckValues(result);
    }
    return Wrong("no plane beyond what can be bounded");
  }

  ::testing::AssertionResult CheckValues(const Bound& result) const {
    if (IsEmpty(given_.bound()) && op_.IsFinite()) {
      if (result == Bound::Empty()) return ::testing::AssertionSuccess();
      return Wrong("Empty()");
    }
    const bool is_everything = result == Bound::Everything();
    if (!IsValid(given_.bound()) || !op_.IsFinite()) {
      const bool may_be_empty = IsEmpty(given_.bound());
      if (is_everything || may_be_empty) return ::testing::AssertionSuccess();
      return Wrong("Everything()");
    }
    bool may_be_everything = false;
    auto wrong = ::testing::AssertionSuccess();
    const auto check = [&](float minimum, std::size_t axis, int sign) {
      const float after = MinimumOf(result, axis, sign);
      if (minimum == kUnbounded) {
        if (after == kUnbounded) return true;
        wrong = Wrong("a plane that stays without a bound");
        return false;
      }
      const auto exact = op_.Exact(minimum, axis, sign);
      if (MayOverflow(exact)) {
        may_be_everything = true;
        if (after == kUnbounded) return true;
      }
      if (is_everything) return true;
      wrong = IsMinimumOf(exact, after, op_.ToleranceOf(axis))
              << ": axis " << axis << ", sign " << sign;
      return static_cast<bool>(wrong);
    };
    if (!AllMinima(op_.Before(given_.bound()), check)) return wrong;
    if (is_everything && !may_be_everything &&
        given_.bound() != Bound::Everything()) {
      return Wrong("a bound, not Everything()");
    }
    return ::testing::AssertionSuccess();
  }

  CallerMode mode_;
  Op<Bound> op_;
  AnyBound<Bound> given_;
};

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_FUZZ_PLANE_BY_PLANE_H_

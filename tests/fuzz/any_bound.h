// Bounds of any kind, with any values in their planes.
#ifndef HALFSPACE_TESTS_FUZZ_ANY_BOUND_H_
#define HALFSPACE_TESTS_FUZZ_ANY_BOUND_H_

#include <gmpxx.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <cstddef>
#include <ostream>
#include <span>
#include <stdexcept>

#include "halfspace/bounds.h"
#include "halfspace/fit_status.h"
#include "tests/fuzz/bytes.h"
#include "tests/fuzz/caller_mode.h"
#include "tests/fuzz/exact_real.h"
#include "tests/fuzz/print.h"
#include "tests/library/support/cases.h"

namespace halfspace::testing {

inline constexpr float kUnbounded = -FLT_MAX;  // as a minimum

template <typename Bound>
class AnyBound {
 public:
  explicit AnyBound(Bytes& bytes) {
    const std::size_t kind = bytes.Below(8);
    bound_ = kind == 0 ? Bound::Empty() : Bound::Everything();
    if (kind <= 1) return;
    if (kind == 2) {
      // As engines initialise boxes.
      if constexpr (HasMinima<Bound>) bound_.min.fill(FLT_MAX);
      if constexpr (HasMaxima<Bound>) bound_.max.fill(-FLT_MAX);
      return;
    }
    if constexpr (HasMinima<Bound>) bytes.Fill(bound_.min);
    if constexpr (HasMaxima<Bound>) bytes.Fill(bound_.max);
  }

  const Bound& bound() const { return bound_; }

  friend std::ostream& operator<<(std::ostream& out, const AnyBound& any) {
    out << Bound::kDimensions << 'D';
    if constexpr (HasMinima<Bound>) out << " min " << Print(any.bound_.min);
    if constexpr (HasMaxima<Bound>) out << " max " << Print(any.bound_.max);
    return out;
  }

 private:
  Bound bound_;
};

// Calls visit(bound's minimum, axis, sign) for every minimum, and for every
// mirrored maximum with sign -1, until one returns false.
template <typename Bound, typename Visit>
bool AllMinima(const Bound& bound, Visit visit) {
  for (std::size_t k = 0; k < Bound::kAxes; ++k) {
    if constexpr (HasMinima<Bound>) {
      if (!visit(bound.min[k], k, 1)) return false;
    }
    if constexpr (HasMaxima<Bound>) {
      if (!visit(-bound.max[k], k, -1)) return false;
    }
  }
  return true;
}

template <typename Bound>
float MinimumOf(const Bound& bound, std::size_t axis, int sign) {
  if constexpr (HasMinima<Bound>) {
    if (sign > 0) return bound.min[axis];
  }
  if constexpr (HasMaxima<Bound>) {
    if (sign < 0) return -bound.max[axis];
  }
  return 0.f;
}

inline bool IsValidMinimum(float minimum) {
  return minimum == kUnbounded || std::fabs(minimum) <= 0x1p126f;
}

template <typename Bound>
bool IsValid(const Bound& bound) {
  return AllMinima(bound, [](float minimum, std::size_t, int) {
    return IsValidMinimum(minimum);
  });
}

// Whether one of the values lies near 2^126 or beyond.
inline bool MayOverflow(std::span<const ExactReal> values) {
  const mpq_class most(0x1.fp125);
  return std::any_of(values.begin(), values.end(), [&](const auto& value) {
    return Compare(most, value) < 0 || Compare(-most, value) > 0;
  });
}

inline ::testing::AssertionResult Wrong(const char* expected) {
  return ::testing::AssertionFailure() << "expected " << expected;
}

// One call: build(status) in the given mode. Succeeds with check(result), or if
// the call refuses what it must.
template <typename Result, typename Build, typename Check>
::testing::AssertionResult CheckCall(const CallerMode& mode, bool is_refused,
                                     Build build, Check check) {
  FitStatus status;
  Result result;
  try {
    mode.Run([&] { result = build(&status); });
  } catch (const std::invalid_argument& error) {
    if (is_refused) return ::testing::AssertionSuccess();
    return ::testing::AssertionFailure() << "refused: " << error.what();
  }
  if (is_refused) {
    return ::testing::AssertionFailure() << "nothing was thrown";
  }
  const bool is_everything = result == Result::Everything();
  if (status.results != 1 || status.first_everything != 0 ||
      status.everything != (is_everything ? 1 : 0)) {
    return ::testing::AssertionFailure() << "a wrong status";
  }
  return check(result);
}

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_FUZZ_ANY_BOUND_H_

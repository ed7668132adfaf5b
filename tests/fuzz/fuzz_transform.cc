// Bounds of bounds, against exact arithmetic.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <ostream>

#include "halfspace/transform.h"
#include "tests/fuzz/any_bound.h"
#include "tests/fuzz/bytes.h"
#include "tests/fuzz/caller_mode.h"
#include "tests/fuzz/exact_real.h"
#include "tests/fuzz/run_input.h"
#include "tests/fuzz/transform_ops.h"

namespace halfspace::testing {
namespace {

::testing::AssertionResult Wrong(const char* expected) {
  return ::testing::AssertionFailure() << "expected " << expected;
}

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
    if (given_.bound() == Bound::Empty() && op_.IsFinite()) {
      if (result == Bound::Empty()) return ::testing::AssertionSuccess();
      return Wrong("Empty()");
    }
    const bool is_everything = result == Bound::Everything();
    if (!IsValid(given_.bound()) || !op_.IsFinite()) {
      const bool may_be_empty = given_.bound() == Bound::Empty();
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

  // Whether one of the values lies near 2^126 or beyond.
  static bool MayOverflow(const std::vector<ExactReal>& values) {
    const mpq_class most(0x1.fp125);
    return std::any_of(values.begin(), values.end(), [&](const auto& value) {
      return Compare(most, value) < 0 || Compare(-most, value) > 0;
    });
  }

  CallerMode mode_;
  Op<Bound> op_;
  AnyBound<Bound> given_;
};

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
    Bound merged = a_.bound() == Bound::Empty() ? b_.bound() : a_.bound();
    const Bound& other = b_.bound() == Bound::Empty() ? merged : b_.bound();
    if (merged == Bound::Empty()) return merged;
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

template <typename... Lists>
struct Joined;
template <typename... Inputs>
struct Joined<::testing::Types<Inputs...>> {
  using type = ::testing::Types<Inputs...>;
};
template <typename... As, typename... Bs, typename... Lists>
struct Joined<::testing::Types<As...>, ::testing::Types<Bs...>, Lists...>
    : Joined<::testing::Types<As..., Bs...>, Lists...> {};

template <typename Bound>
using InputsOf = ::testing::Types<
    MergeInput<Bound>, PlaneByPlane<InflateOp, Bound>,
    PlaneByPlane<InflateByBoxOp, Bound>, PlaneByPlane<TranslateOp, Bound>,
    PlaneByPlane<SweepOp, Bound>, PlaneByPlane<ScaleOp, Bound>>;

template <int kDims>
using Inputs =
    typename Joined<InputsOf<UpSimplex<kDims>>, InputsOf<DownSimplex<kDims>>,
                    InputsOf<Aabb<kDims>>, InputsOf<Aabo<kDims>>>::type;

}  // namespace
}  // namespace halfspace::testing

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data,
                                      std::size_t size) {
  using namespace halfspace::testing;
  Bytes bytes(data, size);
  RunOneOfAllDims<Inputs>(bytes);
  return 0;
}

// An input that is one shape, for a builder of fit.h.
//
// A Shape is made from Bytes, can be printed, and has
//   kDims
//   void Describe(ExactShape<kDims>& exact) const;
//   Aabo<kDims> Build(FitStatus* status) const;
#ifndef HALFSPACE_TESTS_FUZZ_FIT_INPUT_H_
#define HALFSPACE_TESTS_FUZZ_FIT_INPUT_H_

#include <gtest/gtest.h>

#include <ostream>
#include <stdexcept>

#include "halfspace/fit.h"
#include "tests/fuzz/bytes.h"
#include "tests/fuzz/caller_mode.h"
#include "tests/fuzz/exact_shape.h"
#include "tests/fuzz/print.h"

namespace halfspace::testing {

template <typename Shape>
class FitInput {
 public:
  explicit FitInput(Bytes& bytes) : mode_(bytes), shape_(bytes) {}

  ::testing::AssertionResult Check() const {
    ExactShape<Shape::kDims> exact;
    shape_.Describe(exact);
    FitStatus status;
    Aabo<Shape::kDims> bound;
    try {
      mode_.Run([&] { bound = shape_.Build(&status); });
    } catch (const std::invalid_argument& error) {
      if (exact.is_refused()) return ::testing::AssertionSuccess();
      return ::testing::AssertionFailure() << "refused: " << error.what();
    }
    const bool is_everything = bound == Aabo<Shape::kDims>::Everything();
    if (status.results != 1 || status.first_everything != 0 ||
        status.everything != (is_everything ? 1 : 0)) {
      return ::testing::AssertionFailure() << "a wrong status";
    }
    return exact.Check(bound) << "\nthe bound: min " << Print(bound.min)
                              << ", max " << Print(bound.max);
  }

  friend std::ostream& operator<<(std::ostream& out, const FitInput& input) {
    return out << input.shape_ << "\nin the mode " << input.mode_;
  }

 private:
  CallerMode mode_;
  Shape shape_;
};

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_FUZZ_FIT_INPUT_H_

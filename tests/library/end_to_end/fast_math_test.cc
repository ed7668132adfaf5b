// The bounds of a caller that is compiled with -ffast-math. Samples are made,
// and judged, by code that is not.
#include <gtest/gtest.h>

#include <cstddef>

#include "tests/library/fit/builders.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/seeded_numbers.h"

#if defined(__FAST_MATH__)
#error "compile this file without -ffast-math"
#endif

namespace halfspace::testing {
namespace {

// The bounds that a usual caller gets are held against exact arithmetic
// elsewhere. Some shapes have NaN.
TEST(FastMathCallerTest, EveryBuilderGivesTheUsualBits) {
  SeededNumbers numbers(90);
  for (const Builder& builder : BuildersAndChanges()) {
    for (std::size_t i = 0; i < Scaled(200); ++i) {
      const Shape shape = SeededShape(builder, numbers);
      ASSERT_TRUE(SameBits(fast_math::Build(builder, shape, nullptr),
                           builder.Build(shape)))
          << builder << ", sample " << i;
    }
  }
}

}  // namespace
}  // namespace halfspace::testing

// The bounds of a caller that is compiled with -ffast-math. Samples are made,
// and judged, by code that is not.
#include <gtest/gtest.h>

#include <cstddef>

#include "tests/library/fit/builders.h"
#include "tests/library/fit/random_shapes.h"

#if defined(__FAST_MATH__)
#error "compile this file without -ffast-math"
#endif

namespace halfspace::testing {
namespace {

// The bounds that a usual caller gets are held against exact arithmetic
// elsewhere.
TEST(FastMathCallerTest, EveryBuilderGivesTheUsualBits) {
  Random random(90);
  for (const Builder& builder : BuildersAndChanges()) {
    for (PointKind kind : kPointKinds) {
      for (std::size_t i = 0; i < Scaled(30); ++i) {
        const Shape shape = RandomShape(builder, kind, random);
        ASSERT_TRUE(SameBits(fast_math::Build(builder, shape, nullptr),
                             builder.Build(shape)))
            << builder << ", " << NameOf(kind) << ", sample " << i;
      }
    }
  }
}

}  // namespace
}  // namespace halfspace::testing

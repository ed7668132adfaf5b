// A caller compiled with -ffast-math gets the same answers: what must not be
// optimised so is compiled in the library. Alone in its executable, since
// inline functions of such a translation unit may replace those of others.
#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <vector>

#include "halfspace/halfspace.h"
#include "tests/library/support/environment.h"

// The calls of builders, which fast_math_test.cc makes.
#define HALFSPACE_COMPILED_AS fast_math
#include "tests/library/fit/build.cc"  // NOLINT(bugprone-suspicious-include)

#if !defined(__FAST_MATH__)
#error "compile this file with -ffast-math"
#endif

namespace halfspace::testing {
namespace {

// From its bits at run time, so that the compiler cannot reason about it.
float NotANumber() {
  volatile std::uint32_t bits = 0x7fc00000u;
  return std::bit_cast<float>(static_cast<std::uint32_t>(bits));
}

template <typename World, typename Query>
void ExpectAllKept(const World& world, const Query& query) {
  for (Target target : TargetsUnderTest()) {
    EXPECT_EQ(CountSurvivors(world, query, {.target = target}), world.size())
        << target.name();
  }
}

TEST(FastMathCallerTest, NanIsKept) {
  const float nan = NotANumber();
  const Aabo3 unknown{{nan, nan, nan, nan}, {nan, nan, nan, nan}};
  const Aabo3 unit{{0, 0, 0, -3}, {1, 1, 1, 0}};
  const AaboWorld3 unknowns(std::vector<Aabo3>(100, unknown));
  ExpectAllKept(unknowns, unit);
  ExpectAllKept(unknowns, unknown);
  ExpectAllKept(AaboWorld3(std::vector<Aabo3>(100, unit)), unknown);
}

}  // namespace
}  // namespace halfspace::testing

// The caller's floating-point mode changes no bound and no error, and is left
// as it was.
#include <gtest/gtest.h>

#include <bit>
#include <cstddef>
#include <cstdint>
#include <stdexcept>

#include "halfspace/halfspace.h"
#include "tests/library/fit/builders.h"
#include "tests/library/fit/random_shapes.h"
#include "tests/library/support/expect_invalid.h"
#include "tests/library/support/fp_modes.h"

namespace halfspace::testing {
namespace {

class FitModesTest : public ::testing::TestWithParam<Builder> {};

TEST_P(FitModesTest, NoBoundChanges) {
  const Builder& builder = GetParam();
  Random random(9);
  for (PointKind kind : kPointKinds) {
    for (std::size_t i = 0; i < Scaled(30); ++i) {
      const Shape shape = RandomShape(builder, kind, random);
      const Planes expected = builder.Build(shape);
      for (FpMode mode : kFpModes) {
        Planes given;
        RunIn(mode, [&] { given = builder.Build(shape); });
        ASSERT_TRUE(SameBits(given, expected))
            << NameOf(kind) << ", " << i << ", mode " << static_cast<int>(mode);
      }
    }
  }
}

// With such values in every number, where the builder refuses them too. As
// bits, because to convert a signalling NaN is an exception itself.
TEST_P(FitModesTest, NothingIsTrappedWhateverTheValues) {
  struct Special {
    std::uint32_t narrow;
    std::uint64_t wide;
  };
  for (const auto& [narrow, wide] :
       {Special{0x7fc00000, 0x7ff8'0000'0000'0000},     // NaN
        Special{0xff800001, 0x7ff0'0000'0000'0001},     // a signalling one
        Special{0x7f800000, 0x7ff0'0000'0000'0000},     // infinity
        Special{0x7f7fffff, 0x7fef'ffff'ffff'ffff},     // the largest
        Special{0xff7fffff, 0xffef'ffff'ffff'ffff},     // the smallest
        Special{0x00000001, 0x0000'0000'0000'0001}}) {  // a subnormal
    SCOPED_TRACE(narrow);
    Shape shape;
    shape.floats.fill(std::bit_cast<float>(narrow));
    shape.doubles.fill(std::bit_cast<double>(wide));
    RunIn(FpMode::kTraps, [&] {
      try {
        GetParam().Build(shape);
      } catch (const std::invalid_argument&) {
      }
    });
  }
}

// The least number below zero is below zero, and one above another is so even
// where compares take both for zero. A throw leaves the mode as it was, too.
TEST_P(FitModesTest, SubnormalMistakesAreRefused) {
  const Builder& builder = GetParam();
  for (std::size_t i = 0; i < builder.roles.size(); ++i) {
    const Role role = builder.roles[i];
    const bool is_box = role == Role::kMinimum && builder.kind != Kind::kChange;
    const bool is_simplex = builder.part >= Part::kUp;
    if (role != Role::kLength && !is_box &&
        !(role == Role::kFactor && is_simplex) &&
        !(builder.change == Change::kCircumscribe)) {
      continue;
    }
    Shape shape;
    const double least = builder.IsDouble(i) ? 0x1p-1074 : 0x1p-149;
    shape.Set(i, is_box || role == Role::kMinimum ? least : -least);
    auto refused = ::testing::AssertionSuccess();
    RunIn(FpMode::kFlushes, [&] {
      refused = Refuses([&] { builder.Build(shape); }, {"expected"});
    });
    EXPECT_TRUE(refused) << i;
  }
}

INSTANTIATE_TEST_SUITE_P(, FitModesTest,
                         ::testing::ValuesIn(BuildersAndChanges()),
                         BuilderNames());

}  // namespace
}  // namespace halfspace::testing

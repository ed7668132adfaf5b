// The caller's floating-point mode changes no answer, and is left as it was.
#include "tests/library/support/fp_modes.h"

#include <gtest/gtest.h>

#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <utility>
#include <vector>

#include "halfspace/halfspace.h"
#include "halfspace/reject.h"
#include "tests/library/fit/builders.h"
#include "tests/library/fit/random_shapes.h"
#include "tests/library/fit_many/bulk.h"
#include "tests/library/fit_many/bulk_answers.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/expect_invalid.h"
#include "tests/library/support/quantized_rows.h"

namespace halfspace::testing {
namespace {

// The caller's floating-point mode changes no bound and no error, and is left
// as it was.

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

// The caller's floating-point mode changes no bound of many.

TEST(FitManyModesTest, NoBoundChanges) {
  constexpr std::size_t kShapes = 70;  // a tile and a tail
  for (const Bulk& bulk : Bulks()) {
    SCOPED_TRACE(bulk.name);
    Random random(9);
    for (PointKind kind : kPointKinds) {
      const BulkShapes shapes = RandomShapes(bulk, kind, kShapes, random);
      Arena arena;
      BulkSource source(bulk, shapes);
      source.Place(arena, BulkLayout::kPacked);
      for (bool is_tightest : {false, true}) {
        BulkAnswers answers(bulk, shapes, {.tightest = is_tightest});
        for (FpMode mode : kFpModes) {
          ASSERT_TRUE(answers.Check(source, arena, 0xFFFFFFFF, mode))
              << NameOf(kind) << ", mode " << static_cast<int>(mode);
        }
      }
    }
  }
}

// Quantized bounds made in one floating-point mode of the thread and tested in
// another: no pair is lost, and refined they answer as a call on floats in the
// mode of the call does.

class QuantizedFpModesTest : public ::testing::TestWithParam<QuantizedRow> {};

TEST_P(QuantizedFpModesTest, ModesDoNotMatter) {
  constexpr std::size_t kObjects = 300;
  constexpr std::pair<FpMode, FpMode> kMadeAndAsked[] = {
      {FpMode::kDefault, FpMode::kFlushes},
      {FpMode::kFlushes, FpMode::kDefault},
      {FpMode::kFlushes, FpMode::kFlushes},
      {FpMode::kUpward, FpMode::kDownward},
      {FpMode::kDownward, FpMode::kToZero},
      {FpMode::kToZero, FpMode::kUpward}};
  Random random(43);
  for (QuantizedInputKind kind :
       {QuantizedInputKind::kSubnormals, QuantizedInputKind::kAnyValues,
        QuantizedInputKind::kUniform}) {
    const auto values =
        MakeQuantizedValues(GetParam().layout, kind, kObjects, random);
    const auto usual = GetParam().make(values);
    for (const auto& [made, asked] : kMadeAndAsked) {
      std::unique_ptr<AnyQuantized> all;
      RunIn(made, [&] {
        all = GetParam().make(values);
        all->world();
      });
      const QuantizedQueries queries(GetParam(), values, Scaled(20), random);
      for (std::size_t q = 0; q < Scaled(20); ++q) {
        const AnyQueries query = queries.Some(q, 1);
        for (Target target : TargetsUnderTest()) {
          const auto mask_of = [&](const AnyWorld& world) {
            std::vector<std::uint64_t> mask(MaskWords(kObjects));
            detail::SurvivorMask(world.Asked(query), mask, {.target = target});
            return mask;
          };
          std::vector<std::uint64_t> floats;
          std::vector<std::uint64_t> quantized;
          std::vector<std::uint64_t> refined;
          std::vector<std::uint64_t> of_world;
          RunIn(asked, [&] {
            floats = mask_of(all->floats());
            quantized = mask_of(all->quantized());
            refined = mask_of(all->refined());
            of_world = mask_of(all->world());
          });
          ASSERT_EQ(refined, floats) << NameOf(kind) << ", " << target.name();
          ASSERT_EQ(of_world, floats) << NameOf(kind) << ", " << target.name();
          for (std::size_t w = 0; w < floats.size(); ++w) {
            ASSERT_EQ(floats[w] & ~quantized[w], 0u) << NameOf(kind);
          }
          // The map does not depend on modes at all.
          ASSERT_EQ(quantized, mask_of(usual->quantized()))
              << NameOf(kind) << ", " << target.name();
        }
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(, QuantizedFpModesTest,
                         ::testing::ValuesIn(QuantizedRows()),
                         QuantizedRowName);

}  // namespace
}  // namespace halfspace::testing

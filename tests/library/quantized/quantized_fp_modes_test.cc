// Quantized bounds made in one floating-point mode of the thread and tested in
// another: no pair is lost, and refined they answer as a call on floats in the
// mode of the call does.
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "halfspace/reject.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/fp_modes.h"
#include "tests/library/support/quantized_rows.h"

namespace halfspace::testing {
namespace {

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

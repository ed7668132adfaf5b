// Quantized bounds made in one floating-point mode of the thread and tested in
// another: no pair is lost, and refined they answer as a call on floats in the
// mode of the call does.
#include <gtest/gtest.h>

#include <cfenv>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "halfspace/quantized.h"
#include "halfspace/reject.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/fp_modes.h"
#include "tests/library/support/quantized_cases.h"

namespace halfspace::testing {
namespace {

template <typename Case>
class QuantizedFpModesTest : public ::testing::Test {
 protected:
  using FloatView = typename Case::View;
  using TheWorld = QuantizedWorld<FloatView, typename Case::Element>;
  using Mask = std::vector<std::uint64_t>;

  struct Masks {
    Mask floats;
    Mask quantized;
    Mask refined;
  };

  // Made and asked in the mode of the caller.
  TheWorld Make() const { return TheWorld(std::span(bounds_)); }
  Masks Ask(const TheWorld& world, const typename FloatView::Query& query,
            const Options& options) const {
    const std::size_t words = MaskWords(bounds_.size());
    Masks masks = {Mask(words), Mask(words), Mask(words)};
    SurvivorMask(floats_, query, masks.floats, options);
    SurvivorMask(world.quantized(), query, masks.quantized, options);
    SurvivorMask(world, query, masks.refined, options);
    return masks;
  }

  // make() and ask() return objects that set another mode while they exist.
  template <typename MakeMode, typename AskMode>
  void ExpectSame(MakeMode make_mode, AskMode ask_mode) {
    for (QuantizedInputKind kind :
         {QuantizedInputKind::kSubnormals, QuantizedInputKind::kAnyValues,
          QuantizedInputKind::kUniform}) {
      bounds_ = MakeQuantizedBounds<FloatView>(kind, 300, random_);
      floats_.Assign(bounds_);
      const TheWorld world = [&] {
        const auto mode = make_mode();
        return Make();
      }();
      const TheWorld usual = Make();
      for (std::size_t i = 0; i < Scaled(20); ++i) {
        const auto query = MakeQuantizedQuery<FloatView>(bounds_, random_);
        for (Target target : TargetsUnderTest()) {
          const Masks masks = [&] {
            const auto mode = ask_mode();
            return Ask(world, query, {.target = target});
          }();
          ASSERT_EQ(masks.refined, masks.floats)
              << NameOf(kind) << ", " << target.name();
          for (std::size_t w = 0; w < masks.floats.size(); ++w) {
            ASSERT_EQ(masks.floats[w] & ~masks.quantized[w], 0u)
                << NameOf(kind) << ", " << target.name();
          }
          // The map does not depend on modes at all.
          ASSERT_EQ(masks.quantized,
                    Ask(usual, query, {.target = target}).quantized)
              << NameOf(kind) << ", " << target.name();
        }
      }
    }
  }

 private:
  Random random_{43};
  std::vector<typename FloatView::Bound> bounds_;
  World<FloatView> floats_;
};

TYPED_TEST_SUITE(QuantizedFpModesTest, FewQuantizedCases, QuantizedCaseNames);

// As threads start.
RoundingMode UsualMode() { return RoundingMode(FE_TONEAREST); }

TYPED_TEST(QuantizedFpModesTest, SubnormalsMayBeFlushedWhenAsked) {
  this->ExpectSame(UsualMode, [] { return FlushDenormals(); });
}

TYPED_TEST(QuantizedFpModesTest, SubnormalsMayBeFlushedWhenMade) {
  this->ExpectSame([] { return FlushDenormals(); }, UsualMode);
}

TYPED_TEST(QuantizedFpModesTest, SubnormalsMayBeFlushedAlways) {
  this->ExpectSame([] { return FlushDenormals(); },
                   [] { return FlushDenormals(); });
}

TYPED_TEST(QuantizedFpModesTest, RoundingDoesNotMatter) {
  for (int mode : {FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO}) {
    SCOPED_TRACE(mode);
    this->ExpectSame([mode] { return RoundingMode(mode); }, UsualMode);
    this->ExpectSame(UsualMode, [mode] { return RoundingMode(mode); });
  }
}

}  // namespace
}  // namespace halfspace::testing

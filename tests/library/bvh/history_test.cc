// A BVH that changes answers as a list of its objects does, after any history.
#include "tests/library/bvh/history.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "tests/library/support/environment.h"

namespace halfspace::testing {
namespace {

class BvhChangesTest : public ::testing::TestWithParam<Layout> {};
INSTANTIATE_TEST_SUITE_P(Of, BvhChangesTest,
                         ::testing::ValuesIn(LayoutsOf(false)), LayoutName());

TEST_P(BvhChangesTest, AnyHistoryIsThatOfTheModel) {
  const std::vector<Target> targets = TargetsUnderTest();
  // Two dimensions are the same code.
  const std::size_t rounds =
      std::max<std::size_t>(4, GetParam().dims == 3 ? Scaled(12) : 0);
  for (std::size_t round = 0; round < rounds + 2; ++round) {
    Random random(round);
    Choices choices(GetParam(), random);
    // Few objects, whose pairs are all compared, and thousands.
    const bool is_large = round % 4 == 1;
    const std::size_t most = is_large ? 9000 : 400;
    // The last ones with too little memory at first, for each change.
    CountingMemory memory;
    const bool is_short = round >= rounds;
    BvhHistory history(GetParam(), choices,
                       round % 3 == 0 ? 0 : choices.Below(most),
                       is_large ? 3000 : 300,
                       is_short ? FpMode::kDefault : kFpModes[round % 6],
                       is_short ? &memory : nullptr);
    // Of a large one a list of the objects takes long to ask.
    const std::size_t changes = is_large ? 3 : 1;
    for (std::size_t step = 0; step < (10 + Scaled(30)) / changes; ++step) {
      std::size_t what = 0;
      for (std::size_t i = 0; i < changes; ++i) what = history.Change();
      constexpr std::uint32_t kMasks[] = {0xFFFFFFFF, 0xFFFFFFFF, 1, 6};
      history.ExpectIsModel({.targets = {targets[random() % targets.size()]},
                             .mask = kMasks[random() % 4],
                             .is_special = random() % 8 == 0,
                             .shapes = 2},
                            random);
      if (HasFailure()) {
        FAIL() << "round " << round << ", step " << step << ", " << what;
      }
    }
  }
}

}  // namespace
}  // namespace halfspace::testing

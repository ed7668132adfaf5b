// A broad phase answers as a Bvh of its bodies does, after any history.
#include "tests/library/broad_phase/history.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "tests/library/support/environment.h"

namespace halfspace::testing {
namespace {

class BroadPhaseHistoryTest : public ::testing::TestWithParam<Layout> {};
INSTANTIATE_TEST_SUITE_P(Of, BroadPhaseHistoryTest,
                         ::testing::ValuesIn(LayoutsOf(true)), LayoutName());

TEST_P(BroadPhaseHistoryTest, AnyHistoryIsThatOfTheModel) {
  const std::size_t rounds = std::max<std::size_t>(8, Scaled(12));
  for (std::size_t round = 0; round < rounds + 6; ++round) {
    constexpr FpMode kModes[] = {FpMode::kDefault, FpMode::kDefault,
                                 FpMode::kTraps, FpMode::kFlushes};
    const FpMode mode = kModes[round / 2 % 4];
    Random random(round);
    Choices choices(GetParam(), random, mode != FpMode::kDefault);
    // One with three levels of nodes: 63 % of so many bodies are more than
    // 64^2. It takes nine tenths of the time, so it is short at a small scale.
    const bool is_large = round == 1;
    // The last ones with too little memory at first, for each change.
    const bool is_short = round >= rounds;
    const std::size_t most_bodies = is_large                     ? 7000
                                    : round % 3 == 0 || is_short ? 200
                                                                 : 1500;
    constexpr std::uint32_t kStrides[] = {1, 3, 700, 64, 5000};
    BroadPhaseOptions options;
    options.moves_wait_for_update = round % 2 != 0;
    options.caller_locks = round % 4 > 1;
    if (round % 3 == 0) options.filter.keep = &KeepsSome;
    CountingMemory memory;
    if (is_short) options.memory = memory.resource();
    BodyHistory history(GetParam(), choices, most_bodies, kStrides[round % 5],
                        options, is_short ? FpMode::kDefault : mode,
                        is_short ? &memory : nullptr);
    if (is_large) history.Insert(most_bodies);
    // Two dimensions are the same code.
    const std::size_t large = GetParam().dims == 3 ? 3 + Scaled(9) : 3;
    const std::size_t steps = is_large ? large : 10 + Scaled(20);
    for (std::size_t step = 0; step < steps; ++step) {
      const std::size_t what = history.Change();
      history.ExpectIsModel(random());
      if (HasFailure()) {
        FAIL() << "round " << round << ", step " << step << ", " << what;
      }
    }
  }
}

}  // namespace
}  // namespace halfspace::testing

// Threads that share one call's work write the same output, each its range.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <thread>
#include <vector>

#include "halfspace/reject_many.h"
#include "tests/library/support/answers.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/flat_cases.h"

namespace halfspace::testing {
namespace {

TEST(RangeThreadsTest, TwoThreadsFillTheSameMasks) {
  constexpr std::size_t kObjects = 9 * 64 + 5;
  constexpr std::size_t kQueries = 5;
  constexpr std::size_t kMiddle = 5 * 64;
  Random random(11);
  const std::vector<FlatCase> kinds = AllFlatCases();
  const FlatCase kind =
      *std::find_if(kinds.begin(), kinds.end(),
                    [](const FlatCase& row) { return row.name == "Aabo3"; });
  const FlatInput input(kind, InputKind::kMixed, kObjects, random);
  const AnyWorld world = input.WorldAt(0, kObjects, 1);
  const FlatQueries queries(kind, input, kQueries, random);
  constexpr std::size_t kWords = MaskWords(kObjects);
  std::vector<std::uint64_t> expected_rows;
  for (std::size_t q = 0; q < kQueries; ++q) {
    Answer answer;
    answer.AssignReference(world, queries.Some(q, 1));
    const auto mask = answer.survivor_mask();
    expected_rows.insert(expected_rows.end(), mask.begin(), mask.end());
  }
  const std::vector<std::uint64_t> expected_mask(
      expected_rows.begin(), expected_rows.begin() + kWords);

  for (Target target : TargetsUnderTest()) {
    for (Schedule schedule : kSchedules) {
      std::vector<std::uint64_t> mask(kWords);
      std::vector<std::uint64_t> rows(kQueries * kWords);
      const auto work = [&](Range range) {
        const Options options{
            .schedule = schedule, .target = target, .range = range};
        const std::size_t first = range.begin / 64;
        for (std::size_t i = 0; i < Scaled(50); ++i) {
          detail::SurvivorMask(world.Asked(queries.Some(0, 1)),
                               std::span(mask).subspan(first), options);
          detail::SurvivorMasks(world.Asked(queries.Some(0, kQueries)),
                                std::span(rows).subspan(first), options,
                                kWords);
        }
      };
      {
        const std::jthread first(work, Range{0, kMiddle});
        const std::jthread second(work, Range{.begin = kMiddle});
      }
      EXPECT_EQ(mask, expected_mask) << target.name();
      EXPECT_EQ(rows, expected_rows) << target.name();
    }
  }
}

}  // namespace
}  // namespace halfspace::testing

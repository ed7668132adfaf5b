// Threads that share one call's work write the same output, each its range.
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <thread>
#include <vector>

#include "halfspace/reject_many.h"
#include "tests/library/support/answers.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/flat_cases.h"
#include "tests/library/support/quantized_rows.h"

namespace halfspace::testing {
namespace {

// The masks are those of one call for the whole world.
void ExpectTheyFillTheSameMasks(const AnyWorld& world,
                                const AnyQueries& queries) {
  constexpr std::size_t kMiddle = 5 * 64;
  const std::size_t words = MaskWords(world.size());
  const AnyQueries one = world.One(queries);
  for (Target target : TargetsUnderTest()) {
    for (Schedule schedule : kSchedules) {
      std::vector<std::uint64_t> expected_mask(words);
      std::vector<std::uint64_t> expected_rows(queries.count * words);
      detail::SurvivorMask(world.Asked(one), expected_mask, {});
      detail::SurvivorMasks(world.Asked(queries), expected_rows, {}, 0);
      std::vector<std::uint64_t> mask(words);
      std::vector<std::uint64_t> rows(queries.count * words);
      const auto work = [&](Range range) {
        const Options options{
            .schedule = schedule, .target = target, .range = range};
        const std::size_t first = range.begin / 64;
        for (std::size_t i = 0; i < Scaled(50); ++i) {
          detail::SurvivorMask(world.Asked(one), std::span(mask).subspan(first),
                               options);
          detail::SurvivorMasks(world.Asked(queries),
                                std::span(rows).subspan(first), options, words);
        }
      };
      std::thread other(work, Range{0, kMiddle});
      work(Range{.begin = kMiddle});
      other.join();
      EXPECT_EQ(mask, expected_mask) << target.name();
      EXPECT_EQ(rows, expected_rows) << target.name();
    }
  }
}

constexpr std::size_t kObjects = 9 * 64 + 5;
constexpr std::size_t kQueries = 5;

TEST(RangeThreadsTest, TwoThreadsFillTheSameMasksOfFloats) {
  Random random(11);
  for (const FlatCase& kind : AllFlatCases()) {
    if (kind.seen.dims != 3) continue;
    SCOPED_TRACE(kind.name);
    const FlatInput input(kind, InputKind::kMixed, kObjects, random);
    const FlatQueries queries(kind, input, kQueries, random);
    ExpectTheyFillTheSameMasks(input.WorldAt(0, kObjects, 1),
                               queries.Some(0, kQueries));
  }
}

TEST(RangeThreadsTest, TwoThreadsFillTheSameMasksOfQuantizedBounds) {
  Random random(37);
  for (const QuantizedRow& row : QuantizedRows()) {
    if (row.layout.dims != 3) continue;
    SCOPED_TRACE(row.name);
    const auto values = MakeQuantizedValues(
        row.layout, QuantizedInputKind::kUniform, kObjects, random);
    const auto all = row.make(values);
    const QuantizedQueries queries(row, values, kQueries, random);
    ExpectTheyFillTheSameMasks(all->world(), queries.Some(0, kQueries));
  }
}

}  // namespace
}  // namespace halfspace::testing

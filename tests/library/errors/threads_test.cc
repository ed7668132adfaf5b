// Threads that share one call's work, and that make errors.
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "halfspace/error.h"
#include "halfspace/reject_many.h"
#include "halfspace/world.h"
#include "tests/library/support/answers.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/flat_cases.h"
#include "tests/library/support/owners.h"
#include "tests/library/support/quantized_cases.h"

namespace halfspace::testing {
namespace {

// Threads that share one call's work write the same output, each its range.

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

TEST(RangeThreadsTest, TwoThreadsFillTheSameMasks) {
  Random random(11);
  for (const FlatCase& kind : AllFlatCases()) {
    if (kind.layout.dims != 3) continue;
    SCOPED_TRACE(kind.name);
    const FlatInput input(kind, InputKind::kMixed, kObjects, random);
    const FlatQueries queries(kind, input, kQueries, random);
    ExpectTheyFillTheSameMasks(input.WorldAt(0, kObjects, 1),
                               queries.Some(0, kQueries));
  }
  for (const QuantizedRow& row : QuantizedRows()) {
    if (row.layout.dims != 3) continue;
    SCOPED_TRACE(row.name);
    const auto values = MakeQuantizedValues(
        row.layout, QuantizedInputKind::kUniform, kObjects, random);
    const auto queries =
        MakeQuantizedQueries(row.layout, values, kQueries, random);
    ExpectTheyFillTheSameMasks(row.Make(values).world(),
                               {queries.data(), kQueries});
  }
}

// Handlers are exchanged while other threads make calls that are wrong: each is
// told to the handler there is, by the thread that made the call.

struct Told {
  int by;
  std::string message;
};
thread_local std::size_t told_here = 0;

template <int kNumber>
[[noreturn]] void Tell(const Error& error) {
  ++told_here;
  throw Told{kNumber, error.what()};
}

TEST(ErrorThreadsTest, EachThreadIsToldOfItsOwn) {
  const std::size_t calls = Scaled(1000);
  std::array<std::size_t, 4> right{};
  std::atomic<std::size_t> running = right.size();
  SetErrorHandler(&Tell<0>);
  std::vector<std::thread> threads;
  for (std::size_t t = 0; t < right.size(); ++t) {
    threads.emplace_back([&, t] {
      const AabbWorld3 world;
      const std::string end = "got " + std::to_string(t);
      for (std::size_t i = 0; i < calls; ++i) {
        try {
          world.Get(t);
        } catch (const Told& told) {
          right[t] +=
              told.message.ends_with(end) && told.by <= 1 && told_here == i + 1;
        }
      }
      --running;
    });
  }
  while (running != 0) {
    EXPECT_EQ(SetErrorHandler(&Tell<1>), &Tell<0>);
    EXPECT_EQ(SetErrorHandler(&Tell<0>), &Tell<1>);
  }
  for (std::thread& thread : threads) thread.join();
  SetErrorHandler(nullptr);
  for (std::size_t count : right) EXPECT_EQ(count, calls);
}

}  // namespace
}  // namespace halfspace::testing

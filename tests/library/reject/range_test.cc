// A part of the world in every output form, for one query and for many: the
// answers of the range, in outputs as large as the range.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "halfspace/reject_many.h"
#include "tests/library/support/answers.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/flat_cases.h"

namespace halfspace::testing {
namespace {

constexpr std::size_t kMost = std::numeric_limits<std::size_t>::max();
constexpr std::size_t kQueries = 7;  // tiles of registers, and one more

// Ranges within words and across them, and what lies past the world.
std::vector<Range> EveryRange(std::size_t size) {
  std::vector<std::size_t> ends = {size, size + 1, kMost};
  const std::size_t past = (MaskWords(size) + 2) * 64;
  for (std::size_t end = 0; end <= past; end += 64) {
    ends.insert(ends.end(), {end, end + 1, end + 13, end + 63});
  }
  std::vector<Range> ranges;
  for (std::size_t begin : {0u, 1u, 3u, 16u, 63u, 64u, 101u, 128u, 4u * 64u}) {
    for (std::size_t end : ends) {
      if (begin <= end) ranges.push_back({begin, end});
    }
  }
  return ranges;
}

class RangeTest : public ::testing::TestWithParam<FlatCase> {
 protected:
  void SetUpInput(std::size_t size) {
    Random random(size);
    input_.emplace(GetParam(), InputKind::kMixed, size, random);
    world_.emplace(input_->WorldAt(0, size, 1));
    queries_ = FlatQueries(GetParam(), *input_, kQueries, random);
  }

  void CheckAll(std::span<const Range> ranges) {
    for (const Range& range : ranges) {
      SCOPED_TRACE(::testing::Message() << world_->size() << " objects, range "
                                        << range.begin << ", " << range.end);
      for (std::size_t count : {std::size_t{1}, kQueries}) {
        const AnyQueries queries = queries_.Some(0, count);
        ASSERT_TRUE(
            AnswersEverywhere(Answers::OfReference(*world_, queries, range),
                              *world_, queries, targets_));
      }
    }
  }

 private:
  std::optional<FlatInput> input_;
  std::optional<AnyWorld> world_;
  FlatQueries queries_;
  std::vector<Target> targets_ = TargetsUnderTest();
};

TEST_P(RangeTest, EveryRangeOfASmallWorld) {
  for (std::size_t size : {0, 1, 64, 3 * 64 + 37}) {
    SetUpInput(size);
    CheckAll(EveryRange(size));
    if (HasFatalFailure()) return;
  }
}

// Tiles begin where the range does.
TEST_P(RangeTest, RangesAcrossTiles) {
  constexpr std::size_t kSize = 2 * 4096 + 5 * 64 + 37;
  SetUpInput(kSize);
  const std::vector<Range> ranges = {
      {65, 4096 + 128}, {4031, kSize},           {64, 4096},
      {63, 4096 + 64},  {2 * 4096 + 319, kMost}, {4096, 2 * 4096 + 1},
      {0, 2 * 4096},    {511, 2 * 4096}};
  CheckAll(
      std::span(ranges).first(std::min(Scaled(ranges.size()), ranges.size())));
}

INSTANTIATE_TEST_SUITE_P(, RangeTest, ::testing::ValuesIn(WholeFlatCases()),
                         FlatCaseName);

}  // namespace
}  // namespace halfspace::testing

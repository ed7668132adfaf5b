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
#include "tests/library/support/canaries.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/flat_cases.h"
#include "tests/library/support/many_canaries.h"

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
    all_queries_ = FlatQueries(GetParam(), *input_, kQueries, random);
    queries_ = all_queries_.Some(0, kQueries);
    query_ = all_queries_.Some(0, 1);
  }

  void CheckAll(std::span<const Range> ranges) {
    for (const Range& range : ranges) {
      SCOPED_TRACE(::testing::Message() << world_->size() << " objects, range "
                                        << range.begin << ", " << range.end);
      answer_.AssignReference(*world_, query_, range);
      ASSERT_TRUE(AnswersEverywhere(answer_, *world_, query_, targets_, range));
      answers_.AssignReference(*world_, queries_, range);
      ASSERT_TRUE(AnswersManyEverywhere(answers_, *world_, queries_, targets_));
    }
  }

  std::optional<AnyWorld> world_;
  AnyQueries queries_;
  AnyQueries query_;

 private:
  std::optional<FlatInput> input_;
  FlatQueries all_queries_;
  std::vector<Target> targets_ = TargetsUnderTest();
  Answer answer_;
  ManyAnswers answers_;
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

// AnySurvivor looks at few objects first, then at more.
TEST_P(RangeTest, AnySurvivorSeesTheRangeAlone) {
  const FlatCase& kind = GetParam();
  constexpr std::size_t kSize = 3 * 4096 + 65;
  kind.WithScalar([&]<typename T>(T) {
    // A query of zeros keeps an object of zeros, and none that is above it.
    const T query[10] = {};
    std::vector<T> plane(kSize, T{1});
    const std::vector<T> others(kSize);
    PlanePointers planes{};
    planes.fill(others.data());
    planes[0] = plane.data();
    const AnyWorld world = kind.world(planes, kSize);
    for (std::size_t at : {64u, 511u, 512u, 575u, 4096u + 512u,
                           2u * 4096u + 63u, 3u * 4096u + 64u}) {
      plane[at] = 0;
      const std::size_t word = at / 64 * 64;
      for (Target target : TargetsUnderTest()) {
        const auto any = [&](std::size_t begin, std::size_t end) {
          return detail::AnySurvivor(
                     world.Asked({query, 1}),
                     {.target = target, .range = {begin, end}}) !=
                 detail::kNoSurvivor;
        };
        EXPECT_TRUE(any(0, kMost)) << at;
        EXPECT_TRUE(any(word, kMost)) << at;
        EXPECT_TRUE(any(word, word + 64)) << at;
        EXPECT_TRUE(any(0, word + 64)) << at;
        EXPECT_TRUE(any(at, at + 1)) << at;
        EXPECT_FALSE(any(0, at)) << at;
        EXPECT_FALSE(any(at + 1, kMost)) << at;
        EXPECT_FALSE(any(0, word)) << at;
        EXPECT_FALSE(any(word, word)) << at;
        EXPECT_FALSE(any(word + 64, kMost)) << at;
      }
      plane[at] = 1;
    }
  });
}

TEST_P(RangeTest, PartsMakeTheWhole) {
  constexpr std::size_t kSize = 4096 + 3 * 64 + 37;
  SetUpInput(kSize);
  const auto all = [&] { return world_->Asked(queries_); };
  const auto one = [&] { return world_->Asked(query_); };
  std::vector<std::uint64_t> whole(kQueries * MaskWords(kSize));
  std::vector<std::size_t> whole_counts(kQueries);
  detail::SurvivorMasks(all(), whole, {}, 0);
  detail::SurvivorCounts(all(), whole_counts, {});
  std::vector<std::uint32_t> whole_list(kSize);
  whole_list.resize(detail::Survivors(one(), whole_list, {}, 0));

  std::vector<std::uint64_t> rows(whole.size());
  std::vector<std::size_t> counts(kQueries);
  std::vector<std::size_t> part_counts(kQueries);
  std::vector<std::uint32_t> list;
  std::vector<std::uint32_t> part(kSize);
  // The last part first: the order does not matter.
  for (const Range& range : {Range{4096 + 64, kMost}, Range{0, 640},
                             Range{640, 640}, Range{640, 4096 + 64}}) {
    const Options options{.range = range};
    detail::SurvivorMasks(all(), std::span(rows).subspan(range.begin / 64),
                          options, MaskWords(kSize));
    detail::SurvivorCounts(all(), part_counts, options);
    for (std::size_t q = 0; q < kQueries; ++q) counts[q] += part_counts[q];
    const std::size_t found = detail::Survivors(one(), part, options, 0);
    const auto end = part.begin() + static_cast<std::ptrdiff_t>(found);
    list.insert(list.end(), part.begin(), end);
  }
  std::sort(list.begin(), list.end());
  EXPECT_EQ(rows, whole);
  EXPECT_EQ(counts, whole_counts);
  EXPECT_EQ(list, whole_list);
}

INSTANTIATE_TEST_SUITE_P(, RangeTest, ::testing::ValuesIn(WholeFlatCases()),
                         FlatCaseName);

}  // namespace
}  // namespace halfspace::testing

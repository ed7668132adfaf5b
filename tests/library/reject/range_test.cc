// A part of the world in every output form, for one query and for many: the
// answers of the range, in outputs as large as the range.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "halfspace/reject_many.h"
#include "tests/library/support/canaries.h"
#include "tests/library/support/cases.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/inputs.h"
#include "tests/library/support/many_canaries.h"
#include "tests/library/support/many_queries.h"

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

template <typename Case>
class RangeTest : public ::testing::Test {
 protected:
  using View = typename Case::View;
  using Query = typename View::Query;

  void SetUpInput(std::size_t size) {
    Random random(size);
    input_ = MakeInput<typename Case::Stored>(InputKind::kMixed, size, random);
    view_ = Case::Seen(ViewAt(input_, 0, size, 1));
    queries_ = MakeQueries<Case>(input_, kQueries, random);
  }

  void CheckAll(std::span<const Range> ranges) {
    for (const Range& range : ranges) {
      SCOPED_TRACE(::testing::Message() << view_.size << " objects, range "
                                        << range.begin << ", " << range.end);
      answer_.AssignReference(view_, queries_[0], range);
      ASSERT_TRUE(
          AnswersEverywhere(answer_, view_, queries_[0], targets_, range));
      answers_.AssignReference(view_, queries_, range);
      ASSERT_TRUE(AnswersManyEverywhere(answers_, view_, queries_, targets_));
    }
  }

  View view_;
  std::vector<Query> queries_;

 private:
  Input<typename Case::Stored> input_;
  std::vector<Target> targets_ = TargetsUnderTest();
  Answer answer_;
  ManyAnswers answers_;
};

TYPED_TEST_SUITE(RangeTest, WholeCases, CaseNames);

TYPED_TEST(RangeTest, EveryRangeOfASmallWorld) {
  for (std::size_t size : {0, 1, 64, 3 * 64 + 37}) {
    this->SetUpInput(size);
    this->CheckAll(EveryRange(size));
    if (this->HasFatalFailure()) return;
  }
}

// Tiles begin where the range does.
TYPED_TEST(RangeTest, RangesAcrossTiles) {
  constexpr std::size_t kSize = 2 * 4096 + 5 * 64 + 37;
  this->SetUpInput(kSize);
  const std::vector<Range> ranges = {
      {65, 4096 + 128}, {4031, kSize},           {64, 4096},
      {63, 4096 + 64},  {2 * 4096 + 319, kMost}, {4096, 2 * 4096 + 1},
      {0, 2 * 4096},    {511, 2 * 4096}};
  this->CheckAll(
      std::span(ranges).first(std::min(Scaled(ranges.size()), ranges.size())));
}

// AnySurvivor looks at few objects first, then at more.
TYPED_TEST(RangeTest, AnySurvivorSeesTheRangeAlone) {
  using TheView = typename TypeParam::View;
  using Bound = typename TheView::Bound;
  constexpr std::size_t kSize = 3 * 4096 + 65;
  World<TheView> world(std::vector<Bound>(kSize, Bound::Empty()));
  const auto query = TheView::Query::Everything();
  for (std::size_t at : {64u, 511u, 512u, 575u, 4096u + 512u, 2u * 4096u + 63u,
                         3u * 4096u + 64u}) {
    world.Set(at, Bound::Everything());
    const std::size_t word = at / 64 * 64;
    for (Target target : TargetsUnderTest()) {
      const auto any = [&](std::size_t begin, std::size_t end) {
        return AnySurvivor(world, query,
                           {.target = target, .range = {begin, end}})
            .has_value();
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
    world.Set(at, Bound::Empty());
  }
}

TYPED_TEST(RangeTest, PartsMakeTheWhole) {
  constexpr std::size_t kSize = 4096 + 3 * 64 + 37;
  this->SetUpInput(kSize);
  const auto& view = this->view_;
  const auto& queries = this->queries_;
  std::vector<std::uint64_t> whole(kQueries * MaskWords(kSize));
  std::vector<std::size_t> whole_counts(kQueries);
  SurvivorMasks(view, queries, whole);
  SurvivorCounts(view, queries, whole_counts);
  std::vector<std::uint32_t> whole_list(kSize);
  whole_list.resize(Survivors(view, queries[0], whole_list));

  std::vector<std::uint64_t> rows(whole.size());
  std::vector<std::size_t> counts(kQueries);
  std::vector<std::size_t> part_counts(kQueries);
  std::vector<std::uint32_t> list;
  std::vector<std::uint32_t> part(kSize);
  // The last part first: the order does not matter.
  for (const Range& range : {Range{4096 + 64, kMost}, Range{0, 640},
                             Range{640, 640}, Range{640, 4096 + 64}}) {
    const Options options{.range = range};
    SurvivorMasks(view, queries, std::span(rows).subspan(range.begin / 64),
                  options, MaskWords(kSize));
    SurvivorCounts(view, queries, part_counts, options);
    for (std::size_t q = 0; q < kQueries; ++q) counts[q] += part_counts[q];
    const std::size_t found = Survivors(view, queries[0], part, options);
    const auto end = part.begin() + static_cast<std::ptrdiff_t>(found);
    list.insert(list.end(), part.begin(), end);
  }
  std::sort(list.begin(), list.end());
  EXPECT_EQ(rows, whole);
  EXPECT_EQ(counts, whole_counts);
  EXPECT_EQ(list, whole_list);
}

}  // namespace
}  // namespace halfspace::testing

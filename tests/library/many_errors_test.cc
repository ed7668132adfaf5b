// The preconditions of the calls for many queries: who broke which, and nothing
// written.
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "halfspace/reject_many.h"
#include "tests/library/cases.h"
#include "tests/library/expect_invalid.h"
#include "tests/library/many_calls.h"
#include "tests/library/misaligned.h"

namespace halfspace::testing {
namespace {

constexpr std::size_t kObjects = 130;  // 3 words
constexpr std::size_t kQueries = 5;

template <typename Case>
class ManyErrorsTest : public ::testing::Test {
 protected:
  using View = typename Case::View;
  using Query = typename View::Query;
  using Scalar = ScalarOf<View>;

  ManyErrorsTest() {
    for (std::size_t p = 0; p < kPlanes<View>; ++p) {
      PlaneOf(view_, p) = planes_.data() + p * kObjects;
    }
    view_.size = kObjects;
  }

  // All five calls refuse, each in its own name, and write nothing.
  void ExpectAllRefuse(const View& view, std::span<const Query> queries,
                       const Options& options, std::string_view argument,
                       std::string_view expected, std::string_view given) {
    const auto check = [&](std::string_view name, auto call) {
      EXPECT_TRUE(Refuses(call, {"halfspace: ", name, ": ", argument,
                                 ": expected", expected, "got", given}));
    };
    ForEachManyCall(view, queries, options, outputs_, check);
    EXPECT_TRUE(outputs_.Untouched());
  }

  // Both calls that write rows.
  void ExpectRowsRefused(std::span<std::uint64_t> rows,
                         std::string_view expected, std::string_view given) {
    EXPECT_TRUE(
        Refuses([&] { RejectMasks(view_, queries_, rows); },
                {"RejectMasks: rows: expected", expected, "got", given}));
    EXPECT_TRUE(
        Refuses([&] { SurvivorMasks(view_, queries_, rows); },
                {"SurvivorMasks: rows: expected", expected, "got", given}));
  }

  void ExpectPairsRefused(std::span<std::uint32_t> query_indices,
                          std::span<std::uint32_t> object_indices,
                          std::string_view argument, std::string_view expected,
                          std::string_view given) {
    EXPECT_TRUE(Refuses(
        [&] {
          (void)SurvivorPairs(view_, queries_, query_indices, object_indices);
        },
        {"SurvivorPairs: ", argument, ": expected", expected, "got", given}));
  }

  void ExpectCountsRefused(std::span<std::size_t> counts,
                           std::string_view expected, std::string_view given) {
    EXPECT_TRUE(
        Refuses([&] { SurvivorCounts(view_, queries_, counts); },
                {"SurvivorCounts: counts: expected", expected, "got", given}));
  }

  // Every output is refused that begins in the first or the last word of
  // `bytes` bytes from `begin` on.
  void ExpectNoOutputIn(void* begin, std::size_t bytes,
                        std::string_view expected, std::string_view given) {
    auto* words = static_cast<std::uint64_t*>(begin);
    const std::size_t count = bytes / sizeof(std::uint64_t);
    ExpectRowsRefused({words, 3 * kQueries}, expected, given);
    ExpectRowsRefused({words + count - 1, 3 * kQueries}, expected, given);
    auto* counts = static_cast<std::size_t*>(begin);
    ExpectCountsRefused({counts, kQueries}, expected, given);
    ExpectCountsRefused({counts + count - 1, kQueries}, expected, given);
    auto* indices = static_cast<std::uint32_t*>(begin);
    std::uint32_t other = 7;
    ExpectPairsRefused({indices, 1}, {&other, 1}, "query_indices", expected,
                       given);
    ExpectPairsRefused({&other, 1}, {indices + 2 * count - 1, 1},
                       "object_indices", expected, given);
    EXPECT_EQ(other, 7u);
    // The longer of the two lists is written no further than the shorter.
    const std::size_t pairs = 2;
    std::uint32_t others[pairs] = {7, 7};
    ExpectPairsRefused({indices + 2 * count - 1, 100}, {others, pairs},
                       "query_indices", expected, given);
    EXPECT_EQ(others[0], 7u);
  }

  View view_;
  ManyCallOutputs outputs_;
  // Room behind queries and planes, for outputs that begin in their last word.
  std::vector<Query> query_room_ = std::vector<Query>(64, Query::Everything());
  std::span<const Query> queries_ = std::span(query_room_).first(kQueries);
  std::vector<Scalar> planes_ =
      std::vector<Scalar>(kPlanes<View> * kObjects + 300);
};

TYPED_TEST_SUITE(ManyErrorsTest, WholeCases, CaseNames);

TYPED_TEST(ManyErrorsTest, BadPlane) {
  for (std::size_t p = 0; p < kPlanes<typename TypeParam::View>; ++p) {
    auto view = this->view_;
    PlaneOf(view, p) = nullptr;
    const bool is_min = IsMinPlane<typename TypeParam::View>(p);
    const std::size_t k = is_min ? p : p - kMinima<typename TypeParam::View>;
    const std::string name = std::string("world.") +
                             (is_min ? "min[" : "max[") + std::to_string(k) +
                             "]";
    this->ExpectAllRefuse(view, this->queries_, {}, name, "a plane of 130",
                          "a null pointer");
    PlaneOf(view, p) = Misaligned(PlaneOf(this->view_, p));
    this->ExpectAllRefuse(view, this->queries_, {}, name, "aligned",
                          "a misaligned one");
  }
}

TYPED_TEST(ManyErrorsTest, BadQueries) {
  const typename TestFixture::Query* none = nullptr;
  this->ExpectAllRefuse(this->view_, {none, 3}, {}, "queries", "3 queries",
                        "a null pointer");
  this->ExpectAllRefuse(this->view_, {Misaligned(this->query_room_.data()), 4},
                        {}, "queries", "aligned", "a misaligned one");
  // Also in a world where they would not be read.
  this->ExpectAllRefuse({}, {none, 3}, {}, "queries", "3 queries",
                        "a null pointer");
}

TYPED_TEST(ManyErrorsTest, BadOptions) {
  const auto check = [this](const auto& view, auto queries) {
    Options options{.schedule = static_cast<Schedule>(17)};
    this->ExpectAllRefuse(view, queries, options, "options.schedule",
                          "one of the enumerators", "17");
    options = {.target = Target::FromHighwayBit(3)};
    this->ExpectAllRefuse(view, queries, options, "options.target", "one of",
                          "a bit that is no target");
  };
  const auto queries = this->queries_;
  const typename TestFixture::View empty;
  check(this->view_, queries);
  // The size of the work is no excuse.
  check(empty, queries);
  check(this->view_, queries.first(0));
  check(empty, queries.first(0));
}

TYPED_TEST(ManyErrorsTest, WorldBeyondTheAddressSpace) {
  auto view = this->view_;
  view.size = std::numeric_limits<std::size_t>::max() /
                  sizeof(typename TestFixture::Scalar) +
              1;
  this->ExpectAllRefuse(view, this->queries_, {}, "world.size",
                        "fits the address space", std::to_string(view.size));
}

TYPED_TEST(ManyErrorsTest, ShortOutputs) {
  std::vector<std::uint64_t> rows(3 * kQueries, 7);
  this->ExpectRowsRefused(std::span(rows).first(3 * kQueries - 1),
                          "at least 5 rows of 3 words", "14 words");
  this->ExpectRowsRefused({}, "at least 5 rows of 3 words", "0 words");
  EXPECT_EQ(rows, std::vector<std::uint64_t>(3 * kQueries, 7));
  std::vector<std::size_t> counts(kQueries, 7);
  this->ExpectCountsRefused(std::span(counts).first(kQueries - 1), "at least 5",
                            "4");
  this->ExpectCountsRefused({}, "at least 5", "0");
  EXPECT_EQ(counts, std::vector<std::size_t>(kQueries, 7));
}

// Rows are of the whole world, whatever the range.
TYPED_TEST(ManyErrorsTest, RowsOfARangeAreNoShorter) {
  std::vector<std::uint64_t> rows(3 * kQueries - 1, 7);
  EXPECT_TRUE(Refuses(
      [&] {
        RejectMasks(this->view_, this->queries_, rows, {.range = {0, 64}});
      },
      {"RejectMasks: rows: expected", "at least 5 rows of 3 words"}));
}

// So many words that their number has no size_t: no span can be long enough.
TYPED_TEST(ManyErrorsTest, MoreRowsThanTheAddressSpace) {
  using AQuery = typename TestFixture::Query;
  auto view = this->view_;
  view.size = std::size_t{1} << 40;
  std::vector<std::uint64_t> rows(16, 7);
  // 2^34 words a row. Of 2^30 queries and one more, the product wraps to few.
  for (std::size_t count :
       {std::size_t{1} << 30, (std::size_t{1} << 30) + 1,
        std::numeric_limits<std::size_t>::max() / sizeof(AQuery)}) {
    const std::span<const AQuery> queries(this->query_room_.data(), count);
    EXPECT_TRUE(Refuses([&] { RejectMasks(view, queries, rows); },
                        {"RejectMasks: rows: expected", "at least",
                         std::to_string(count), "16 words"}));
    EXPECT_TRUE(Refuses([&] { SurvivorMasks(view, queries, rows); },
                        {"SurvivorMasks: rows: expected", "at least",
                         std::to_string(count), "16 words"}));
    std::vector<std::size_t> counts(16, 7);
    EXPECT_TRUE(Refuses([&] { SurvivorCounts(view, queries, counts); },
                        {"SurvivorCounts: counts: expected", "at least",
                         std::to_string(count), "16"}));
    EXPECT_EQ(counts, std::vector<std::size_t>(16, 7));
  }
  EXPECT_EQ(rows, std::vector<std::uint64_t>(16, 7));
}

TYPED_TEST(ManyErrorsTest, NullOutputs) {
  std::uint64_t* no_words = nullptr;
  this->ExpectRowsRefused({no_words, 3 * kQueries}, "room for the output",
                          "a null pointer");
  std::size_t* no_counts = nullptr;
  this->ExpectCountsRefused({no_counts, kQueries}, "room for the output",
                            "a null pointer");
  std::uint32_t* no_indices = nullptr;
  std::uint32_t index = 7;
  this->ExpectPairsRefused({no_indices, 1}, {&index, 1}, "query_indices",
                           "room for the output", "a null pointer");
  this->ExpectPairsRefused({&index, 1}, {no_indices, 1}, "object_indices",
                           "room for the output", "a null pointer");
  EXPECT_EQ(index, 7u);
}

TYPED_TEST(ManyErrorsTest, MisalignedOutputs) {
  std::vector<std::uint64_t> rows(3 * kQueries + 1, 7);
  this->ExpectRowsRefused({Misaligned(rows.data()), 3 * kQueries}, "aligned",
                          "a misaligned one");
  EXPECT_EQ(rows, std::vector<std::uint64_t>(3 * kQueries + 1, 7));
  std::vector<std::size_t> counts(kQueries + 1, 7);
  this->ExpectCountsRefused({Misaligned(counts.data()), kQueries}, "aligned",
                            "a misaligned one");
  EXPECT_EQ(counts, std::vector<std::size_t>(kQueries + 1, 7));
  std::vector<std::uint32_t> indices(3, 7);
  std::uint32_t index = 7;
  this->ExpectPairsRefused({Misaligned(indices.data()), 1}, {&index, 1},
                           "query_indices", "aligned", "a misaligned one");
  this->ExpectPairsRefused({&index, 1}, {Misaligned(indices.data()), 1},
                           "object_indices", "aligned", "a misaligned one");
  EXPECT_EQ(indices, std::vector<std::uint32_t>(3, 7));
}

TYPED_TEST(ManyErrorsTest, OutputOverlapsAPlane) {
  constexpr std::size_t kValues = kPlanes<typename TypeParam::View> * kObjects;
  const auto before = this->planes_;
  this->ExpectNoOutputIn(
      this->planes_.data(), kValues * sizeof(typename TestFixture::Scalar),
      "apart from the world's planes", "an overlap with world.");
  EXPECT_EQ(this->planes_, before);
}

TYPED_TEST(ManyErrorsTest, OutputOverlapsTheQueries) {
  const auto before = this->query_room_;
  this->ExpectNoOutputIn(this->query_room_.data(), this->queries_.size_bytes(),
                         "apart from the queries", "an overlap with them");
  EXPECT_EQ(this->query_room_, before);
}

}  // namespace
}  // namespace halfspace::testing

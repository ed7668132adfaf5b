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
#include "tests/library/many/many_errors_fixture.h"
#include "tests/library/support/cases.h"
#include "tests/library/support/expect_invalid.h"
#include "tests/library/support/many_calls.h"
#include "tests/library/support/misaligned.h"

namespace halfspace::testing {
namespace {

template <typename Case>
class ManyErrorsTest : public ManyErrors<Case> {
 protected:
  using View = typename ManyErrors<Case>::View;
  using Query = typename ManyErrors<Case>::Query;

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

  ManyCallOutputs outputs_;
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
  std::vector<std::uint64_t> rows(3 * TestFixture::kQueries, 7);
  this->ExpectRowsRefused(std::span(rows).first(3 * TestFixture::kQueries - 1),
                          "at least 5 rows of 3 words", "14 words");
  this->ExpectRowsRefused({}, "at least 5 rows of 3 words", "0 words");
  EXPECT_EQ(rows, std::vector<std::uint64_t>(3 * TestFixture::kQueries, 7));
  std::vector<std::size_t> counts(TestFixture::kQueries, 7);
  this->ExpectCountsRefused(std::span(counts).first(TestFixture::kQueries - 1),
                            "at least 5", "4");
  this->ExpectCountsRefused({}, "at least 5", "0");
  EXPECT_EQ(counts, std::vector<std::size_t>(TestFixture::kQueries, 7));
}

// Rows are of the whole world, whatever the range.
TYPED_TEST(ManyErrorsTest, RowsOfARangeAreNoShorter) {
  std::vector<std::uint64_t> rows(3 * TestFixture::kQueries - 1, 7);
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

}  // namespace
}  // namespace halfspace::testing

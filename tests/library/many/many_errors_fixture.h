// Calls for many queries that refuse: what their tests share.
#ifndef HALFSPACE_TESTS_LIBRARY_MANY_MANY_ERRORS_FIXTURE_H_
#define HALFSPACE_TESTS_LIBRARY_MANY_MANY_ERRORS_FIXTURE_H_

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "halfspace/reject_many.h"
#include "tests/library/support/cases.h"
#include "tests/library/support/expect_invalid.h"

namespace halfspace::testing {

template <typename Case>
class ManyErrors : public ::testing::Test {
 protected:
  using View = typename Case::View;
  using Query = typename View::Query;
  using Scalar = ScalarOf<View>;
  static constexpr std::size_t kObjects = 130;  // 3 words
  static constexpr std::size_t kQueries = 5;

  ManyErrors() {
    for (std::size_t p = 0; p < kPlanes<View>; ++p) {
      PlaneOf(view_, p) = planes_.data() + p * kObjects;
    }
    view_.size = kObjects;
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

  void ExpectCountsRefused(std::span<std::size_t> counts,
                           std::string_view expected, std::string_view given) {
    EXPECT_TRUE(
        Refuses([&] { SurvivorCounts(view_, queries_, counts); },
                {"SurvivorCounts: counts: expected", expected, "got", given}));
  }

  View view_;
  // Room behind queries and planes, for outputs that begin in their last word.
  std::vector<Query> query_room_ = std::vector<Query>(64, Query::Everything());
  std::span<const Query> queries_ = std::span(query_room_).first(kQueries);
  std::vector<Scalar> planes_ =
      std::vector<Scalar>(kPlanes<View> * kObjects + 300);
};

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_MANY_MANY_ERRORS_FIXTURE_H_

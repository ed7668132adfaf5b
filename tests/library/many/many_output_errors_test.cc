// The memory that calls for many queries write to: null, misaligned, or part of
// what they read or write besides.
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "halfspace/reject_many.h"
#include "tests/library/many/many_errors_fixture.h"
#include "tests/library/support/cases.h"
#include "tests/library/support/expect_invalid.h"
#include "tests/library/support/misaligned.h"

namespace halfspace::testing {
namespace {

template <typename Case>
class ManyOutputErrorsTest : public ManyErrors<Case> {
 protected:
  using Base = ManyErrors<Case>;

  void ExpectPairsRefused(std::span<std::uint32_t> query_indices,
                          std::span<std::uint32_t> object_indices,
                          std::string_view argument, std::string_view expected,
                          std::string_view given) {
    EXPECT_TRUE(Refuses(
        [&] {
          (void)SurvivorPairs(this->view_, this->queries_, query_indices,
                              object_indices);
        },
        {"SurvivorPairs: ", argument, ": expected", expected, "got", given}));
  }

  // Every output is refused that begins in the first or the last word of
  // `bytes` bytes from `begin` on.
  void ExpectNoOutputIn(void* begin, std::size_t bytes,
                        std::string_view expected, std::string_view given) {
    auto* words = static_cast<std::uint64_t*>(begin);
    const std::size_t count = bytes / sizeof(std::uint64_t);
    this->ExpectRowsRefused({words, 3 * Base::kQueries}, expected, given);
    this->ExpectRowsRefused({words + count - 1, 3 * Base::kQueries}, expected,
                            given);
    auto* counts = static_cast<std::size_t*>(begin);
    this->ExpectCountsRefused({counts, Base::kQueries}, expected, given);
    this->ExpectCountsRefused({counts + count - 1, Base::kQueries}, expected,
                              given);
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
};

TYPED_TEST_SUITE(ManyOutputErrorsTest, WholeCases, CaseNames);

TYPED_TEST(ManyOutputErrorsTest, NullOutputs) {
  std::uint64_t* no_words = nullptr;
  this->ExpectRowsRefused({no_words, 3 * TestFixture::kQueries},
                          "room for the output", "a null pointer");
  std::size_t* no_counts = nullptr;
  this->ExpectCountsRefused({no_counts, TestFixture::kQueries},
                            "room for the output", "a null pointer");
  std::uint32_t* no_indices = nullptr;
  std::uint32_t index = 7;
  this->ExpectPairsRefused({no_indices, 1}, {&index, 1}, "query_indices",
                           "room for the output", "a null pointer");
  this->ExpectPairsRefused({&index, 1}, {no_indices, 1}, "object_indices",
                           "room for the output", "a null pointer");
  EXPECT_EQ(index, 7u);
}

TYPED_TEST(ManyOutputErrorsTest, MisalignedOutputs) {
  std::vector<std::uint64_t> rows(3 * TestFixture::kQueries + 1, 7);
  this->ExpectRowsRefused({Misaligned(rows.data()), 3 * TestFixture::kQueries},
                          "aligned", "a misaligned one");
  EXPECT_EQ(rows, std::vector<std::uint64_t>(3 * TestFixture::kQueries + 1, 7));
  std::vector<std::size_t> counts(TestFixture::kQueries + 1, 7);
  this->ExpectCountsRefused({Misaligned(counts.data()), TestFixture::kQueries},
                            "aligned", "a misaligned one");
  EXPECT_EQ(counts, std::vector<std::size_t>(TestFixture::kQueries + 1, 7));
  std::vector<std::uint32_t> indices(3, 7);
  std::uint32_t index = 7;
  this->ExpectPairsRefused({Misaligned(indices.data()), 1}, {&index, 1},
                           "query_indices", "aligned", "a misaligned one");
  this->ExpectPairsRefused({&index, 1}, {Misaligned(indices.data()), 1},
                           "object_indices", "aligned", "a misaligned one");
  EXPECT_EQ(indices, std::vector<std::uint32_t>(3, 7));
}

TYPED_TEST(ManyOutputErrorsTest, OutputOverlapsAPlane) {
  constexpr std::size_t kValues =
      kPlanes<typename TypeParam::View> * TestFixture::kObjects;
  const auto before = this->planes_;
  this->ExpectNoOutputIn(
      this->planes_.data(), kValues * sizeof(typename TestFixture::Scalar),
      "apart from the world's planes", "an overlap with world.");
  EXPECT_EQ(this->planes_, before);
}

TYPED_TEST(ManyOutputErrorsTest, OutputOverlapsTheQueries) {
  const auto before = this->query_room_;
  this->ExpectNoOutputIn(this->query_room_.data(), this->queries_.size_bytes(),
                         "apart from the queries", "an overlap with them");
  EXPECT_EQ(this->query_room_, before);
}

// By one element, or all, and in either order.
TYPED_TEST(ManyOutputErrorsTest, PairsOverlapOneAnother) {
  constexpr std::size_t kPairs = 4;
  std::vector<std::uint32_t> room(3 * kPairs, 7);
  for (std::size_t begin = 1; begin < 2 * kPairs; ++begin) {
    this->ExpectPairsRefused({&room[kPairs], kPairs}, {&room[begin], kPairs},
                             "object_indices",
                             "memory apart from query_indices", "an overlap");
  }
  // Where one has room for more than the other, too.
  this->ExpectPairsRefused({&room[0], kPairs}, {&room[kPairs - 1], 2 * kPairs},
                           "object_indices", "memory apart from query_indices",
                           "an overlap");
  EXPECT_EQ(room, std::vector<std::uint32_t>(3 * kPairs, 7));
}

TYPED_TEST(ManyOutputErrorsTest, PairsSideBySideAreFine) {
  constexpr std::size_t kPairs = 4;
  std::vector<std::uint32_t> room(3 * kPairs, 7);
  const std::size_t all = this->queries_.size() * this->view_.size;
  for (std::size_t begin : {std::size_t{0}, 2 * kPairs}) {
    EXPECT_EQ(SurvivorPairs(this->view_, this->queries_,
                            {&room[kPairs], kPairs}, {&room[begin], kPairs}),
              all);
  }
  const std::vector<std::uint32_t> expected = {0, 1, 2, 3, 0, 0,
                                               0, 0, 0, 1, 2, 3};
  EXPECT_EQ(room, expected);
}

// What is never written may overlap: the longer list past the end of the
// shorter one, and either past the last pair there can be.
TYPED_TEST(ManyOutputErrorsTest, RoomForMorePairsMayOverlap) {
  std::vector<std::uint32_t> room(10, 7);
  EXPECT_EQ(
      SurvivorPairs(this->view_, this->queries_, {&room[0], 8}, {&room[2], 2}),
      this->queries_.size() * this->view_.size);
  EXPECT_EQ(room, (std::vector<std::uint32_t>{0, 0, 0, 1, 7, 7, 7, 7, 7, 7}));
  auto two = this->view_;
  two.size = 2;
  EXPECT_EQ(
      SurvivorPairs(two, this->queries_.first(1), {&room[4], 4}, {&room[6], 4}),
      2u);
  EXPECT_EQ(room, (std::vector<std::uint32_t>{0, 0, 0, 1, 0, 0, 0, 1, 7, 7}));
  // A range has the pairs of its objects.
  EXPECT_EQ(SurvivorPairs(this->view_, this->queries_.first(1), {&room[4], 4},
                          {&room[6], 4}, {.range = {1, 3}}),
            2u);
  EXPECT_EQ(room, (std::vector<std::uint32_t>{0, 0, 0, 1, 0, 0, 1, 2, 7, 7}));
  // Nothing survives in a world without objects.
  EXPECT_EQ(SurvivorPairs(typename TestFixture::View{}, this->queries_,
                          {&room[0], 8}, {&room[0], 8}),
            0u);
}

}  // namespace
}  // namespace halfspace::testing

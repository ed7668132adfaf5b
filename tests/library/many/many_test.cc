// Many queries at once on every target and schedule, in every output form,
// against the oracle query by query, bit for bit.
#include <gtest/gtest.h>

#include <cstddef>
#include <iterator>
#include <vector>

#include "halfspace/reject_many.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/flat_cases.h"
#include "tests/library/support/many_canaries.h"

namespace halfspace::testing {
namespace {

// Around the registers that share a load (2 or 4 queries), the rows of a tile
// (16) and the queries that are ready at a time (256).
constexpr std::size_t kQueryCounts[] = {0, 1,  2,  3,   4,   5,   7,  8,
                                        9, 16, 17, 255, 256, 257, 600};

// Misaligned worlds, as no two planes share an alignment.
constexpr std::size_t kMisalignments = 8;

class ManyTest : public ::testing::TestWithParam<FlatCase> {
 protected:
  void Check(const FlatInput& input, const AnyQueries& queries,
             std::size_t size) {
    const AnyWorld world = input.WorldAt(size, size, kMisalignments);
    answers_.AssignReference(world, queries);
    survivors_ += answers_.pairs();
    tests_ += size * queries.count;
    ASSERT_TRUE(AnswersManyEverywhere(answers_, world, queries, targets_))
        << size << " objects, " << queries.count << " queries";
  }

  // Objects of the tiles that the calls for many queries go by.
  static std::size_t TileObjects() {
    Random random(1);
    const FlatInput input(GetParam(), InputKind::kMixed, 5000, random);
    const FlatQueries queries(GetParam(), input, 2, random);
    std::size_t objects = 0;
    const auto see = [&](const SurvivorTile& tile) {
      if (tile.first_object == 0) objects = tile.objects;
    };
    detail::Callback call{see};
    detail::ForEachTile(input.WorldAt(0, 5000, 1).Asked(queries.Some(0, 2)),
                        &decltype(call)::Run, &call, {});
    return objects;
  }

  // An input without both answers would test little.
  void ExpectBothAnswers() const {
    EXPECT_GT(survivors_, 0u);
    EXPECT_LT(survivors_, tests_);
  }

 private:
  std::vector<Target> targets_ = TargetsUnderTest();
  ManyAnswers answers_;
  std::size_t survivors_ = 0;
  std::size_t tests_ = 0;
};

TEST_P(ManyTest, EveryNumberOfQueries) {
  constexpr std::size_t kSizes[] = {0, 1, 63, 64, 65, 2 * 64 + 31};
  for (std::size_t seed = 0; seed < Scaled(4); ++seed) {
    const InputKind kind =
        seed % 2 == 0 ? InputKind::kAdversarial : InputKind::kMixed;
    SCOPED_TRACE(::testing::Message() << NameOf(kind) << ", seed " << seed);
    Random random(seed);
    const FlatInput input(GetParam(), kind,
                          std::end(kSizes)[-1] + kMisalignments, random);
    const FlatQueries queries(GetParam(), input, 601, random);
    for (std::size_t size : kSizes) {
      for (std::size_t count : kQueryCounts) {
        // From the second on: aligned to no more than a value is.
        Check(input, queries.Some(1, count), size);
        if (HasFatalFailure()) return;
      }
    }
  }
  ExpectBothAnswers();
}

TEST_P(ManyTest, SizesAroundTiles) {
  const std::size_t tile = TileObjects();
  ASSERT_GE(tile, 64u);
  ASSERT_EQ(tile % 64, 0u);
  for (InputKind kind : {InputKind::kRuns, InputKind::kDense}) {
    SCOPED_TRACE(NameOf(kind));
    Random random(7);
    const FlatInput input(GetParam(), kind, 2 * tile + 65 + kMisalignments,
                          random);
    const FlatQueries queries(GetParam(), input, 300, random);
    for (std::size_t size : {tile - 1, tile, tile + 1, 2 * tile + 65}) {
      for (std::size_t count : {2, 5, 17}) {
        Check(input, queries.Some(0, count), size);
        if (HasFatalFailure()) return;
      }
    }
    // A second block, of which the world is read again.
    Check(input, queries.Some(0, 259), tile + 1);
    if (HasFatalFailure()) return;
  }
  ExpectBothAnswers();
}

INSTANTIATE_TEST_SUITE_P(, ManyTest, ::testing::ValuesIn(AllFlatCases()),
                         FlatCaseName);

}  // namespace
}  // namespace halfspace::testing

// Every target, schedule and call against the oracle, bit for bit: of one query
// in worlds of every size, and of many queries.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <vector>

#include "halfspace/reject_many.h"
#include "tests/library/support/answers.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/flat_cases.h"
#include "tests/library/support/sizes.h"

namespace halfspace::testing {
namespace {

class DifferentialTest : public ::testing::TestWithParam<FlatCase> {
 protected:
  // An input without both answers would test little.
  void TearDown() override {
    EXPECT_GT(survivors_, 0u);
    EXPECT_LT(survivors_, tests_);
  }

  // More than one vector of misalignments, also where a vector is one lane.
  static std::size_t Misalignments() {
    return std::max<std::size_t>(4, MostLanes());
  }

  // Checks `offsets` misalignments of one size.
  void Check(const FlatInput& input, const AnyQueries& queries,
             std::size_t size, std::size_t offsets = 1) {
    for (std::size_t i = 0; i < offsets; ++i) {
      // From one size to the next other ones, when not all are checked.
      const std::size_t offset = (5 * size + i) % Misalignments();
      const AnyWorld world = input.WorldAt(offset, size, Misalignments());
      const Answers answers = Answers::OfReference(world, queries);
      survivors_ += answers.survivors().size();
      tests_ += size * queries.count;
      ASSERT_TRUE(AnswersEverywhere(answers, world, queries, targets_))
          << size << " objects, " << queries.count << " queries, offset "
          << offset;
    }
  }

  // Checks `offsets` misalignments of all sizes of the first `kinds` kinds of
  // input, each of `seeds` seeds.
  void CheckKinds(const std::vector<std::size_t>& sizes, std::size_t offsets,
                  std::size_t kinds, std::size_t seeds = 1) {
    for (std::size_t k = 0; k < kinds; ++k) {
      for (std::size_t seed = 0; seed < seeds; ++seed) {
        SCOPED_TRACE(::testing::Message()
                     << NameOf(kInputKinds[k]) << ", seed " << seed);
        Random random(seed);
        const FlatInput input(GetParam(), kInputKinds[k],
                              sizes.back() + Misalignments(), random);
        for (std::size_t size : sizes) {
          Check(input, input.query(), size, offsets);
          if (HasFatalFailure()) return;
        }
      }
    }
  }

 private:
  std::vector<Target> targets_ = TargetsUnderTest();
  std::size_t survivors_ = 0;
  std::size_t tests_ = 0;
};

TEST_P(DifferentialTest, EverySmallSizeAtEveryMisalignment) {
  CheckKinds(EverySmallSize(), Scaled(Misalignments()), kInputKinds.size(),
             Scaled(4));
}

TEST_P(DifferentialTest, SizesAroundTiles) {
  CheckKinds(SizesAroundTiles(), Scaled(2), kInputKinds.size());
}

TEST_P(DifferentialTest, SizesFromMemory) {
  CheckKinds(SizesFromMemory(GetParam().query_bytes()), 1,
             Scaled(kInputKinds.size()));
}

// Around the registers that share a load (2 or 4 queries), the rows of a tile
// (16) and the queries that are ready at a time (256).
TEST_P(DifferentialTest, EveryNumberOfQueries) {
  for (std::size_t seed = 0; seed < Scaled(4); ++seed) {
    const InputKind kind =
        seed % 2 == 0 ? InputKind::kAdversarial : InputKind::kMixed;
    SCOPED_TRACE(::testing::Message() << NameOf(kind) << ", seed " << seed);
    Random random(seed);
    const FlatInput input(GetParam(), kind, 2 * 64 + 31 + Misalignments(),
                          random);
    const FlatQueries queries(GetParam(), input, 601, random);
    for (std::size_t size : {0, 1, 63, 64, 65, 2 * 64 + 31}) {
      for (std::size_t count :
           {0, 1, 2, 3, 4, 5, 7, 8, 9, 16, 17, 255, 256, 257, 600}) {
        // From the second on: aligned to no more than a value is.
        Check(input, queries.Some(1, count), size);
        if (HasFatalFailure()) return;
      }
    }
  }
}

// Objects of the tiles that the calls for many queries go by.
std::size_t TileObjects(const FlatInput& input, const AnyQueries& queries) {
  std::size_t objects = 0;
  const auto see = [&](const SurvivorTile& tile) {
    if (tile.first_object == 0) objects = tile.objects;
  };
  detail::Callback call{see};
  detail::ForEachTile(input.WorldAt(0, 5000, 1).Asked(queries),
                      &decltype(call)::Run, &call, {});
  return objects;
}

TEST_P(DifferentialTest, ManyQueriesAroundTiles) {
  for (InputKind kind : {InputKind::kRuns, InputKind::kDense}) {
    SCOPED_TRACE(NameOf(kind));
    Random random(7);
    const FlatInput input(GetParam(), kind, 10'000, random);
    const FlatQueries queries(GetParam(), input, 300, random);
    const std::size_t tile = TileObjects(input, queries.Some(0, 2));
    ASSERT_GE(tile, 64u);
    ASSERT_LE(2 * tile + 65 + Misalignments(), 10'000u);
    ASSERT_EQ(tile % 64, 0u);
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
}

INSTANTIATE_TEST_SUITE_P(, DifferentialTest,
                         ::testing::ValuesIn(AllFlatCases()), FlatCaseName);

}  // namespace
}  // namespace halfspace::testing

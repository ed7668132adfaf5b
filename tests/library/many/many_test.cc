// Many queries at once on every target and schedule, in every output form,
// against the oracle query by query, bit for bit.
#include <gtest/gtest.h>

#include <cstddef>
#include <iterator>
#include <span>
#include <vector>

#include "halfspace/reject_many.h"
#include "tests/library/support/cases.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/inputs.h"
#include "tests/library/support/many_canaries.h"
#include "tests/library/support/many_queries.h"

namespace halfspace::testing {
namespace {

// Around the registers that share a load (2 or 4 queries), the rows of a tile
// (16) and the queries that are ready at a time (256).
constexpr std::size_t kQueryCounts[] = {0, 1,  2,  3,   4,   5,   7,  8,
                                        9, 16, 17, 255, 256, 257, 600};

// Misaligned worlds, as no two planes share an alignment.
constexpr std::size_t kMisalignments = 8;

template <typename Case>
class ManyTest : public ::testing::Test {
 protected:
  using View = typename Case::View;
  using Query = typename View::Query;
  using TheInput = Input<typename Case::Stored>;

  void Check(const TheInput& input, std::span<const Query> queries,
             std::size_t size) {
    const View view = Case::Seen(ViewAt(input, size, size, kMisalignments));
    answers_.AssignReference(view, queries);
    survivors_ += answers_.pairs();
    tests_ += size * queries.size();
    ASSERT_TRUE(AnswersManyEverywhere(answers_, view, queries, targets_))
        << size << " objects, " << queries.size() << " queries";
  }

  // Objects of the tiles that the calls for many queries go by.
  std::size_t TileObjects() {
    const std::vector<typename Case::Stored::Bound> bounds(
        5000, Case::Stored::Bound::Empty());
    const World<typename Case::Stored> world(bounds);
    const std::vector<Query> queries(2);
    std::size_t objects = 0;
    ForEachTile(Case::Seen(world.view()), queries,
                [&](const SurvivorTile& tile) {
                  if (tile.first_object == 0) objects = tile.objects;
                });
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

TYPED_TEST_SUITE(ManyTest, AllCases, CaseNames);

TYPED_TEST(ManyTest, EveryNumberOfQueries) {
  constexpr std::size_t kSizes[] = {0, 1, 63, 64, 65, 2 * 64 + 31};
  for (std::size_t seed = 0; seed < Scaled(4); ++seed) {
    const InputKind kind =
        seed % 2 == 0 ? InputKind::kAdversarial : InputKind::kMixed;
    SCOPED_TRACE(::testing::Message() << NameOf(kind) << ", seed " << seed);
    Random random(seed);
    const auto input = MakeInput<typename TypeParam::Stored>(
        kind, std::end(kSizes)[-1] + kMisalignments, random);
    const auto queries = MakeQueries<TypeParam>(input, 601, random);
    for (std::size_t size : kSizes) {
      for (std::size_t count : kQueryCounts) {
        // From the second on: aligned to no more than a value is.
        this->Check(input, std::span(queries).subspan(1, count), size);
        if (this->HasFatalFailure()) return;
      }
    }
  }
  this->ExpectBothAnswers();
}

TYPED_TEST(ManyTest, SizesAroundTiles) {
  const std::size_t tile = this->TileObjects();
  ASSERT_GE(tile, 64u);
  ASSERT_EQ(tile % 64, 0u);
  for (InputKind kind : {InputKind::kRuns, InputKind::kDense}) {
    SCOPED_TRACE(NameOf(kind));
    Random random(7);
    const auto input = MakeInput<typename TypeParam::Stored>(
        kind, 2 * tile + 65 + kMisalignments, random);
    const auto queries = MakeQueries<TypeParam>(input, 300, random);
    for (std::size_t size : {tile - 1, tile, tile + 1, 2 * tile + 65}) {
      for (std::size_t count : {2, 5, 17}) {
        this->Check(input, std::span(queries).first(count), size);
        if (this->HasFatalFailure()) return;
      }
    }
    // A second block, of which the world is read again.
    this->Check(input, std::span(queries).first(259), tile + 1);
    if (this->HasFatalFailure()) return;
  }
  this->ExpectBothAnswers();
}

}  // namespace
}  // namespace halfspace::testing

// Nothing is read or written beyond planes, queries and outputs when there are
// many queries: each lies right beside a page that faults.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "tests/library/support/cases.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/guarded_memory.h"
#include "tests/library/support/inputs.h"
#include "tests/library/support/many_answers.h"
#include "tests/library/support/many_queries.h"

namespace halfspace::testing {
namespace {

constexpr GuardedSide kSides[] = {GuardedSide::kBefore, GuardedSide::kAfter};

template <typename Case>
class ManyGuardPagesTest : public ::testing::Test {
 protected:
  using View = typename Case::View;
  using Query = typename View::Query;
  using Scalar = ScalarOf<View>;

  static constexpr std::size_t kMostObjects = 2 * 4096 + 37;
  static constexpr std::size_t kMostQueries = 259;

  ManyGuardPagesTest() {
    for (auto& plane : planes_) {
      plane = std::make_unique<GuardedMemory>(kMostObjects * sizeof(Scalar));
    }
  }

  // The first `size` objects and `count` queries, and a range of the objects.
  void Check(std::size_t size, std::size_t count, GuardedSide side,
             const Range& range = {}) {
    View view;
    for (std::size_t p = 0; p < kPlanes<View>; ++p) {
      const auto plane = planes_[p]->template Get<Scalar>(size, side);
      std::copy_n(input_.planes[p].begin(), size, plane.begin());
      PlaneOf(view, p) = plane.data();
    }
    view.size = size;
    const auto queries = queries_memory_.Get<Query>(count, side);
    std::copy_n(all_queries_.begin(), count, queries.begin());
    answers_.AssignReference(view, queries, range);
    const auto rows =
        rows_.Get<std::uint64_t>(answers_.reject_rows().size(), side);
    for (Target target : targets_) {
      for (Schedule schedule : kSchedules) {
        std::fill(rows.begin(), rows.end(), kUnwritten);
        const ManyOutputs outputs = {
            rows, query_indices_.Get<std::uint32_t>(answers_.pairs(), side),
            object_indices_.Get<std::uint32_t>(answers_.pairs(), side),
            counts_.Get<std::size_t>(count, side)};
        ASSERT_TRUE(AnswersMany(
            answers_, view, queries,
            {.schedule = schedule, .target = target, .range = range}, outputs))
            << size << " objects, " << count << " queries, range "
            << range.begin << ", " << range.end;
      }
    }
  }

 private:
  Random random_{5};
  Input<View> input_ = MakeInput<View>(InputKind::kRuns, kMostObjects, random_);
  std::vector<Query> all_queries_ =
      MakeQueries<Case>(input_, kMostQueries, random_);
  std::vector<Target> targets_ = TargetsUnderTest();
  ManyAnswers answers_;
  std::unique_ptr<GuardedMemory> planes_[kPlanes<View>];
  GuardedMemory queries_memory_{kMostQueries * sizeof(Query)};
  GuardedMemory rows_{kMostQueries * MaskWords(kMostObjects) *
                      sizeof(std::uint64_t)};
  GuardedMemory query_indices_{kMostQueries * kMostObjects *
                               sizeof(std::uint32_t)};
  GuardedMemory object_indices_{kMostQueries * kMostObjects *
                                sizeof(std::uint32_t)};
  GuardedMemory counts_{kMostQueries * sizeof(std::size_t)};
};

TYPED_TEST_SUITE(ManyGuardPagesTest, WholeCases, CaseNames);

TYPED_TEST(ManyGuardPagesTest, EveryLengthOfTheLastWord) {
  for (std::size_t size = 0; size <= 64 + MostLanes(); ++size) {
    for (std::size_t count : {1, 7}) {
      for (GuardedSide side : kSides) {
        this->Check(size, count, side);
        if (this->HasFatalFailure()) return;
      }
    }
  }
}

TYPED_TEST(ManyGuardPagesTest, EveryNumberOfQueries) {
  for (std::size_t count : {0, 1, 2, 3, 4, 5, 8, 15, 16, 17, 255, 256, 259}) {
    for (GuardedSide side : kSides) {
      this->Check(2 * 64 + 5, count, side);
      if (this->HasFatalFailure()) return;
    }
  }
}

TYPED_TEST(ManyGuardPagesTest, TilesAndRanges) {
  for (GuardedSide side : kSides) {
    for (const Range& range :
         {Range{}, Range{64, 4096}, Range{4096, 2 * 4096 + 37}}) {
      this->Check(2 * 4096 + 37, 5, side, range);
      if (this->HasFatalFailure()) return;
    }
  }
}

}  // namespace
}  // namespace halfspace::testing

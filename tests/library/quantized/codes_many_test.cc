// Many queries at once, and parts of the world, by codes alone and confirmed.
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <thread>
#include <vector>

#include "halfspace/codes.h"
#include "halfspace/reject_many.h"
#include "tests/library/quantized/coded_answers.h"
#include "tests/library/support/coded_cases.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/many_canaries.h"

namespace halfspace::testing {
namespace {

template <typename Case>
class CodesManyTest : public ::testing::Test {
 protected:
  using FloatView = typename Case::View;
  using Query = typename FloatView::Query;
  using Coded = CodedWorld<FloatView, typename Case::Code>;

  void SetUpWorld(CodedInputKind kind, std::size_t size, std::size_t queries) {
    auto bounds = MakeCodedBounds<FloatView>(kind, size, random_);
    floats_.Assign(bounds);
    world_ = Coded(floats_);
    queries_.clear();
    coded_.clear();
    for (std::size_t q = 0; q < queries; ++q) {
      queries_.push_back(MakeCodedQuery<FloatView>(bounds, random_));
      coded_.push_back(
          AnswerByMask(world_.codes(), size, queries_[q], targets_[0]));
    }
  }

  // The answers to one query at a time, as codes_differential_test.cc proves
  // them, are those to all.
  void Check(std::size_t queries, const Range& range = {}) {
    SCOPED_TRACE(::testing::Message()
                 << world_.size() << " objects, range " << range.begin << ", "
                 << range.end << ", " << queries << " queries");
    const auto some = std::span(std::as_const(queries_)).first(queries);
    answers_.AssignReference(floats_.view(), some, range);
    ASSERT_TRUE(AnswersManyEverywhere(answers_, world_, some, targets_));
    answers_.Assign(world_.size(), queries, range,
                    [&](std::size_t q, std::size_t i) {
                      const auto mask = coded_[q].reject_mask();
                      return (mask[i / 64] >> (i % 64) & 1) != 0;
                    });
    ASSERT_TRUE(
        AnswersManyEverywhere(answers_, world_.codes(), some, targets_));
  }

  World<FloatView> floats_;
  Coded world_;
  std::vector<Query> queries_;
  std::vector<Answer> coded_;
  std::vector<Target> targets_ = TargetsUnderTest();

 private:
  Random random_{37};
  ManyAnswers answers_;
};

TYPED_TEST_SUITE(CodesManyTest, CodedCases, CodedCaseNames);

// Around the queries that share a load (2 or 4), the rows of a tile (16), and
// the queries whose codes are made at a time (256).
TYPED_TEST(CodesManyTest, EveryNumberOfQueries) {
  this->SetUpWorld(CodedInputKind::kAnyValues, 2 * 64 + 37, 600);
  for (std::size_t queries : {0, 1, 2, 3, 4, 5, 9, 16, 17, 256, 257, 600}) {
    this->Check(queries);
    if (this->HasFatalFailure()) return;
  }
}

TYPED_TEST(CodesManyTest, WorldsOfSeveralTiles) {
  for (CodedInputKind kind :
       {CodedInputKind::kUniform, CodedInputKind::kClustered}) {
    this->SetUpWorld(kind, 2 * 4096 + 64 + 37, 19);
    this->Check(19);
    if (this->HasFatalFailure()) return;
  }
}

TYPED_TEST(CodesManyTest, Ranges) {
  constexpr std::size_t kSize = 4096 + 3 * 64 + 37;
  this->SetUpWorld(CodedInputKind::kUniform, kSize, 7);
  const Range ranges[] = {{0, 0},
                          {0, 64},
                          {64, 64},
                          {63, 192},
                          {4001, 4096},
                          {64, 4096 + 64},
                          {4096 + 192, kSize},
                          {128, ~std::size_t{0}},
                          {8192, ~std::size_t{0}}};
  for (const Range& range : ranges) {
    this->Check(7, range);
    if (this->HasFatalFailure()) return;
    Answer exact;
    exact.AssignReference(this->floats_.view(), this->queries_[0], range);
    ASSERT_TRUE(AnswersEverywhere(exact, this->world_, this->queries_[0],
                                  this->targets_, range));
  }
}

// Threads share one world, one set of queries and one output.
TYPED_TEST(CodesManyTest, ThreadsShareTheWork) {
  constexpr std::size_t kSize = 4 * 1024 + 37;
  constexpr std::size_t kThreads = 4;
  this->SetUpWorld(CodedInputKind::kUniform, kSize, 300);
  const std::size_t words = MaskWords(kSize);
  std::vector<std::uint64_t> expected(words * 300);
  SurvivorMasks(this->world_, this->queries_, expected);
  std::vector<std::uint64_t> rows(expected.size());
  std::vector<std::thread> threads;
  for (std::size_t t = 0; t < kThreads; ++t) {
    const std::size_t end = t + 1 == kThreads ? kSize : (t + 1) * 1024;
    threads.emplace_back([&, t, end] {
      SurvivorMasks(this->world_, this->queries_,
                    std::span(rows).subspan(t * 1024 / 64),
                    {.range = {t * 1024, end}, .row_words = words});
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(rows, expected);
}

}  // namespace
}  // namespace halfspace::testing

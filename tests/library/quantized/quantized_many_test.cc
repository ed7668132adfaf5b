// Many queries at once, and parts of the world, by quantized bounds alone and
// refined.
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <thread>
#include <vector>

#include "halfspace/quantized.h"
#include "halfspace/reject_many.h"
#include "tests/library/quantized/quantized_answers.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/many_canaries.h"
#include "tests/library/support/quantized_cases.h"

namespace halfspace::testing {
namespace {

template <typename Case>
class QuantizedManyTest : public ::testing::Test {
 protected:
  using FloatView = typename Case::View;
  using Query = typename FloatView::Query;
  using TheWorld = QuantizedWorld<FloatView, typename Case::Element>;

  void SetUpWorld(QuantizedInputKind kind, std::size_t size,
                  std::size_t queries) {
    auto bounds = MakeQuantizedBounds<FloatView>(kind, size, random_);
    floats_.Assign(bounds);
    world_ = TheWorld(floats_);
    queries_.clear();
    quantized_world_.clear();
    for (std::size_t q = 0; q < queries; ++q) {
      queries_.push_back(MakeQuantizedQuery<FloatView>(bounds, random_));
      quantized_world_.push_back(
          AnswerByMask(world_.quantized(), size, queries_[q], targets_[0]));
    }
  }

  // The answers to one query at a time, as quantized_differential_test.cc
  // proves them, are those to all.
  void Check(std::size_t queries, const Range& range = {}) {
    SCOPED_TRACE(::testing::Message()
                 << world_.size() << " objects, range " << range.begin << ", "
                 << range.end << ", " << queries << " queries");
    const auto some = std::span(std::as_const(queries_)).first(queries);
    answers_.AssignReference(floats_.view(), some, range);
    ASSERT_TRUE(AnswersManyEverywhere(answers_, world_, some, targets_));
    answers_.Assign(world_.size(), queries, range,
                    [&](std::size_t q, std::size_t i) {
                      const auto mask = quantized_world_[q].reject_mask();
                      return (mask[i / 64] >> (i % 64) & 1) != 0;
                    });
    ASSERT_TRUE(
        AnswersManyEverywhere(answers_, world_.quantized(), some, targets_));
  }

  World<FloatView> floats_;
  TheWorld world_;
  std::vector<Query> queries_;
  std::vector<Answer> quantized_world_;
  std::vector<Target> targets_ = TargetsUnderTest();

 private:
  Random random_{37};
  ManyAnswers answers_;
};

TYPED_TEST_SUITE(QuantizedManyTest, QuantizedCases, QuantizedCaseNames);

// Around the queries that share a load (2 or 4), the rows of a tile (16), and
// the queries that are encoded at a time (256).
TYPED_TEST(QuantizedManyTest, EveryNumberOfQueries) {
  this->SetUpWorld(QuantizedInputKind::kAnyValues, 2 * 64 + 37, 600);
  for (std::size_t queries : {0, 1, 2, 3, 4, 5, 9, 16, 17, 256, 257, 600}) {
    this->Check(queries);
    if (this->HasFatalFailure()) return;
  }
}

TYPED_TEST(QuantizedManyTest, WorldsOfSeveralTiles) {
  for (QuantizedInputKind kind :
       {QuantizedInputKind::kUniform, QuantizedInputKind::kClustered}) {
    this->SetUpWorld(kind, 2 * 4096 + 64 + 37, 19);
    this->Check(19);
    if (this->HasFatalFailure()) return;
  }
}

TYPED_TEST(QuantizedManyTest, Ranges) {
  constexpr std::size_t kSize = 4096 + 3 * 64 + 37;
  this->SetUpWorld(QuantizedInputKind::kUniform, kSize, 7);
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
TYPED_TEST(QuantizedManyTest, ThreadsShareTheWork) {
  constexpr std::size_t kSize = 4 * 1024 + 37;
  constexpr std::size_t kThreads = 4;
  this->SetUpWorld(QuantizedInputKind::kUniform, kSize, 300);
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
                    {.range = {t * 1024, end}}, words);
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(rows, expected);
}

}  // namespace
}  // namespace halfspace::testing

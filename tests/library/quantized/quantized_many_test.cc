// Many queries at once, and parts of the world, by quantized bounds alone and
// refined.
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <thread>
#include <vector>

#include "halfspace/reject_many.h"
#include "tests/library/quantized/quantized_answers.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/many_canaries.h"
#include "tests/library/support/quantized_rows.h"

namespace halfspace::testing {
namespace {

class QuantizedManyTest : public ::testing::TestWithParam<QuantizedRow> {
 protected:
  void SetUpWorld(QuantizedInputKind kind, std::size_t size,
                  std::size_t queries) {
    const auto values =
        MakeQuantizedValues(GetParam().layout, kind, size, random_);
    all_ = GetParam().make(values);
    queries_ = QuantizedQueries(GetParam(), values, queries, random_);
    of_quantized_.clear();
    for (std::size_t q = 0; q < queries; ++q) {
      of_quantized_.push_back(
          AnswerByMask(all_->quantized(), queries_.Some(q, 1), targets_[0]));
    }
  }

  // The answers to one query at a time, as quantized_differential_test.cc
  // proves them, are those to all.
  void Check(std::size_t count, const Range& range = {}) {
    const AnyWorld floats = all_->floats();
    SCOPED_TRACE(::testing::Message()
                 << floats.size() << " objects, range " << range.begin << ", "
                 << range.end << ", " << count << " queries");
    const AnyQueries some = queries_.Some(0, count);
    answers_.AssignReference(floats, some, range);
    ASSERT_TRUE(AnswersManyEverywhere(answers_, all_->world(), some, targets_));
    answers_.Assign(floats.size(), count, range,
                    [&](std::size_t q, std::size_t i) {
                      const auto mask = of_quantized_[q].reject_mask();
                      return (mask[i / 64] >> (i % 64) & 1) != 0;
                    });
    ASSERT_TRUE(
        AnswersManyEverywhere(answers_, all_->quantized(), some, targets_));
  }

  std::unique_ptr<AnyQuantized> all_;
  QuantizedQueries queries_;
  std::vector<Target> targets_ = TargetsUnderTest();

 private:
  Random random_{37};
  std::vector<Answer> of_quantized_;
  ManyAnswers answers_;
};

// Around the queries that share a load (2 or 4), the rows of a tile (16), and
// the queries that are encoded at a time (256).
TEST_P(QuantizedManyTest, EveryNumberOfQueries) {
  SetUpWorld(QuantizedInputKind::kAnyValues, 2 * 64 + 37, 600);
  for (std::size_t queries : {0, 1, 2, 3, 4, 5, 9, 16, 17, 256, 257, 600}) {
    Check(queries);
    if (HasFatalFailure()) return;
  }
}

TEST_P(QuantizedManyTest, WorldsOfSeveralTiles) {
  for (QuantizedInputKind kind :
       {QuantizedInputKind::kUniform, QuantizedInputKind::kClustered}) {
    SetUpWorld(kind, 2 * 4096 + 64 + 37, 19);
    Check(19);
    if (HasFatalFailure()) return;
  }
}

TEST_P(QuantizedManyTest, Ranges) {
  constexpr std::size_t kSize = 4096 + 3 * 64 + 37;
  SetUpWorld(QuantizedInputKind::kUniform, kSize, 7);
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
    Check(7, range);
    if (HasFatalFailure()) return;
    Answer exact;
    exact.AssignReference(all_->floats(), queries_.Some(0, 1), range);
    ASSERT_TRUE(AnswersEverywhere(exact, all_->world(), queries_.Some(0, 1),
                                  targets_, range));
  }
}

// Threads share one world, one set of queries and one output.
TEST_P(QuantizedManyTest, ThreadsShareTheWork) {
  constexpr std::size_t kSize = 4 * 1024 + 37;
  constexpr std::size_t kThreads = 4;
  SetUpWorld(QuantizedInputKind::kUniform, kSize, 300);
  const AnyWorld world = all_->world();
  const AnyQueries queries = queries_.Some(0, 300);
  const std::size_t words = MaskWords(kSize);
  std::vector<std::uint64_t> expected(words * 300);
  detail::SurvivorMasks(world.Asked(queries), expected, {}, 0);
  std::vector<std::uint64_t> rows(expected.size());
  std::vector<std::thread> threads;
  for (std::size_t t = 0; t < kThreads; ++t) {
    const std::size_t end = t + 1 == kThreads ? kSize : (t + 1) * 1024;
    threads.emplace_back([&, t, end] {
      detail::SurvivorMasks(world.Asked(queries),
                            std::span(rows).subspan(t * 1024 / 64),
                            {.range = {t * 1024, end}}, words);
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(rows, expected);
}

INSTANTIATE_TEST_SUITE_P(, QuantizedManyTest,
                         ::testing::ValuesIn(QuantizedRows()),
                         QuantizedRowName);

}  // namespace
}  // namespace halfspace::testing

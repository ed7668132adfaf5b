// Outputs of the calls for many queries that notice a write past their end.
#ifndef HALFSPACE_TESTS_LIBRARY_SUPPORT_MANY_CANARIES_H_
#define HALFSPACE_TESTS_LIBRARY_SUPPORT_MANY_CANARIES_H_

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <span>

#include "tests/library/support/canaries.h"
#include "tests/library/support/many_answers.h"

namespace halfspace::testing {

class CanariedManyOutputs {
 public:
  ManyOutputs For(const ManyAnswers& answers) {
    words_ = answers.reject_rows().size();
    pairs_ = answers.pairs();
    queries_ = answers.answers().size();
    return {rows_.Reset(words_), query_indices_.Reset(pairs_),
            object_indices_.Reset(pairs_), counts_.Reset(queries_)};
  }

  bool Intact() const {
    return rows_.IntactBut(words_) && query_indices_.IntactBut(pairs_) &&
           object_indices_.IntactBut(pairs_) && counts_.IntactBut(queries_);
  }

 private:
  Canaried<std::uint64_t> rows_;
  Canaried<std::uint32_t> query_indices_;
  Canaried<std::uint32_t> object_indices_;
  Canaried<std::size_t> counts_;
  std::size_t words_ = 0;
  std::size_t pairs_ = 0;
  std::size_t queries_ = 0;
};

// AnswersMany() between canaries, with every schedule on every given target.
inline ::testing::AssertionResult AnswersManyEverywhere(
    const ManyAnswers& answers, const AnyWorld& world,
    const AnyQueries& queries, std::span<const Target> targets) {
  thread_local CanariedManyOutputs outputs;
  for (Target target : targets) {
    for (Schedule schedule : kSchedules) {
      const Options options{
          .schedule = schedule, .target = target, .range = answers.range()};
      auto result =
          AnswersMany(answers, world, queries, options, outputs.For(answers));
      if (!result) return result;
      if (!outputs.Intact()) {
        return internal::Fail("a call", options) << "wrote past its output";
      }
    }
  }
  return ::testing::AssertionSuccess();
}
template <typename World>
::testing::AssertionResult AnswersManyEverywhere(
    const ManyAnswers& answers, const World& world,
    std::span<const typename World::Query> queries,
    std::span<const Target> targets) {
  return AnswersManyEverywhere(answers, AnyWorld(world), AnyQueries(queries),
                               targets);
}

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_SUPPORT_MANY_CANARIES_H_

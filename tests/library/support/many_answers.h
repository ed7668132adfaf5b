// The answers of a world to many queries, and the check that the calls of
// reject_many.h give exactly those.
#ifndef HALFSPACE_TESTS_LIBRARY_SUPPORT_MANY_ANSWERS_H_
#define HALFSPACE_TESTS_LIBRARY_SUPPORT_MANY_ANSWERS_H_

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "halfspace/reject_many.h"
#include "halfspace/targets.h"
#include "tests/library/support/answers.h"
#include "tests/library/support/covered_tiles.h"

namespace halfspace::testing {

// One answer for each query, and their masks as rows.
class ManyAnswers {
 public:
  // rejects(q, i) says whether query q rejects object i.
  template <typename Rejects>
  void Assign(std::size_t objects, std::size_t queries, const Range& range,
              Rejects rejects) {
    objects_ = objects;
    range_ = range;
    reject_rows_.clear();
    survivor_rows_.clear();
    pairs_ = 0;
    answers_.resize(queries);
    for (std::size_t q = 0; q < queries; ++q) {
      Answer& answer = answers_[q];
      answer.Assign(objects, range,
                    [&](std::size_t i) { return rejects(q, i); });
      Append(answer.reject_mask(), reject_rows_);
      Append(answer.survivor_mask(), survivor_rows_);
      pairs_ += answer.survivors().size();
    }
  }

  // The oracle's answers, query by query.
  void AssignReference(const AnyWorld& world, const AnyQueries& queries,
                       const Range& range = {}) {
    const std::size_t words = MaskWords(world.size());
    std::vector<std::uint64_t> rows(queries.count * words);
    for (std::size_t q = 0; q < queries.count; ++q) {
      world.ReferenceMask(world.One(queries, q),
                          std::span(rows).subspan(q * words, words));
    }
    Assign(world.size(), queries.count, range,
           [&](std::size_t q, std::size_t i) {
             return (rows[q * words + i / 64] >> (i % 64) & 1) != 0;
           });
  }
  template <typename View>
  void AssignReference(const View& view,
                       std::span<const typename View::Query> queries,
                       const Range& range = {}) {
    AssignReference(AnyWorld(view), AnyQueries(queries), range);
  }

  std::size_t objects() const { return objects_; }
  const Range& range() const { return range_; }
  std::span<const Answer> answers() const { return answers_; }
  std::span<const std::uint64_t> reject_rows() const { return reject_rows_; }
  std::span<const std::uint64_t> survivor_rows() const {
    return survivor_rows_;
  }
  std::size_t pairs() const { return pairs_; }

 private:
  static void Append(std::span<const std::uint64_t> mask,
                     std::vector<std::uint64_t>& rows) {
    rows.insert(rows.end(), mask.begin(), mask.end());
  }

  std::size_t objects_ = 0;
  Range range_;
  std::vector<Answer> answers_;
  std::vector<std::uint64_t> reject_rows_;
  std::vector<std::uint64_t> survivor_rows_;
  std::size_t pairs_ = 0;
};

// Where a check may write: exactly as much as the answers need, the rows at
// first unwritten.
struct ManyOutputs {
  std::span<std::uint64_t> rows;
  std::span<std::uint32_t> query_indices;
  std::span<std::uint32_t> object_indices;
  std::span<std::size_t> counts;
};

namespace internal {

// Every pair once, those of one query in ascending order.
inline ::testing::AssertionResult PairsAre(const ManyAnswers& answers,
                                           const Options& options,
                                           const ManyOutputs& outputs) {
  std::vector<std::size_t> seen(answers.answers().size());
  for (std::size_t j = 0; j < answers.pairs(); ++j) {
    const std::uint32_t q = outputs.query_indices[j];
    const std::uint32_t object = outputs.object_indices[j];
    if (q >= seen.size()) {
      return Fail("SurvivorPairs", options) << "pair " << j << ": query " << q;
    }
    const auto survivors = answers.answers()[q].survivors();
    if (seen[q] == survivors.size() || survivors[seen[q]] != object) {
      return Fail("SurvivorPairs", options)
             << "pair " << j << ": object " << object << " as number "
             << seen[q] << " of query " << q;
    }
    ++seen[q];
  }
  return ::testing::AssertionSuccess();
}

}  // namespace internal

// All five calls give `answers`.
inline ::testing::AssertionResult AnswersMany(const ManyAnswers& answers,
                                              const AnyWorld& world,
                                              const AnyQueries& queries,
                                              const Options& options,
                                              ManyOutputs outputs) {
  using internal::Fail;
  using internal::FailElement;
  using internal::Same;
  const std::span<const std::uint64_t> rows = outputs.rows;

  detail::RejectMasks(world.Asked(queries), outputs.rows, options, 0);
  if (!Same(answers.reject_rows(), rows)) {
    return FailElement("RejectMasks", options, answers.reject_rows(), rows);
  }

  detail::SurvivorMasks(world.Asked(queries), outputs.rows, options, 0);
  if (!Same(answers.survivor_rows(), rows)) {
    return FailElement("SurvivorMasks", options, answers.survivor_rows(), rows);
  }

  if (world.HasUnchecked() && options.schedule == Schedule::kAuto &&
      options.range.begin == 0 && options.range.end >= world.size()) {
    std::fill(outputs.rows.begin(), outputs.rows.end(), kUnwritten);
    world.UncheckedMasks(queries, outputs.rows, options.target);
    if (!Same(answers.survivor_rows(), rows)) {
      return FailElement("Kernels", options, answers.survivor_rows(), rows);
    }
  }

  const std::size_t pairs =
      detail::SurvivorPairs(world.Asked(queries), outputs.query_indices,
                            outputs.object_indices, options, 0);
  if (pairs != answers.pairs()) {
    return Fail("SurvivorPairs", options)
           << "expected " << answers.pairs() << ", got " << pairs;
  }
  if (auto right = internal::PairsAre(answers, options, outputs); !right) {
    return right;
  }

  detail::SurvivorCounts(world.Asked(queries), outputs.counts, options);
  for (std::size_t q = 0; q < queries.count; ++q) {
    if (outputs.counts[q] != answers.answers()[q].survivors().size()) {
      return Fail("SurvivorCounts", options)
             << "query " << q << ": expected "
             << answers.answers()[q].survivors().size() << ", got "
             << outputs.counts[q];
    }
  }

  CoveredTiles covered(answers.survivor_rows(), queries.count,
                       answers.objects(), answers.range());
  const auto add = [&](const SurvivorTile& tile) { covered.Add(tile); };
  detail::Callback call{add};
  detail::ForEachTile(world.Asked(queries), &decltype(call)::Run, &call,
                      options);
  if (const auto wrong = covered.WhatIsWrong(); !wrong.empty()) {
    return Fail("ForEachTile", options) << wrong;
  }
  return ::testing::AssertionSuccess();
}

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_SUPPORT_MANY_ANSWERS_H_

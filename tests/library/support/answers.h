// The answers of a world to queries, and the check that all calls of reject.h
// and reject_many.h give exactly those and write nothing else.
#ifndef HALFSPACE_TESTS_LIBRARY_SUPPORT_ANSWERS_H_
#define HALFSPACE_TESTS_LIBRARY_SUPPORT_ANSWERS_H_

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <ios>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "halfspace/reject_many.h"
#include "halfspace/targets.h"
#include "tests/library/support/any_world.h"
#include "tests/library/support/canaries.h"
#include "tests/library/support/target_that_runs.h"

namespace halfspace::testing {

inline constexpr std::array kSchedules = {Schedule::kAuto, Schedule::kFlat,
                                          Schedule::kStaged,
                                          Schedule::kStagedByAxis};

// Of one query or of several: masks of a range, one row after another, and
// lists.
class Answers {
 public:
  Answers() = default;

  // rejects(q, i) says whether query q rejects object i.
  template <typename Rejects>
  Answers(std::size_t objects, std::size_t queries, const Range& range,
          Rejects rejects)
      : objects_(objects), range_(range), ends_(queries) {
    const std::size_t begin = std::min(range.begin, objects);
    const std::size_t end = std::min(range.end, objects);
    const std::size_t words = MaskWords(end - begin);
    rejected_.assign(queries * words, ~std::uint64_t{0});
    survived_.assign(queries * words, 0);
    for (std::size_t q = 0; q < queries; ++q) {
      for (std::size_t i = begin; i < end; ++i) {
        if (rejects(q, i)) continue;
        const std::size_t at = i - begin;
        const std::uint64_t bit = std::uint64_t{1} << (at % 64);
        rejected_[q * words + at / 64] &= ~bit;
        survived_[q * words + at / 64] |= bit;
        survivors_.push_back(static_cast<std::uint32_t>(i));
      }
      ends_[q] = survivors_.size();
    }
  }

  // Of one query: rejects(i).
  template <typename Rejects>
  Answers(std::size_t objects, Rejects rejects)
      : Answers(objects, 1, {},
                [&](std::size_t, std::size_t i) { return rejects(i); }) {}

  // The oracle's.
  static Answers OfReference(const AnyWorld& world, const AnyQueries& queries,
                             const Range& range = {}) {
    const std::size_t words = MaskWords(world.size());
    std::vector<std::uint64_t> rows(queries.count * words);
    for (std::size_t q = 0; q < queries.count; ++q) {
      world.ReferenceMask(world.One(queries, q),
                          std::span(rows).subspan(q * words, words));
    }
    return {world.size(), queries.count, range, rows};
  }

  // Those of one call on one target.
  static Answers OfCall(const AnyWorld& world, const AnyQueries& queries,
                        Target target, const Range& range = {}) {
    std::vector<std::uint64_t> rows(queries.count * MaskWords(world.size()));
    detail::RejectMasks(world.Asked(queries), rows,
                        {.schedule = Schedule::kFlat, .target = target}, 0);
    return {world.size(), queries.count, range, rows};
  }

  std::size_t objects() const { return objects_; }
  std::size_t queries() const { return ends_.size(); }
  const Range& range() const { return range_; }
  std::span<const std::uint64_t> rejected() const { return rejected_; }
  std::span<const std::uint64_t> survived() const { return survived_; }
  // Of all queries, one after another, or of one.
  std::span<const std::uint32_t> survivors() const { return survivors_; }
  std::span<const std::uint32_t> survivors(std::size_t q) const {
    const std::size_t begin = q == 0 ? 0 : ends_[q - 1];
    return survivors().subspan(begin, ends_[q] - begin);
  }

 private:
  // By masks of the whole world.
  Answers(std::size_t objects, std::size_t queries, const Range& range,
          const std::vector<std::uint64_t>& rows)
      : Answers(objects, queries, range, [&](std::size_t q, std::size_t i) {
          const std::size_t row = q * MaskWords(objects);
          return (rows[row + i / 64] >> (i % 64) & 1) != 0;
        }) {}

  std::size_t objects_ = 0;
  Range range_;
  std::vector<std::uint64_t> rejected_;
  std::vector<std::uint64_t> survived_;
  std::vector<std::uint32_t> survivors_;
  std::vector<std::size_t> ends_;  // of each query in the list
};

// Where calls write: as much as the answers need, or more.
struct Outputs {
  std::span<std::uint64_t> words;
  std::span<std::uint32_t> objects;
  std::span<std::uint32_t> queries;  // of pairs
  std::span<std::size_t> counts;
};

// The first difference that a call makes.
class Differences {
 public:
  explicit Differences(const Options& options) : options_(options) {}

  ::testing::AssertionResult Say(std::string_view call) {
    return ::testing::AssertionFailure()
           << call << " on " << options_.target.name() << ", schedule "
           << static_cast<int>(options_.schedule) << ": ";
  }
  template <typename T>
  void Find(std::string_view call, std::span<const T> expected,
            std::span<const T> given) {
    const auto [e, g] =
        std::mismatch(expected.begin(), expected.end(), given.begin());
    if (!first_ || e == expected.end()) return;
    first_ = Say(call) << "element " << e - expected.begin() << " of "
                       << expected.size() << ": expected " << std::hex << *e
                       << ", got " << *g;
  }
  void Find(std::string_view call, std::size_t expected, std::size_t given) {
    Find<std::size_t>(call, {&expected, 1}, {&given, 1});
  }
  void Add(std::string_view call, const std::string& wrong) {
    if (first_ && !wrong.empty()) first_ = Say(call) << wrong;
  }
  const ::testing::AssertionResult& first() const { return first_; }

 private:
  const Options& options_;
  ::testing::AssertionResult first_ = ::testing::AssertionSuccess();
};

namespace internal {

// Before a call, so that what it writes shows.
template <typename T>
std::span<T> Unwritten(std::span<T> output) {
  std::fill(output.begin(), output.end(), Canaried<T>::kCanary);
  return output;
}

inline void CompareCallsOfOne(const Answers& answers, const AnyWorld& world,
                              const AnyQueries& query, const Options& options,
                              const Outputs& outputs, Differences& compare) {
  const auto asked = [&] { return world.Asked(query); };
  const Target target =
      options.target == Target() ? ChosenTarget() : options.target;
  if (const Target ran = TargetThatRuns(world, query, options); ran != target) {
    compare.Add("CountSurvivors", "ran on " + std::string(ran.name()));
  }
  detail::RejectMask(asked(), Unwritten(outputs.words), options);
  compare.Find<std::uint64_t>("RejectMask", answers.rejected(), outputs.words);
  detail::SurvivorMask(asked(), outputs.words, options);
  compare.Find<std::uint64_t>("SurvivorMask", answers.survived(),
                              outputs.words);

  const auto all = answers.survivors();
  compare.Find("Survivors", all.size(),
               detail::Survivors(asked(), outputs.objects, options, 0));
  compare.Find<std::uint32_t>("Survivors", all, outputs.objects);
  compare.Find("CountSurvivors", all.size(),
               detail::CountSurvivors(asked(), options));
  compare.Find("AnySurvivor", all.empty() ? detail::kNoSurvivor : all.front(),
               detail::AnySurvivor(asked(), options));
  std::vector<std::uint32_t> seen;
  const auto add = [&](Span<const std::uint32_t> some) {
    seen.insert(seen.end(), some.begin(), some.end());
  };
  detail::Callback call{add};
  detail::ForEachSurvivor(asked(), &decltype(call)::Run, &call, options);
  compare.Find("ForEachSurvivor", all.size(), seen.size());
  seen.resize(all.size());
  compare.Find<std::uint32_t>("ForEachSurvivor", all, seen);
}

// Pairs come in any order, but those of one query in ascending order.
inline std::string WhatIsWrong(const Answers& answers, const Outputs& pairs) {
  std::vector<std::size_t> seen(answers.queries());
  for (std::size_t j = 0; j < answers.survivors().size(); ++j) {
    const std::uint32_t q = pairs.queries[j];
    if (q >= seen.size() || seen[q] == answers.survivors(q).size() ||
        answers.survivors(q)[seen[q]++] != pairs.objects[j]) {
      return "pair " + std::to_string(j) + " is query " + std::to_string(q) +
             ", object " + std::to_string(pairs.objects[j]);
    }
  }
  return {};
}

// Each word of the masks is in one tile, and tiles are parts of the range.
inline void CompareTiles(const Answers& answers, const AnyWorld& world,
                         const AnyQueries& queries, const Options& options,
                         Differences& compare) {
  const std::size_t begin = std::min(answers.range().begin, world.size());
  const std::size_t end = std::min(answers.range().end, world.size());
  const std::size_t words = MaskWords(end - begin);
  std::vector<std::uint64_t> rows(answers.survived().size());
  std::vector<int> times(rows.size());
  const auto add = [&](const SurvivorTile& tile) {
    const std::size_t first = tile.first_object - begin;
    const bool is_part =
        tile.queries > 0 && tile.objects > 0 &&
        tile.first_query + tile.queries <= queries.count &&
        tile.first_object >= begin && first % 64 == 0 &&
        tile.first_object + tile.objects <= end &&
        (tile.objects % 64 == 0 || tile.first_object + tile.objects == end);
    if (!is_part) return compare.Add("ForEachTile", "a tile out of place");
    for (std::size_t q = 0; q < tile.queries; ++q) {
      const std::span<const std::uint64_t> row = tile.Row(q);
      const std::size_t at = (tile.first_query + q) * words + first / 64;
      compare.Find("a row of ForEachTile", MaskWords(tile.objects), row.size());
      for (std::size_t w = 0; w < MaskWords(tile.objects); ++w) {
        rows[at + w] = row[w];
        ++times[at + w];
      }
    }
  };
  detail::Callback call{add};
  detail::ForEachTile(world.Asked(queries), &decltype(call)::Run, &call,
                      options);
  compare.Find<std::uint64_t>("ForEachTile", answers.survived(), rows);
  compare.Find<int>("ForEachTile, tiles of a word",
                    std::vector<int>(rows.size(), 1), times);
}

}  // namespace internal

// All calls for several queries give `answers`; and those for one query, if
// there is one.
inline ::testing::AssertionResult CallsAnswer(const Answers& answers,
                                              const AnyWorld& world,
                                              const AnyQueries& queries,
                                              const Options& options,
                                              const Outputs& outputs) {
  using internal::Unwritten;
  Differences compare(options);
  if (queries.count == 1) {
    internal::CompareCallsOfOne(answers, world, queries, options, outputs,
                                compare);
  }
  const auto asked = [&] { return world.Asked(queries); };
  detail::RejectMasks(asked(), Unwritten(outputs.words), options, 0);
  compare.Find<std::uint64_t>("RejectMasks", answers.rejected(), outputs.words);
  detail::SurvivorMasks(asked(), outputs.words, options, 0);
  compare.Find<std::uint64_t>("SurvivorMasks", answers.survived(),
                              outputs.words);
  if (world.HasUnchecked() && options.schedule == Schedule::kAuto &&
      options.range.begin == 0 && options.range.end >= world.size()) {
    for (bool is_one : {false, true}) {
      if (is_one && queries.count != 1) continue;
      world.UncheckedMasks(queries, is_one, Unwritten(outputs.words),
                           options.target);
      compare.Find<std::uint64_t>("Kernels", answers.survived(), outputs.words);
    }
  }

  const std::size_t pairs =
      detail::SurvivorPairs(asked(), Unwritten(outputs.queries),
                            Unwritten(outputs.objects), options, 0);
  compare.Find("SurvivorPairs", answers.survivors().size(), pairs);
  compare.Add("SurvivorPairs", internal::WhatIsWrong(answers, outputs));
  detail::SurvivorCounts(asked(), outputs.counts, options);
  for (std::size_t q = 0; q < queries.count; ++q) {
    compare.Find("SurvivorCounts", answers.survivors(q).size(),
                 outputs.counts[q]);
  }
  internal::CompareTiles(answers, world, queries, options, compare);
  return compare.first();
}

// Outputs with more room than is needed, that notice a write into it and around
// it.
class CanariedOutputs {
 public:
  Outputs For(const Answers& answers) {
    constexpr std::size_t kMore = 5;
    needed_words_ = answers.rejected().size();
    needed_pairs_ = answers.survivors().size();
    queries_count_ = answers.queries();
    return {words_.Reset(needed_words_ + kMore),
            objects_.Reset(needed_pairs_ + kMore),
            queries_.Reset(needed_pairs_ + kMore),
            counts_.Reset(queries_count_ + kMore)};
  }
  bool Intact() const {
    return words_.IntactBut(needed_words_) &&
           objects_.IntactBut(needed_pairs_) &&
           queries_.IntactBut(needed_pairs_) &&
           counts_.IntactBut(queries_count_);
  }

 private:
  std::size_t needed_words_ = 0;
  std::size_t needed_pairs_ = 0;
  std::size_t queries_count_ = 0;
  Canaried<std::uint64_t> words_;
  Canaried<std::uint32_t> objects_;
  Canaried<std::uint32_t> queries_;
  Canaried<std::size_t> counts_;
};

// CallsAnswer() between canaries, with these schedules on every given target.
inline ::testing::AssertionResult AnswersEverywhere(
    const Answers& answers, const AnyWorld& world, const AnyQueries& queries,
    std::span<const Target> targets,
    std::span<const Schedule> schedules = kSchedules) {
  thread_local CanariedOutputs outputs;
  for (Target target : targets) {
    for (Schedule schedule : schedules) {
      const Options options{
          .schedule = schedule, .target = target, .range = answers.range()};
      auto result =
          CallsAnswer(answers, world, queries, options, outputs.For(answers));
      if (!result) return result;
      if (!outputs.Intact()) {
        return Differences(options).Say("a call") << "wrote past its output";
      }
    }
  }
  return ::testing::AssertionSuccess();
}

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_SUPPORT_ANSWERS_H_

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

  // The oracle's.
  static Answers OfReference(const AnyWorld& world, const AnyQueries& queries,
                             const Range& range = {});
  // Those of one call on one target.
  static Answers OfCall(const AnyWorld& world, const AnyQueries& queries,
                        Target target, const Range& range = {});

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

// All calls for several queries give `answers`; and those for one query, if
// there is one.
::testing::AssertionResult CallsAnswer(const Answers& answers,
                                       const AnyWorld& world,
                                       const AnyQueries& queries,
                                       const Options& options,
                                       const Outputs& outputs);

// CallsAnswer() between canaries, with these schedules on every given target.
::testing::AssertionResult AnswersEverywhere(
    const Answers& answers, const AnyWorld& world, const AnyQueries& queries,
    std::span<const Target> targets,
    std::span<const Schedule> schedules = kSchedules);

// Quantized bounds alone keep what floats keep, and all calls agree on what
// that is; refined, they are the floats' answers. Everywhere.
::testing::AssertionResult QuantizedAnswersEverywhere(
    const AnyWorld& quantized, const AnyWorld& refined, const Answers& exact,
    const AnyQueries& queries, std::span<const Target> targets);

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_SUPPORT_ANSWERS_H_

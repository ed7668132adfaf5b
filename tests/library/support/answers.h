// The answer of a world to a query in all its forms, and the check that the
// calls of reject.h give exactly that.
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

#include "halfspace/reject.h"
#include "halfspace/targets.h"
#include "tests/library/support/target_that_runs.h"
#include "tests/library/support/unchecked.h"
#include "tests/reference/reference.h"

namespace halfspace::testing {

inline constexpr std::array kSchedules = {Schedule::kAuto, Schedule::kFlat,
                                          Schedule::kStaged,
                                          Schedule::kStagedByAxis};

// What masks hold before a call, to show what it writes.
inline constexpr std::uint64_t kUnwritten = 0xc5c5c5c5c5c5c5c5u;

// One answer, as a reject mask, a survivor mask and a list.
class Answer {
 public:
  Answer() = default;

  // rejects(i) says whether object i is rejected.
  template <typename Rejects>
  Answer(std::size_t objects, Rejects rejects) {
    Assign(objects, {}, rejects);
  }

  template <typename Rejects>
  void Assign(std::size_t objects, const Range& range, Rejects rejects) {
    const std::size_t begin = std::min(range.begin, objects);
    const std::size_t end = std::min(range.end, objects);
    const std::size_t words = MaskWords(end - begin);
    reject_mask_.assign(words, ~std::uint64_t{0});
    survivor_mask_.assign(words, 0);
    survivors_.clear();
    for (std::size_t i = begin; i < end; ++i) {
      if (rejects(i)) continue;
      const std::size_t at = i - begin;
      const std::uint64_t bit = std::uint64_t{1} << (at % 64);
      reject_mask_[at / 64] &= ~bit;
      survivor_mask_[at / 64] |= bit;
      survivors_.push_back(static_cast<std::uint32_t>(i));
    }
  }

  // The oracle's answer.
  template <typename View>
  void AssignReference(const View& view, const typename View::Query& query,
                       const Range& range = {}) {
    Assign(view.size, range,
           [&](std::size_t i) { return reference::Rejects(view, query, i); });
  }

  std::span<const std::uint64_t> reject_mask() const { return reject_mask_; }
  std::span<const std::uint64_t> survivor_mask() const {
    return survivor_mask_;
  }
  std::span<const std::uint32_t> survivors() const { return survivors_; }

 private:
  std::vector<std::uint64_t> reject_mask_;
  std::vector<std::uint64_t> survivor_mask_;
  std::vector<std::uint32_t> survivors_;
};

template <typename View>
Answer ReferenceAnswer(const View& view, const typename View::Query& query) {
  Answer answer;
  answer.AssignReference(view, query);
  return answer;
}

// Where a check may write: exactly as much as the answer needs, the mask at
// first unwritten.
struct Outputs {
  std::span<std::uint64_t> mask;
  std::span<std::uint32_t> indices;
};

namespace internal {

inline ::testing::AssertionResult Fail(std::string_view call,
                                       const Options& options) {
  return ::testing::AssertionFailure()
         << call << " on " << options.target.name() << ", schedule "
         << static_cast<int>(options.schedule) << ": ";
}

template <typename T>
::testing::AssertionResult FailElement(std::string_view call,
                                       const Options& options,
                                       std::span<const T> expected,
                                       std::span<const T> given) {
  const auto [e, g] =
      std::mismatch(expected.begin(), expected.end(), given.begin());
  return Fail(call, options)
         << "element " << e - expected.begin() << " of " << expected.size()
         << ": expected " << std::hex << *e << ", got " << *g;
}

template <typename T>
bool Same(std::span<const T> expected, std::span<const T> given) {
  return std::equal(expected.begin(), expected.end(), given.begin());
}

}  // namespace internal

// All calls give `answer`, and run on the target of `options`, or on the
// chosen one.
template <typename AnyWorld>
::testing::AssertionResult Answers(const Answer& answer, const AnyWorld& world,
                                   const typename AnyWorld::Query& query,
                                   const Options& options, Outputs outputs) {
  using internal::Fail;
  using internal::FailElement;
  using internal::Same;
  const Target expected =
      options.target == Target() ? ChosenTarget() : options.target;
  if (const Target ran = TargetThatRuns(world, query, options);
      ran != expected) {
    return Fail("CountSurvivors", options) << "ran on " << ran.name();
  }

  RejectMask(world, query, outputs.mask, options);
  std::span<const std::uint64_t> mask = outputs.mask;
  if (!Same(answer.reject_mask(), mask)) {
    return FailElement("RejectMask", options, answer.reject_mask(), mask);
  }

  SurvivorMask(world, query, outputs.mask, options);
  if (!Same(answer.survivor_mask(), mask)) {
    return FailElement("SurvivorMask", options, answer.survivor_mask(), mask);
  }

  const std::size_t count = answer.survivors().size();
  std::size_t counted = Survivors(world, query, outputs.indices, options);
  std::span<const std::uint32_t> indices = outputs.indices;
  if (counted != count) {
    return Fail("Survivors", options)
           << "expected " << count << ", got " << counted;
  }
  if (!Same(answer.survivors(), indices)) {
    return FailElement("Survivors", options, answer.survivors(), indices);
  }

  counted = CountSurvivors(world, query, options);
  if (counted != count) {
    return Fail("CountSurvivors", options)
           << "expected " << count << ", got " << counted;
  }

  const std::optional<std::size_t> first = AnySurvivor(world, query, options);
  if (first.has_value() != (count != 0) ||
      (first && *first != answer.survivors().front())) {
    return Fail("AnySurvivor", options)
           << "got " << (first ? std::to_string(*first) : "none") << " of "
           << count << " survivors";
  }

  std::fill(outputs.indices.begin(), outputs.indices.end(), 0);
  counted = 0;
  ForEachSurvivor(
      world, query,
      [&](Span<const std::uint32_t> some) {
        for (std::uint32_t i : some) {
          if (counted < outputs.indices.size()) outputs.indices[counted] = i;
          ++counted;
        }
      },
      options);
  if (counted != count || !Same(answer.survivors(), indices)) {
    return Fail("ForEachSurvivor", options)
           << "expected " << count << " survivors, got " << counted
           << ", or others";
  }

  if constexpr (HasKernels<AnyWorld>) {
    if (options.schedule == Schedule::kAuto && options.range.begin == 0 &&
        options.range.end >= world.size) {
      std::fill(outputs.mask.begin(), outputs.mask.end(), kUnwritten);
      SurvivorMaskUnchecked(world, query, outputs.mask, options.target);
      if (!Same(answer.survivor_mask(), mask)) {
        return FailElement("Kernels", options, answer.survivor_mask(), mask);
      }
    }
  }
  return ::testing::AssertionSuccess();
}

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_SUPPORT_ANSWERS_H_

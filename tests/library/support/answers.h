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
#include "tests/library/support/any_world.h"
#include "tests/library/support/target_that_runs.h"

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
  void AssignReference(const AnyWorld& world, const AnyQueries& query,
                       const Range& range = {}) {
    std::vector<std::uint64_t> mask(MaskWords(world.size()));
    world.ReferenceMask(query, mask);
    Assign(world.size(), range,
           [&](std::size_t i) { return (mask[i / 64] >> (i % 64) & 1) != 0; });
  }
  template <typename View>
  void AssignReference(const View& view, const typename View::Query& query,
                       const Range& range = {}) {
    AssignReference(AnyWorld(view), {&query, 1}, range);
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
inline ::testing::AssertionResult Answers(const Answer& answer,
                                          const AnyWorld& world,
                                          const AnyQueries& query,
                                          const Options& options,
                                          Outputs outputs) {
  using internal::Fail;
  using internal::FailElement;
  using internal::Same;
  const Target expected =
      options.target == Target() ? ChosenTarget() : options.target;
  if (const Target ran = TargetThatRuns(world, query, options);
      ran != expected) {
    return Fail("CountSurvivors", options) << "ran on " << ran.name();
  }

  detail::RejectMask(world.Asked(query), outputs.mask, options);
  std::span<const std::uint64_t> mask = outputs.mask;
  if (!Same(answer.reject_mask(), mask)) {
    return FailElement("RejectMask", options, answer.reject_mask(), mask);
  }

  detail::SurvivorMask(world.Asked(query), outputs.mask, options);
  if (!Same(answer.survivor_mask(), mask)) {
    return FailElement("SurvivorMask", options, answer.survivor_mask(), mask);
  }

  const std::size_t count = answer.survivors().size();
  std::size_t counted =
      detail::Survivors(world.Asked(query), outputs.indices, options, 0);
  std::span<const std::uint32_t> indices = outputs.indices;
  if (counted != count) {
    return Fail("Survivors", options)
           << "expected " << count << ", got " << counted;
  }
  if (!Same(answer.survivors(), indices)) {
    return FailElement("Survivors", options, answer.survivors(), indices);
  }

  counted = detail::CountSurvivors(world.Asked(query), options);
  if (counted != count) {
    return Fail("CountSurvivors", options)
           << "expected " << count << ", got " << counted;
  }

  const std::size_t first = detail::AnySurvivor(world.Asked(query), options);
  if (first !=
      (count == 0 ? detail::kNoSurvivor : answer.survivors().front())) {
    return Fail("AnySurvivor", options)
           << "got " << first << " of " << count << " survivors";
  }

  std::fill(outputs.indices.begin(), outputs.indices.end(), 0);
  counted = 0;
  const auto add = [&](Span<const std::uint32_t> some) {
    for (std::uint32_t i : some) {
      if (counted < outputs.indices.size()) outputs.indices[counted] = i;
      ++counted;
    }
  };
  detail::Callback call{add};
  detail::ForEachSurvivor(world.Asked(query), &decltype(call)::Run, &call,
                          options);
  if (counted != count || !Same(answer.survivors(), indices)) {
    return Fail("ForEachSurvivor", options)
           << "expected " << count << " survivors, got " << counted
           << ", or others";
  }

  if (world.HasUnchecked() && options.schedule == Schedule::kAuto &&
      options.range.begin == 0 && options.range.end >= world.size()) {
    std::fill(outputs.mask.begin(), outputs.mask.end(), kUnwritten);
    world.UncheckedMask(query, outputs.mask, options.target);
    if (!Same(answer.survivor_mask(), mask)) {
      return FailElement("Kernels", options, answer.survivor_mask(), mask);
    }
  }
  return ::testing::AssertionSuccess();
}
template <typename World>
::testing::AssertionResult Answers(const Answer& answer, const World& world,
                                   const typename World::Query& query,
                                   const Options& options, Outputs outputs) {
  return Answers(answer, AnyWorld(world), {&query, 1}, options, outputs);
}

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_SUPPORT_ANSWERS_H_

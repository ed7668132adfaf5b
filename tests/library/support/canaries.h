// Outputs that notice a write past their end.
#ifndef HALFSPACE_TESTS_LIBRARY_SUPPORT_CANARIES_H_
#define HALFSPACE_TESTS_LIBRARY_SUPPORT_CANARIES_H_

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "tests/library/support/answers.h"

namespace halfspace::testing {

// `size` elements between canaries that can be looked at again.
template <typename T>
class Canaried {
 public:
  static constexpr T kCanary = static_cast<T>(kUnwritten);
  static constexpr std::size_t kEach = 64;  // more than any vector is long

  // All of it, the usable part too, becomes canaries.
  std::span<T> Reset(std::size_t size) {
    elements_.assign(size + 2 * kEach, kCanary);
    return std::span<T>(elements_).subspan(kEach, size);
  }

  // Nothing outside the first `used` usable elements was written.
  bool IntactBut(std::size_t used) const {
    const auto is_canary = [](T value) { return value == kCanary; };
    const auto begin = elements_.begin() + kEach;
    return std::all_of(elements_.begin(), begin, is_canary) &&
           std::all_of(begin + static_cast<std::ptrdiff_t>(used),
                       elements_.end(), is_canary);
  }

 private:
  std::vector<T> elements_;
};

class CanariedOutputs {
 public:
  Outputs For(const Answer& answer) {
    words_ = answer.reject_mask().size();
    survivors_ = answer.survivors().size();
    return {mask_.Reset(words_), indices_.Reset(survivors_)};
  }

  bool Intact() const {
    return mask_.IntactBut(words_) && indices_.IntactBut(survivors_);
  }

 private:
  Canaried<std::uint64_t> mask_;
  Canaried<std::uint32_t> indices_;
  std::size_t words_ = 0;
  std::size_t survivors_ = 0;
};

// Answers() between canaries, with every schedule on every given target.
inline ::testing::AssertionResult AnswersEverywhere(
    const Answer& answer, const AnyWorld& world, const AnyQueries& query,
    std::span<const Target> targets, const Range& range = {}) {
  thread_local CanariedOutputs outputs;
  for (Target target : targets) {
    for (Schedule schedule : kSchedules) {
      const Options options{
          .schedule = schedule, .target = target, .range = range};
      auto result = Answers(answer, world, query, options, outputs.For(answer));
      if (!result) return result;
      if (!outputs.Intact()) {
        return internal::Fail("a call", options) << "wrote past its output";
      }
    }
  }
  return ::testing::AssertionSuccess();
}
template <typename World>
::testing::AssertionResult AnswersEverywhere(const Answer& answer,
                                             const World& world,
                                             const typename World::Query& query,
                                             std::span<const Target> targets,
                                             const Range& range = {}) {
  return AnswersEverywhere(answer, AnyWorld(world), {&query, 1}, targets,
                           range);
}

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_SUPPORT_CANARIES_H_

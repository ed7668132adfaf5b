// What coded worlds answer: exactly what the floats do, or, of codes alone, no
// more rejections than that.
#ifndef HALFSPACE_TESTS_LIBRARY_QUANTIZED_CODED_ANSWERS_H_
#define HALFSPACE_TESTS_LIBRARY_QUANTIZED_CODED_ANSWERS_H_

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "halfspace/codes.h"
#include "halfspace/reject.h"
#include "tests/library/support/answers.h"
#include "tests/library/support/canaries.h"

namespace halfspace::testing {

// The answer of any world, by one call on one target.
template <typename AnyWorld>
Answer AnswerByMask(const AnyWorld& world, std::size_t size,
                    const typename AnyWorld::Query& query, Target target) {
  std::vector<std::uint64_t> mask(MaskWords(size));
  RejectMask(world, query, mask,
             {.schedule = Schedule::kFlat, .target = target});
  return Answer(
      size, [&](std::size_t i) { return (mask[i / 64] >> (i % 64) & 1) != 0; });
}

// Whatever survives in `exact` survives in `coded` too.
inline ::testing::AssertionResult KeepsAllOf(const Answer& exact,
                                             const Answer& coded) {
  for (const std::uint32_t i : exact.survivors()) {
    if ((coded.reject_mask()[i / 64] >> (i % 64) & 1) == 0) continue;
    return ::testing::AssertionFailure()
           << "the codes reject object " << i << ", which floats keep";
  }
  return ::testing::AssertionSuccess();
}

// Codes alone keep what floats keep, and all calls agree on what that is;
// confirmed, they are the floats' answer. Everywhere.
template <typename FloatView, typename Code>
::testing::AssertionResult CodesAnswerEverywhere(
    const Codes<FloatView, Code>& codes, const FloatView& floats,
    const typename FloatView::Query& query, std::span<const Target> targets) {
  const Answer exact = ReferenceAnswer(floats, query);
  const Answer coded = AnswerByMask(codes, codes.size(), query, targets[0]);
  auto result = KeepsAllOf(exact, coded);
  if (result) result = AnswersEverywhere(coded, codes, query, targets);
  if (!result) return result << " (codes alone)";
  result = AnswersEverywhere(exact, Confirmed(codes, floats), query, targets);
  if (!result) return result << " (confirmed)";
  return result;
}

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_QUANTIZED_CODED_ANSWERS_H_

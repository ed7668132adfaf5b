// The answers of quantized worlds: exactly those of the floats, or, without
// refining, no more rejections than those.
#ifndef HALFSPACE_TESTS_LIBRARY_QUANTIZED_QUANTIZED_ANSWERS_H_
#define HALFSPACE_TESTS_LIBRARY_QUANTIZED_QUANTIZED_ANSWERS_H_

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "halfspace/quantized.h"
#include "halfspace/reject.h"
#include "tests/library/support/answers.h"
#include "tests/library/support/canaries.h"

namespace halfspace::testing {

// The answer of any world, by one call on one target.
inline Answer AnswerByMask(const AnyWorld& world, const AnyQueries& query,
                           Target target) {
  std::vector<std::uint64_t> mask(MaskWords(world.size()));
  detail::RejectMask(world.Asked(query), mask,
                     {.schedule = Schedule::kFlat, .target = target});
  return Answer(world.size(), [&](std::size_t i) {
    return (mask[i / 64] >> (i % 64) & 1) != 0;
  });
}
template <typename World>
Answer AnswerByMask(const World& world, std::size_t size,
                    const typename World::Query& query, Target target) {
  EXPECT_EQ(world.view().size, size);
  return AnswerByMask(AnyWorld(world), {&query, 1}, target);
}

// Whatever survives in `exact` survives in `quantized` too.
inline ::testing::AssertionResult KeepsAllOf(const Answer& exact,
                                             const Answer& of_quantized) {
  for (const std::uint32_t i : exact.survivors()) {
    if ((of_quantized.reject_mask()[i / 64] >> (i % 64) & 1) == 0) continue;
    return ::testing::AssertionFailure()
           << "quantized bounds reject object " << i << ", which floats keep";
  }
  return ::testing::AssertionSuccess();
}

// Quantized bounds alone keep what floats keep, and all calls agree on what
// that is; refined, they are the floats' answer. Everywhere.
inline ::testing::AssertionResult QuantizedAnswersEverywhere(
    const AnyWorld& quantized, const AnyWorld& refined, const Answer& exact,
    const AnyQueries& query, std::span<const Target> targets) {
  const Answer of_quantized = AnswerByMask(quantized, query, targets[0]);
  auto result = KeepsAllOf(exact, of_quantized);
  if (result)
    result = AnswersEverywhere(of_quantized, quantized, query, targets);
  if (!result) return result << " (quantized alone)";
  result = AnswersEverywhere(exact, refined, query, targets);
  if (!result) return result << " (refined)";
  return result;
}
template <typename FloatView, typename Element>
::testing::AssertionResult QuantizedAnswersEverywhere(
    const QuantizedBounds<FloatView, Element>& quantized,
    const FloatView& floats, const typename FloatView::Query& query,
    std::span<const Target> targets) {
  return QuantizedAnswersEverywhere(
      AnyWorld(quantized), AnyWorld(Refined(quantized, floats)),
      ReferenceAnswer(floats, query), {&query, 1}, targets);
}

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_QUANTIZED_QUANTIZED_ANSWERS_H_

// The answers of quantized worlds: exactly those of the floats, or, without
// refining, no more rejections than those.
#ifndef HALFSPACE_TESTS_LIBRARY_QUANTIZED_QUANTIZED_ANSWERS_H_
#define HALFSPACE_TESTS_LIBRARY_QUANTIZED_QUANTIZED_ANSWERS_H_

#include <gtest/gtest.h>

#include <cstddef>
#include <span>

#include "halfspace/quantized.h"
#include "tests/library/support/answers.h"

namespace halfspace::testing {

// Whatever survives in `exact` survives in `of_quantized` too.
inline ::testing::AssertionResult KeepsAllOf(const Answers& exact,
                                             const Answers& of_quantized) {
  for (std::size_t w = 0; w < exact.survived().size(); ++w) {
    if ((exact.survived()[w] & of_quantized.rejected()[w]) == 0) continue;
    return ::testing::AssertionFailure()
           << "quantized bounds reject an object of word " << w
           << ", which floats keep";
  }
  return ::testing::AssertionSuccess();
}

// Quantized bounds alone keep what floats keep, and all calls agree on what
// that is; refined, they are the floats' answers. Everywhere.
inline ::testing::AssertionResult QuantizedAnswersEverywhere(
    const AnyWorld& quantized, const AnyWorld& refined, const Answers& exact,
    const AnyQueries& queries, std::span<const Target> targets) {
  const Answers of_quantized =
      Answers::OfCall(quantized, queries, targets[0], exact.range());
  auto result = KeepsAllOf(exact, of_quantized);
  if (result) {
    result = AnswersEverywhere(of_quantized, quantized, queries, targets);
  }
  if (!result) return result << " (quantized alone)";
  result = AnswersEverywhere(exact, refined, queries, targets);
  if (!result) return result << " (refined)";
  return result;
}

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_QUANTIZED_QUANTIZED_ANSWERS_H_

// Answers worked out by hand, since two implementations that agree may share
// an error.
//
// Most queries are the corner simplex with vertices 0 and 2 on every axis:
// X, Y, ... go from 0 to 2, and D = -(X + Y + ...) from -2 to 0.
#ifndef HALFSPACE_TESTS_LIBRARY_REJECT_KNOWN_ANSWERS_H_
#define HALFSPACE_TESTS_LIBRARY_REJECT_KNOWN_ANSWERS_H_

#include <gtest/gtest.h>

#include <cstddef>
#include <initializer_list>
#include <limits>
#include <vector>

#include "halfspace/world.h"
#include "tests/library/support/answers.h"
#include "tests/library/support/canaries.h"
#include "tests/library/support/environment.h"

namespace halfspace::testing {

inline constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
inline constexpr float kAbove2 = 0x1.000002p1f;  // one ulp above 2
inline constexpr float kTiny = 0x1p-149f;        // one ulp above 0

enum class Fate { kKept, kRejected };

template <typename Bound>
struct KnownAnswer {
  const char* why;
  Bound bound;
  Fate fate;
};

// Expects every bound's fate, of many copies: whole words and a tail.
template <typename View>
void ExpectFates(
    const typename View::Query& query,
    std::initializer_list<KnownAnswer<typename View::Bound>> known) {
  constexpr std::size_t kCopies = 3 * 64 - 1;
  const std::vector<Target> targets = TargetsUnderTest();
  for (const auto& [why, bound, fate] : known) {
    const World<View> world(std::vector(kCopies, bound));
    const bool rejected = fate == Fate::kRejected;
    const Answer answer(kCopies, [&](std::size_t) { return rejected; });
    EXPECT_TRUE(AnswersEverywhere(answer, world, query, targets)) << why;
  }
}

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_REJECT_KNOWN_ANSWERS_H_

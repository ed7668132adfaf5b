// The loop of the tests against exact arithmetic: many samples of every kind.
#ifndef HALFSPACE_TESTS_LIBRARY_SUPPORT_SAMPLES_H_
#define HALFSPACE_TESTS_LIBRARY_SUPPORT_SAMPLES_H_

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <string>

#include "tests/library/support/environment.h"
#include "tests/library/support/points.h"

namespace halfspace::testing {

// Says in the test's XML report how much it tested; tests/full_scale.sh adds
// the numbers up.
inline void RecordSize(const char* what, std::size_t size) {
  ::testing::Test::RecordProperty(what, std::to_string(size));
}

// Runs check(kind, random), which looks at `bounds` bounds, for Scaled(samples)
// samples of each kind, or until one fails.
template <typename Check>
void ForEachSample(std::uint64_t seed, std::size_t samples, std::size_t bounds,
                   Check check) {
  Random random(seed);
  const std::size_t count = Scaled(samples);
  for (PointKind kind : kPointKinds) {
    for (std::size_t i = 0; i < count; ++i) {
      check(kind, random);
      if (::testing::Test::HasFailure()) {
        GTEST_FAIL() << NameOf(kind) << ", sample " << i;
      }
    }
  }
  RecordSize("bounds", kPointKinds.size() * count * bounds);
}

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_SUPPORT_SAMPLES_H_

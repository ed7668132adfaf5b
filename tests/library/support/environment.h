// What the environment says about a run of the tests: which targets, how much.
#ifndef HALFSPACE_TESTS_LIBRARY_SUPPORT_ENVIRONMENT_H_
#define HALFSPACE_TESTS_LIBRARY_SUPPORT_ENVIRONMENT_H_

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <vector>

#include "halfspace/targets.h"

namespace halfspace::testing {

// All supported targets, or only the one that HALFSPACE_TARGET forces.
inline std::vector<Target> TargetsUnderTest() {
  if (!DescribeTargetChoice().requested.empty()) return {ChosenTarget()};
  const auto supported = SupportedTargets();
  return {supported.begin(), supported.end()};
}

// float32 lanes of the widest target under test.
inline std::size_t MostLanes() {
  std::size_t most = 0;
  for (Target target : TargetsUnderTest()) {
    most = std::max(most, target.lanes());
  }
  return most;
}

// HALFSPACE_TEST_SCALE, 1 if it is not set: the share of the full sizes.
inline double TestScale() {
  static const double scale = [] {
    const char* text = std::getenv("HALFSPACE_TEST_SCALE");
    if (text == nullptr || *text == '\0') return 1.0;
    char* end = nullptr;
    const double value = std::strtod(text, &end);
    if (*end != '\0' || !(value > 0.0)) {
      throw std::runtime_error(
          "HALFSPACE_TEST_SCALE: expected a positive number, got \"" +
          std::string(text) + "\"");
    }
    return value;
  }();
  return scale;
}

// `full` at full scale, fewer at a smaller one, at least 1.
inline std::size_t Scaled(std::size_t full) {
  return static_cast<std::size_t>(
      std::max(1.0, std::round(static_cast<double>(full) * TestScale())));
}

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_SUPPORT_ENVIRONMENT_H_

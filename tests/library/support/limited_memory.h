// Memory that comes to an end when a test says so. An executable that links
// limited_memory.cc allocates everything by it.
#ifndef HALFSPACE_TESTS_LIBRARY_SUPPORT_LIMITED_MEMORY_H_
#define HALFSPACE_TESTS_LIBRARY_SUPPORT_LIMITED_MEMORY_H_

#include <gtest/gtest.h>

#include <cstddef>
#include <limits>
#include <new>

namespace halfspace::testing {

inline constexpr std::size_t kNoAllocationLimit =
    std::numeric_limits<std::size_t>::max();

// How many allocations are left before std::bad_alloc. For one thread.
extern std::size_t allocations_left;

// Runs call() without memory.
inline constexpr auto kWithoutMemory = [](const auto& call) {
  bool had_enough = true;
  allocations_left = 0;
  try {
    (void)call();
  } catch (const std::bad_alloc&) {
    had_enough = false;
  }
  allocations_left = kNoAllocationLimit;
  EXPECT_TRUE(had_enough);
};

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_SUPPORT_LIMITED_MEMORY_H_

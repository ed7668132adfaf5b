// Memory that comes to an end when a test says so. An executable that links
// limited_memory.cc allocates everything by it.
#ifndef HALFSPACE_TESTS_LIBRARY_SUPPORT_LIMITED_MEMORY_H_
#define HALFSPACE_TESTS_LIBRARY_SUPPORT_LIMITED_MEMORY_H_

#include <cstddef>
#include <limits>

namespace halfspace::testing {

inline constexpr std::size_t kNoAllocationLimit =
    std::numeric_limits<std::size_t>::max();

// How many allocations are left before std::bad_alloc. For one thread.
extern std::size_t allocations_left;

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_SUPPORT_LIMITED_MEMORY_H_

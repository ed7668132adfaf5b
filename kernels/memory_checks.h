// Checks of the caller's memory that all calls share. O(1). Names are made only
// for messages: a call that is right allocates nothing.
#ifndef HALFSPACE_KERNELS_MEMORY_CHECKS_H_
#define HALFSPACE_KERNELS_MEMORY_CHECKS_H_

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "kernels/error.h"

namespace halfspace::kernels {

// Throws unless `pointer` is neither null nor misaligned. name() and expected()
// return strings for the message.
template <typename Name, typename Expected>
void CheckPointer(std::string_view call, const void* pointer,
                  std::size_t alignment, const Name& name,
                  const Expected& expected) {
  if (pointer == nullptr) {
    ThrowInvalid(call, name(), expected(), "a null pointer");
  }
  if (reinterpret_cast<std::uintptr_t>(pointer) % alignment != 0) {
    ThrowInvalid(call, name(),
                 "a pointer aligned to " + std::to_string(alignment) + " bytes",
                 "a misaligned one");
  }
}

// Whether two ranges of bytes share one.
inline bool Overlap(const void* a, std::size_t a_bytes, const void* b,
                    std::size_t b_bytes) {
  const auto first = reinterpret_cast<std::uintptr_t>(a);
  const auto second = reinterpret_cast<std::uintptr_t>(b);
  if (a_bytes == 0 || b_bytes == 0) return false;
  // Differences wrap, and so tell which one begins inside the other.
  return second - first < a_bytes || first - second < b_bytes;
}

}  // namespace halfspace::kernels

#endif  // HALFSPACE_KERNELS_MEMORY_CHECKS_H_

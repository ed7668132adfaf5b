// Checks of the caller's memory that all calls share. O(1). Names are made only
// for messages: a call that is right allocates nothing.
#ifndef HALFSPACE_KERNELS_MEMORY_CHECKS_H_
#define HALFSPACE_KERNELS_MEMORY_CHECKS_H_

#include <cstddef>
#include <cstdint>
#include <limits>
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

// Throws unless the scalars of `count` > 0 elements fit the address space: one
// begins `stride` scalars after another, and the last has `last`. The message
// names the larger of stride and count; `argument` is also the name of the
// elements.
inline void CheckExtent(std::string_view call, std::string_view argument,
                        std::size_t scalar_bytes, std::size_t count,
                        std::size_t stride, std::size_t last) {
  const std::size_t most =
      std::numeric_limits<std::size_t>::max() / scalar_bytes;
  if (stride == 0 || count - 1 <= (most - last) / stride) return;
  const std::string name(argument);
  if (stride > count) {
    ThrowInvalid(call, name + ".stride",
                 "a stride with which " + std::to_string(count) + ' ' + name +
                     " fit the address space",
                 std::to_string(stride));
  }
  ThrowInvalid(call, name + ".count",
               name + " that fit the address space with stride " +
                   std::to_string(stride),
               std::to_string(count));
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

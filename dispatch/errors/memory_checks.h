// Checks of the caller's memory that all calls share. O(1). Names are made only
// for messages: a call that is right allocates nothing.
#ifndef HALFSPACE_DISPATCH_ERRORS_MEMORY_CHECKS_H_
#define HALFSPACE_DISPATCH_ERRORS_MEMORY_CHECKS_H_

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>

#include "dispatch/errors/error.h"
#include "kernels/compiler.h"

namespace halfspace::dispatch {

// Whether it is neither null nor misaligned.
inline bool IsAligned(const void* pointer, std::size_t alignment) {
  const auto address = reinterpret_cast<std::uintptr_t>(pointer);
  return address != 0 && (address & (alignment - 1)) == 0;
}

// What throws is apart from the checks, as it is many times their code.
[[noreturn, gnu::cold]] HALFSPACE_NOINLINE inline void ThrowPointer(
    std::string_view call, const void* pointer, std::size_t alignment,
    std::string_view name, std::string_view expected) {
  if (pointer == nullptr) {
    ThrowInvalid(call, name, expected, "a null pointer");
  }
  ThrowInvalid(call, name,
               "a pointer aligned to " + std::to_string(alignment) + " bytes",
               "a misaligned one");
}

// Throws unless `pointer` is neither null nor misaligned. name() and expected()
// return strings for the message. `alignment` is a power of two: a division
// would take longer than the other checks of a call.
template <typename Name, typename Expected>
inline void CheckPointer(std::string_view call, const void* pointer,
                         std::size_t alignment, const Name& name,
                         const Expected& expected) {
  if (!IsAligned(pointer, alignment)) {
    ThrowPointer(call, pointer, alignment, name(), expected());
  }
}

[[noreturn, gnu::cold]] HALFSPACE_NOINLINE inline void ThrowMemory(
    std::string_view call, std::string_view argument, const void* memory,
    std::size_t size, std::size_t alignment) {
  ThrowPointer(call, memory, alignment, argument,
               "memory for " + std::to_string(size) + " elements");
}

// Throws unless there is aligned memory for `size` elements. If `size` is 0,
// any pointer is valid.
inline void CheckMemory(std::string_view call, std::string_view argument,
                        const void* memory, std::size_t size,
                        std::size_t alignment) {
  if (size != 0 && !IsAligned(memory, alignment)) {
    ThrowMemory(call, argument, memory, size, alignment);
  }
}

[[noreturn, gnu::cold]] HALFSPACE_NOINLINE inline void ThrowExtent(
    std::string_view call, std::string_view argument, std::size_t count,
    std::size_t stride) {
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
  ThrowExtent(call, argument, count, stride);
}

// Throws unless `count` elements of `bytes` each fit the address space.
inline void CheckAddressable(std::string_view call, std::string_view argument,
                             std::size_t count, std::size_t bytes) {
  if (count <= std::numeric_limits<std::size_t>::max() / bytes) return;
  ThrowInvalid(call, argument, "a size that fits the address space",
               std::to_string(count));
}

// Plane `p` of all minima, then all maxima.
[[gnu::cold]] inline std::string PlaneName(std::string_view planes,
                                           std::size_t axes, std::size_t p) {
  std::string name(planes);
  name += p < axes ? ".min[" : ".max[";
  return name + std::to_string(p % axes) + "]";
}

// From the first of `count` scalars to the end of the last.
constexpr std::size_t ColumnBytes(std::size_t count, std::size_t stride,
                                  std::size_t scalar_bytes) {
  return count == 0 ? 0 : ((count - 1) * stride + 1) * scalar_bytes;
}

[[noreturn]] inline void ThrowOverlap(std::string_view call,
                                      std::string_view argument,
                                      std::string_view other,
                                      std::string_view what = "an overlap") {
  ThrowInvalid(call, argument, "memory apart from " + std::string(other), what);
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

}  // namespace halfspace::dispatch

#endif  // HALFSPACE_DISPATCH_ERRORS_MEMORY_CHECKS_H_

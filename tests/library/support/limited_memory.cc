// In a file of its own: a compiler that sees both the operators and their use
// takes them for mismatched.
#include "tests/library/support/limited_memory.h"

#include <cstddef>
#include <cstdlib>
#include <new>

namespace halfspace::testing {

std::size_t allocations_left = kNoAllocationLimit;

namespace {

void* Allocate(std::size_t size, std::size_t alignment) {
  if (allocations_left == 0) throw std::bad_alloc();
  if (allocations_left != kNoAllocationLimit) --allocations_left;
  const std::size_t whole = (size + alignment) / alignment * alignment;
  void* memory = std::aligned_alloc(alignment, whole);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

}  // namespace
}  // namespace halfspace::testing

void* operator new(std::size_t size) {
  return halfspace::testing::Allocate(size, alignof(std::max_align_t));
}
void* operator new(std::size_t size, std::align_val_t alignment) {
  return halfspace::testing::Allocate(size,
                                      static_cast<std::size_t>(alignment));
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
  std::free(memory);
}

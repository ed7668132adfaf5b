// Internal. Memory of the owning worlds: cache lines, and huge pages where
// there are enough of them. Not part of the interface.
#ifndef HALFSPACE_DETAIL_BLOCK_MEMORY_H_
#define HALFSPACE_DETAIL_BLOCK_MEMORY_H_

#include <cstddef>
#include <limits>
#include <new>

#include "halfspace/export.h"

namespace halfspace::detail {

// At least 64-byte aligned. Throws std::bad_alloc.
HALFSPACE_API void* AllocateBlock(std::size_t bytes);
HALFSPACE_API void FreeBlock(void* block, std::size_t bytes);

// The same for std::vector.
template <typename T>
struct BlockAllocator {
  using value_type = T;

  BlockAllocator() = default;
  template <typename U>
  explicit BlockAllocator(const BlockAllocator<U>&) {}

  T* allocate(std::size_t count) {
    return static_cast<T*>(AllocateBlock(count * sizeof(T)));
  }
  void deallocate(T* block, std::size_t count) {
    FreeBlock(block, count * sizeof(T));
  }
  friend bool operator==(const BlockAllocator&, const BlockAllocator&) {
    return true;
  }
  friend bool operator!=(const BlockAllocator&, const BlockAllocator&) {
    return false;
  }
};

}  // namespace halfspace::detail

#endif  // HALFSPACE_DETAIL_BLOCK_MEMORY_H_

// Internal. Memory of the owning worlds: cache lines, and, of the default
// resource, huge pages where there are enough of them. Not part of the
// interface.
#ifndef HALFSPACE_DETAIL_BLOCK_MEMORY_H_
#define HALFSPACE_DETAIL_BLOCK_MEMORY_H_

#include <cstddef>
#include <type_traits>
#include <utility>

#include "halfspace/export.h"
#include "halfspace/memory.h"

namespace halfspace::detail {

// At least 64-byte aligned. Throws std::bad_alloc.
HALFSPACE_API void* AllocateBlock(const MemoryResource& memory,
                                  std::size_t bytes);
HALFSPACE_API void FreeBlock(const MemoryResource& memory, void* block,
                             std::size_t bytes);

// The same for std::vector.
template <typename T>
class BlockAllocator {
 public:
  using value_type = T;
  using propagate_on_container_swap = std::true_type;
  using is_always_equal = std::false_type;

  BlockAllocator() = default;
  explicit BlockAllocator(const MemoryResource& memory) : memory_(memory) {}
  template <typename U>
  explicit BlockAllocator(const BlockAllocator<U>& other)
      : memory_(other.memory()) {}

  const MemoryResource& memory() const { return memory_; }

  T* allocate(std::size_t count) {
    return static_cast<T*>(AllocateBlock(memory_, count * sizeof(T)));
  }
  void deallocate(T* block, std::size_t count) {
    FreeBlock(memory_, block, count * sizeof(T));
  }
  BlockAllocator select_on_container_copy_construction() const { return {}; }

  friend bool operator==(const BlockAllocator& a, const BlockAllocator& b) {
    return a.memory_ == b.memory_;
  }
  friend bool operator!=(const BlockAllocator& a, const BlockAllocator& b) {
    return !(a == b);
  }

 private:
  MemoryResource memory_;
};

// The assignments of all owners, which keep their resource, and are as they
// were if there is no memory.
template <typename Owner>
Owner& AssignCopy(Owner& to, const Owner& from) {
  Owner copy(from, to.memory());
  swap(to, copy);
  return to;
}
template <typename Owner>
Owner& AssignMove(Owner& to, Owner& from) {
  const bool is_copied = to.memory() != from.memory();
  if (is_copied) AssignCopy(to, from);
  Owner taken(std::move(from));  // leaves it empty
  if (!is_copied) swap(to, taken);
  return to;
}

}  // namespace halfspace::detail

#endif  // HALFSPACE_DETAIL_BLOCK_MEMORY_H_

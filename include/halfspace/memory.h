// Where owners allocate memory. The owners are World (world.h),
// QuantizedBounds and QuantizedWorld (quantized.h) and Bvh (bvh.h).
//
//   std::pmr::monotonic_buffer_resource arena;
//   halfspace::AaboWorld3 world(halfspace::MemoryFrom(arena));
//
// An owner allocates all memory from its resource, also memory that it needs
// only during a call. The default resource is operator new. On Linux the
// library requests huge pages for its blocks of 4 MiB or more.
//
// The rest of the library allocates only for the text of an error, for the
// choice of a target and its description (targets.h).
//
// Owners choose a resource like containers of std::pmr:
// - A new owner uses the given resource, or the default.
// - A copy uses the default, or the given resource, as in World(other, memory).
// - An owner that is created by a move uses the resource of the source.
// - An owner that is assigned to keeps its resource. A move assignment between
//   equal resources takes the block of the source and never throws. Between
//   different resources it copies, and can throw. If it throws, both owners are
//   unchanged.
// - swap(a, b), called without a namespace, exchanges blocks and resources, and
//   never throws. std::swap consists of moves: each owner keeps its resource if
//   these differ.
// A moved-from owner is empty and keeps its resource.
//
// An owner that grows allocates the new block before it frees the old one. If
// the resource does not reuse freed blocks, call Reserve() first. A Bvh also
// allocates memory to sort with: give it a resource that reuses blocks.
#ifndef HALFSPACE_MEMORY_H_
#define HALFSPACE_MEMORY_H_

#include <cstddef>

namespace halfspace {

// The functions that an owner calls, and their context. Set both functions, or
// neither for the default resource. To set only one is an error (error.h).
//
// Owners copy this struct. The object that `context` points to must outlive the
// owners, and all owners to which they are moved.
//
// This is not std::pmr::memory_resource, because engines often have none. Also,
// <memory_resource> is a large header (25 000 lines with gcc 12), which only
// its users should include. MemoryResource is the same type for callers and
// library with any compiler flags and any standard library.
//
// Thread safety: the functions are called by the thread that creates, changes
// or destroys an owner, or calls PairsOf() or ForEachPairOf() on it
// (bvh_pairs.h).
struct MemoryResource {
  // Returns `bytes` > 0 bytes of memory, aligned to `alignment`, which is 64.
  //
  // If there is no memory, it throws std::bad_alloc, or returns null, and the
  // owner throws std::bad_alloc. The owner is then unchanged. If the memory is
  // misaligned, the owner frees it and reports an error (error.h).
  void* (*allocate)(void* context, std::size_t bytes,
                    std::size_t alignment) = nullptr;
  // Frees a block. `bytes` and `alignment` are the same as at its allocation.
  // Must not throw.
  void (*deallocate)(void* context, void* block, std::size_t bytes,
                     std::size_t alignment) = nullptr;
  void* context = nullptr;

  friend constexpr bool operator==(const MemoryResource& a,
                                   const MemoryResource& b) {
    return a.allocate == b.allocate && a.deallocate == b.deallocate &&
           a.context == b.context;
  }
  friend constexpr bool operator!=(const MemoryResource& a,
                                   const MemoryResource& b) {
    return !(a == b);
  }
};

// Returns a MemoryResource that calls resource.allocate(bytes, alignment) and
// resource.deallocate(block, bytes, alignment), for example of a
// std::pmr::memory_resource. `resource` must outlive the owners. Two results
// are equal only if they have the same object and the same type `Resource`.
template <typename Resource>
MemoryResource MemoryFrom(Resource& resource) {
  MemoryResource memory;
  memory.allocate = [](void* context, std::size_t bytes,
                       std::size_t alignment) -> void* {
    return static_cast<Resource*>(context)->allocate(bytes, alignment);
  };
  memory.deallocate = [](void* context, void* block, std::size_t bytes,
                         std::size_t alignment) {
    static_cast<Resource*>(context)->deallocate(block, bytes, alignment);
  };
  memory.context = &resource;
  return memory;
}

}  // namespace halfspace

#endif  // HALFSPACE_MEMORY_H_

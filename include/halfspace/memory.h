// Where owners get their memory: World (world.h), QuantizedBounds and
// QuantizedWorld (quantized.h), SortedWorld (sorted.h). Nothing else in the
// library allocates, but for the text of an error, and the choice of a target,
// once.
//
//   std::pmr::monotonic_buffer_resource arena;
//   AaboWorld3 world(MemoryFrom(arena));
//
// Whatever an owner allocates comes from its resource, that which it needs for
// the time of a call included (PairsOf() of sorted_pairs.h is such a call).
// Without one it comes from operator new, in huge pages where there are enough
// of them.
//
// Which resource an owner uses is as in std::pmr:
// - Constructed: the one that is given, or the default.
// - Copied: the default, unless one is given, as in World(other, memory).
// - Made by a move: that of the source.
// - Assigned to: its own, which it keeps. A move from an owner with an equal
//   resource takes its block and throws nothing; from another it copies, and
//   may throw, and both are then as they were.
// - swap(a, b), found by its arguments: each takes the other's resource with
//   its block, and nothing is thrown. std::swap is made of moves, and leaves
//   each its own resource if they differ.
// What was moved from is empty, and keeps its resource.
//
// An owner that grows gets the new block before it gives the old one back.
// Where blocks that are given back are not used again, Reserve() first.
//
// Two functions and a context, because engines have those and often no
// std::pmr: a std::pmr::memory_resource fits into them, and <memory_resource>,
// 25 000 lines with gcc 12, is left to those who use it. Callers and library
// see the same type then, whatever their flags and standard libraries.
#ifndef HALFSPACE_MEMORY_H_
#define HALFSPACE_MEMORY_H_

#include <cstddef>

namespace halfspace {

// Both functions, or neither for the default. Owners copy it; what `context`
// points to must outlive them, and those that they are moved to.
//
// Thread safety: the functions are called by the thread that changes, makes or
// destroys an owner, or that calls PairsOf() or ForEachPairOf() on it.
struct MemoryResource {
  // Memory of `bytes` > 0, aligned to `alignment`, which is 64. May throw
  // std::bad_alloc, or return null, which the owner turns into std::bad_alloc:
  // the owner is then as it was. Misaligned memory is given back, and is a
  // violated precondition (error.h).
  void* (*allocate)(void* context, std::size_t bytes,
                    std::size_t alignment) = nullptr;
  // Gives a block back, with the size and alignment that it was allocated with.
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

// Anything with allocate(bytes, alignment) and deallocate(block, bytes,
// alignment): a std::pmr::memory_resource, say. It must outlive the owners.
// Equal only to one of the same object and type.
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

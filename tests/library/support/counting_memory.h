// A resource of the caller's that knows what it gave, and can come to an end.
#ifndef HALFSPACE_TESTS_LIBRARY_SUPPORT_COUNTING_MEMORY_H_
#define HALFSPACE_TESTS_LIBRARY_SUPPORT_COUNTING_MEMORY_H_

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <new>

#include "halfspace/memory.h"

#ifdef _WIN32
#include <malloc.h>
#endif

namespace halfspace::testing {

enum class Failure { kThrows, kReturnsNull };

// Its own memory is malloc's, so that operator new can be forbidden meanwhile.
// Before each block stand its size and the resource that it came from.
class CountingMemory {
 public:
  explicit CountingMemory(Failure failure = Failure::kThrows)
      : failure_(failure) {}
  CountingMemory(const CountingMemory&) = delete;
  CountingMemory& operator=(const CountingMemory&) = delete;
  ~CountingMemory() { EXPECT_EQ(blocks, 0u); }

  void* allocate(std::size_t bytes, std::size_t alignment) {
    EXPECT_EQ(alignment, kAlignment);
    EXPECT_GT(bytes, 0u);
    if (left == 0) {
      if (failure_ == Failure::kThrows) throw std::bad_alloc();
      return nullptr;
    }
    if (left != kNoLimit) --left;
    const std::size_t whole = (bytes / kAlignment + 2) * kAlignment;
#ifdef _WIN32
    void* const block = _aligned_malloc(whole, kAlignment);
#else
    void* const block = std::aligned_alloc(kAlignment, whole);
#endif
    auto* memory = static_cast<std::byte*>(block);
    new (memory) Header{bytes, this};
    // Tools know uninitialized bytes of all other blocks.
    if (fill != 0) std::memset(memory + kAlignment, fill, whole - kAlignment);
    ++blocks;
    ++allocations;
    allocated_bytes += bytes;
    return memory + kAlignment + shift;
  }

  void deallocate(void* block, std::size_t bytes, std::size_t alignment) {
    auto* memory = static_cast<std::byte*>(block) - kAlignment - shift;
    const Header header = *reinterpret_cast<const Header*>(memory);
    EXPECT_EQ(header.bytes, bytes);
    EXPECT_EQ(header.from, this);
    EXPECT_EQ(alignment, kAlignment);
    --blocks;
#ifdef _WIN32
    _aligned_free(memory);
#else
    std::free(memory);
#endif
  }

  MemoryResource resource() { return MemoryFrom(*this); }

  static constexpr std::size_t kNoLimit =
      std::numeric_limits<std::size_t>::max();
  std::size_t left = kNoLimit;  // allocations before there is no memory
  std::size_t blocks = 0;       // that were not given back
  std::size_t allocations = 0;
  std::size_t allocated_bytes = 0;  // by all allocations
  int fill = 0;                     // the bytes of a new block
  std::size_t shift = 0;            // bytes that blocks lie off their alignment

 private:
  static constexpr std::size_t kAlignment = 64;
  struct Header {
    std::size_t bytes;
    const CountingMemory* from;
  };

  Failure failure_;
};

// Makes a call with memory for 0, 1, 2, ... allocations, until it is enough.
// After each failure there is memory again, and check() is called. Returns how
// many calls failed.
template <typename Call, typename Check>
std::size_t FailuresOf(CountingMemory& memory, const Call& call,
                       const Check& check) {
  for (std::size_t failures = 0;; ++failures) {
    memory.left = failures;
    bool is_done = true;
    try {
      call();
    } catch (const std::bad_alloc&) {
      is_done = false;
    }
    memory.left = CountingMemory::kNoLimit;
    if (is_done) return failures;
    check();
  }
}

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_SUPPORT_COUNTING_MEMORY_H_
